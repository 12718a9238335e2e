// A loop records its times: quantiles against sorted values, counts against a plain account.
#include "gliss/thread/timing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>
#include <random>
#include <vector>

namespace gliss {
namespace {

using namespace std::chrono_literals;

TEST(DurationHistogram, quantiles_are_right_to_a_hundredth) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> magnitude(0, 10.7);  // 1 ns to 50 s
  const auto histogram = std::make_unique<DurationHistogram>();
  std::vector<std::int64_t> values;
  for (int i = 0; i < 20000; ++i) {
    values.push_back(static_cast<std::int64_t>(std::pow(10, magnitude(random))));
    histogram->add(Nanoseconds(values.back()));
  }
  std::sort(values.begin(), values.end());
  EXPECT_EQ(histogram->count(), values.size());
  EXPECT_EQ(histogram->max().count(), values.back());
  for (const double q : {0.0, 0.001, 0.01, 0.25, 0.5, 0.9, 0.99, 0.999, 1.0}) {
    const auto rank = static_cast<std::size_t>(std::ceil(q * static_cast<double>(values.size())));
    const std::int64_t exact = values[std::max<std::size_t>(rank, 1) - 1];
    const auto least = static_cast<double>(exact);
    EXPECT_NEAR(static_cast<double>(histogram->quantile(q).count()), least, 0.008 * least) << q;
  }
}

TEST(DurationHistogram, quantiles_are_no_edges_of_bins) {
  const auto histogram = std::make_unique<DurationHistogram>();
  for (int ns = 1; ns <= 100'000; ++ns) histogram->add(Nanoseconds(ns));
  for (const double q : {0.5, 0.77, 0.99})
    EXPECT_NEAR(static_cast<double>(histogram->quantile(q).count()), 1e5 * q, 10);
  EXPECT_EQ(histogram->quantile(1), 100us);
}

TEST(DurationHistogram, takes_every_duration) {
  const auto histogram = std::make_unique<DurationHistogram>();
  EXPECT_EQ(histogram->quantile(0.5).count(), 0);
  histogram->add(-5us);
  EXPECT_EQ(histogram->quantile(1).count(), 0);
  for (int shift = 0; shift < 63; ++shift) {
    const Nanoseconds power(std::int64_t{1} << shift);
    histogram->add(power - 1ns);
    histogram->add(power);
    EXPECT_EQ(histogram->max(), power);
  }
  histogram->add(Nanoseconds::max());
  EXPECT_EQ(histogram->max(), Nanoseconds::max());
  EXPECT_EQ(histogram->count(), 128u);
}

TEST(TickRecord, agrees_with_a_plain_account) {
  std::mt19937 random(6);
  const auto record = std::make_unique<TickRecord>();
  EXPECT_EQ(record->success(), 1);
  std::deque<bool> periods;
  std::uint64_t missed = 0, longest = 0, errors = 0;
  constexpr int kTicks = 2000;
  for (int i = 0; i < kTicks; ++i) {
    const std::uint64_t skipped = random() % 50 == 0 ? random() % 300 : 0;
    const int error = random() % 20 == 0 ? static_cast<int>(random() % 3) : 0;
    record->add({Nanoseconds(random() % 1000), Nanoseconds(random() % 1000), error}, skipped);
    missed += skipped;
    longest = std::max(longest, skipped);
    errors += error != 0 ? 1 : 0;
    periods.insert(periods.end(), skipped, false);
    periods.push_back(error == 0);
  }
  EXPECT_EQ(record->ticks(), kTicks);
  EXPECT_EQ(record->missed(), missed);
  EXPECT_EQ(record->longest_missed(), longest);
  EXPECT_EQ(record->errors(), errors);
  EXPECT_DOUBLE_EQ(record->success(),
                   static_cast<double>(std::count(periods.begin(), periods.end(), true)) /
                       static_cast<double>(periods.size()));
}

}  // namespace
}  // namespace gliss
