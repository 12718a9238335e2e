// Dense triangle meshes of a patch surface: what flat polygons and force shading need to feel
// alike.
#pragma once

#include "gliss/base/export.h"
#include "gliss/base/parallel.h"
#include "gliss/base/poll.h"
#include "gliss/mesh/topology.h"
#include "gliss/surface/patch_cache.h"

namespace gliss {

// Each corner's part of a face, to its centre and the middles of its sides, becomes cells x cells
// quads of two triangles. A face that is cut into triangles without a centre, as where it is not
// convex, becomes 4 cells x cells triangles for each of these. Vertices on edges are shared.
// Positions and normals are the surface's: one normal a vertex, so that creases are not kept.
// `mesh`: the one that the cache was built from, all of it.
GLISS_EXPORT Mesh tessellate(const Mesh& mesh, const PatchCache& cache, std::uint32_t cells,
                             const ParallelFor& parallel = serial_for, const Poll& poll = {});

// Triangles that tessellate makes.
GLISS_EXPORT std::uint64_t tessellated_count(const Mesh& mesh, const PatchCache& cache,
                                             std::uint32_t cells);

}  // namespace gliss
