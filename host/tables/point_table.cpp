#include "gliss/tables/point_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "gliss/base/poll.h"
#include "gliss/base/units.h"
#include "gliss/mesh/mesh.h"
#include "gliss/tables/hdf5_reader.h"

namespace gliss {
namespace {

const std::vector<std::vector<std::string>> kNames = {{"x", "y", "z"}, {"x_mm", "y_mm", "z_mm"}};

// Vectors of three columns that `numbers` gives, each as long as the first.
template <class Numbers>
std::vector<Vec3> vectors_of(const Numbers& x, const Numbers& y, const Numbers& z, ItemPoll& poll) {
  std::vector<Vec3> vectors;
  vectors.reserve(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    poll();
    vectors.emplace_back(x[i], y[i], z[i]);
  }
  return vectors;
}

template <class Numbers>
std::vector<std::chrono::nanoseconds> times_of(const Numbers& seconds, ItemPoll& poll) {
  constexpr double kMost = 9e9;  // s, of 64 bits of nanoseconds
  std::vector<std::chrono::nanoseconds> times;
  times.reserve(seconds.size());
  for (const double time : seconds) {
    poll();
    times.emplace_back(std::llround(1e9 * std::clamp(time, -kMost, kMost)));
  }
  return times;
}

// ticks/x, ticks/y and ticks/z, or of other names.
std::vector<Vec3> read_vectors(const Hdf5Reader& file, const std::string& prefix,
                               const std::string& action, ItemPoll& poll) {
  const auto x = file.numbers(prefix + "x"), y = file.numbers(prefix + "y"),
             z = file.numbers(prefix + "z");
  if (y.size() != x.size() || z.size() != x.size())
    throw std::runtime_error(action + ": x, y and z are not equally long");
  std::vector<Vec3> vectors = vectors_of(x, y, z, poll);
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    if (!vectors[i].allFinite())
      throw std::runtime_error(fmt::format("{}: tick {} is not finite", action, i));
  }
  return vectors;
}

std::vector<Rotation> read_recorded_rotations(const Hdf5Reader& file, std::size_t ticks,
                                              const std::string& action, ItemPoll& poll) {
  std::vector<Rotation> rotations;
  if (!file.has("ticks/qw")) return rotations;
  const auto w = file.numbers("ticks/qw"), x = file.numbers("ticks/qx"),
             y = file.numbers("ticks/qy"), z = file.numbers("ticks/qz");
  if (w.size() != ticks || x.size() != ticks || y.size() != ticks || z.size() != ticks)
    throw std::runtime_error(action + ": qw, qx, qy and qz are not as long as x");
  rotations.reserve(ticks);
  for (std::size_t i = 0; i < ticks; ++i) {
    poll();
    rotations.emplace_back(w[i], x[i], y[i], z[i]);
  }
  return rotations;
}

PointTable read_recording(const Hdf5Reader& file, const std::string& action, ItemPoll& poll) {
  PointTable ticks;
  ticks.points = read_vectors(file, "ticks/", action, poll);
  ticks.rotations = read_recorded_rotations(file, ticks.points.size(), action, poll);
  if (file.has("ticks/time")) ticks.times = times_of(file.numbers("ticks/time"), poll);
  if (file.has("ticks/vx")) ticks.velocities = read_vectors(file, "ticks/v", action, poll);
  for (const std::size_t length : {ticks.times.size(), ticks.velocities.size()}) {
    if (length != 0 && length != ticks.points.size())
      throw std::runtime_error(action + ": time, vx, vy and vz are not as long as x");
  }
  return ticks;
}

// Sets what the table has of kMotionColumns.
void read_motion(const InputTable& table, PointTable& to, ItemPoll& poll) {
  const LargeArray<double>* found[4];
  for (std::size_t i = 0; i < 4; ++i) found[i] = table.find(kMotionColumns[i]);
  if (found[0] != nullptr) to.times = times_of(*found[0], poll);
  if (found[1] != nullptr && found[2] != nullptr && found[3] != nullptr)
    to.velocities = vectors_of(*found[1], *found[2], *found[3], poll);
}

// True if a quaternion's length is 1 but for what files round.
bool is_rotation(const Rotation& rotation) { return std::abs(rotation.norm() - 1) < 1e-3; }

}  // namespace

std::vector<Rotation> rotations_of(const InputTable& table, const Poll& ask) {
  const LargeArray<double>* q[4];
  std::size_t there = 0;
  for (std::size_t i = 0; i < 4; ++i) there += (q[i] = table.find(kRotationColumns[i])) != nullptr;
  if (there == 0 || table.rows == 0) return {};
  if (there < 4) throw std::runtime_error(table.place(0) + ": a rotation has qw, qx, qy and qz");
  ItemPoll poll(ask);
  std::vector<Rotation> rotations;
  rotations.reserve(table.rows);
  for (std::size_t i = 0; i < table.rows; ++i) {
    poll();
    rotations.emplace_back((*q[0])[i], (*q[1])[i], (*q[2])[i], (*q[3])[i]);
    if (!is_rotation(rotations.back()))
      throw std::runtime_error(
          fmt::format("{}: qw, qx, qy and qz have the length {:.3g}, and a rotation has 1",
                      table.place(i), rotations.back().norm()));
    rotations.back().normalize();
  }
  return rotations;
}

PointReader::PointReader(const std::string& path, double unit,
                         const std::vector<std::string>& optional, const Poll& poll)
    : path_(path), unit_(unit), poll_(poll) {
  if (is_hdf5(path)) {
    try {
      const Hdf5Reader file(path, "a recording", poll);
      if (!file.has("x") && !file.has("x_mm")) {
        const std::string action = fmt::format("cannot read '{}' as a recording", path);
        ItemPoll poll_rows(poll);
        recording_ = read_recording(file, action, poll_rows);
        return;
      }
    } catch (const std::runtime_error& error) {
      throw RecordingError(error.what());
    }
  }
  reader_ = open_table(path, {.alternatives = kNames, .optional = optional, .poll = poll});
}

PointTable PointReader::read(std::size_t begin, std::size_t end) {
  PointTable result;
  ItemPoll poll(poll_);
  if (!reader_) {
    const auto add_rows = [&](const auto& from, auto& to) {
      if (from.empty()) return;
      to.reserve(end - begin);
      for (std::size_t i = begin; i < end; ++i) {
        poll();
        to.push_back(from[i]);
      }
    };
    add_rows(recording_.points, result.points);
    add_rows(recording_.rotations, result.rotations);
    add_rows(recording_.times, result.times);
    add_rows(recording_.velocities, result.velocities);
    return result;
  }
  result.table = reader_->read(begin, end);
  result.rotations = rotations_of(result.table, poll_);
  read_motion(result.table, result, poll);
  const std::size_t chosen = result.table.alternative;
  const std::string named = result.table.unit(kNames[chosen][0]);
  result.unit = chosen == 0 ? unit_ : 1e-3;
  if (!named.empty()) {
    try {
      result.unit = parse_unit(named);
    } catch (const UnitError& error) {
      throw RecordingError(
          fmt::format("{}: column '{}': {}", path_, kNames[chosen][0], error.what()));
    }
  }
  const auto &x = *result.table.find(kNames[chosen][0]), &y = *result.table.find(kNames[chosen][1]),
             &z = *result.table.find(kNames[chosen][2]);
  result.points = vectors_of(x, y, z, poll);
  for (std::size_t i = 0; i < result.points.size(); ++i) {
    const double farthest = result.points[i].cwiseAbs().maxCoeff();
    if (!(farthest <= kMostCoordinate))
      throw RecordingError(fmt::format("{}: {:.3g} is beyond {:g}, where distances overflow",
                                       result.table.place(i), farthest, kMostCoordinate));
  }
  return result;
}

PointTable read_points(const std::string& path, double unit,
                       const std::vector<std::string>& optional, const Poll& poll) {
  PointReader reader(path, unit, optional, poll);
  return reader.read(0, reader.rows());
}

std::vector<Vec3> points_in_metres(PointTable table) {
  const UnitChange to_metres(table.unit, 1);
  std::vector<Vec3> points = std::move(table.points);
  for (Vec3& point : points) point = to_metres(point);
  return points;
}

}  // namespace gliss
