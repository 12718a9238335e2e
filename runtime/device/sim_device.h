// A simulated device in a simulated hand: a point mass that a spring and a damper draw after a
// target on a scripted path, pushed by the force written. What it reports is delayed, noisy and
// rounded as a sensor's. The same seed and times give the same bytes.
#pragma once

#include <optional>
#include <random>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/device/device.h"

namespace gliss {

// The place where the hand wants to be: on straight lines between the points, and from the last to
// the first again in a further round.
class GLISS_EXPORT HandPath {
 public:
  HandPath() = default;  // stays at the origin
  // Times in s, not decreasing; points in m; `back` s from the last point to the first. Throws
  // std::invalid_argument otherwise.
  HandPath(std::vector<double> times, std::vector<Vec3> points, int rounds = 1, double back = 0);
  // A point every `interval` (s).
  static HandPath sampled(std::vector<Vec3> points, double interval, int rounds = 1);
  // At a speed (m/s) along the waypoints.
  static HandPath along(const std::vector<Vec3>& waypoints, double speed, int rounds = 1);

  double duration() const { return times_.empty() ? 0 : (rounds_ - 1) * lap_ + times_.back(); }
  // The path's end after its duration, its beginning before. Quick where t grows from call to call.
  Vec3 at(double t) noexcept;

 private:
  std::vector<double> times_;  // of the first round
  std::vector<Vec3> points_;
  int rounds_ = 1;
  double lap_ = 0;  // s, from a round's beginning to the next one's
  std::size_t next_ = 0;
};

struct SimOptions {
  double mass = 0.1;            // kg, of the end effector and what moves with it
  double hand_stiffness = 300;  // N/m, of the hand's grip
  double hand_damping = 5;      // N s/m
  double resolution = 5e-6;     // m, of the position sensor; 0: exact
  double noise = 0;             // m, standard deviation of a coordinate
  Nanoseconds delay{0};         // of what is read, unknown to the reader; at most kLongestDelay
  std::uint64_t seed = 1;       // of the noise
  double max_force = 3.3;       // N, what the motors give
  double max_stiffness = 2000;  // N/m
  Eigen::AlignedBox3d workspace = {};  // m, where the arm reaches; empty: everywhere
  // rad/s, at which the hand would turn the tool about its point; null: it does not turn.
  std::optional<Vec3> turning = {};
  double inertia = 2e-5;         // kg m^2, about any axis
  double wrist_stiffness = 2;    // N m/rad
  double wrist_damping = 0.005;  // N m s/rad
  double max_torque = 0.3;       // N m
};

class GLISS_EXPORT SimDevice final : public HapticDevice {
 public:
  static constexpr Nanoseconds kStep = std::chrono::microseconds(50);
  static constexpr Nanoseconds kLongestDelay = std::chrono::milliseconds(20);

  // Starts at rest at the path's first point. Throws std::invalid_argument, naming the option.
  SimDevice(HandPath path, const SimOptions& options = {});

  const DeviceInfo& info() const noexcept override { return info_; }
  // Moves on to `now` with the force written last. Ended once the path is over and the delay with
  // it; the hand is then still there.
  DeviceState read(Nanoseconds now) noexcept override;
  bool write(const Vec3& force, Nanoseconds now) noexcept override;
  bool write_wrench(const Wrench& wrench, Nanoseconds now) noexcept override;

  // Draws the hand to a target from now on, instead of along its path, whose end is then no end.
  // For the loop's thread. False for a target that is not finite: nothing changes.
  bool draw_to(const Vec3& target) noexcept;

  const Vec3& position() const { return position_; }  // m, without delay, noise and rounding

 private:
  void move() noexcept;
  void turn() noexcept;

  DeviceInfo info_;
  HandPath path_;
  std::optional<Vec3> target_;  // in the path's place
  SimOptions options_;
  std::mt19937_64 random_;
  std::normal_distribution<double> noise_;
  Nanoseconds start_{};
  std::uint64_t steps_ = 0, reads_ = 0;
  Vec3 position_, velocity_ = Vec3::Zero(), force_ = Vec3::Zero();
  Vec3 spin_ = Vec3::Zero(), torque_ = Vec3::Zero();  // rad/s, N m
  Rotation orientation_ = Rotation::Identity();
  struct Moment {
    Vec3 position, velocity;
    Rotation orientation;
  };
  std::vector<Moment> past_;  // the last ones, in a ring by steps_
};

}  // namespace gliss
