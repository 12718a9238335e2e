// A loop's record of its ticks, made without allocating: how late it woke, how long it computed,
// what it missed. One thread's.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/thread/periodic.h"

namespace gliss {

// A distribution of durations to 0.8 %: whole nanoseconds below 256, above that 128 bins for each
// doubling. The Histogram of gliss/sweep/sweep.h has bins of 12 %, wider than the 50 us that a tail
// of 0.5 ms is judged by.
class GLISS_EXPORT DurationHistogram {
 public:
  // More counts as this, except in max().
  static constexpr Nanoseconds kLargest = std::chrono::seconds(60);

  void add(Nanoseconds duration) noexcept;  // negative: as 0
  std::uint64_t count() const { return count_; }
  Nanoseconds max() const { return max_; }
  // Interpolated within the bin that holds it, never above max(); 0 where there is none.
  Nanoseconds quantile(double q) const;
  // The bins that hold any, shortest first: the longest duration of the bin, and how many.
  struct Bin {
    Nanoseconds longest;
    std::uint64_t count;
  };
  std::vector<Bin> bins() const;

 private:
  static constexpr int kBitsPerDoubling = 7, kDoublings = 30;
  static_assert(kLargest.count() < std::int64_t{1} << (kBitsPerDoubling + kDoublings - 1));
  static std::size_t bin_of(std::uint64_t ns) noexcept;
  static std::uint64_t longest_of(std::size_t bin) noexcept;

  std::array<std::uint64_t, std::size_t{kDoublings} << kBitsPerDoubling> bins_{};
  std::uint64_t count_ = 0;
  Nanoseconds max_{};
};

struct TickSample {
  Nanoseconds lateness{};  // of the wake
  Nanoseconds compute{};   // thread CPU clock
  int error = 0;           // the loop's own code; 0: none
};

// About 60 KB.
class GLISS_EXPORT TickRecord {
 public:
  // `missed`: periods skipped before this tick.
  void add(const TickSample& tick, std::uint64_t missed) noexcept;

  const DurationHistogram& lateness() const { return lateness_; }
  const DurationHistogram& compute() const { return compute_; }
  std::uint64_t ticks() const { return compute_.count(); }
  std::uint64_t missed() const { return missed_; }
  std::uint64_t longest_missed() const { return longest_missed_; }  // in a row
  std::uint64_t errors() const { return errors_; }                  // ticks with an error
  // Share of the periods that had a tick without an error; 1 where there is none yet.
  double success() const;

 private:
  DurationHistogram lateness_, compute_;
  std::uint64_t missed_ = 0, longest_missed_ = 0, errors_ = 0;
};

}  // namespace gliss
