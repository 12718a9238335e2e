#include "gliss/scene/read_motion.h"

#include <filesystem>
#include <numbers>

#include "gliss/base/poll.h"
#include "gliss/base/units.h"
#include "gliss/scene/scene.h"
#include "gliss/tables/csv_reader.h"
#include "gliss/tables/point_table.h"

namespace gliss {
namespace {

struct Poses {
  std::vector<double> times;
  std::vector<Pose> poses;
};

Poses read_table_of_poses(const std::string& path, const Poll& poll) {
  const std::vector<std::vector<std::string>> names = {{"t", "x", "y", "z"},
                                                       {"t", "x_mm", "y_mm", "z_mm"}};
  const InputTable table =
      read_table(path, {.alternatives = names, .optional = kRotationColumns, .poll = poll});
  const auto column = [&](std::size_t i) -> const LargeArray<double>& {
    return *table.find(names[table.alternative][i]);
  };
  const UnitChange to_metres(table.alternative == 0 ? 1 : 1e-3, 1);
  const std::vector<Rotation> rotations = rotations_of(table, poll);
  ItemPoll poll_rows(poll);
  Poses all;
  for (std::size_t i = 0; i < table.rows; ++i) {
    poll_rows();
    Pose pose = Pose::Identity();
    pose.translation() = to_metres(Vec3(column(1)[i], column(2)[i], column(3)[i]));
    if (!rotations.empty()) pose.linear() = rotations[i].toRotationMatrix();
    if (i > 0 && !(column(0)[i] > all.times.back()))
      throw std::runtime_error(
          fmt::format("{}: its time is not later than that of the row before", table.place(i)));
    all.times.push_back(column(0)[i]);
    all.poses.push_back(pose);
  }
  return all;
}

Poses read_keyframes(TomlTable& table) {
  Poses all;
  for (TomlTable& frame : table.tables("keyframes")) {
    double time = 0;
    if (!frame.has("time")) frame.fail("", "needs a time");
    frame.get("time", time, parse_time);
    if (!all.times.empty() && !(time > all.times.back()))
      frame.fail("time", "must be later than that of the keyframe before");
    Vec3 position = Vec3::Zero();
    frame.get_point("position", position);
    Pose pose = Pose::Identity();
    pose.translation() = position;
    if (auto rotation = frame.table("rotation")) pose.linear() = read_rotation(*rotation);
    frame.done();
    all.times.push_back(time);
    all.poses.push_back(pose);
  }
  return all;
}

}  // namespace

AxisAngle read_axis_angle(TomlTable& table) {
  Vec3 axis = Vec3::Zero();
  double degrees = 0;
  table.get_point("axis", axis);
  table.get("degrees", degrees);
  table.done();
  if (axis.isZero(0)) table.fail("axis", "must be three numbers that are not all zero");
  // Squares of 1e155 are not finite, those of 1e-165 are zero.
  return {axis.stableNormalized(), degrees * std::numbers::pi / 180};
}

Eigen::Matrix3d read_rotation(TomlTable table) {
  const AxisAngle turn = read_axis_angle(table);
  return Eigen::AngleAxisd(turn.angle, turn.axis).matrix();
}

std::shared_ptr<const Motion> read_motion(TomlTable table, std::vector<std::string>& files,
                                          const Poll& poll) {
  std::string path;
  table.get("path", path);
  bool repeats = false;
  table.get("repeat", repeats);
  if (path.empty() == !table.has("keyframes"))
    table.fail("", "needs a path (a table of poses) or keyframes, one of them");
  Poses all;
  if (path.empty()) {
    all = read_keyframes(table);
  } else {
    files.push_back((std::filesystem::path(files.front()).parent_path() / path).string());
    try {
      all = read_table_of_poses(files.back(), poll);
    } catch (const CsvError&) {
      throw;  // which names its own file and line
    } catch (const std::runtime_error& error) {
      table.fail("path", error.what());
    }
  }
  table.done();
  std::shared_ptr<const Motion> motion;
  try {
    motion = std::make_shared<const Motion>(std::move(all.times), all.poses, repeats);
  } catch (const std::invalid_argument& error) {
    table.fail("", error.what());
  }
  return motion;
}

}  // namespace gliss
