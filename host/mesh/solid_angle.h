// The part of the view that a triangle fills: summed over a closed mesh, 4 pi for each time that it
// goes round a point.
#pragma once

#include <cmath>

#include "gliss/base/vector.h"

namespace gliss {

// Solid angle of a triangle seen from the origin, positive from behind (van Oosterom and Strackee
// 1983).
inline double solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double x = a.norm(), y = b.norm(), z = c.norm();
  return 2 * std::atan2(a.dot(b.cross(c)), x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y);
}

}  // namespace gliss
