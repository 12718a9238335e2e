#include "gliss/lazy/lazy_mesh.h"

#include <algorithm>

#include "gliss/build/build_cache.h"
#include "gliss/mesh/regions.h"

namespace gliss {
namespace {

double largest_face(const Mesh& mesh) {
  double most = 0;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const Box box = box_of(mesh, f);
    most = std::max(most, (box.high - box.low).norm());
  }
  return most;
}

}  // namespace

LazyMesh::LazyMesh(Mesh mesh, const LazyOptions& options)
    : mesh_(std::move(mesh)), options_(options) {
  if (options.rings < 2) throw std::invalid_argument("rings: must be at least 2");
  const std::uint64_t hash = hash_of(mesh_);
  topology_ = complete_mesh(mesh_, options.level.construction);
  base_ = build_base(mesh_, topology_, options.precision);
  base_.mesh_hash = hash;
  reach_ = largest_face(mesh_);
}

LazyRegion LazyMesh::build(std::span<const std::uint32_t> faces, const Poll& poll) const {
  const std::vector<std::uint32_t> used = faces_around(mesh_, topology_, faces, options_.rings);
  BuildOptions build;
  build.precision = options_.precision;
  build.level = options_.level;
  build.like = &base_;
  build.faces = faces_touching(mesh_, topology_, used);
  BuildBackend backend;
  backend.poll = poll;
  LazyRegion region{build_cache(mesh_, topology_, build, nullptr, backend), {}};
  region.used.resize(region.cache.patch_count());
  for (std::size_t p = 0; p < region.used.size(); ++p)
    region.used[p] = std::binary_search(used.begin(), used.end(), region.cache.patch_face[p]);
  return region;
}

bool LazyMesh::needs_all() const {
  return base_.winding != nullptr ||
         std::visit([](const auto& surface) { return !surface.part.empty(); }, base_.surface);
}

bool LazyMesh::is_inside(const LazyRegion& region, std::uint32_t face) const {
  if (!region.covers(face)) return false;
  for (std::uint32_t s = mesh_.face_begin[face]; s < mesh_.face_begin[face + 1]; ++s) {
    const std::uint32_t twin = topology_.side_twin[s];
    if (twin != kNone && !region.covers(topology_.side_face[twin])) return false;
  }
  return true;
}

}  // namespace gliss
