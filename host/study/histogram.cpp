#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "gliss/study/sweep.h"

namespace gliss {

void Histogram::add(double value) {
  ++count_;
  if (!std::isfinite(value)) {
    ++unsound_;
    max_ = std::numeric_limits<double>::infinity();
    return;
  }
  const int bin =
      value > kLowest ? static_cast<int>(std::floor(kPerDecade * std::log10(value / kLowest))) : 0;
  ++bins_[static_cast<std::size_t>(std::clamp(bin, 0, kBins - 1))];
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
    seen += bins_[static_cast<std::size_t>(i)];
    if (seen >= wanted && seen > 0) return std::min(bin_edge(i), max_);
  }
  return max_;
}

}  // namespace gliss
