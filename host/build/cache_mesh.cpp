#include "gliss/build/cache_mesh.h"

#include <algorithm>
#include <stdexcept>

#include "gliss/mesh/mesh_edges.h"
#include "gliss/surface/base_triangles.h"
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

  // Joins the corners at one vertex, of which the first stands for all: both ends of an edge are
  // vertices of both its faces.
  DisjointSets join_corners() const {
    DisjointSets same(side_.size());
    for (std::uint32_t corner = 0; corner < side_.size(); ++corner) {
      const std::uint32_t twin = s_.side_twin[side_[corner]];
      if (twin == kNone) continue;
      const std::uint32_t other = cache_.patch_face[s_.side_patch[twin]],
                          begin = mesh_.face_begin[other], n = cache_.face_valence[other];
      same.unite(corner, begin + (cache_.corner_of_face[twin] + 1) % n);
    }
    return same;
  }

  void number_vertices() {
    DisjointSets same = join_corners();
    std::vector<std::vector<std::uint32_t>> normals;  // [vertex], those of its corners
    for (std::uint32_t corner = 0; corner < side_.size(); ++corner) {
      const std::uint32_t first = same.find(corner);
      if (first == corner) {
        mesh_.corner_vertex.push_back(static_cast<std::uint32_t>(mesh_.positions.size()));
        mesh_.positions.push_back(cache_.origin + start_of(s_, side_[corner]) / cache_.scale);
        normals.emplace_back();
      } else {
        mesh_.corner_vertex.push_back(mesh_.corner_vertex[first]);
      }
      // Corners between which there is no crease have the very same normal.
      const Vec3 own = normal_at_start(s_, side_[corner]).normalized();
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
    for (const std::uint32_t side : side_)
      mesh_.sharp.push_back(s_.side_twin[side] != kNone && !is_smooth_across(s_, side));
  }

  const PatchCache& cache_;
  const Surface<Real>& s_;
  Mesh mesh_;
  std::vector<std::uint32_t> side_;  // [corner]
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
