#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

#include "gliss/sweep/sweep.h"

namespace gliss {

namespace {

std::uint32_t bin_of(double value) {
  const double bin = std::floor(Histogram::kPerDecade * std::log10(value / Histogram::kLowest));
  return static_cast<std::uint32_t>(std::clamp(bin, 0.0, Histogram::kBins - 1.0));
}

// Finds bins without a logarithm: from a number's exponent and first bits. A cell of numbers that
// have these in common is narrower than a bin.
class BinFinder {
 public:
  BinFinder() {
    const auto end = static_cast<std::uint32_t>(cell_.size());
    for (std::uint32_t c = 0; c < end; ++c) {
      const double first = std::bit_cast<double>((std::uint64_t{kFirst} + c) << kShift);
      const double last =
          std::nextafter(std::bit_cast<double>((std::uint64_t{kFirst} + c + 1) << kShift), first);
      Cell& cell = cell_[c];
      cell.bin = bin_of(first);
      cell.next = std::numeric_limits<double>::infinity();
      if (bin_of(last) == cell.bin) continue;
      double low = first, high = last;  // the first number of the next bin lies between
      while (std::nextafter(low, high) < high) {
        const double middle = low + (high - low) / 2;
        (bin_of(middle) == cell.bin ? low : high) = middle;
      }
      cell.next = high;
    }
  }
  std::uint32_t operator()(double value) const {
    const std::uint64_t bits = std::bit_cast<std::uint64_t>(value) >> kShift;
    if (!(value > Histogram::kLowest)) return 0;
    const Cell& cell = cell_[std::min<std::uint64_t>(bits - kFirst, cell_.size() - 1)];
    return cell.bin + (value >= cell.next ? 1u : 0u);
  }

 private:
  static constexpr int kShift = 48;  // leaves four bits of the fraction
  static constexpr std::uint32_t kFirst =
      std::bit_cast<std::uint64_t>(Histogram::kLowest) >> kShift;
  static constexpr std::uint32_t kLast = std::bit_cast<std::uint64_t>(1e5) >> kShift;
  struct Cell {
    std::uint32_t bin;  // of its first number
    double next;        // first number of the next bin
  };
  std::array<Cell, kLast - kFirst + 1> cell_;
};

}  // namespace

void Histogram::add(double value) {
  static const BinFinder find_bin;

  ++count_;
  if (!std::isfinite(value)) {
    ++unsound_;
    max_ = std::numeric_limits<double>::infinity();
    return;
  }
  ++bins_[find_bin(value)];
  sum_ += value;
  max_ = std::max(max_, value);
}

void Histogram::merge(const Histogram& other) {
  for (std::size_t i = 0; i < bins_.size(); ++i) bins_[i] += other.bins_[i];
  count_ += other.count_;
  unsound_ += other.unsound_;
  sum_ += other.sum_;
  max_ = std::max(max_, other.max_);
}

bool Histogram::is_consistent() const {
  const std::uint64_t sound = std::accumulate(bins_.begin(), bins_.end(), std::uint64_t{0});
  return unsound_ <= count_ && sound == count_ - unsound_ && sum_ >= 0 && max_ >= 0 &&
         std::isfinite(max_) == (unsound_ == 0);
}

double Histogram::bin_edge(int bin) { return kLowest * std::pow(10.0, (bin + 1.0) / kPerDecade); }

double Histogram::quantile(double q) const {
  const auto wanted = static_cast<std::uint64_t>(std::ceil(q * static_cast<double>(count_)));
  std::uint64_t seen = 0;
  for (int i = 0; i < kBins; ++i) {
    const std::uint64_t here = bins_[static_cast<std::size_t>(i)], before = seen;
    seen += here;
    if (seen < wanted || seen == 0) continue;
    const double most = std::min(bin_edge(i), max_);
    if (i == 0) return most;
    const double least = bin_edge(i - 1);
    const double share = static_cast<double>(wanted - before) / static_cast<double>(here);
    return least < most ? least * std::pow(most / least, share) : most;
  }
  return max_;
}

}  // namespace gliss
