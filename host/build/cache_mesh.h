// The mesh of a cache, for those who have only the cache.
#pragma once

#include "gliss/mesh/mesh.h"
#include "gliss/surface/patch_cache.h"

namespace gliss {

// Returns the polygons and vertex normals that a cache's patches were made from: its faces in
// their order, with vertices numbered as faces meet them. Positions and normals are rounded as the
// cache rounds them. Its creases are the edges across which normals differ, which those of flat
// faces of one plane are not. Throws std::invalid_argument if faces are not built.
GLISS_EXPORT Mesh mesh_of(const PatchCache& cache);

}  // namespace gliss
