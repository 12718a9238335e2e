// How an object moves: by poses in time, or by those of another thread.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/contact/pose.h"
#include "gliss/thread/seqlock.h"

namespace gliss {

// True if a pose is finite and its linear part a rotation, to 1e-6 of a matrix entry.
GLISS_EXPORT bool is_rigid(const Pose& pose) noexcept;

// Poses by time: between two of them the translation goes along a line and the rotation along the
// shorter arc, each evenly. Before the first and after the last the object rests there. Any number
// of threads may ask it.
class GLISS_EXPORT Motion {
 public:
  // Times in s from 0 on, each above the one before; as many poses, one at least. `repeats`: at the
  // last time it begins anew. Throws std::invalid_argument otherwise, naming the first of them that
  // is wrong, from 0.
  Motion(std::vector<double> times, const std::vector<Pose>& poses, bool repeats = false);

  Pose at(double time) const noexcept;
  double duration() const { return times_.back(); }  // s, of one round

 private:
  std::vector<double> times_;
  std::vector<Eigen::Quaternion<double, Eigen::DontAlign>> rotations_;
  std::vector<Eigen::Vector3d> places_;
  bool repeats_;
};

// The latest pose that another thread gave: whole, and without a lock on either side. One thread
// publishes; any number read.
class GLISS_EXPORT PoseChannel {
 public:
  // False for a pose that is not rigid: it is not published.
  bool publish(const Pose& pose) noexcept;
  // Nothing before the first one, and where the writer is met each of a few times.
  std::optional<Pose> latest() const noexcept;

 private:
  Seqlock<std::array<double, 12>> lock_;
};

}  // namespace gliss
