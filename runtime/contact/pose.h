// The place of an object in the world.
#pragma once

#include <Eigen/Geometry>

namespace gliss {

// A rotation and a translation (m) from the object's frame to the world's, in that order. It takes
// what Eigen makes, such as Translation3d(0.1, 0, 0) * AngleAxisd(0.5, Vec3::UnitZ()), and has the
// members of Eigen::Isometry3d. That type's alignment follows the flags of the file that includes
// it (-mavx2, -march=native), so that a library and its user would disagree about sizes; this one's
// does not.
using Pose = Eigen::Transform<double, 3, Eigen::Isometry, Eigen::DontAlign>;
static_assert(sizeof(Pose) == 16 * sizeof(double) && alignof(Pose) == alignof(double));

}  // namespace gliss
