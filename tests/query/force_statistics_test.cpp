// The steps, jumps and losses that a series of forces has.
#include "gliss/query/force_statistics.h"

#include <gtest/gtest.h>

#include <initializer_list>
#include <optional>

#include "gliss/sweep/sweep.h"
#include "tests/support/numbers.h"

namespace gliss {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
using test::kInfinity;

// Forces along z; no force: a free tick.
using Series = std::initializer_list<std::optional<double>>;

ForceStatistics felt(const Series& series, ForceStatistics statistics = {}) {
  for (const auto& f : series) statistics.add(f.has_value(), Vec3(0, 0, f.value_or(0)));
  return statistics;
}

constexpr std::optional<double> kFree = std::nullopt;

// The force is as an open wrist gave it: constant while in contact, gone every other tick.
TEST(ForceStatistics, counts_the_steps_to_zero_and_back_of_a_contact_that_chatters) {
  const ForceStatistics s =
      felt({kFree, 1.04, 1.04, kFree, 1.04, kFree, 1.04, 1.04, kFree, kFree}, ForceStatistics(1));
  EXPECT_DOUBLE_EQ(s.largest_step, 1.04);
  EXPECT_EQ(s.ticks, 10u);
  EXPECT_EQ(s.touching, 5u);
  EXPECT_EQ(s.entries, 3u);
  EXPECT_EQ(s.lost, 3u);
  EXPECT_EQ(s.jumps(), 6u);  // three in, three out
  EXPECT_DOUBLE_EQ(s.mean_step, 6 * 1.04 / 8);
  EXPECT_DOUBLE_EQ(s.jumps_per_100k(), 1.2e5);
  EXPECT_DOUBLE_EQ(s.lost_per_100k(), 0.6e5);
}

TEST(ForceStatistics, counts_the_same_where_it_is_not_told_the_full_force) {
  const Series series = {kFree, 1.04, 1.04, kFree, 1.04, kFree, 1.04, 1.04, kFree, kFree};
  const ForceStatistics told = felt(series, ForceStatistics(1.04)), not_told = felt(series);
  EXPECT_EQ(told.jumps(), not_told.jumps());
  EXPECT_EQ(told.lost, not_told.lost);
}

TEST(ForceStatistics, begins_without_a_step) {
  const ForceStatistics s = felt({5.0, 5.0}, ForceStatistics(5));
  EXPECT_EQ(s.largest_step, 0);
  EXPECT_EQ(s.jumps(), 0u);
  EXPECT_EQ(s.entries, 1u);
}

TEST(ForceStatistics, counts_steps_above_a_fifth_of_the_full_force_as_jumps) {
  const ForceStatistics s = felt({1.0, 1.19, 1.0, 1.21, 1.0, 1.0}, ForceStatistics(1));
  EXPECT_EQ(s.jumps(), 2u);
  EXPECT_NEAR(s.largest_step, 0.21, 1e-15);
}

TEST(ForceStatistics, has_neither_jump_nor_loss_where_little_force_comes_and_goes) {
  const ForceStatistics s =
      felt({kFree, 0.19, kFree, 0.21, kFree, 0.1, 0.05, kFree}, ForceStatistics(1));
  EXPECT_EQ(s.lost, 1u);
  EXPECT_EQ(s.jumps(), 2u);  // 0.21 comes and goes
}

TEST(ForceStatistics, does_not_take_a_smooth_press_for_jumps) {
  ForceStatistics s;
  for (int press = 0; press < 3; ++press) {
    for (int i = 0; i < 200; ++i) {
      const double force = 0.02 * std::min(i, 200 - i);
      s.add(force > 0, Vec3(0, 0, force));
    }
  }
  EXPECT_EQ(s.entries, 3u);
  EXPECT_EQ(s.jumps(), 0u);
  EXPECT_EQ(s.lost, 0u);
  EXPECT_NEAR(s.largest_step, 0.02, 1e-15);
}

TEST(ForceStatistics, counts_a_jump_in_the_first_ticks_of_a_contact_at_once) {
  EXPECT_EQ(felt({kFree, 1.0, 1.0}).jumps(), 1u);
  EXPECT_EQ(felt({kFree, 1.0, kFree}).jumps(), 2u);
  EXPECT_EQ(felt({kFree, 1.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0}).jumps(), 2u);
}

TEST(ForceStatistics, judges_by_the_force_held_lately) {
  ForceStatistics s;
  const auto hold = [&](int ticks, double force) {
    for (int i = 0; i < ticks; ++i) s.add(true, Vec3(0, 0, force));
    return s.jumps();
  };
  EXPECT_EQ(hold(100, 10), 0u);
  EXPECT_EQ(hold(1, 8.5), 0u);  // 15 %
  EXPECT_EQ(hold(1, 2), 1u);
  EXPECT_EQ(hold(1, 3.5), 1u);    // 15 % of what was held lately
  EXPECT_EQ(hold(400, 3.5), 1u);  // now that is what is held
  EXPECT_EQ(hold(1, 4.1), 1u);
  EXPECT_EQ(hold(1, 5.5), 2u);
}

TEST(ForceStatistics, never_takes_what_is_not_finite_for_a_small_step) {
  for (const double wrong : {kNan, kInfinity, -kInfinity}) {
    const ForceStatistics s = felt({1.0, 1.0, wrong, 1.0, 1.1, kFree}, ForceStatistics(1));
    EXPECT_EQ(s.unsound, 1u);
    EXPECT_EQ(s.largest_step, kInfinity);
    EXPECT_EQ(s.jumps(), 2u);  // that one, and the loss
    EXPECT_EQ(s.lost, 1u);
    EXPECT_TRUE(std::isfinite(s.mean_step));
    EXPECT_DOUBLE_EQ(s.largest_force, 1.1);
  }
  EXPECT_EQ(felt({kNan}).unsound, 1u);
}

TEST(ForceStatistics, says_which_ticks_have_a_step) {
  ForceStatistics s;
  EXPECT_TRUE(std::isnan(s.add(true, Vec3(0, 0, 1))));
  EXPECT_EQ(s.add(true, Vec3(0, 0, 3)), 2);
  EXPECT_EQ(s.add(false, Vec3::Zero()), 3);
  EXPECT_TRUE(std::isnan(s.add(false, Vec3::Zero())));
  EXPECT_EQ(s.add(true, Vec3(0, 0, kNan)), kInfinity);
}

TEST(HistogramTest, ranks_what_is_not_finite_above_all_else) {
  Histogram sound, all;
  for (int i = 0; i < 98; ++i) sound.add(1e-3);
  all.merge(sound);
  for (const double wrong : {kNan, kInfinity}) {
    Histogram one;
    one.add(wrong);
    all.merge(one);
  }
  EXPECT_EQ(all.count(), 100u);
  EXPECT_EQ(all.unsound(), 2u);
  EXPECT_EQ(all.bins(), sound.bins());
  EXPECT_EQ(all.max(), kInfinity);
  EXPECT_EQ(all.quantile(0.99), kInfinity);
  EXPECT_LE(all.quantile(0.98), 1.2e-3);
  EXPECT_DOUBLE_EQ(all.mean(), 1e-3);
}

}  // namespace
}  // namespace gliss
