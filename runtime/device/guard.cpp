#include "gliss/device/guard.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "gliss/base/plain_arithmetic.h"
#include "gliss/base/require.h"
#include "gliss/thread/clock.h"

namespace gliss {
namespace {

using std::chrono::nanoseconds;

constexpr nanoseconds kLeastStep{1'000'000};  // once tripped
constexpr int kStalledSteps = 3;
// Scaled vectors end this much inside, so that rounding leads none out.
constexpr double kWithin = 1 - 8 * std::numeric_limits<double>::epsilon();

// From `then` to `now`, within [0, most]; any two times will do, for none is subtracted as signed.
nanoseconds since(nanoseconds then, nanoseconds now, nanoseconds most) {
  if (now <= then) return nanoseconds{0};
  const std::uint64_t gap =
      static_cast<std::uint64_t>(now.count()) - static_cast<std::uint64_t>(then.count());
  return gap < static_cast<std::uint64_t>(most.count())
             ? nanoseconds{static_cast<nanoseconds::rep>(gap)}
             : most;
}

bool is_finite(const Vec3& v) {
  return std::isfinite(v.x()) && std::isfinite(v.y()) && std::isfinite(v.z());
}

std::uint32_t bit_of(GuardReason reason) { return 1u << static_cast<unsigned>(reason); }

GuardLimits checked(const GuardLimits& limits) {
  using namespace std::chrono_literals;
  const auto positive = [](double x) { return x > 0 && std::isfinite(x); };
  require(positive(limits.max_force), "max_force: must be a positive number");
  require(positive(limits.max_rate), "max_rate: must be a positive number");
  require(positive(limits.max_torque), "max_torque: must be a positive number");
  require(positive(limits.max_torque_rate), "max_torque_rate: must be a positive number");
  require(limits.hold_after > 0ns, "hold_after: must be positive");
  require(limits.ramp_from >= limits.hold_after, "ramp_from: must not be before hold_after");
  require(limits.ramp_to > limits.ramp_from, "ramp_to: must be after ramp_from");
  require(limits.ramp_to <= 10ms, "ramp_to: must be at most 10 ms");
  const double ramp = in_seconds(limits.ramp_to - limits.ramp_from);
  require(limits.max_force <= limits.max_rate * ramp,
          "max_rate: too low to bring max_force to zero from ramp_from to ramp_to");
  require(limits.max_torque <= limits.max_torque_rate * ramp,
          "max_torque_rate: too low to bring max_torque to zero from ramp_from to ramp_to");
  require(limits.engage_below > 0 && limits.engage_below <= 0.2,
          "engage_below: must be positive and at most 0.2 N");
  require(limits.engage_ramp >= 500ms, "engage_ramp: must be at least 0.5 s");
  return limits;
}

}  // namespace

LimitedForce limit_force(const Vec3& wanted, const Vec3& from, double most,
                         double change) noexcept {
  LimitedForce result{wanted};
  Vec3& force = result.force;
  if (!is_finite(force)) {
    result.finite = false;
    force = from;
  }
  if (!(force.norm() <= most)) {
    result.force_limited = true;
    force /= force.cwiseAbs().maxCoeff();  // the square of 1e300 is not finite
    force *= kWithin * most / force.norm();
  }
  const Vec3 step = force - from;
  const double length = step.norm();
  if (!(length <= change)) {
    result.rate_limited = true;
    force = from + kWithin * change / length * step;
  }
  if (!is_finite(force)) {
    result.finite = false;
    force = Vec3::Zero();
  }
  return result;
}

std::optional<Vec3> motor_force(const Vec3& wanted, double most) noexcept {
  const PlainArithmetic plain;
  if (!std::isfinite(wanted.norm())) return std::nullopt;
  return limit_force(wanted, Vec3::Zero(), most, std::numeric_limits<double>::infinity()).force;
}

Guard::Guard(const GuardLimits& limits) : limits_(checked(limits)) {}

GuardOutput Guard::step(nanoseconds now, const GuardInput& input) noexcept {
  const PlainArithmetic plain;
  nanoseconds dt{0};
  if (started_) {
    dt = since(now_, now, limits_.ramp_to);
    stalled_ = now == now_ ? std::min(stalled_ + 1, kStalledSteps) : 0;
    if (now < now_) trip(GuardReason::kTimeBackwards);
  }
  started_ = true;
  now_ = now;
  if (stalled_ >= kStalledSteps) trip(GuardReason::kTimeStalled);
  if (since(now, input.measured, limits_.ramp_to) > limits_.hold_after) {
    trip(GuardReason::kTimeBackwards);
  }
  const nanoseconds age = since(input.measured, now, limits_.ramp_to);
  if (!is_finite(input.force) || !is_finite(input.torque)) note(GuardReason::kNotFinite);
  if (!(age <= limits_.hold_after)) note(GuardReason::kLateInput);
  const bool usable = acts_ == 0;
  ready_ = usable && input.force.norm() < limits_.engage_below &&
           input.torque.norm() < limits_.max_torque * (limits_.engage_below / limits_.max_force);

  if (tripped()) dt = std::max(dt, kLeastStep);
  silent_ = std::min(silent_ + dt, limits_.ramp_to);
  if (state_ == GuardState::kSafe) return out();
  // Also where this input is usable: the force stood too long.
  if (silent_ > limits_.hold_after && usable) note(GuardReason::kLateInput);
  if (silent_ >= limits_.ramp_to && !tripped()) {
    trip(acts_ & bit_of(GuardReason::kNotFinite) ? GuardReason::kNotFinite
                                                 : GuardReason::kLateInput);
  }
  if (usable && !tripped()) {
    run(input, age, dt);
  } else {
    fade(dt);
  }
  return out();
}

GuardOutput Guard::out() noexcept { return {sent_.force, state_, count_reasons(), sent_.torque}; }

void Guard::run(const GuardInput& wanted, nanoseconds age, nanoseconds dt) noexcept {
  ceiling_ *= left();
  silent_ = age;
  engaged_ = engaged_ || ready_;
  state_ = engaged_ ? GuardState::kRun : GuardState::kStart;
  ceiling_ =
      std::min(ceiling_ + limits_.max_force * (in_seconds(dt) / in_seconds(limits_.engage_ramp)),
               engaged_ ? limits_.max_force : limits_.engage_below);
  const double seconds = in_seconds(std::min(dt, limits_.hold_after));
  const LimitedForce force =
      limit_force(wanted.force, sent_.force, ceiling_, limits_.max_rate * seconds);
  const LimitedForce torque =
      limit_force(wanted.torque, sent_.torque, limits_.max_torque * (ceiling_ / limits_.max_force),
                  limits_.max_torque_rate * seconds);
  sent_ = {force.force, torque.force};
  note(force);
  note(torque);
}

void Guard::fade(nanoseconds dt) noexcept {
  const bool first = state_ == GuardState::kStart || state_ == GuardState::kRun;
  if (first) held_ = sent_;
  if (tripped()) silent_ = std::max(silent_, limits_.ramp_from);
  state_ = first || silent_ <= limits_.ramp_from ? GuardState::kHold : GuardState::kRamp;
  const auto fall = [&](const Vec3& held, const Vec3& from, double rate) {
    return limit_force(held * left(), from, from.norm(), rate * in_seconds(dt)).force;
  };
  sent_ = {fall(held_.force, sent_.force, limits_.max_rate),
           fall(held_.torque, sent_.torque, limits_.max_torque_rate)};
  if (tripped() && sent_.is_zero()) state_ = GuardState::kSafe;
}

// The share of the force that the ramp leaves.
double Guard::left() const noexcept {
  const double left = static_cast<double>((limits_.ramp_to - silent_).count()) /
                      static_cast<double>((limits_.ramp_to - limits_.ramp_from).count());
  return std::clamp(left, 0.0, 1.0);
}

void Guard::trip(GuardReason reason) noexcept {
  assert(reason != GuardReason::kNone);
  note(reason);
  ready_ = false;
  if (!tripped()) tripped_by_ = reason;
}

bool Guard::engage() noexcept {
  if (state_ != GuardState::kSafe || !ready_) return false;
  tripped_by_ = GuardReason::kNone;
  engaged_ = true;
  state_ = GuardState::kRun;
  ceiling_ = 0;
  silent_ = nanoseconds{0};
  return true;
}

void Guard::note(GuardReason reason) noexcept { acts_ |= bit_of(reason); }

void Guard::note(const LimitedForce& limited) noexcept {
  if (!limited.finite) note(GuardReason::kNotFinite);
  if (limited.force_limited) note(GuardReason::kForceLimit);
  if (limited.rate_limited) note(GuardReason::kRateLimit);
}

// Counts what began in this step and returns its reason.
GuardReason Guard::count_reasons() noexcept {
  for (std::uint32_t begun = acts_ & ~acted_; begun != 0; begun &= begun - 1) {
    ++counts_[static_cast<std::size_t>(std::countr_zero(begun))];
  }
  const GuardReason gravest =
      acts_ == 0 ? GuardReason::kNone : static_cast<GuardReason>(std::countr_zero(acts_));
  acted_ = acts_;
  acts_ = 0;
  return tripped() ? tripped_by_ : gravest;
}

const char* guard_reason_name(GuardReason reason) noexcept {
  constexpr std::array<const char*, kGuardReasons> kTexts = {
      "none",       "device fault", "stop requested", "time ran backwards", "time stood still",
      "not finite", "late input",   "force limit",    "rate limit"};
  return kTexts[static_cast<std::size_t>(reason)];
}

bool is_failure(GuardReason reason) noexcept {
  return reason != GuardReason::kNone && reason != GuardReason::kStopRequested &&
         reason < GuardReason::kForceLimit;
}

bool may_reengage(GuardReason reason) noexcept {
  return reason == GuardReason::kLateInput || reason == GuardReason::kNotFinite;
}

const char* guard_state_name(GuardState state) noexcept {
  constexpr std::array<const char*, 5> kTexts = {"start", "run", "hold", "ramp", "safe"};
  return kTexts[static_cast<std::size_t>(state)];
}

}  // namespace gliss
