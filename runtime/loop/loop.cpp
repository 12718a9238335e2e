#include "gliss/loop/loop.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>

#include "gliss/base/message.h"
#include "gliss/base/plain_arithmetic.h"

namespace gliss {
namespace {

GuardLimits limits_of(const LoopOptions& options, const DeviceInfo& device) {
  GuardLimits limits = guard_limits(options);
  limits.max_force = std::min(limits.max_force, device.max_force);
  limits.max_torque = std::min(limits.max_torque, device.max_torque);
  return limits;
}

struct ZeroAtTheEnd {
  HapticDevice& device;
  const Nanoseconds& now;
  ~ZeroAtTheEnd() { device.write_wrench({}, now); }
};

// Deadlines on the timer's grid, or one after the other in a time of their own.
class Pace {
 public:
  explicit Pace(const LoopOptions& options) : period_(options.period) {
    PeriodicTimer timer(options.period);  // checks the period
    if (options.wait) timer_ = timer;
  }
  Wake wait() noexcept {
    if (timer_) return timer_->wait();
    return {next_ += period_, {}, 0};
  }
  Nanoseconds start() const noexcept { return start_; }

 private:
  std::optional<PeriodicTimer> timer_;
  Nanoseconds period_, start_ = monotonic_time(), next_ = start_;
};

}  // namespace

int tick_error(GuardReason reason) noexcept {
  return is_failure(reason) ? static_cast<int>(reason) : 0;
}

const char* loop_end_text(LoopEnd end) noexcept {
  switch (end) {
    case LoopEnd::kStopped:
      return "stopped";
    case LoopEnd::kDeviceEnded:
      return "the device has ended";
    case LoopEnd::kDeviceFault:
      return "the device reports a fault";
  }
  return "?";
}

GuardLimits guard_limits(const LoopOptions& options) {
  GuardLimits limits = options.guard;
  const Nanoseconds late = options.period * 3 / 2;
  const bool follows = limits.hold_after == GuardLimits{}.hold_after && late > limits.hold_after;
  if (follows) limits.hold_after = late, limits.ramp_from = std::max(limits.ramp_from, late);
  std::string why;
  try {
    Guard{limits};
  } catch (const std::invalid_argument& error) {
    if (!follows) throw;
    if (options.period <= options.guard.hold_after) return options.guard;  // tight, as it was asked
    why = error.what();
  }
  if (options.period > limits.hold_after)
    throw std::invalid_argument(detail::message("hold_after: must be a period at least, ",
                                                1e3 * in_seconds(options.period), " ms"));
  if (why.empty()) return limits;
  throw std::invalid_argument(detail::message(
      "rate: at ", 1 / in_seconds(options.period), " Hz the guard takes an input as late after ",
      1e3 * in_seconds(limits.hold_after), " ms, and must end the force within ",
      1e3 * in_seconds(limits.ramp_to), " ms: ", why, "; a quicker loop fits"));
}

HapticLoop::HapticLoop(HapticDevice& device, Tracker& tracker, const LoopOptions& options)
    : device_(device),
      tracker_(tracker),
      options_(options),
      guard_(limits_of(options, device.info())) {
  PeriodicTimer{options.period};
}

void HapticLoop::feel(Nanoseconds now, LoopTick& tick) noexcept {
  const PlainArithmetic plain;
  const Rotation& rotation = tick.input.orientation;
  const bool is_rotation = std::abs(rotation.norm() - 1) < 1e-3;  // of three degrees of freedom as
                                                                  // well
  if (tick.input.sequence > 0 && is_rotation) {
    Pose tool = Pose::Identity();
    if (device_.info().has_orientation) tool.linear() = rotation.normalized().toRotationMatrix();
    tool.translation() = tick.input.position;
    const Wrench wrench = tracker_.step(tool, tick.time, tick.input.velocity);
    tick.rendered = wrench.force;
    if (device_.info().has_orientation) tick.rendered_torque = wrench.torque;
  } else {
    tick.rendered.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  if (failed_ || tick.input.fault) guard_.trip(GuardReason::kDeviceFault);
  const GuardOutput out =
      guard_.step(now, {tick.rendered, tick.input.measured, tick.rendered_torque});
  tick.sent = out.force;
  tick.sent_torque = out.torque;
  tick.state = out.state;
  tick.reason = out.reason;
  failed_ = !device_.write_wrench({tick.sent, tick.sent_torque}, now) || tick.input.fault;
  const bool may_engage = (options_.reengage && may_reengage(out.reason)) || engage_wanted_;
  if (out.state == GuardState::kStart || out.state == GuardState::kRun ||
      (out.state == GuardState::kSafe && may_engage && guard_.engage()))
    engage_wanted_ = false;
}

void HapticLoop::describe(LoopTick& tick) const noexcept {
  const PlainArithmetic plain;
  const auto steps = tracker_.objects();
  tick.touching = tracker_.touching();
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (!steps[i].searched) continue;
    const double distance = steps[i].contact.distance * tracker_.unit(i);
    const double rank = steps[i].contact.touching ? -steps[i].force.norm() : distance;
    if (!(rank < best)) continue;
    best = rank;
    tick.object = static_cast<std::uint32_t>(i);
    const Contact& contact = steps[i].contact;
    tick.face = contact.at.face;
    tick.distance = distance;
    tick.iterations = contact.iterations;
    tick.crossings = contact.crossings;
    tick.flags = contact.flags;
  }
}

LoopEnd HapticLoop::run(const std::function<bool(const LoopTick&)>& on_tick) {
  Nanoseconds now = monotonic_time();
  const ZeroAtTheEnd zero{device_, now};
  const clockid_t clock = options_.cpu_time ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC;
  std::optional<LoopEnd> end;
  std::uint64_t last_sequence = 0;
  Nanoseconds arrived = now;
  Pace pace(options_);
  for (std::uint64_t number = 0;; ++number) {
    const Wake wake = pace.wait();
    now = wake.deadline + wake.lateness;
    const Nanoseconds began = read_clock(clock);
    LoopTick tick;
    tick.number = number;
    tick.input = device_.read(now);
    if (tick.input.ended) {
      end = end.value_or(LoopEnd::kDeviceEnded);
      if (tick.input.sequence == last_sequence) return *end;  // nobody is there to be let down
    }
    // Whatever the device stamps: what brings nothing new grows old.
    if (tick.input.sequence != last_sequence) arrived = now;
    tick.input.measured = std::min(tick.input.measured, arrived);
    last_sequence = tick.input.sequence;
    tick.age = now - tick.input.measured;
    if (end && !failed_) guard_.trip(GuardReason::kStopRequested);
    tick.time = wake.deadline - pace.start();
    feel(now, tick);
    tick.compute = read_clock(clock) - began;
    tick.lateness = wake.lateness;
    tick.missed = wake.missed;
    describe(tick);
    record_.add({tick.lateness, tick.compute, tick_error(tick.reason)}, tick.missed);
    if (failed_) end = LoopEnd::kDeviceFault;
    if (!on_tick(tick) || stop_wanted_) end = end.value_or(LoopEnd::kStopped);
    // A guard that was safe before a force could not be handed on has that fault still to count.
    const bool counted = !failed_ || guard_.count(GuardReason::kDeviceFault) > 0;
    if (end && counted && tick.state == GuardState::kSafe) return *end;
  }
}

}  // namespace gliss
