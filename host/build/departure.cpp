#include "gliss/build/departure.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "gliss/build/face_rays.h"
#include "gliss/surface/base_triangles.h"

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

}  // namespace

void find_departures(PatchCache& cache, std::span<const double> sag, const ParallelFor& parallel) {
  constexpr std::size_t kGrain = 256;
  std::vector<Departure> all(cache.mesh_face_count);
  std::visit(
      [&](const auto& s) {
        for (std::uint32_t p = 0; p < cache.patch_count(); ++p) {
          Departure& d = all[cache.patch_face[p]];
          d.face = cache.patch_face[p];
          d.distance = std::max(d.distance, (sag[p] + centre_off(s, p)) / cache.scale);
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
  if (!(cache.tightest.share() > kFaithful)) cache.tightest = cache.departure;
}

}  // namespace gliss
