#include "gliss/mesh/mesh_edges.h"

namespace gliss {

std::vector<std::uint32_t> side_faces(const Mesh& mesh) {
  std::vector<std::uint32_t> side_face(mesh.corner_vertex.size());
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    std::fill(side_face.begin() + mesh.face_begin[face],
              side_face.begin() + mesh.face_begin[face + 1], face);
  }
  return side_face;
}

std::vector<std::uint32_t> pair_sides(const Mesh& mesh,
                                      const std::vector<std::uint32_t>& side_face) {
  std::vector<std::uint32_t> other(side_face.size(), kNone);
  for_each_edge(mesh, side_face, [&](const Edge& edge) {
    if (edge.sides.size() != 2) return;
    other[edge.sides[0]] = edge.sides[1];
    other[edge.sides[1]] = edge.sides[0];
  });
  return other;
}

}  // namespace gliss
