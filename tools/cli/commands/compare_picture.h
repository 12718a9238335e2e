// The pictures of a comparison as JSON: the surface of each construction with its curvature, and
// the places where walks jump. Their keys are a contract.
#pragma once

#include <utility>
#include <vector>

#include "gliss/compare/compare.h"
#include "gliss/results/json.h"

namespace gliss::tools {

// Bounds that keep a page of a comparison below 3 MB.
inline constexpr std::size_t kMostPicturePoints = 16000;  // of a construction
inline constexpr std::size_t kMostRowJumps = 200;

// `unit`: of the cache, in m.
Json picture_json(const std::vector<std::pair<Construction, SurfacePicture>>& pictures,
                  double unit);
Json jumps_json(const std::vector<WalkJump>& jumps);

}  // namespace gliss::tools
