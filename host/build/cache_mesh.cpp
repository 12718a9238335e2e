#include "gliss/build/cache_mesh.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "gliss/mesh/mesh_edges.h"
#include "gliss/surface/layout.h"

namespace gliss {
namespace {

template <class Real>
class MeshMaker {
 public:
  MeshMaker(const PatchCache& cache, const Surface<Real>& surface) : cache_(cache), s_(surface) {}

  Mesh make() {
    for (const std::uint32_t valence : cache_.face_valence)
      mesh_.face_begin.push_back(mesh_.face_begin.back() + valence);
    find_sides();
    same_.resize(mesh_.face_begin.back());
    std::iota(same_.begin(), same_.end(), 0u);
    for (std::uint32_t corner = 0; corner < same_.size(); ++corner) join_twin(corner);
    number_vertices();
    if (cache_.crease_count > 0) mark_creases();
    mesh_.unit = cache_.unit;
    return std::move(mesh_);
  }

 private:
  // Finds the side of a patch that each side of a face is.
  void find_sides() {
    side_.assign(mesh_.face_begin.back(), kNone);
    for (std::uint32_t side = 0; side < s_.side_patch.size(); ++side) {
      if (!is_outer_side(cache_, s_, side)) continue;
      const std::uint32_t face = cache_.patch_face[s_.side_patch[side]];
      side_[mesh_.face_begin[face] + cache_.corner_of_face[side]] = side;
    }
  }

  // Both ends of an edge are vertices of both its faces.
  void join_twin(std::uint32_t corner) {
    const std::uint32_t twin = s_.side_twin[side_[corner]];
    if (twin == kNone) return;
    const std::uint32_t other = cache_.patch_face[s_.side_patch[twin]];
    const std::uint32_t begin = mesh_.face_begin[other], n = cache_.face_valence[other];
    join(corner, begin + (cache_.corner_of_face[twin] + 1) % n);
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = first_of(a), b = first_of(b);
    same_[std::max(a, b)] = std::min(a, b);
  }
  // The first corner known to be at the same vertex.
  std::uint32_t first_of(std::uint32_t corner) {
    while (same_[corner] != corner) corner = same_[corner] = same_[same_[corner]];
    return corner;
  }

  void number_vertices() {
    std::vector<std::vector<std::uint32_t>> normals;  // [vertex], those of its corners
    for (std::uint32_t corner = 0; corner < same_.size(); ++corner) {
      const std::uint32_t first = first_of(corner);
      if (first == corner) {
        mesh_.corner_vertex.push_back(static_cast<std::uint32_t>(mesh_.positions.size()));
        mesh_.positions.push_back(position(corner));
        normals.emplace_back();
      } else {
        mesh_.corner_vertex.push_back(mesh_.corner_vertex[first]);
      }
      // Corners between which there is no crease have the very same normal.
      const Vec3 own = normal(corner);
      std::vector<std::uint32_t>& known = normals[mesh_.corner_vertex.back()];
      const auto at = std::find_if(known.begin(), known.end(),
                                   [&](std::uint32_t i) { return mesh_.normals[i] == own; });
      if (at != known.end()) {
        mesh_.corner_normal.push_back(*at);
        continue;
      }
      known.push_back(static_cast<std::uint32_t>(mesh_.normals.size()));
      mesh_.corner_normal.push_back(known.back());
      mesh_.normals.push_back(own);
    }
  }

  // Marks the edges across which normals differ.
  void mark_creases() {
    mesh_.sharp.assign(same_.size(), 0);
    const auto differ = [&](std::uint32_t a, std::uint32_t b) {
      return mesh_.corner_normal[a] != mesh_.corner_normal[b];
    };
    for (std::uint32_t corner = 0; corner < same_.size(); ++corner) {
      const std::uint32_t twin = s_.side_twin[side_[corner]];
      if (twin == kNone) continue;
      const std::uint32_t face = cache_.patch_face[s_.side_patch[side_[corner]]],
                          other = cache_.patch_face[s_.side_patch[twin]],
                          back = mesh_.face_begin[other] + cache_.corner_of_face[twin];
      mesh_.sharp[corner] = differ(corner, next_corner(mesh_, other, back)) ||
                            differ(next_corner(mesh_, face, corner), back);
    }
  }

  const Real* reals(std::uint32_t corner) const {
    return &s_.corner[6 * std::size_t{side_[corner]}];
  }
  static Vec3 triple(const Real* from) { return Vec3(from[0], from[1], from[2]); }
  Vec3 normal(std::uint32_t corner) const { return triple(reals(corner) + 3).normalized(); }
  Vec3 position(std::uint32_t corner) const {
    const Real* numbers = &s_.patch[std::size_t{s_.side_patch[side_[corner]]} * kPatchReals];
    const double unscale = static_cast<double>(numbers[kPatchUnscale]);
    return cache_.origin +
           (triple(numbers + kPatchOrigin) + unscale * triple(reals(corner))) / cache_.scale;
  }

  const PatchCache& cache_;
  const Surface<Real>& s_;
  Mesh mesh_;
  std::vector<std::uint32_t> side_, same_;  // [corner]
};

}  // namespace

Mesh mesh_of(const PatchCache& cache) {
  for (std::uint32_t face = 0; face < cache.mesh_face_count; ++face) {
    if (cache.first_patch(face) == kNone)
      throw std::invalid_argument("faces of the cache are not built");
  }
  return std::visit([&](const auto& surface) { return MeshMaker(cache, surface).make(); },
                    cache.surface);
}

}  // namespace gliss
