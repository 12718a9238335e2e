#include "gliss/device/sim_device.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "gliss/base/require.h"
#include "gliss/device/guard.h"

namespace gliss {
namespace {

constexpr double kStepSeconds = in_seconds(SimDevice::kStep);
// A reader that was away for longer finds the hand where it would have been after this.
constexpr std::uint64_t kMostSteps = 2000;

SimOptions checked(const SimOptions& options) {
  const auto positive = [](double x) { return x > 0 && std::isfinite(x); };
  const auto not_negative = [](double x) { return x >= 0 && std::isfinite(x); };
  require(positive(options.mass), "mass: must be a positive number");
  require(positive(options.hand_stiffness), "hand_stiffness: must be a positive number");
  require(not_negative(options.hand_damping), "hand_damping: must not be negative");
  require(not_negative(options.resolution), "resolution: must not be negative");
  require(not_negative(options.noise), "noise: must not be negative");
  require(positive(options.max_force), "max_force: must be a positive number");
  require(positive(options.max_stiffness), "max_stiffness: must be a positive number");
  require(options.delay >= Nanoseconds(0) && options.delay <= SimDevice::kLongestDelay,
          "delay: must be 0 to 20 ms");
  // Semi-implicit Euler is stable below 2 / frequency and 2 / damping rate; well below.
  require(options.hand_stiffness * kStepSeconds * kStepSeconds < 0.1 * options.mass &&
              options.hand_damping * kStepSeconds < 0.1 * options.mass,
          "mass: too small for this hand_stiffness and hand_damping");
  require(positive(options.max_torque), "max_torque: must be a positive number");
  require(!options.turning || options.turning->allFinite(), "turning: must be finite");
  require(positive(options.inertia), "inertia: must be a positive number");
  require(positive(options.wrist_stiffness), "wrist_stiffness: must be a positive number");
  require(not_negative(options.wrist_damping), "wrist_damping: must not be negative");
  require(options.wrist_stiffness * kStepSeconds * kStepSeconds < 0.1 * options.inertia &&
              options.wrist_damping * kStepSeconds < 0.1 * options.inertia,
          "inertia: too small for this wrist_stiffness and wrist_damping");
  return options;
}

// The rotation by a vector of its angle along its axis.
Rotation rotation_of(const Vec3& v) {
  const double angle = v.norm();
  return angle > 0 ? Rotation(Eigen::AngleAxisd(angle, v / angle)) : Rotation(Rotation::Identity());
}

}  // namespace

HandPath::HandPath(std::vector<double> times, std::vector<Vec3> points, int rounds, double back)
    : times_(std::move(times)), points_(std::move(points)), rounds_(rounds) {
  require(times_.size() == points_.size(), "path: as many times as points");
  require(std::is_sorted(times_.begin(), times_.end()), "path: times must not decrease");
  const auto finite = [](const Vec3& point) { return point.allFinite(); };
  require(std::all_of(points_.begin(), points_.end(), finite) &&
              (times_.empty() || (std::isfinite(times_.front()) && std::isfinite(times_.back()))),
          "path: not finite");
  require(rounds > 0, "rounds: must be positive");
  require(back >= 0 && std::isfinite(back), "path: the way back must take a time");
  if (!times_.empty()) lap_ = times_.back() + back;
  require(std::isfinite(duration()), "path: not finite");
  require(rounds == 1 || times_.empty() || times_.front() >= 0, "path: rounds begin at 0 s");
}

HandPath HandPath::sampled(std::vector<Vec3> points, double interval, int rounds) {
  require(interval > 0, "interval: must be positive");
  std::vector<double> times;
  for (std::size_t i = 0; i < points.size(); ++i)
    times.push_back(static_cast<double>(i) * interval);
  return {std::move(times), std::move(points), rounds, interval};
}

HandPath HandPath::along(const std::vector<Vec3>& waypoints, double speed, int rounds) {
  require(speed > 0 && std::isfinite(speed), "speed: must be a positive number");
  std::vector<double> times;
  double time = 0;
  for (std::size_t i = 0; i < waypoints.size(); ++i) {
    if (i > 0) time += (waypoints[i] - waypoints[i - 1]).norm() / speed;
    times.push_back(time);
  }
  const double back = waypoints.empty() ? 0 : (waypoints.front() - waypoints.back()).norm() / speed;
  return {std::move(times), waypoints, rounds, back};
}

Vec3 HandPath::at(double t) noexcept {
  if (points_.empty()) return Vec3::Zero();
  const double round = lap_ > 0 ? std::clamp(std::floor(t / lap_), 0.0, rounds_ - 1.0) : 0;
  t -= round * lap_;
  if (next_ > 0 && t < times_[next_ - 1]) next_ = 0;
  while (next_ < times_.size() && times_[next_] <= t) ++next_;
  if (next_ == 0) return points_.front();
  const bool last = next_ == times_.size();
  if (last && !(round + 1 < rounds_ && lap_ > times_.back())) return points_.back();
  const double from = times_[next_ - 1], to = last ? lap_ : times_[next_];
  const Vec3 &a = points_[next_ - 1], &b = points_[last ? 0 : next_];
  return a + (t - from) / (to - from) * (b - a);
}

SimDevice::SimDevice(HandPath path, const SimOptions& options)
    : path_(std::move(path)),
      options_(checked(options)),
      random_(options.seed),
      position_(path_.at(0)),
      past_(static_cast<std::size_t>(options.delay / kStep) + 1,
            {position_, Vec3::Zero(), Rotation::Identity()}) {
  info_.name = "sim";
  info_.max_force = options.max_force;
  info_.max_stiffness = options.max_stiffness;
  info_.workspace = options.workspace;
  info_.has_velocity = true;
  info_.has_orientation = options.turning.has_value();
  info_.max_torque = options.max_torque;
  info_.real_time = false;
}

// Semi-implicit Euler.
void SimDevice::move() noexcept {
  const Vec3 target = target_ ? *target_ : path_.at(static_cast<double>(steps_) * kStepSeconds);
  const Vec3 grip =
      options_.hand_stiffness * (target - position_) - options_.hand_damping * velocity_;
  velocity_ += kStepSeconds / options_.mass * (grip + force_);
  position_ += kStepSeconds * velocity_;
  if (!options_.workspace.isEmpty() && !options_.workspace.contains(position_)) {
    const Vec3 inside =
        position_.cwiseMax(options_.workspace.min()).cwiseMin(options_.workspace.max());
    velocity_ = (inside.array() == position_.array()).select(velocity_, 0);
    position_ = inside;
  }
  if (options_.turning) turn();
  ++steps_;
  past_[steps_ % past_.size()] = {position_, velocity_, orientation_};
}

// Likewise, with a wrist for the grip.
void SimDevice::turn() noexcept {
  const Rotation target =
      rotation_of(static_cast<double>(steps_) * kStepSeconds * *options_.turning);
  Rotation left = target * orientation_.conjugate();
  if (left.w() < 0) left.coeffs() *= -1;
  const double half = left.vec().norm();
  const Vec3 to_go =
      half > 0 ? Vec3(2 * std::atan2(half, left.w()) / half * left.vec()) : Vec3::Zero();
  const Vec3 grip = options_.wrist_stiffness * to_go - options_.wrist_damping * spin_;
  spin_ += kStepSeconds / options_.inertia * (grip + torque_);
  orientation_ = (rotation_of(kStepSeconds * spin_) * orientation_).normalized();
}

DeviceState SimDevice::read(Nanoseconds now) noexcept {
  if (reads_ == 0) start_ = now;
  const auto due = static_cast<std::uint64_t>(std::max(now - start_, Nanoseconds(0)) / kStep);
  if (due > steps_ + kMostSteps)
    start_ += kStep * static_cast<std::int64_t>(due - steps_ - kMostSteps);
  for (std::uint64_t left = std::min(due - std::min(due, steps_), kMostSteps); left > 0; --left) {
    move();
  }
  const Moment& seen = past_[(steps_ + 1) % past_.size()];  // the oldest of the ring
  DeviceState state;
  state.sequence = ++reads_;
  state.measured = now;
  state.position = seen.position;
  for (double& x : state.position) {
    if (options_.noise > 0) x += options_.noise * noise_(random_);
    if (options_.resolution > 0) x = options_.resolution * std::round(x / options_.resolution);
  }
  state.velocity = seen.velocity;
  state.orientation = seen.orientation;
  const double over = path_.duration() + in_seconds(options_.delay);
  state.ended = !target_ && static_cast<double>(steps_) * kStepSeconds > over;
  return state;
}

bool SimDevice::draw_to(const Vec3& target) noexcept {
  if (!target.allFinite()) return false;
  target_ = target;
  return true;
}

bool SimDevice::write(const Vec3& force, Nanoseconds) noexcept {
  const auto given = motor_force(force, options_.max_force);
  force_ = given.value_or(Vec3::Zero());
  return given.has_value();
}

bool SimDevice::write_wrench(const Wrench& wrench, Nanoseconds now) noexcept {
  const auto given = motor_force(wrench.torque, options_.max_torque);
  torque_ = given.value_or(Vec3::Zero());
  return write(wrench.force, now) && given.has_value();
}

}  // namespace gliss
