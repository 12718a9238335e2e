// The device loop: each tick reads the device, follows the contact, guards the force and writes it.
#pragma once

#include <atomic>
#include <functional>

#include "gliss/base/export.h"
#include "gliss/contact/tracker.h"
#include "gliss/device/device.h"
#include "gliss/device/guard.h"
#include "gliss/thread/timing.h"

namespace gliss {

struct LoopOptions {
  Nanoseconds period = std::chrono::milliseconds(1);
  // False: ticks follow each other at once, in a time of their own in which each takes a period.
  bool wait = true;
  // Tells the computing of a tick by the thread's CPU clock, blind to pre-emption: two more system
  // calls a tick. Else by the monotonic clock.
  bool cpu_time = false;
  // Once late inputs or numbers that are not finite have made the guard safe, engage it again as
  // soon as it permits. Else it stays safe.
  bool reengage = false;
  GuardLimits guard = {};
};

// The guard's limits for such a loop. Where hold_after is left at its default it follows a slow
// loop: an input is late after one and a half periods, and ramp_from is no earlier. Throws
// std::invalid_argument, "rate: ..." or naming the limit, if the guard would take each input as
// late or has no time left to end the force by ramp_to.
GLISS_EXPORT GuardLimits guard_limits(const LoopOptions& options);

// The doings of one tick.
struct LoopTick {
  std::uint64_t number = 0;  // from 0
  Nanoseconds time{};        // of the deadline, since the loop's start
  Nanoseconds lateness{}, compute{};
  std::uint64_t missed = 0;  // periods skipped before it
  DeviceState input;
  Nanoseconds age{};             // of the input, when it was read
  Vec3 rendered = Vec3::Zero();  // N, as the tracker has it; NaN without a usable position
  Vec3 sent = Vec3::Zero();      // N, as the guard let it out
  // N m, about the device's position, likewise; zero without an orientation.
  Vec3 rendered_torque = Vec3::Zero(), sent_torque = Vec3::Zero();
  GuardState state = GuardState::kStart;
  GuardReason reason = GuardReason::kNone;
  // The object that pushes most, or else is nearest; kNothing: none is near enough to ask.
  static constexpr std::uint32_t kNothing = ~0u;
  std::uint32_t object = kNothing;  // index in Tracker::objects()
  bool touching = false;            // any of them
  std::uint32_t face = 0;           // of its mesh
  double distance = 0;              // m, signed; negative inside
  int iterations = 0, crossings = 0;
  std::uint32_t flags = 0;  // Contact::flags
};

// The error of a tick in a TickRecord: the reason, where its force is not the tracker's, nor that
// within a limit; else 0.
GLISS_EXPORT int tick_error(GuardReason reason) noexcept;

enum class LoopEnd { kStopped, kDeviceEnded, kDeviceFault };
GLISS_EXPORT const char* loop_end_text(LoopEnd end) noexcept;  // "the device has ended"

// It keeps references to device and tracker, which must outlive it, and takes no temporaries. While
// run() is under way they are its thread's alone; one thread runs it.
class GLISS_EXPORT HapticLoop {
 public:
  // Throws std::invalid_argument for a period that is invalid and as guard_limits. The largest
  // force and torque are the smaller ones of the guard's and the device's.
  HapticLoop(HapticDevice& device, Tracker& tracker, const LoopOptions& options = {});

  // Ticks until on_tick returns false, or the device ends or fails: then on to where the guard is
  // safe, ten ticks or so. Zero force is the last that is written, also where on_tick throws. It is
  // called after each tick's force has gone out and is part of the loop: it must not wait.
  // Runs once: the guard stays safe, so that another run would give no force. A later session is
  // another loop.
  LoopEnd run(const std::function<bool(const LoopTick&)>& on_tick);

  // Ends the run as on_tick does by returning false. For any thread, also before run(); no wait.
  void request_stop() noexcept { stop_wanted_ = true; }
  // True if somebody has.
  bool stop_requested() const noexcept { return stop_wanted_; }
  // Engages a safe guard again as soon as it permits (Guard::engage), whatever made it safe: then
  // the largest force rises from zero over engage_ramp. The wish stays until it is met; one that
  // finds the guard at work is met. For any thread; no wait.
  void request_engage() noexcept { engage_wanted_ = true; }

  const TickRecord& record() const { return record_; }  // errors: of GuardReason
  const Guard& guard() const { return guard_; }

 private:
  void feel(Nanoseconds now, LoopTick& tick) noexcept;
  void describe(LoopTick& tick) const noexcept;

  HapticDevice& device_;
  Tracker& tracker_;
  LoopOptions options_;
  Guard guard_;
  TickRecord record_;
  bool failed_ = false;  // the device, in the last tick
  std::atomic<bool> stop_wanted_ = false, engage_wanted_ = false;
};

}  // namespace gliss
