#include "gliss/build/departure.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "gliss/build/face_rays.h"
#include "gliss/build/patch_batch.h"
#include "gliss/surface/base_triangles.h"
#include "gliss/surface/domain.h"
#include "gliss/surface/instances.h"

namespace gliss {
namespace {

// Points of a patch, mesh frame, until the thread asks for others.
template <class Real>
std::span<const Vec3> points_of(const Surface<Real>& s, std::uint32_t patch,
                                std::span<const DomainVec> at) {
  thread_local std::vector<Real> rows;  // xi, eta, and the nine of points
  thread_local std::vector<Vec3> points;
  const std::size_t count = at.size();
  const std::uint32_t n = s.valence(patch);
  rows.resize(11 * count), points.resize(count);
  Real *xi = rows.data(), *eta = xi + count, *p = eta + count;
  for (std::size_t i = 0; i < count; ++i)
    xi[i] = static_cast<Real>(at[i].x()), eta[i] = static_cast<Real>(at[i].y());
  kernels<Real>().evaluate(&s.domain[s.domain_begin[n]],
                           &s.control[3 * std::size_t{s.control_begin[patch]}], s.form[patch], n,
                           xi, eta, count, count, p);
  for (std::size_t i = 0; i < count; ++i) points[i] = from_local(s, patch, vector_at(p + i, count));
  return points;
}

// How far the sides where a patch ends, at a border or a sharp edge, leave those of its polygon,
// mesh frame: where a surface is smaller than its polygons, none of its own points tells.
template <class Real>
double rim_departure(const Surface<Real>& s, std::uint32_t patch) {
  constexpr double kAlong[] = {0.25, 0.5, 0.75};
  thread_local std::vector<DomainVec> at;
  thread_local std::vector<std::uint32_t> rim;  // sides
  const std::uint32_t n = s.valence(patch), first = s.side_begin[patch];
  at.clear(), rim.clear();
  for (std::uint32_t k = 0; k < n; ++k) {
    if (is_smooth_across(s, first + k)) continue;
    rim.push_back(first + k);
    for (const double t : kAlong) at.push_back(on_side(n, k, t));
  }
  const std::span<const Vec3> points = points_of(s, patch, at);
  double most = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::uint32_t side = rim[i / std::size(kAlong)];
    const Vec3 start = start_of(s, side), from_start = points[i] - start,
               along = (start_of(s, next_side(s, side)) - start).stableNormalized();
    most = std::max(most, across(along, from_start).norm());
  }
  return most;
}

// Points of a patch: its centre, and rings round it out to its sides.
template <class Real>
std::span<const Vec3> spread_points(const Surface<Real>& s, std::uint32_t patch) {
  const std::uint32_t n = s.valence(patch);
  thread_local std::vector<DomainVec> at;
  at.assign(1, DomainVec::Zero());
  for (std::uint32_t k = 0; k < n; ++k) {
    for (const double t : {0.0, 0.25, 0.5, 0.75}) {
      for (const double share : {0.25, 0.5, 0.75, 1.0}) at.push_back(share * on_side(n, k, t));
    }
  }
  return points_of(s, patch, at);
}

// How far a patch rises above its polygon, or sinks below it, along the polygon's normal, mesh
// frame.
template <class Real>
double height_departure(const Surface<Real>& s, std::uint32_t patch) {
  const Vec3 normal = vector_at(&s.patch[patch * kPatchReals + kPatchNormal]);
  double low = normal.dot(start_of(s, s.side_begin[patch])), high = low;
  for (std::uint32_t side = s.side_begin[patch]; side < s.side_begin[patch + 1]; ++side) {
    const double corner = normal.dot(start_of(s, side));
    low = std::min(low, corner), high = std::max(high, corner);
  }
  double most = 0;
  for (const Vec3& p : spread_points(s, patch))
    most = std::max({most, normal.dot(p) - high, low - normal.dot(p)});
  return most;
}

// How far a point is from a triangle.
double distance_to(const BaseTriangle& t, const Vec3& p) {
  const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]).stableNormalized();
  double nearest = std::numeric_limits<double>::infinity();
  bool is_over = !normal.isZero(0);
  for (int k = 0; k < 3; ++k) {
    const Vec3 edge = t[(k + 1) % 3] - t[k], from = p - t[k];
    const double square = edge.squaredNorm();
    const double along = square > 0 ? std::clamp(edge.dot(from) / square, 0.0, 1.0) : 0;
    nearest = std::min(nearest, (from - along * edge).norm());
    is_over = is_over && normal.dot(edge.cross(from)) >= 0;
  }
  return is_over ? std::abs(normal.dot(p - t[0])) : nearest;
}

// How far the patches of a face that is cut round a centre leave its polygon, mesh frame: the
// polygon's triangles are not theirs. They are those from `first` to `end`.
template <class Real>
double cut_departure(const Surface<Real>& s, std::uint32_t first, std::uint32_t end) {
  thread_local std::vector<BaseTriangle> polygon;
  polygon.clear();
  for (std::uint32_t p = first; p < end; ++p)
    for_polygon_triangles(s, p, [](const BaseTriangle& t) { polygon.push_back(t); });
  double most = 0;
  for (std::uint32_t p = first; p < end; ++p) {
    for (const Vec3& point : spread_points(s, p)) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const BaseTriangle& t : polygon) nearest = std::min(nearest, distance_to(t, point));
      most = std::max(most, nearest);
    }
  }
  return most;
}

struct FaceDeparture {
  Departure ahead;          // of the patch that comes nearest to the next face
  double farthest = 0;      // of the patch that is farthest from its polygon, mesh's unit
  bool goes_aside = false;  // true if that one bows aside with its rim
};

template <class Real>
FaceDeparture departure_of(const PatchCache& cache, const Surface<Real>& s, std::uint32_t face,
                           std::span<const double> sag) {
  FaceDeparture d{{.face = face}};
  const std::uint32_t first = cache.first_patch(face), end = cache.end_of_face(first);
  const bool is_cut = first < end && piece_of(s, first) != nullptr;
  const double cut = is_cut ? cut_departure(s, first, end) : 0;
  for (std::uint32_t p = first; p < end; ++p) {
    const double own = is_cut ? cut : sag[p], rim = rim_departure(s, p);
    // A patch that bows aside with its rim does not come nearer to the next face.
    const bool is_aside = 2 * rim > own;
    const double off = is_aside ? height_departure(s, p) : own;
    d.ahead.distance = std::max(d.ahead.distance, off / cache.scale);
    const double most = std::max(own, rim) / cache.scale;
    if (most > d.farthest) d.farthest = most, d.goes_aside = is_aside;
  }
  return d;
}

}  // namespace

void find_departures(PatchCache& cache, std::span<const double> sag, const ParallelFor& parallel) {
  constexpr std::size_t kGrain = 256;
  const FaceRays rays(cache, parallel);
  std::vector<FaceDeparture> all(cache.mesh_face_count);
  parallel(all.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (auto f = static_cast<std::uint32_t>(begin); f < end; ++f) {
      all[f] =
          std::visit([&](const auto& s) { return departure_of(cache, s, f, sag); }, cache.surface);
      all[f].ahead.room = rays.room(f, all[f].ahead.distance / kFaithful);
    }
  });
  const auto most = [&](auto less) { return std::max_element(all.begin(), all.end(), less); };
  const FaceDeparture& farthest =
      *most([](const auto& a, const auto& b) { return a.farthest < b.farthest; });
  cache.departure = {.distance = farthest.farthest, .face = farthest.ahead.face};
  if (!farthest.goes_aside)
    cache.departure.room = rays.room(cache.departure.face, std::numeric_limits<double>::infinity());
  cache.tightest =
      most([](const auto& a, const auto& b) { return a.ahead.share() < b.ahead.share(); })->ahead;
  if (!(cache.tightest.share() > kFaithful)) cache.tightest = cache.departure;
}

}  // namespace gliss
