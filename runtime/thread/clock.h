// The two clocks of the loop. An instant is the time since the clock's own zero.
#pragma once

#include <time.h>

#include <chrono>

namespace gliss {

using Nanoseconds = std::chrono::nanoseconds;

constexpr double in_seconds(Nanoseconds time) noexcept {
  return std::chrono::duration<double>(time).count();
}

inline Nanoseconds read_clock(clockid_t clock) noexcept {
  timespec time{};
  clock_gettime(clock, &time);
  return std::chrono::seconds(time.tv_sec) + Nanoseconds(time.tv_nsec);
}

inline Nanoseconds monotonic_time() noexcept { return read_clock(CLOCK_MONOTONIC); }

// Processor time of the calling thread: not what it waited or was pre-empted. A system call, unlike
// the other.
inline Nanoseconds thread_time() noexcept { return read_clock(CLOCK_THREAD_CPUTIME_ID); }

}  // namespace gliss
