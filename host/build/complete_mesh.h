// Makes what patches need besides positions: vertex normals and the tangents of sides, such that no
// patch leaves its polygon by more than the mesh around has room for.
#pragma once

#include "gliss/base/export.h"
#include "gliss/base/parallel.h"
#include "gliss/mesh/topology.h"
#include "gliss/surface/patch_cache.h"

namespace gliss {

// The weights of the vertex normals that a construction makes for meshes without.
constexpr NormalWeights normal_weights(Construction construction) {
  return construction == Construction::kFair ? NormalWeights::kSmooth : NormalWeights::kAngle;
}

// Completes a validated mesh: add_vertex_normals, and then what follows where patches bulge too
// much. An end of a side bulges by (4/27) |C' x e|, e being the side's direction: the most by which
// it holds the curve off its chord. It may do so by 16/81 of w or h, whichever is larger, so that
// the curve leaves its chord by a third of that at most. w is the least width of the faces at that
// end's vertex, and at most the side's length; h the least room of those faces (face_rays.h).
//
// First, for normals that were made here: flat regions keep theirs (flat_regions.h), and others
// turn away from long edges until an edge leans by no more than reach / length, where the surface
// goes on beyond the vertex by `reach`: as far as that makes the faces around lean less. For these
// edges h is at most twice the radius by which their faces bend over them, so that the rim of a
// plate is as thick as the plate. Then what still bulges gets shorter tangents (Mesh::tangents),
// the same in both faces: patches stay G1. Sides of a rounded mesh that have tangents keep them.
// Last, a patch may leave its polygon by a third of w or h, of its face and its vertices, whichever
// is larger (Mesh::most_sag): build_cache shortens the cross tangents of one that does not keep to
// it. A fair one of three or four sides follows its sides, and is left as it is.
//
// A mesh that is completed is left as it is. `parallel` runs what takes long. Returns the topology.
GLISS_EXPORT Topology complete_mesh(Mesh& mesh, Construction construction,
                                    const ParallelFor& parallel = serial_for);

}  // namespace gliss
