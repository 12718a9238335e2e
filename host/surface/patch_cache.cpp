#include "gliss/surface/patch_cache.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "gliss/base/plain_arithmetic.h"
#include "gliss/surface/base_triangles.h"
#include "gliss/surface/instances.h"
#include "gliss/surface/layout.h"
#include "gliss/surface/surface_parts.h"
#include "gliss/surface/winding.h"

namespace gliss {

void require_patches(const PatchCache& cache) {
  if (cache.patch_count() == 0)
    throw std::invalid_argument("the cache has no patches: it is empty, or was moved from");
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
        for (std::uint32_t side = 0; side < s.side_patch.size(); ++side)
          box.hold(origin + start_of(s, side) / scale);
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
               size(face_valence) + size(open);
      },
      surface);
}

void find_open_parts(PatchCache& cache) {
  LargeArray<std::uint8_t>& of_face = cache.open.write();
  of_face.clear();
  std::visit(
      [&](const auto& s) {
        if (std::find(s.side_twin.begin(), s.side_twin.end(), kNone) == s.side_twin.end()) return;
        DisjointSets parts = parts_of(s);
        std::vector<std::uint8_t> open(s.patch_count(), 0);
        for (std::size_t side = 0; side < s.side_twin.size(); ++side) {
          if (s.side_twin[side] == kNone) open[parts.find(s.side_patch[side])] = 1;
        }
        of_face.resize(cache.mesh_face_count);
        for (std::uint32_t p = 0; p < s.patch_count(); ++p)
          of_face[cache.patch_face[p]] = open[parts.find(p)];
      },
      cache.surface);
}

namespace {

template <class Real>
Vec3 polygon_normal(const Surface<Real>& s, std::uint32_t side) {
  return vector_at(&s.patch[s.side_patch[side] * kPatchReals + kPatchNormal]);
}

// True if the polygons at a sharp side form a wedge of which its two patches leave little at one
// end, as where edges from a vertex lie in one plane, or nothing: they touch or cross there.
template <class Real>
bool closes_wedge(const Surface<Real>& s, std::uint32_t side) {
  constexpr double kLittle = 0.25;
  const std::uint32_t twin = s.side_twin[side];
  if (twin == kNone) return false;
  const Vec3 own = polygon_normal(s, side), beyond = polygon_normal(s, twin);
  if (!(own.dot(beyond) < 0)) return false;
  const Vec3 along = start_of(s, twin) - start_of(s, side);
  const double wedge = own.cross(beyond).dot(along), little = kLittle * wedge * wedge;
  const auto closes = [&](std::uint32_t at, std::uint32_t at_beyond) {
    const Vec3 m = normal_at_start(s, at), n = normal_at_start(s, at_beyond);
    return m != n && m.cross(n).dot(along) * wedge < little;
  };
  return closes(side, next_side(s, twin)) || closes(next_side(s, side), twin);
}

// True if the base polygon of a patch faces against the surface's normal at one of its corners, or
// closes a wedge.
template <class Real>
bool has_folds(const Surface<Real>& s) {
  for (std::uint32_t side = 0; side < s.side_patch.size(); ++side) {
    if (polygon_normal(s, side).dot(normal_at_start(s, side)) < 0 || closes_wedge(s, side))
      return true;
  }
  return false;
}

}  // namespace

void find_folds(PatchCache& cache) {
  cache.winding = nullptr;
  bool has_bent = false;
  for (std::uint32_t p = 0; p < cache.patch_count() && !has_bent; ++p)
    has_bent = cache.folded[p] &&
               (cache.kind[p] == PatchKind::kBent || cache.kind[p] == PatchKind::kPlain);
  std::visit(
      [&](const auto& s) {
        if (!has_bent && !has_folds(s)) return;
        auto tree = std::make_shared<const WindingTree>(s);
        if (tree->counts_any()) cache.winding = std::move(tree);
      },
      cache.surface);
}

}  // namespace gliss
