// Points of the domain and measures of polygons, for the tests that judge by the oracle.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "tests/oracle/oracle.h"

namespace gliss::oracle {

inline constexpr double kDegree = std::numbers::pi / 180;

/// The largest distance between two corners.
template <class S>
S size_of(const Polygon<S>& polygon) {
  S size = 0;
  for (const Vec<S>& p : polygon.positions) {
    for (const Vec<S>& q : polygon.positions) size = std::max(size, (p - q).norm());
  }
  return size;
}

template <class S>
Vec2<S> on_side(int n, int k, S t) {
  return (1 - t) * domain_corner<S>(n, k) + t * domain_corner<S>(n, k + 1);
}

/// A random point of the domain, off its boundary.
template <class S>
Vec2<S> random_inside(Rng& rng, int n) {
  const int k = static_cast<int>(rng() % static_cast<std::uint64_t>(n));
  const S radius = static_cast<S>(std::sqrt(uniform(rng, 0, 0.98)));
  return radius * on_side<S>(n, k, static_cast<S>(uniform(rng, 0, 1)));
}

/// Angle between vectors, right when it is small.
template <class S>
S angle(const Vec<S>& a, const Vec<S>& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace gliss::oracle
