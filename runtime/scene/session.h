// A loop in a thread of its own, and the ring from which another thread takes its ticks.
#pragma once

#include <atomic>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gliss/loop/loop.h"
#include "gliss/thread/realtime.h"

namespace gliss {

struct SessionOptions {
  double seconds = 0;    // ends the loop after this time; 0: it ends with the device
  bool realtime = true;  // asks the system for a real-time thread, for a loop that keeps a clock
  RealtimeOptions scheduling = {};
  std::size_t ring = 1 << 15;  // ticks that wait to be taken: half a minute at 1 kHz
  // Called after each tick, in the loop's thread and as a part of it: it must not wait. It may
  // change what the tracker renders, with what another thread left for it.
  std::function<void(Tracker& tracker)> after_tick = nullptr;
};

// The system's answer to a thread that wants to be real-time.
struct SessionGrants {
  int priority = 0;  // of SCHED_FIFO; 0: scheduled as any thread
  bool memory_locked = false;
  std::vector<std::string> refusals;  // one line each, the device's threads included
};

// It keeps references to device and tracker, which outlive it and are its thread's alone until it
// has ended. All other threads may call its functions, take() one of them.
class GLISS_EXPORT LoopSession {
 public:
  // The loop begins at once. Throws as HapticLoop.
  LoopSession(HapticDevice& device, Tracker& tracker, const LoopOptions& rules = {},
              const SessionOptions& options = {});
  ~LoopSession();  // ends the loop and waits for that
  LoopSession(const LoopSession&) = delete;
  LoopSession& operator=(const LoopSession&) = delete;

  // Gives all ticks that wait, instead of what `ticks` held. A loop that keeps a clock never waits
  // for this: ticks without room are lost. One without a clock waits, and loses none.
  void take(std::vector<LoopTick>& ticks);
  std::uint64_t lost() const noexcept { return lost_.load(std::memory_order_relaxed); }

  void request_stop() noexcept { loop_.request_stop(); }
  void request_engage() noexcept { loop_.request_engage(); }

  // True if the loop has ended within this time.
  bool wait_for(Nanoseconds time) const {
    return running_.wait_for(time) == std::future_status::ready;
  }
  // Waits for the end, but in a child of fork(), where there is none.
  void wait() const {
    if (running_.valid()) running_.wait();
  }
  // Waits for the end. Throws what ended the loop: LoopError where `scheduling.require` is not met.
  void join() const { running_.get(); }
  // kStopped before the end, and where join() throws.
  LoopEnd end() const noexcept { return end_; }

  // Nothing until the thread is ready for its first tick.
  std::optional<SessionGrants> grants() const;
  // Its record and guard are the thread's until the end.
  const HapticLoop& loop() const noexcept { return loop_; }

  // For a child of fork(), which lacks the loop's thread: nothing waits for it from now on.
  void abandon();

 private:
  struct Ring;

  void run(HapticDevice& device, Tracker& tracker, bool keeps_clock, const SessionOptions& options);

  HapticLoop loop_;
  std::unique_ptr<Ring> ring_;
  SessionGrants grants_;
  std::atomic<bool> is_ready_ = false;
  std::atomic<std::uint64_t> lost_ = 0;
  std::atomic<LoopEnd> end_ = LoopEnd::kStopped;
  std::shared_future<void> running_;
};

}  // namespace gliss
