// The oracle of force shading: the blended normal and the force, slow and literal, in long double.
//
// Sources: Morgenbesser, Srinivasan, "Force shading for haptic shape perception" (1996); Hormann,
// Floater, "Mean value coordinates for arbitrary planar polygons" (2006): with r_k the distance of
// corner k and alpha_k the signed angle under which the point sees side k,
//   w_k = (tan(alpha_{k-1} / 2) + tan(alpha_k / 2)) / r_k,   lambda_k = w_k / sum of w.
// A polygon that is not planar is seen along its vector area, and so is the point.
// This file includes nothing of kernels/ and host/, and was written without them at hand.
#pragma once

#include "tests/oracle/oracle.h"

namespace gliss::oracle {

/// The coordinates of a point of the plane in a polygon there; on a side they are linear.
inline std::vector<long double> mean_values(const std::vector<Vec2<long double>>& corners,
                                            const Vec2<long double>& at) {
  using Real = long double;
  const std::size_t n = corners.size();
  const auto next = [&](std::size_t k) { return (k + 1) % n; };
  Real size = 0;
  for (const auto& c : corners) size = std::max(size, (c - at).norm());
  std::vector<Real> lambda(n, 0);
  for (std::size_t k = 0; k < n; ++k) {
    const Vec2<Real> side = corners[next(k)] - corners[k], way = at - corners[k];
    const Real t = way.dot(side) / side.squaredNorm();
    if (t < 0 || t > 1 || (way - t * side).norm() > 1e-17L * size) continue;
    lambda[k] = 1 - t, lambda[next(k)] = t;
    return lambda;
  }
  std::vector<Real> tangent(n);
  for (std::size_t k = 0; k < n; ++k) {
    const Vec2<Real> a = corners[k] - at, b = corners[next(k)] - at;
    tangent[k] = std::tan(std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b)) / 2);
  }
  Real sum = 0;
  for (std::size_t k = 0; k < n; ++k) {
    lambda[k] = (tangent[(k + n - 1) % n] + tangent[k]) / (corners[k] - at).norm();
    sum += lambda[k];
  }
  for (Real& l : lambda) l /= sum;
  return lambda;
}

/// The normal of force shading at a point of a polygon.
inline Vec<long double> shaded_normal(const Polygon<long double>& polygon,
                                      const Vec<long double>& at) {
  const Vec<long double> up = face_normal(polygon), x = up.unitOrthogonal(), y = up.cross(x);
  const auto seen = [&](const Vec<long double>& p) {
    return Vec2<long double>((p - at).dot(x), (p - at).dot(y));
  };
  std::vector<Vec2<long double>> corners;
  for (const Vec<long double>& p : polygon.positions) corners.push_back(seen(p));
  const std::vector<long double> lambda = mean_values(corners, seen(at));
  Vec<long double> blend = Vec<long double>::Zero();
  for (std::size_t k = 0; k < lambda.size(); ++k) blend += lambda[k] * polygon.normals[k];
  return blend.normalized();
}

/// SCP - HIP of force shading: as long as that of the polygon's own point, along the blended
/// normal.
inline Vec<long double> shaded_push(const Polygon<long double>& polygon,
                                    const Vec<long double>& scp, const Vec<long double>& hip) {
  return (scp - hip).norm() * shaded_normal(polygon, scp);
}

}  // namespace gliss::oracle
