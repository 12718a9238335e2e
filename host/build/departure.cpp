#include "gliss/build/departure.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>
#include <vector>

#include "gliss/build/face_rays.h"
#include "gliss/build/patch_batch.h"
#include "gliss/surface/base_triangles.h"
#include "gliss/surface/instances.h"
#include "gliss/surface/layout.h"

namespace gliss {
namespace {

// No point of the patch is farther from its polygon, mesh frame.
template <class Real>
double sag_of(const Surface<Real>& s, std::uint32_t patch) {
  const Real* numbers = &s.patch[patch * kPatchReals];
  const double own = static_cast<double>(numbers[kPatchSag] * numbers[kPatchUnscale]);
  if (piece_of(s, patch) == nullptr) return own;
  // One round a centre is near its own triangle, which leaves the polygon as its centre does.
  double off = 0;
  for_polygon_triangles(s, patch, [&](const BaseTriangle& t) {
    const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]).stableNormalized();
    off = std::abs(normal.dot(start_of(s, s.side_begin[patch] + 2) - t[0]));
  });
  return own + off;
}

// The distance of a point from a triangle (Ericson 2005, Real-Time Collision Detection, 5.1.5).
double distance_to(const BaseTriangle& t, const Vec3& x) {
  const Vec3 ab = t[1] - t[0], ac = t[2] - t[0], ax = x - t[0], bx = x - t[1], cx = x - t[2];
  const double d1 = ab.dot(ax), d2 = ac.dot(ax), d3 = ab.dot(bx), d4 = ac.dot(bx), d5 = ab.dot(cx),
               d6 = ac.dot(cx);
  const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  if (va > 0 && vb > 0 && vc > 0) return std::abs(ab.cross(ac).stableNormalized().dot(ax));
  const auto to_edge = [&](const Vec3& from, const Vec3& along) {
    const double length2 = along.squaredNorm();
    const double part = length2 > 0 ? std::clamp(from.dot(along) / length2, 0.0, 1.0) : 0;
    return (from - part * along).norm();
  };
  return std::min({to_edge(ax, ab), to_edge(ax, ac), to_edge(bx, t[2] - t[1])});
}

// The largest distance of a patch from its face's polygon at points of a grid, mesh frame.
template <class Real>
double sampled_sag(const Surface<Real>& s, std::uint32_t patch,
                   const std::vector<BaseTriangle>& polygon, const ValenceTables& tables) {
  constexpr std::uint32_t kRings = 16;
  const std::uint32_t n = s.valence(patch);
  std::vector<double> xi{0}, eta{0};
  for (std::uint32_t ring = 1; ring <= kRings; ++ring) {
    for (std::uint32_t k = 0; k < n; ++k) {
      for (std::uint32_t i = 0; i < ring; ++i) {
        const DomainVec at = 1.0 * ring / kRings * on_side(n, k, 1.0 * i / ring);
        xi.push_back(at.x()), eta.push_back(at.y());
      }
    }
  }
  const std::size_t count = xi.size();
  const Real* own = &s.control[3 * std::size_t{s.control_begin[patch]}];
  const std::vector<double> control(own, own + kernels<double>().control_reals(s.form[patch], n));
  std::vector<double> rows(9 * count);
  kernels<double>().evaluate(tables.domain_of(n), control.data(), s.form[patch], n, xi.data(),
                             eta.data(), count, count, rows.data());
  const Real* numbers = &s.patch[patch * kPatchReals];
  const Vec3 origin(numbers[kPatchOrigin], numbers[kPatchOrigin + 1], numbers[kPatchOrigin + 2]);
  double most = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 x = origin + static_cast<double>(numbers[kPatchUnscale]) *
                                Vec3(rows[i], rows[count + i], rows[2 * count + i]);
    double least = std::numeric_limits<double>::infinity();
    for (const BaseTriangle& t : polygon) least = std::min(least, distance_to(t, x));
    most = std::max(most, least);
  }
  return most;
}

}  // namespace

void find_departures(PatchCache& cache, const ValenceTables& tables, const ParallelFor& parallel) {
  constexpr std::size_t kGrain = 256;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::size_t faces = cache.mesh_face_count;
  std::vector<double> sag(faces, 0), room(faces, kInfinity);
  const auto for_patches = [&](std::uint32_t face, auto visit) {
    std::visit(
        [&](const auto& s) {
          for (std::uint32_t p = cache.first_patch(face);
               p < cache.patch_count() && cache.patch_face[p] == face; ++p)
            visit(s, p);
        },
        cache.surface);
  };
  const FaceRays rays(cache, parallel);
  parallel(faces, kGrain, [&](std::size_t begin, std::size_t end) {
    for (auto f = static_cast<std::uint32_t>(begin); f < end; ++f) {
      for_patches(f, [&](const auto& s, std::uint32_t p) {
        sag[f] = std::max(sag[f], sag_of(s, p) / cache.scale);
      });
      room[f] = rays.room(f, sag[f] / kFaithful);
    }
  });

  // Bounds are wider than what they hold: the largest are looked at until one is what it says.
  std::vector<char> is_sampled(faces, 0);
  const auto sample = [&](std::uint32_t face) {
    std::vector<BaseTriangle> polygon;
    for_patches(face, [&](const auto& s, std::uint32_t p) {
      for_polygon_triangles(s, p, [&](const BaseTriangle& t) { polygon.push_back(t); });
    });
    sag[face] = 0;
    for_patches(face, [&](const auto& s, std::uint32_t p) {
      sag[face] = std::max(sag[face], sampled_sag(s, p, polygon, tables) / cache.scale);
    });
  };
  const auto largest = [&](auto value) {
    std::priority_queue<std::pair<double, std::uint32_t>> open;
    for (std::uint32_t f = 0; f < faces; ++f) {
      if (value(f) > 0 || f == 0) open.emplace(value(f), f);
    }
    while (true) {
      const std::uint32_t face = open.top().second;
      if (std::exchange(is_sampled[face], 1) != 0) return face;
      open.pop();
      sample(face);
      open.emplace(value(face), face);
    }
  };
  const std::uint32_t farthest = largest([&](std::uint32_t f) { return sag[f]; }),
                      tightest = largest([&](std::uint32_t f) { return sag[f] / room[f]; });
  room[farthest] = rays.room(farthest, kInfinity);
  const auto at = [&](std::uint32_t face) { return Departure{sag[face], room[face], face}; };
  cache.departure = at(farthest);
  cache.tightest = at(tightest).share() > kFaithful ? at(tightest) : cache.departure;
}

}  // namespace gliss
