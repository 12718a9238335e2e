// The parts of a mesh among each other: which lie within which, which way round they are, and which
// meet. Private to host/validate.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <unordered_set>
#include <vector>

#include "gliss/base/vector.h"
#include "gliss/validate/validate_steps.h"

namespace gliss {

class PartPairs {
 public:
  // The mesh, its parts and the report outlive it. The faces of each part are one way round.
  PartPairs(Mesh& mesh, MeshParts& parts, Report& report);

  // Turns closed parts outward, unless they stay as the file has them, and open ones over where
  // that is asked for. A part that is wound against the closed part around it stays its cavity.
  void turn(const LoadOptions& options);
  // Warns of closed parts that meet other parts or hold them.
  void warn();

 private:
  void find_volumes();
  void find_boxes();
  void find_meeting();
  void find_containers();
  void reverse_part(std::uint32_t part);
  void warn_of_place(std::uint32_t part);
  void warn_of_inward(std::uint32_t part);
  bool encloses(std::uint32_t part) const {
    return parts_.closed[part] && parts_.volume[part] != 0;
  }
  bool lies_in_solid(std::uint32_t part) const;
  bool faces_meet(std::uint32_t a, std::uint32_t b) const;
  bool winds_round(std::uint32_t part, const Vec3& x) const;
  const Vec3& corner(std::uint32_t c) const { return mesh_.positions[mesh_.corner_vertex[c]]; }
  static std::uint64_t key(std::uint32_t a, std::uint32_t b) {
    return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
  }

  static constexpr std::size_t kMostPairs = 100'000;  // that are looked for

  Mesh& mesh_;
  MeshParts& parts_;
  Report& report_;
  std::vector<std::vector<std::uint32_t>> faces_;        // [part]
  std::vector<Box> boxes_, part_boxes_;                  // [face], [part]; once needed
  std::optional<std::vector<std::uint32_t>> container_;  // [part], the closed part next around it
  bool has_met_ = false;                                 // these are found:
  std::unordered_set<std::uint64_t> met_;                // pairs of parts
  std::uint32_t meets_ = kNone, other_ = kNone;          // faces of the pair that is named
};

}  // namespace gliss
