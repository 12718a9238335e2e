// The HIPs of a tool that is more than a point.
#pragma once

#include <vector>

#include "gliss/base/export.h"
#include "gliss/base/poll.h"
#include "gliss/base/vector.h"
#include "gliss/mesh/mesh.h"

namespace gliss {

// `count` points of a mesh's surface, in m, spread over it: of its vertices and a lattice on its
// faces each the one that is farthest from those before it (Gonzalez 1985), the first from the
// middle of the bounding box. Fewer where the mesh has no area. Its time goes with the square of
// `count`.
GLISS_EXPORT std::vector<Vec3> spread_points(const Mesh& mesh, std::size_t count,
                                             const Poll& poll = {});

}  // namespace gliss
