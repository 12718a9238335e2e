#include "gliss/mesh/mesh.h"

#include <xxhash.h>

namespace gliss {
namespace {

Box box_of_corners(const Mesh& mesh, std::size_t begin, std::size_t end) {
  const Vec3& any = mesh.positions[mesh.corner_vertex[begin]];
  Box box{any, any};
  for (std::size_t c = begin; c < end; ++c) box.hold(mesh.positions[mesh.corner_vertex[c]]);
  return box;
}

}  // namespace

Box box_of(const Mesh& mesh, std::size_t face) {
  return box_of_corners(mesh, mesh.face_begin[face], mesh.face_begin[face + 1]);
}

Box box_of(const Mesh& mesh) { return box_of_corners(mesh, 0, mesh.corner_vertex.size()); }

std::uint64_t hash_of(const Mesh& mesh) {
  XXH64_hash_t hash = XXH3_64bits(&mesh.unit, sizeof(mesh.unit));
  const auto add = [&](const auto& v) {
    if (!v.empty()) hash = XXH3_64bits_withSeed(v.data(), v.size() * sizeof(v[0]), hash);
  };
  add(mesh.positions);
  add(mesh.normals);
  add(mesh.face_begin);
  add(mesh.corner_vertex);
  add(mesh.corner_normal);
  add(mesh.sharp);
  return hash;
}

}  // namespace gliss
