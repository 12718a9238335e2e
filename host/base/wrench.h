// A force and a torque on a hand, and the limits that each has.
#pragma once

#include "gliss/base/vector.h"

namespace gliss {

// About the device's point, in the world's frame.
struct Wrench {
  Vec3 force = Vec3::Zero();   // N
  Vec3 torque = Vec3::Zero();  // N m

  bool is_zero() const { return force.isZero(0) && torque.isZero(0); }
};

// A rotation of a tool or device, unit. Eigen never aligns it, as Pose.
using Rotation = Eigen::Quaternion<double, Eigen::DontAlign>;

}  // namespace gliss
