// A timer for a loop at a fixed rate. Its deadlines lie on a grid fixed at the start, so that they
// never drift. A period that a loop is too late for is skipped and counted: ticks never come in a
// burst.
#pragma once

#include <cstdint>

#include "gliss/base/export.h"
#include "gliss/thread/clock.h"

namespace gliss {

// The deadlines start + k period, without a clock.
class GLISS_EXPORT DeadlineGrid {
 public:
  DeadlineGrid(Nanoseconds start, Nanoseconds period) : deadline_(start), period_(period) {}

  Nanoseconds deadline() const { return deadline_; }  // of the last tick; at first the start
  // Moves on to the next deadline that is not before `now` nor within half a period of `woke`, when
  // the last tick began. Returns how many deadlines were skipped.
  std::uint64_t advance(Nanoseconds woke, Nanoseconds now) noexcept;

 private:
  Nanoseconds deadline_, period_;
};

struct Wake {
  Nanoseconds deadline{};    // on CLOCK_MONOTONIC
  Nanoseconds lateness{};    // from the deadline to the wake; may exceed a period
  std::uint64_t missed = 0;  // periods skipped between the last deadline and this one
};

class GLISS_EXPORT PeriodicTimer {
 public:
  static constexpr Nanoseconds kShortest = std::chrono::microseconds(10);
  static constexpr Nanoseconds kLongest = std::chrono::seconds(1);

  // The first deadline comes a period from now. Throws std::invalid_argument unless kShortest <=
  // period <= kLongest.
  explicit PeriodicTimer(Nanoseconds period);

  // Sleeps until the next deadline, one system call; neither spins nor allocates. Signals do not
  // end it.
  Wake wait() noexcept;

 private:
  DeadlineGrid grid_;
  Nanoseconds woke_;
};

}  // namespace gliss
