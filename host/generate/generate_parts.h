// Steps that the generators share. Private to host/.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <numbers>
#include <string>

#include "gliss/base/require.h"
#include "gliss/mesh/mesh.h"

namespace gliss {

inline constexpr double kTurn = 2 * std::numbers::pi;

inline Mesh make_mesh(std::string source) {
  Mesh mesh;
  mesh.unit = 1e-3;
  mesh.source = std::move(source);
  return mesh;
}

inline void add_face(Mesh& mesh, std::initializer_list<std::uint32_t> vertices) {
  mesh.corner_vertex.insert(mesh.corner_vertex.end(), vertices);
  mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corner_vertex.size()));
}

// Quads between rings of `around` vertices each, ring after ring; every ring runs anticlockwise
// seen from the next one. A closed tube goes on from the last ring to the first, an open one gets
// caps.
inline void add_tube(Mesh& mesh, std::uint32_t rings, std::uint32_t around, bool closed) {
  for (std::uint32_t ring = 0; ring + (closed ? 0 : 1) < rings; ++ring) {
    const std::uint32_t here = ring * around;
    const std::uint32_t ahead = (ring + 1) % rings * around;
    for (std::uint32_t k = 0; k < around; ++k) {
      const std::uint32_t next = (k + 1) % around;
      add_face(mesh, {here + k, here + next, ahead + next, ahead + k});
    }
  }
  if (closed) return;
  for (std::uint32_t k = around; k-- > 0;) mesh.corner_vertex.push_back(k);
  add_face(mesh, {});
  for (std::uint32_t k = 0; k < around; ++k) mesh.corner_vertex.push_back((rings - 1) * around + k);
  add_face(mesh, {});
}

// For one normal a vertex.
inline void share_normals(Mesh& mesh) { mesh.corner_normal = mesh.corner_vertex; }

}  // namespace gliss
