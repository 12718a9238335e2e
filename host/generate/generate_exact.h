// The surfaces of the simple generated solids. Private to host/.
#pragma once

#include "gliss/generate/generate.h"

namespace gliss {

class Sphere : public ExactSurface {
 public:
  explicit Sphere(double radius) : radius_(radius) {}
  Point nearest(const Vec3& point) const override;

 private:
  double radius_;
};

// Round the z axis.
class Torus : public ExactSurface {
 public:
  Torus(double ring, double tube) : ring_(ring), tube_(tube) {}
  Point nearest(const Vec3& point) const override;

 private:
  double ring_, tube_;
};

// Its half axes lie along x, y and z.
class Ellipsoid : public ExactSurface {
 public:
  explicit Ellipsoid(const Vec3& half) : half_(half) {}
  Point nearest(const Vec3& point) const override;
  Vec3 normal_at(const Vec3& on) const;  // outward, unit

 private:
  Vec3 half_;
};

class ExactBox : public ExactSurface {
 public:
  explicit ExactBox(const Vec3& half) : half_(half) {}
  Point nearest(const Vec3& point) const override;

 private:
  Vec3 half_;
};

// A solid one about the z axis, from -half to half.
class ExactCylinder : public ExactSurface {
 public:
  ExactCylinder(double radius, double half) : radius_(radius), half_(half) {}
  Point nearest(const Vec3& point) const override;

 private:
  double radius_, half_;
};

// The point of a surface of the given distance from a curve or point: `foot` is the nearest on
// that, `direction` any unit vector that will do where `point` is on it.
ExactSurface::Point nearest_at_distance(const Vec3& point, const Vec3& foot, double distance,
                                        const Vec3& direction);

}  // namespace gliss
