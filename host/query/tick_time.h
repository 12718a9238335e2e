// The time that a tick takes, from what its caller tells.
#pragma once

#include <chrono>
#include <cstdint>

#include "gliss/query/contact_tracker.h"

namespace gliss {

// s: `dt`, or ContactTracker::kTick where that is not above 0, or not finite.
inline double tick_time(double dt) noexcept {
  constexpr double kLongest = 1e10;  // some centuries
  return dt > 0 && dt <= kLongest ? dt : ContactTracker::kTick;
}

// ... of a tick at `now` after one at `last`, both since any start.
inline double tick_time(std::chrono::nanoseconds last, std::chrono::nanoseconds now) noexcept {
  if (!(last < now)) return ContactTracker::kTick;
  // The difference of unsigned numbers does not overflow.
  const std::uint64_t passed =
      static_cast<std::uint64_t>(now.count()) - static_cast<std::uint64_t>(last.count());
  return static_cast<double>(passed) / 1e9;
}

}  // namespace gliss
