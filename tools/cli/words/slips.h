// Lines on stderr that name the cure of what is likely a slip. With --quiet nothing is said.
#pragma once

#include <array>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "gliss/surface/patch_cache.h"
#include "gliss/validate/validate.h"
#include "tools/cli/words/command.h"

namespace gliss::tools {

// A mesh of the size of a house, read without --unit, or one that no eye sees.
void tell_odd_size(const SurfaceOptions& options, const Mesh& mesh);

// A mesh of which borders lie beside each other, nearly at the same places.
void tell_seams(const SurfaceOptions& options, const Mesh& mesh,
                const std::vector<Finding>& findings);

// A mesh file of the same name beside a cache that is not what the cache was baked from.
void tell_edited_mesh(const SurfaceOptions& options, const PatchCache& cache);

// A spring (N/m) that no hand feels, as of "0.5" for "0.5N/mm". `name` is whose it is.
void tell_soft_spring(const ReportOptions& options, double stiffness, const std::string& name);

// How near HIPs come to surfaces in boxes (m), as they are, and were their numbers in other units.
class Nearness {
 public:
  explicit Nearness(std::vector<Box> boxes) : boxes_(std::move(boxes)) {}
  void add(std::span<const Vec3> hips);  // m

  const std::vector<Box>& boxes() const { return boxes_; }
  bool any() const { return least_[0] < std::numeric_limits<double>::infinity(); }
  double apart() const { return least_[0]; }  // m
  bool would_meet_in_millimetres() const { return least_[1] == 0; }
  bool would_meet_in_metres() const { return least_[2] == 0; }

 private:
  std::vector<Box> boxes_;
  std::array<double, 3> least_{std::numeric_limits<double>::infinity(),
                               std::numeric_limits<double>::infinity(),
                               std::numeric_limits<double>::infinity()};
};

// A path none of whose HIPs has touched the surfaces: how far off it was, and in which unit it may
// be meant. `columns`: how its units are said.
void tell_untouched(const ReportOptions& options, const std::string& path, const Nearness& nearness,
                    const std::string& columns);
void tell_untouched(const ReportOptions& options, const std::string& path,
                    std::span<const Vec3> hips, std::span<const Box> boxes,
                    const std::string& columns);

// The same where the HIPs are not even as near as the surface is across.
void tell_far(const ReportOptions& options, const std::string& path, const Nearness& nearness,
              const std::string& columns);

// A cache that is given where a mesh is wanted.
void refuse_cache(const SurfaceOptions& options);

}  // namespace gliss::tools
