// The mesh of a cache, for those who have only the cache.
#pragma once

#include "gliss/mesh/mesh.h"
#include "gliss/surface/patch_cache.h"

namespace gliss {

// Returns the polygons and vertex normals that a cache's patches were made from: its faces in
// their order, with vertices numbered as faces meet them. Positions and normals are rounded as the
// cache rounds them. Throws std::invalid_argument if faces are creased or not built, for a cache
// does not keep all of these.
GLISS_EXPORT Mesh mesh_of(const PatchCache& cache);

}  // namespace gliss
