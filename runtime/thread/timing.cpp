#include "gliss/thread/timing.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace gliss {

// The leading kBitsPerDoubling + 1 bits of a number, and how many follow them.
std::size_t DurationHistogram::bin_of(std::uint64_t ns) noexcept {
  const int tail = std::max(0, static_cast<int>(std::bit_width(ns)) - kBitsPerDoubling - 1);
  return (static_cast<std::size_t>(tail) << kBitsPerDoubling) + (ns >> tail);
}

std::uint64_t DurationHistogram::longest_of(std::size_t bin) noexcept {
  const std::size_t doubling = bin >> kBitsPerDoubling;
  const std::size_t tail = doubling > 0 ? doubling - 1 : 0;
  return ((std::uint64_t{bin} - (tail << kBitsPerDoubling) + 1) << tail) - 1;
}

void DurationHistogram::add(Nanoseconds duration) noexcept {
  const Nanoseconds counted = std::clamp(duration, Nanoseconds(0), kLargest);
  ++bins_[bin_of(static_cast<std::uint64_t>(counted.count()))];
  ++count_;
  max_ = std::max(max_, duration);
}

Nanoseconds DurationHistogram::quantile(double q) const {
  auto rank = static_cast<std::uint64_t>(std::ceil(q * static_cast<double>(count_)));
  if (rank >= count_) return max_;
  rank -= rank > 0 ? 1 : 0;  // from 0
  std::uint64_t shortest = 0;
  for (std::size_t bin = 0;; shortest = longest_of(bin++) + 1) {
    if (rank >= bins_[bin]) {
      rank -= bins_[bin];
      continue;
    }
    const std::uint64_t width = longest_of(bin) + 1 - shortest;
    const double share = static_cast<double>(rank) / static_cast<double>(bins_[bin]);
    return Nanoseconds(static_cast<std::int64_t>(
        shortest + static_cast<std::uint64_t>(share * static_cast<double>(width))));
  }
}

std::vector<DurationHistogram::Bin> DurationHistogram::bins() const {
  std::vector<Bin> held;
  for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
    if (bins_[bin] == 0) continue;
    held.push_back({Nanoseconds(static_cast<std::int64_t>(longest_of(bin))), bins_[bin]});
  }
  return held;
}

void TickRecord::add(const TickSample& tick, std::uint64_t missed) noexcept {
  lateness_.add(tick.lateness);
  compute_.add(tick.compute);
  missed_ += missed;
  longest_missed_ = std::max(longest_missed_, missed);
  errors_ += tick.error != 0 ? 1 : 0;
}

double TickRecord::success() const {
  const std::uint64_t periods = ticks() + missed_;
  return periods > 0 ? static_cast<double>(ticks() - errors_) / static_cast<double>(periods) : 1;
}

}  // namespace gliss
