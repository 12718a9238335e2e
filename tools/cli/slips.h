// Lines on stderr that name the cure of what is likely a slip. With --quiet nothing is said.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "gliss/surface/patch_cache.h"
#include "gliss/validate/validate.h"
#include "tools/cli/command.h"

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

// A path (m) none of whose HIPs has touched the surfaces in the boxes (m): how far off it was, and
// in which unit it may be meant. `columns`: how its units are said.
void tell_untouched(const ReportOptions& options, const std::string& path,
                    std::span<const Vec3> hips, std::span<const Box> boxes,
                    const std::string& columns);

// The same where the HIPs are not even as near as the surface is across.
void tell_far(const ReportOptions& options, const std::string& path, std::span<const Vec3> hips,
              const Box& box, const std::string& columns);

// A cache that is given where a mesh is wanted.
void refuse_cache(const SurfaceOptions& options);

}  // namespace gliss::tools
