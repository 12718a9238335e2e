#include "host/patch_cache.h"

#include <xxhash.h>

#include <algorithm>
#include <limits>

#include "host/kernels.h"
#include "host/plain_arithmetic.h"
#include "host/query.h"

namespace gliss {

std::vector<std::uint32_t> faces_in_box(const Mesh& mesh, const Box& box) {
  std::vector<std::uint32_t> faces;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    Box face{Vec3::Constant(std::numeric_limits<double>::infinity()),
             Vec3::Constant(-std::numeric_limits<double>::infinity())};
    for (std::uint32_t s = mesh.face_begin[f]; s < mesh.face_begin[f + 1]; ++s) {
      face.low = face.low.cwiseMin(mesh.positions[mesh.corner_vertex[s]]);
      face.high = face.high.cwiseMax(mesh.positions[mesh.corner_vertex[s]]);
    }
    if ((face.low.array() <= box.high.array()).all() &&
        (face.high.array() >= box.low.array()).all())
      faces.push_back(f);
  }
  return faces;
}

std::vector<std::uint32_t> faces_around(const Mesh& mesh, const Topology& topology,
                                        std::uint32_t face, int rings) {
  return faces_around(mesh, topology, {&face, 1}, rings);
}

std::vector<std::uint32_t> faces_around(const Mesh& mesh, const Topology& topology,
                                        std::span<const std::uint32_t> faces, int rings) {
  std::vector<std::uint32_t> found, front;
  std::vector<char> seen(mesh.face_count(), 0);
  for (const std::uint32_t f : faces) {
    if (!seen[f]) front.push_back(f);
    seen[f] = 1;
  }
  found = front;
  for (int r = 0; r < rings; ++r) {
    std::vector<std::uint32_t> next;
    for (const std::uint32_t f : front) {
      for (std::uint32_t s = mesh.face_begin[f]; s < mesh.face_begin[f + 1]; ++s) {
        const std::uint32_t twin = topology.side_twin[s];
        if (twin == kNone || seen[topology.side_face[twin]]) continue;
        seen[topology.side_face[twin]] = 1;
        next.push_back(topology.side_face[twin]);
      }
    }
    found.insert(found.end(), next.begin(), next.end());
    front = std::move(next);
  }
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<std::uint32_t> faces_touching(const Mesh& mesh, const Topology& topology,
                                          std::span<const std::uint32_t> faces) {
  std::vector<std::uint32_t> found(faces.begin(), faces.end());
  for (const std::uint32_t f : faces) {
    for (std::uint32_t s = mesh.face_begin[f]; s < mesh.face_begin[f + 1]; ++s) {
      // Round the corner one way, and from a border the other way.
      std::uint32_t at = next_around(mesh, topology, s);
      for (; at != kNone && at != s; at = next_around(mesh, topology, at))
        found.push_back(topology.side_face[at]);
      if (at == s) continue;
      for (at = topology.side_twin[s]; at != kNone; at = topology.side_twin[at]) {
        found.push_back(topology.side_face[at]);
        at = next_side(mesh, topology, at);
      }
    }
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

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
  return hash;
}

double PatchCache::smallest_rho() const {
  require_patches(*this);
  return *std::min_element(rho_min.begin(), rho_min.end());
}

Box PatchCache::bounds() const {
  require_patches(*this);
  const PlainArithmetic plain;
  return std::visit(
      [&](const auto& s) {
        Box box{Vec3::Constant(std::numeric_limits<double>::infinity()),
                Vec3::Constant(-std::numeric_limits<double>::infinity())};
        for (std::uint32_t p = 0; p < s.patch_count(); ++p) {
          const auto* numbers = &s.patch[p * kPatchReals];
          const Vec3 at(numbers[0], numbers[1], numbers[2]);
          for (std::uint32_t side = s.side_begin[p]; side < s.side_begin[p + 1]; ++side) {
            const auto* c = &s.corner[6 * side];
            const Vec3 x =
                origin +
                (at + Vec3(c[0], c[1], c[2]) * static_cast<double>(numbers[kPatchUnscale])) / scale;
            box.low = box.low.cwiseMin(x);
            box.high = box.high.cwiseMax(x);
          }
        }
        return box;
      },
      surface);
}

std::size_t PatchCache::bytes() const {
  const auto size = [](const auto& v) { return v.size() * sizeof(v[0]); };
  return std::visit(
      [&](const auto& s) {
        return size(s.domain) + size(s.domain_begin) + size(s.side_begin) + size(s.side_patch) +
               size(s.side_twin) + size(s.control) + size(s.control_begin) + size(s.form) +
               size(s.corner) + size(s.patch) + size(s.triangle) + size(s.node) + size(s.child) +
               size(s.tile) + size(s.tile_begin) + size(s.part) + size(s.part_table) +
               size(s.partner) + size(s.part_box) + size(patch_face) + size(face_patch) +
               size(kind) + size(folded) + size(rho_min) + size(corner_of_face) +
               size(face_valence);
      },
      surface);
}

bool has_border(const PatchCache& cache) {
  return std::visit(
      [](const auto& s) {
        return std::find(s.side_twin.begin(), s.side_twin.end(), kNone) != s.side_twin.end();
      },
      cache.surface);
}

}  // namespace gliss
