// A fixed triangulation of a polygon that need be neither planar nor convex, by clipping ears.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/mesh/mesh.h"

namespace gliss {

// Appends n - 2 triangles of corner indices, oriented as the polygon. `normal`: its Newell normal,
// along which it is seen. A self-crossing polygon is triangulated too, with triangles that overlap.
GLISS_EXPORT void triangulate(std::span<const Vec3> corners, const Vec3& normal,
                              std::vector<std::uint32_t>& triangles);

// Corners of the triangles that the faces of a mesh fall into so: three each, face by face.
GLISS_EXPORT std::vector<Vec3> triangles_of(const Mesh& mesh);

}  // namespace gliss
