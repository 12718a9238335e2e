// Makes a thread and its process ready for a loop that must not be late: real-time scheduling, the
// finest timers, memory that stays in RAM.
#pragma once

#include <pthread.h>
#include <sched.h>

#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include "gliss/base/export.h"

namespace gliss {

// The loop cannot be run as it was asked for; what() is one line that says why.
struct GLISS_EXPORT LoopError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Schedules a thread by SCHED_FIFO. Returns the line that says what was refused, which limit says
// so, and the cure; "" where it was granted.
GLISS_EXPORT std::string set_realtime(pthread_t thread, int priority);

struct RealtimeOptions {
  int priority = 80;     // of SCHED_FIFO, 1 to 99
  bool require = false;  // what is refused is an error
  int cpu = -1;          // the only processor that the thread runs on, from 0; -1: any
};

// For the calling thread, until the object is destroyed in that thread; one object a thread. Memory
// is locked for the whole process, what it gets later too, and counts against RLIMIT_MEMLOCK, until
// the last object goes. Where /dev/cpu_dma_latency may be written, processors do not sleep so
// deeply meanwhile that they wake late.
class GLISS_EXPORT Realtime {
 public:
  // Below the caller's, there from now on; less where the stack ends before.
  static constexpr std::size_t kStackBytes = 512 << 10;

  // Throws std::invalid_argument for an invalid priority, LoopError where `require` asks for it;
  // then all is as before.
  explicit Realtime(const RealtimeOptions& options = {});
  ~Realtime();
  Realtime(const Realtime&) = delete;
  Realtime& operator=(const Realtime&) = delete;

  // One line each: what was refused, which limit says so, and the cure.
  const std::vector<std::string>& refusals() const { return refusals_; }
  int priority() const { return priority_; }  // of SCHED_FIFO; 0: scheduled as before
  bool memory_locked() const { return memory_locked_; }

 private:
  void schedule(int wanted);
  void pin(int cpu);
  void lock_memory();
  void restore() noexcept;

  std::vector<std::string> refusals_;
  int old_policy_ = 0, old_priority_ = 0, old_slack_ = 0;  // slack: ns
  int priority_ = 0;
  bool memory_locked_ = false, pinned_ = false;
  int awake_ = -1;  // file
  cpu_set_t old_cpus_{};
};

}  // namespace gliss
