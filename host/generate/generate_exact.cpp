#include "gliss/generate/generate_exact.h"

#include <cmath>

namespace gliss {

ExactSurface::Point nearest_at_distance(const Vec3& point, const Vec3& foot, double distance,
                                        const Vec3& direction) {
  const Vec3 offset = point - foot;
  const double length = offset.norm();
  const Vec3 normal = length > 0 ? Vec3(offset / length) : direction;
  return {foot + distance * normal, normal, length - distance};
}

ExactSurface::Point Sphere::nearest(const Vec3& point) const {
  return nearest_at_distance(point, Vec3::Zero(), radius_, Vec3::UnitZ());
}

ExactSurface::Point Torus::nearest(const Vec3& point) const {
  const double from_axis = std::hypot(point.x(), point.y());
  const Vec3 radial =
      from_axis > 0 ? Vec3(point.x() / from_axis, point.y() / from_axis, 0) : Vec3(1, 0, 0);
  return nearest_at_distance(point, ring_ * radial, tube_, radial);
}

Vec3 Ellipsoid::normal_at(const Vec3& on) const {
  return on.cwiseQuotient(half_).cwiseQuotient(half_).normalized();
}

// The nearest point x of y has x_i = e_i^2 y_i / (s + e_i^2 - e^2), e the least half axis, where s
// > 0 solves sum (e_i y_i / (s + e_i^2 - e^2))^2 = 1; the sum falls with s. Inside, where y has
// nothing along the least axes, there may be no such s: then the point is at s = 0, up or down
// those axes. Source: Eberly, Distance from a Point to an Ellipse, an Ellipsoid, or a
// Hyperellipsoid.
ExactSurface::Point Ellipsoid::nearest(const Vec3& point) const {
  int least = 0;
  const double e = half_.minCoeff(&least);
  const Vec3 y = point.cwiseAbs();
  Vec3 x = Vec3::Zero();
  // Sets x, and returns the sum.
  const auto sum_at = [&](double s) {
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
      if (y[i] == 0) continue;
      const double ratio = half_[i] * y[i] / (s + (half_[i] - e) * (half_[i] + e));
      x[i] = half_[i] * ratio;
      sum += ratio * ratio;
    }
    return sum;
  };
  const double at_zero = sum_at(0);  // infinite where y has something along a least axis
  if (at_zero < 1) {
    x[least] = e * std::sqrt(1 - at_zero);
  } else {
    double low = 0, high = half_.cwiseProduct(y).norm();
    for (double middle = high / 2; middle > low && middle < high; middle = (low + high) / 2)
      (sum_at(middle) > 1 ? low : high) = middle;
    sum_at(high);
  }
  for (int i = 0; i < 3; ++i) x[i] = std::copysign(x[i], point[i]);
  const double outside = point.cwiseQuotient(half_).squaredNorm() - 1;
  return {x, normal_at(x), std::copysign((point - x).norm(), outside)};
}

ExactSurface::Point ExactBox::nearest(const Vec3& point) const {
  const Vec3 inside = point.cwiseMax(-half_).cwiseMin(half_);
  const Vec3 offset = point - inside;
  const double distance = offset.norm();
  if (distance > 0) return {inside, offset / distance, distance};

  int axis = 0;  // of the nearest face
  const double depth = (half_ - point.cwiseAbs()).minCoeff(&axis);
  Vec3 normal = Vec3::Zero();
  normal[axis] = point[axis] < 0 ? -1 : 1;
  Vec3 on_face = point;
  on_face[axis] = normal[axis] * half_[axis];
  return {on_face, normal, -depth};
}

ExactSurface::Point ExactCylinder::nearest(const Vec3& point) const {
  const double from_axis = std::hypot(point.x(), point.y());
  const Vec3 radial =
      from_axis > 0 ? Vec3(point.x() / from_axis, point.y() / from_axis, 0) : Vec3(1, 0, 0);
  // A half plane through the axis sees half of a rectangle.
  const Point flat =
      ExactBox(Vec3(radius_, 2 * (radius_ + half_), half_)).nearest({from_axis, 0, point.z()});
  const Vec3 up = Vec3::UnitZ();
  return {flat.position.x() * radial + flat.position.z() * up,
          flat.normal.x() * radial + flat.normal.z() * up, flat.distance};
}

}  // namespace gliss
