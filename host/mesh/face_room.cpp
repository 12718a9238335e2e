#include "gliss/mesh/face_room.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace gliss {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kRounding = 1e-9;  // of the squares of what is compared

using Vec2 = Eigen::Vector2d;

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

// A point that moves in a plane.
struct Moving {
  Vec2 start, step;
  Vec2 at(double t) const { return start + t * step; }
  Moving from(const Moving& other) const { return {start - other.start, step - other.step}; }
};

// The roots of a t^2 + b t + c, ascending; NaN where there is none.
std::array<double, 2> roots_of(double a, double b, double c) {
  const double squared = b * b - 4 * a * c;
  // Two roots that are one but for rounding: a polygon that shrinks to a point has them.
  const double root = std::sqrt(squared > -kRounding * b * b ? std::max(0.0, squared) : squared);
  const double q = -0.5 * (b + std::copysign(root, b));
  const std::array<double, 2> roots{q / a, c / q};
  return roots[0] < roots[1] ? roots : std::array<double, 2>{roots[1], roots[0]};
}

// When c is first on the side from a to b.
double meeting(const Moving& a, const Moving& b, const Moving& c) {
  const Moving e = b.from(a), f = c.from(a);
  for (const double t :
       roots_of(cross(e.step, f.step), cross(e.start, f.step) + cross(e.step, f.start),
                cross(e.start, f.start))) {
    if (!(t > 0 && t < kNever)) continue;
    const double along = f.at(t).dot(e.at(t)), length = e.at(t).squaredNorm(),
                 rounding = kRounding * e.start.squaredNorm();
    if (along >= -rounding && along <= length + rounding) return t;
  }
  return kNever;
}

}  // namespace

double room_of(std::span<const Vec3> corners, std::span<const Vec3> steps, const Vec3& normal) {
  if (std::all_of(steps.begin(), steps.end(), [](const Vec3& s) { return s.isZero(0); }))
    return kNever;
  const Vec3 z = normal.stableNormalized(), x = z.unitOrthogonal(), y = z.cross(x);
  const std::size_t n = corners.size();
  std::vector<Moving> polygon;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 at = corners[i] - corners[0];
    polygon.push_back({{at.dot(x), at.dot(y)}, {steps[i].dot(x), steps[i].dot(y)}});
  }
  double least = kNever;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t j = (i + 1) % n;
    for (std::size_t k = 0; k < n; ++k) {
      const Vec2& at = polygon[k].start;
      if (at != polygon[i].start && at != polygon[j].start)
        least = std::min(least, meeting(polygon[i], polygon[j], polygon[k]));
    }
  }
  return least;
}

}  // namespace gliss
