// The motion of an object of a scene.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "gliss/base/poll.h"
#include "gliss/contact/motion.h"
#include "gliss/scene/toml_table.h"

namespace gliss {

struct AxisAngle {
  Vec3 axis;     // unit
  double angle;  // rad
};
// {axis = [x, y, z], degrees = 90}
AxisAngle read_axis_angle(TomlTable& table);
// ... as a rotation.
Eigen::Matrix3d read_rotation(TomlTable table);

// {path = "motion.csv"}, a table t,x,y,z or t,x_mm,y_mm,z_mm, perhaps with qw,qx,qy,qz; or
// {keyframes = [{time = "1s", position = [x, y, z], rotation = {...}}, ...]}; perhaps repeat.
// Throws SceneError, and what reading a table throws. Adds the table to `files`, whose first is the
// scene's own.
std::shared_ptr<const Motion> read_motion(TomlTable table, std::vector<std::string>& files,
                                          const Poll& poll);

}  // namespace gliss
