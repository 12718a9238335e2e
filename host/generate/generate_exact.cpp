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
