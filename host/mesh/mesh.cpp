#include "gliss/mesh/mesh.h"

#include <xxhash.h>

namespace gliss {

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
