#include "gliss/build/departure.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "gliss/build/face_rays.h"
#include "gliss/build/patch_batch.h"
#include "gliss/surface/base_triangles.h"
#include "gliss/surface/instances.h"

namespace gliss {
namespace {

// How far the centre is off the polygon, mesh frame, of a patch that holds a piece round one: so
// much more than from its own triangle the patch may be from its polygon. Else 0.
template <class Real>
double centre_off(const Surface<Real>& s, std::uint32_t patch) {
  double off = 0;
  if (piece_of(s, patch) == nullptr) return off;
  for_polygon_triangles(s, patch, [&](const BaseTriangle& t) {
    const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]).stableNormalized();
    off = std::abs(normal.dot(start_of(s, s.side_begin[patch] + 2) - t[0]));
  });
  return off;
}

// True if a patch ends at a side: at a border or a sharp edge.
template <class Real>
bool ends_at(const Surface<Real>& s, std::uint32_t side) {
  const std::uint32_t twin = s.side_twin[side];
  return twin == kNone || normal_at_start(s, side) != normal_at_start(s, next_side(s, twin)) ||
         normal_at_start(s, next_side(s, side)) != normal_at_start(s, twin);
}

// How far the sides where a patch ends leave those of its polygon, mesh frame: where a surface is
// smaller than its polygons, none of its own points tells.
template <class Real>
double rim_departure(const Surface<Real>& s, std::uint32_t patch) {
  const Real* numbers = &s.patch[patch * kPatchReals];
  const Vec3 origin(numbers[kPatchOrigin], numbers[kPatchOrigin + 1], numbers[kPatchOrigin + 2]);
  const double unscale = static_cast<double>(numbers[kPatchUnscale]);
  const std::uint32_t n = s.valence(patch);
  double most = 0;
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t side = s.side_begin[patch] + k;
    if (!ends_at(s, side)) continue;
    const Vec3 start = start_of(s, side),
               along = (start_of(s, next_side(s, side)) - start).stableNormalized();
    for (const double t : {0.25, 0.5, 0.75}) {
      const DomainVec x = on_side(n, k, t);
      const Real xi = static_cast<Real>(x.x()), eta = static_cast<Real>(x.y());
      Real at[9];
      kernels<Real>().evaluate(&s.domain[s.domain_begin[n]], &s.control[3 * s.control_begin[patch]],
                               s.form[patch], n, &xi, &eta, 1, 1, at);
      const Vec3 off = origin + unscale * Vec3(at[0], at[1], at[2]) - start;
      most = std::max(most, (off - along.dot(off) * along).norm());
    }
  }
  return most;
}

}  // namespace

void find_departures(PatchCache& cache, std::span<const double> sag, const ParallelFor& parallel) {
  constexpr std::size_t kGrain = 256;
  std::vector<Departure> all(cache.mesh_face_count);
  Departure rim;
  std::visit(
      [&](const auto& s) {
        for (std::uint32_t p = 0; p < cache.patch_count(); ++p) {
          Departure& d = all[cache.patch_face[p]];
          d.face = cache.patch_face[p];
          d.distance = std::max(d.distance, (sag[p] + centre_off(s, p)) / cache.scale);
          const double off = rim_departure(s, p) / cache.scale;
          if (off > rim.distance) rim = {.distance = off, .face = d.face};
        }
      },
      cache.surface);
  const FaceRays rays(cache, parallel);
  parallel(all.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      all[i].room = rays.room(all[i].face, all[i].distance / kFaithful);
  });
  cache.departure = *std::max_element(
      all.begin(), all.end(), [](const auto& a, const auto& b) { return a.distance < b.distance; });
  cache.departure.room = rays.room(cache.departure.face, std::numeric_limits<double>::infinity());
  cache.tightest = *std::max_element(
      all.begin(), all.end(), [](const auto& a, const auto& b) { return a.share() < b.share(); });
  // A rim goes aside, where no face is next.
  if (rim.distance > cache.departure.distance) cache.departure = rim;
  if (!(cache.tightest.share() > kFaithful)) cache.tightest = cache.departure;
}

}  // namespace gliss
