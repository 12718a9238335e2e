#include "gliss/thread/periodic.h"

#include <algorithm>
#include <cerrno>
#include <stdexcept>

namespace gliss {
namespace {

Nanoseconds checked(Nanoseconds period) {
  if (period < PeriodicTimer::kShortest || period > PeriodicTimer::kLongest)
    throw std::invalid_argument("the period of a timer must be 10 us to 1 s");
  return period;
}

void sleep_until(Nanoseconds deadline) noexcept {
  const auto seconds = std::chrono::floor<std::chrono::seconds>(deadline);
  timespec time{};
  time.tv_sec = seconds.count();
  time.tv_nsec = (deadline - seconds).count();
  // The deadline is absolute: after a signal the same call goes on.
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, nullptr) == EINTR) {
  }
}

}  // namespace

std::uint64_t DeadlineGrid::advance(Nanoseconds woke, Nanoseconds now) noexcept {
  const Nanoseconds next = deadline_ + period_, earliest = std::max(now, woke + period_ / 2);
  const auto skipped = earliest > next ? (earliest - next + period_ - Nanoseconds(1)) / period_ : 0;
  deadline_ = next + skipped * period_;
  return static_cast<std::uint64_t>(skipped);
}

PeriodicTimer::PeriodicTimer(Nanoseconds period)
    : grid_(monotonic_time(), checked(period)), woke_(grid_.deadline()) {}

Wake PeriodicTimer::wait() noexcept {
  const std::uint64_t missed = grid_.advance(woke_, monotonic_time());
  sleep_until(grid_.deadline());
  woke_ = monotonic_time();
  return {grid_.deadline(), woke_ - grid_.deadline(), missed};
}

}  // namespace gliss
