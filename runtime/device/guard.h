// The guards between the force that the tracker wants and the force that goes to the device, a pure
// function of its inputs and of the past: it has no clock, allocates nothing, takes no lock.
//
//   kStart   until the wanted force has once been below `engage_below`: at most that goes out, so a
//            start inside a solid does not kick.
//   kRun     the wanted force goes out, limited in size and in change.
//   kHold    a step without a usable input: not finite, or measured more than `hold_after` ago. The
//            force keeps its direction and does not grow. It lasts from the first step without
//            a usable input until `ramp_from` after the last usable one. A first step that
//            comes later is kHold too, though it already lies on kRamp's line.
//   kRamp    the later ones: on a straight line to zero, from `ramp_from` to `ramp_to`. The force
//            is zero at the first step whose last usable input is `ramp_to` old; at 1 kHz that is
//            within 10 ms of the input that was missed, which was due after 1 ms.
//   kSafe    zero, latched, with the reason; engage() alone leads out of it.
//
// A force that is not finite is a missed input and nothing more: one NaN holds the force for a
// step, 10 ms of them end in kSafe. From kHold and kRamp a usable input leads back (to kStart
// before it was ever engaged). The largest force has then been cut in the ramp's proportion, also
// where the loop stood still and no step saw the ramp, and comes back at the pace of engage_ramp.
//
// A torque has limits of its own, and else goes with the force: what holds of the force, the share
// of the largest one that may go out, and the ramp, holds of the torque.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>

#include "gliss/base/export.h"
#include "gliss/base/vector.h"
#include "gliss/base/wrench.h"

namespace gliss {

struct GuardLimits {
  double max_force = 3.3;                             // N, of what goes out
  double max_rate = 1000;                             // N/s, of its change, as a vector
  double max_torque = 0.3;                            // N m, likewise of the torque
  double max_torque_rate = 100;                       // N m/s
  std::chrono::nanoseconds hold_after{2'000'000};     // age of an input that is late
  std::chrono::nanoseconds ramp_from{2'000'000};      // age at which the force begins to fall,
  std::chrono::nanoseconds ramp_to{10'000'000};       // and at which it is zero
  double engage_below = 0.2;                          // N, wanted force that may engage
  std::chrono::nanoseconds engage_ramp{500'000'000};  // largest force from zero to max_force
};

// Why the force is not the wanted one, the gravest first.
enum class GuardReason : std::uint8_t {
  kNone,
  kDeviceFault,    // trip(): the device reports a fault
  kStopRequested,  // trip(): a person or a program wants an end
  kTimeBackwards,  // now before the last now, or an input measured more than hold_after after now
  kTimeStalled,    // the same now four times running
  kNotFinite,
  kLateInput,
  kForceLimit,
  kRateLimit,
};
inline constexpr int kGuardReasons = 9;
GLISS_EXPORT const char* guard_reason_name(GuardReason reason) noexcept;  // "late input"
// Something went wrong: not a limit, and not a stop that was asked for.
GLISS_EXPORT bool is_failure(GuardReason reason) noexcept;

// True for what a guard may engage again after by itself: inputs that were late or no numbers.
GLISS_EXPORT bool may_reengage(GuardReason reason) noexcept;

enum class GuardState : std::uint8_t { kStart, kRun, kHold, kRamp, kSafe };
GLISS_EXPORT const char* guard_state_name(GuardState state) noexcept;  // "hold"

struct GuardInput {
  Vec3 force = Vec3::Zero();             // N, wanted; may be anything
  std::chrono::nanoseconds measured{0};  // when the position that it answers was, clock of `now`
  Vec3 torque = Vec3::Zero();            // N m, likewise
};

struct GuardOutput {
  Vec3 force = Vec3::Zero();  // N, for the device: finite, at most max_force
  GuardState state = GuardState::kStart;
  GuardReason reason = GuardReason::kNone;  // the trip's until engage(), else this step's gravest
  Vec3 torque = Vec3::Zero();               // N m, at most max_torque
};

struct LimitedForce {
  Vec3 force;  // N
  bool finite = true, force_limited = false, rate_limited = false;
};
// The guards of one step in their order: finite (or else `from`), |F| <= most, |F - from| <=
// change, finite (or else zero). All in N, or all in N m; from is at most `most` where that is to
// hold of the result.
GLISS_EXPORT LimitedForce limit_force(const Vec3& wanted, const Vec3& from, double most,
                                      double change) noexcept;

class GLISS_EXPORT Guard {
 public:
  // Throws std::invalid_argument, naming the limit, unless all are positive and finite; hold_after
  // <= ramp_from < ramp_to; the ramp keeps max_rate (max_force <= max_rate (ramp_to - ramp_from),
  // and so for torques); and none is laxer than the specification: ramp_to <= 10 ms, engage_below
  // <= 0.2 N, engage_ramp
  // >= 0.5 s.
  explicit Guard(const GuardLimits& limits = {});

  // One tick, at the time `now` since any start; each clock may stall or run backwards.
  // |F - last F| <= max_rate dt, and so for torques, where dt is the time since the last step, at
  // most ramp_to; zero in the first step and where the clock does not advance; but at least 1 ms
  // once tripped, because a clock that failed must not keep the force up. In kStart and kRun dt is
  // at most hold_after, so that no jump follows a stall of the loop, and steps ramp_to apart end in
  // kSafe as a late input.
  GuardOutput step(std::chrono::nanoseconds now, const GuardInput& input) noexcept;

  // From the next step on, whatever the input: to zero as in kHold and kRamp, then kSafe. Every
  // step that a fault lasts; the first trip's reason stays. reason is not kNone.
  void trip(GuardReason reason) noexcept;

  // From kSafe to kRun, where the largest force rises from zero over engage_ramp. False, and
  // nothing changes, unless kSafe and the last step had a usable input, a wanted force below
  // engage_below and no fault.
  bool engage() noexcept;

  // The number of times that a guard began to act for this reason: a series of steps counts once.
  std::uint64_t count(GuardReason reason) const noexcept {
    return counts_[static_cast<std::size_t>(reason)];
  }

 private:
  void run(const GuardInput& wanted, std::chrono::nanoseconds age,
           std::chrono::nanoseconds dt) noexcept;
  void fade(std::chrono::nanoseconds dt) noexcept;
  double left() const noexcept;
  bool tripped() const noexcept { return tripped_by_ != GuardReason::kNone; }
  void note(GuardReason reason) noexcept;
  void note(const LimitedForce& limited) noexcept;
  GuardOutput out() noexcept;
  GuardReason count_reasons() noexcept;

  GuardLimits limits_;
  GuardState state_ = GuardState::kStart;
  GuardReason tripped_by_ = GuardReason::kNone;
  bool engaged_ = false, ready_ = false;  // ready: engage() may
  bool started_ = false;
  std::chrono::nanoseconds now_{0}, silent_{0};  // last step; age of the last usable input
  int stalled_ = 0;                              // steps since the clock advanced
  double ceiling_ = 0;                           // N, largest force for now
  Wrench sent_;                                  // that went out last
  Wrench held_;                                  // when the input went missing
  std::uint32_t acts_ = 0, acted_ = 0;           // bit set of reasons: of this step, of the last
  std::array<std::uint64_t, kGuardReasons> counts_{};
};

// A force for motors that give `most` N: at most that. None where its size is not a finite number:
// who asks for that has failed, and is to have no force rather than the largest.
GLISS_EXPORT std::optional<Vec3> motor_force(const Vec3& wanted, double most) noexcept;

}  // namespace gliss
