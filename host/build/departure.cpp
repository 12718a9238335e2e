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

// Points of a patch, mesh frame.
template <class Real>
std::vector<Vec3> points_of(const Surface<Real>& s, std::uint32_t patch,
                            const std::vector<DomainVec>& at) {
  const Real* numbers = &s.patch[patch * kPatchReals];
  const Vec3 origin(numbers[kPatchOrigin], numbers[kPatchOrigin + 1], numbers[kPatchOrigin + 2]);
  const double unscale = static_cast<double>(numbers[kPatchUnscale]);
  const std::uint32_t n = s.valence(patch);
  std::vector<Vec3> points;
  for (const DomainVec& x : at) {
    const Real xi = static_cast<Real>(x.x()), eta = static_cast<Real>(x.y());
    Real p[9];
    kernels<Real>().evaluate(&s.domain[s.domain_begin[n]], &s.control[3 * s.control_begin[patch]],
                             s.form[patch], n, &xi, &eta, 1, 1, p);
    points.push_back(origin + unscale * Vec3(p[0], p[1], p[2]));
  }
  return points;
}

// How far the sides where a patch ends leave those of its polygon, mesh frame: where a surface is
// smaller than its polygons, none of its own points tells.
template <class Real>
double rim_departure(const Surface<Real>& s, std::uint32_t patch) {
  const std::uint32_t n = s.valence(patch);
  double most = 0;
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t side = s.side_begin[patch] + k;
    if (!ends_at(s, side)) continue;
    const Vec3 start = start_of(s, side),
               along = (start_of(s, next_side(s, side)) - start).stableNormalized();
    const std::vector<Vec3> curve =
        points_of(s, patch, {on_side(n, k, 0.25), on_side(n, k, 0.5), on_side(n, k, 0.75)});
    for (const Vec3& p : curve)
      most = std::max(most, (p - start - along.dot(p - start) * along).norm());
  }
  return most;
}

// How far a patch rises above its polygon, or sinks below it, along the polygon's normal, mesh
// frame.
template <class Real>
double height_departure(const Surface<Real>& s, std::uint32_t patch) {
  const Real* m = &s.patch[patch * kPatchReals + kPatchNormal];
  const Vec3 normal(m[0], m[1], m[2]);
  const std::uint32_t n = s.valence(patch), first = s.side_begin[patch];
  double low = normal.dot(start_of(s, first)), high = low;
  std::vector<DomainVec> at{DomainVec::Zero()};
  for (std::uint32_t k = 0; k < n; ++k) {
    const double corner = normal.dot(start_of(s, first + k));
    low = std::min(low, corner), high = std::max(high, corner);
    for (const double t : {0.0, 0.5}) {
      for (const double share : {1.0 / 3, 2.0 / 3, 1.0}) at.push_back(share * on_side(n, k, t));
    }
  }
  double most = 0;
  for (const Vec3& p : points_of(s, patch, at))
    most = std::max({most, normal.dot(p) - high, low - normal.dot(p)});
  return most;
}

}  // namespace

void find_departures(PatchCache& cache, std::span<const double> sag, const ParallelFor& parallel) {
  constexpr std::size_t kGrain = 256;
  std::vector<Departure> all(cache.mesh_face_count);  // towards the next face
  Departure farthest;
  bool goes_aside = false;
  std::visit(
      [&](const auto& s) {
        for (std::uint32_t p = 0; p < cache.patch_count(); ++p) {
          Departure& d = all[cache.patch_face[p]];
          d.face = cache.patch_face[p];
          const double own = sag[p] + centre_off(s, p), rim = rim_departure(s, p);
          // A patch that bows aside with its rim does not come nearer to the next face.
          const bool is_aside = 2 * rim > own;
          const double off = is_aside ? height_departure(s, p) : own;
          d.distance = std::max(d.distance, off / cache.scale);
          const double most = std::max(own, rim) / cache.scale;
          if (most > farthest.distance) {
            farthest = {.distance = most, .face = d.face};
            goes_aside = is_aside;
          }
        }
      },
      cache.surface);
  const FaceRays rays(cache, parallel);
  parallel(all.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      all[i].room = rays.room(all[i].face, all[i].distance / kFaithful);
  });
  if (!goes_aside)
    farthest.room = rays.room(farthest.face, std::numeric_limits<double>::infinity());
  cache.departure = farthest;
  cache.tightest = *std::max_element(
      all.begin(), all.end(), [](const auto& a, const auto& b) { return a.share() < b.share(); });
  if (!(cache.tightest.share() > kFaithful)) cache.tightest = cache.departure;
}

}  // namespace gliss
