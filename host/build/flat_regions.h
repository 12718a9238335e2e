// Flat regions of a mesh: a face, or several that lie in one plane, as CAD triangulates a face of a
// part.
#pragma once

#include "gliss/base/parallel.h"
#include "gliss/mesh/topology.h"

namespace gliss {

// Gives vertices at the rim of a flat region its normal, where the other regions around are far
// smaller: a fillet or a chamfer begins there, tangent to the region, which stays flat. A mean of
// the faces would lean, and lift a large face by much. Triangles of their own are no region, nor is
// what lies beside creases. For normals that were made for the mesh.
void keep_flat_regions(Mesh& mesh, const Topology& topology, const ParallelFor& parallel);

}  // namespace gliss
