// A fixed triangulation of a polygon that need be neither planar nor convex, by clipping ears.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/mesh/topology.h"

namespace gliss {

// Appends n - 2 triangles of corner indices, oriented as the polygon. `normal`: its Newell normal,
// along which it is seen. A self-crossing polygon is triangulated too, with triangles that overlap.
GLISS_EXPORT void triangulate(std::span<const Vec3> corners, const Vec3& normal,
                              std::vector<std::uint32_t>& triangles);

// Appends the corners of the triangles that a face falls into so, three each, where place(corner)
// has them.
template <class Place>
void append_triangles(const Mesh& mesh, std::size_t face, Place place,
                      std::vector<Vec3>& triangles) {
  thread_local std::vector<Vec3> corners;
  thread_local std::vector<std::uint32_t> cut;
  corners.clear(), cut.clear();
  for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c)
    corners.push_back(place(c));
  triangulate(corners, newell_normal(mesh, face), cut);
  for (const std::uint32_t corner : cut) triangles.push_back(corners[corner]);
}

// The same where the mesh has them.
GLISS_EXPORT void append_triangles(const Mesh& mesh, std::size_t face,
                                   std::vector<Vec3>& triangles);
// The same of all faces, face by face.
GLISS_EXPORT std::vector<Vec3> triangles_of(const Mesh& mesh);

}  // namespace gliss
