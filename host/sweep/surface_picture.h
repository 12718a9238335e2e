// A surface as points to draw, each with the curvature of its face: few enough for a page, however
// large the mesh.
#pragma once

#include <cstdint>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/surface/patch_cache.h"

namespace gliss {

// Vectors are x y z x y z ...; lengths are in the mesh's unit, curvatures in 1 / the mesh's unit.
struct SurfacePicture {
  std::vector<std::uint32_t> face;      // [point], in order
  std::vector<float> position, normal;  // [point x 3]
  // [point]: the diameter of a spot there, so that spots cover the surface; of its face
  std::vector<float> spot, curvature;
  std::vector<float> departure;          // [point], how far it is from the polygons
  double p50 = 0, p99 = 0, largest = 0;  // curvature of all faces that have patches
};

// Returns the largest curvature of each face, in 1 / the mesh's unit; NaN where it has no patch.
GLISS_EXPORT std::vector<double> face_curvatures(const PatchCache& cache);

// The points of a sweep's grid, as dense as `most_points` allow; of a mesh with more faces than
// that, some points evenly. The curvature of a face is 1 / rho_min of its sharpest patch. The same
// points for every cache of a mesh.
GLISS_EXPORT SurfacePicture picture_of(const PatchCache& cache, std::size_t most_points);

}  // namespace gliss
