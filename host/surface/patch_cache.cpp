#include "gliss/surface/patch_cache.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "gliss/base/plain_arithmetic.h"
#include "gliss/mesh/mesh_edges.h"
#include "gliss/surface/instances.h"
#include "gliss/surface/layout.h"
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
        for (std::uint32_t p = 0; p < s.patch_count(); ++p) {
          const auto* numbers = &s.patch[p * kPatchReals];
          const Vec3 at(numbers[0], numbers[1], numbers[2]);
          for (std::uint32_t side = s.side_begin[p]; side < s.side_begin[p + 1]; ++side) {
            const auto* c = &s.corner[6 * side];
            box.hold(origin +
                     (at + Vec3(c[0], c[1], c[2]) * static_cast<double>(numbers[kPatchUnscale])) /
                         scale);
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
        DisjointSets parts(s.patch_count());
        for (std::size_t side = 0; side < s.side_twin.size(); ++side) {
          if (s.side_twin[side] != kNone)
            parts.unite(s.side_patch[side], s.side_patch[s.side_twin[side]]);
        }
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

// True if the base polygon of a patch faces against the surface's normal at one of its corners.
template <class Real>
bool has_folds(const Surface<Real>& s) {
  for (std::size_t side = 0; side < s.side_patch.size(); ++side) {
    const Real *face = &s.patch[s.side_patch[side] * kPatchReals + kPatchNormal],
               *corner = &s.corner[6 * side + 3];
    if (face[0] * corner[0] + face[1] * corner[1] + face[2] * corner[2] < 0) return true;
  }
  return false;
}

}  // namespace

void find_folds(PatchCache& cache) {
  cache.winding = nullptr;
  if (!cache.open.empty()) return;
  bool has_bent = false;
  for (std::uint32_t p = 0; p < cache.patch_count() && !has_bent; ++p)
    has_bent = cache.folded[p] &&
               (cache.kind[p] == PatchKind::kBent || cache.kind[p] == PatchKind::kPlain);
  std::visit(
      [&](const auto& s) {
        if (has_bent || has_folds(s)) cache.winding = std::make_shared<const WindingTree>(s);
      },
      cache.surface);
}

}  // namespace gliss
