// Turns faces one way round: neighbours agree, most faces win, and closed parts enclose a positive
// volume.
#include <algorithm>
#include <cmath>
#include <utility>

#include "gliss/mesh/mesh_edges.h"
#include "gliss/validate/validate_steps.h"

namespace gliss {
namespace {

// Six times the volume of the cone from `apex` over a face, and its size without sign.
struct Volume {
  double value = 0;
  double size = 0;
};

Volume cone_volume(const Mesh& mesh, std::uint32_t face, const Vec3& apex) {
  const auto from_apex = [&](std::uint32_t corner) -> Vec3 {
    return mesh.positions[mesh.corner_vertex[corner]] - apex;
  };
  Volume volume;
  const std::uint32_t begin = mesh.face_begin[face];
  const Vec3 first = from_apex(begin);
  for (std::uint32_t c = begin + 1; c + 1 < mesh.face_begin[face + 1]; ++c) {
    const double part = first.dot(from_apex(c).cross(from_apex(c + 1)));
    volume.value += part;
    volume.size += std::abs(part);
  }
  return volume;
}

class Orientation {
 public:
  Orientation(Mesh& mesh, Report& report)
      : mesh_(mesh),
        report_(report),
        side_face_(side_faces(mesh)),
        other_(pair_sides(mesh, side_face_)),
        turn_(mesh.face_count(), Turn::kUnknown),
        flipped_(mesh.face_count(), false) {}

  // Returns the number of parts.
  std::size_t repair() {
    report_borders();
    std::size_t parts = 0;
    std::uint32_t second = kNone;
    for (std::uint32_t face = 0; face < mesh_.face_count(); ++face) {
      if (turn_[face] != Turn::kUnknown) continue;
      settle_part(gather_part(face));
      if (++parts == 2) second = face;
    }
    report_flipped();
    if (parts < 2) return parts;
    report_
        .add(Severity::kWarning, "several-parts", {.face = second},
             "shares no edge with the part of the first face ({} parts)", parts)
        .count = parts;
    return parts;
  }

 private:
  enum class Turn : std::uint8_t { kUnknown, kKeep, kFlip };

  static Turn opposite(Turn turn) { return turn == Turn::kKeep ? Turn::kFlip : Turn::kKeep; }

  // Fills part_ with all faces around the first, each turned to suit it; true if none has a border.
  bool gather_part(std::uint32_t first) {
    bool closed = true;
    orientable_ = true;
    part_.assign(1, first);
    turn_[first] = Turn::kKeep;
    // part_ grows on the way. NOLINTNEXTLINE(modernize-loop-convert)
    for (std::size_t done = 0; done < part_.size(); ++done) {
      report_.poll();
      const std::uint32_t face = part_[done];
      for (std::uint32_t side = mesh_.face_begin[face]; side < mesh_.face_begin[face + 1]; ++side) {
        if (other_[side] == kNone) {
          closed = false;
        } else {
          visit_neighbour(side);
        }
      }
    }
    return closed;
  }

  void visit_neighbour(std::uint32_t side) {
    const std::uint32_t face = side_face_[side];
    const std::uint32_t neighbour = side_face_[other_[side]];
    const bool agree = mesh_.corner_vertex[side] != mesh_.corner_vertex[other_[side]];
    const Turn needed = agree ? turn_[face] : opposite(turn_[face]);
    if (turn_[neighbour] == Turn::kUnknown) {
      turn_[neighbour] = needed;
      part_.push_back(neighbour);
    } else if (turn_[neighbour] != needed && std::exchange(orientable_, false)) {
      const std::uint32_t from = mesh_.corner_vertex[side];
      report_.add(Severity::kError, "non-orientable", {.face = face, .vertex = from},
                  "cannot be turned the way of its neighbour at edge {}-{} and of all others", from,
                  end_vertex(side));
    }
  }

  void settle_part(bool closed) {
    if (!orientable_) return;
    const auto is_flipped = [&](std::uint32_t face) { return turn_[face] == Turn::kFlip; };
    const auto flipped = std::count_if(part_.begin(), part_.end(), is_flipped);
    if (2 * static_cast<std::size_t>(flipped) > part_.size()) turn_part();
    for (const std::uint32_t face : part_) flipped_[face] = is_flipped(face);
    if (closed) settle_inside();
    for (const std::uint32_t face : part_) {
      if (is_flipped(face)) flip(face);
    }
  }

  // Both in the order of the file, so that the first is named.
  void report_flipped() {
    for (std::uint32_t face = 0; face < mesh_.face_count(); ++face) {
      if (!flipped_[face]) continue;
      report_.add(Severity::kRepaired, "flipped-face", {.face = face},
                  "turned the other way than its part; turned back");
    }
  }
  void report_borders() {
    for (std::uint32_t side = 0; side < other_.size(); ++side) {
      report_.poll();
      if (other_[side] != kNone) continue;
      const std::uint32_t from = mesh_.corner_vertex[side];
      report_.add(Severity::kWarning, "open-border", {.face = side_face_[side], .vertex = from},
                  "has no neighbour beyond edge {}-{}", from, end_vertex(side));
    }
  }

  void turn_part() {
    for (const std::uint32_t face : part_) turn_[face] = opposite(turn_[face]);
  }

  void settle_inside() {
    constexpr double kRounding = 1e-12;
    const Vec3 apex = mesh_.positions[mesh_.corner_vertex[mesh_.face_begin[part_.front()]]];
    Volume sum;
    for (const std::uint32_t face : part_) {
      const Volume volume = cone_volume(mesh_, face, apex);
      sum.value += turn_[face] == Turn::kFlip ? -volume.value : volume.value;
      sum.size += volume.size;
    }
    if (!(std::abs(sum.value) > kRounding * sum.size)) {
      report_.add(Severity::kWarning, "no-volume", {.face = part_.front()},
                  "belongs to a closed part that encloses nothing ({} faces)", part_.size());
    } else if (sum.value < 0) {
      report_.add(Severity::kRepaired, "inside-out-part", {.face = part_.front()},
                  "belongs to a part that is inside out ({} faces); turned outward", part_.size());
      turn_part();
    }
  }

  void flip(std::uint32_t face) {
    const auto reverse = [&](std::vector<std::uint32_t>& corners) {  // the first corner stays
      if (corners.empty()) return;
      std::reverse(corners.begin() + mesh_.face_begin[face] + 1,
                   corners.begin() + mesh_.face_begin[face + 1]);
    };
    reverse(mesh_.corner_vertex);
    reverse(mesh_.corner_normal);
  }

  std::uint32_t end_vertex(std::uint32_t side) const {
    return mesh_.corner_vertex[next_corner(mesh_, side_face_[side], side)];
  }

  Mesh& mesh_;
  Report& report_;
  std::vector<std::uint32_t> side_face_;
  std::vector<std::uint32_t> other_;  // [side], across the edge; kNone: border
  std::vector<Turn> turn_;            // [face]
  std::vector<bool> flipped_;         // [face], against most of its part
  std::vector<std::uint32_t> part_;   // faces of the part in hand
  bool orientable_ = true;            // that part, so far
};

}  // namespace

std::size_t repair_orientation(Mesh& mesh, Report& report) {
  return Orientation(mesh, report).repair();
}

}  // namespace gliss
