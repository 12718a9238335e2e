// That what is recommended is what a hand feels least of, whatever the largest error along a path.
#include "gliss/compare/recommend.h"

#include <gmock/gmock.h>

namespace gliss {
namespace {

using ::testing::HasSubstr;

// Feels `jumps` in each of 100 walks of 1,000 ticks.
CompareRow row_of(Method method, int jumps, double p99_error) {
  CompareRow row{};
  row.candidate.method = method;
  row.p99_force_error = p99_error;
  row.max_force_error = 10;
  row.bytes = 1000;
  row.loop_gain = {0, 1e-6};
  FeltWalks all{ForceStatistics(1)};
  for (int walk = 0; walk < 100; ++walk) {
    FeltWalks felt{ForceStatistics(1)};
    for (int tick = 0; tick < 1000; ++tick)
      felt.add(true, Vec3(tick >= 500 && tick < 500 + jumps ? tick % 2 : 1, 0, 0));
    all.merge(felt);
  }
  row.walks = {{5e-6, 0, all}};
  return row;
}

TEST(FeltWalks, tell_their_spread_over_seeds) {
  const FeltWalks felt = row_of(Method::kGregory, 4, 0).walks[0].felt;
  EXPECT_EQ(felt.jumps(), 400u);
  EXPECT_NEAR(felt.jumps_per_100k(), 400, 1e-9);
  EXPECT_NEAR(felt.jumps_spread_per_100k(), 40, 1e-9);  // bursts of four, 100 of them
  const FeltWalks none = row_of(Method::kGregory, 0, 0).walks[0].felt;
  EXPECT_NEAR(none.jumps_spread_per_100k(), 1, 1e-9);  // one may have been missed
}

TEST(Recommend, takes_no_baseline_that_jumps_more_or_makes_energy) {
  std::vector<CompareRow> rows = {row_of(Method::kGregory, 2, 0.5), row_of(Method::kFlat, 4, 0.01),
                                  row_of(Method::kShaded, 0, 0.01)};
  rows[2].loop_gain = {0.2, 1e-4};
  EXPECT_EQ(recommend(rows, {}).row, &rows[0]);
  EXPECT_THAT(recommend(rows, {}).reason,
              HasSubstr("shaded jumps 0 times, but closed loops give the hand up to 20 %"));
  rows[0].bytes = 2000;  // not within the budget, and still what baselines are judged by
  const Recommendation none = recommend(rows, {{}, {}, 1500});
  EXPECT_EQ(none.row, nullptr);
  EXPECT_THAT(none.reason, HasSubstr("jump more"));
  rows[2].loop_gain = {0.2, 0.3};  // within its error
  EXPECT_EQ(recommend(rows, {}).row, &rows[2]);
}

TEST(Recommend, takes_what_is_no_number_for_no_figure_within_a_budget) {
  std::vector<CompareRow> rows = {row_of(Method::kGregory, 2, 0.5)};
  EXPECT_EQ(recommend(rows, {20, {}, {}}).row, &rows[0]);
  rows[0].max_force_error = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(recommend(rows, {}).row, &rows[0]);
  EXPECT_EQ(recommend(rows, {20, {}, {}}).row, nullptr);
}

// At the rim of an open mesh all patches give some.
TEST(Recommend, takes_patches_that_give_energy_only_where_all_do) {
  std::vector<CompareRow> rows = {row_of(Method::kGregory, 0, 0), row_of(Method::kGregory, 4, 0.5),
                                  row_of(Method::kFlat, 8, 0.01)};
  rows[0].loop_gain = {0.01, 1e-4};
  EXPECT_EQ(recommend(rows, {}).row, &rows[1]);
  rows[1].loop_gain = {0.01, 1e-4};
  const Recommendation best = recommend(rows, {});
  EXPECT_EQ(best.row, &rows[0]);
  EXPECT_THAT(best.reason, HasSubstr("closed loops give the hand up to 1 %"));
  rows[2] = row_of(Method::kShaded, 0, 0.01);
  rows[2].loop_gain = {};
  EXPECT_EQ(recommend(rows, {}).row, &rows[0]);
}

TEST(Recommend, takes_differences_within_the_spread_for_none) {
  std::vector<CompareRow> rows = {row_of(Method::kGregory, 14, 0.2),
                                  row_of(Method::kGregory, 14, 0.1),
                                  row_of(Method::kGregory, 16, 0), row_of(Method::kGregory, 24, 0)};
  const Recommendation best = recommend(rows, {});
  EXPECT_EQ(best.row, &rows[2]);
  EXPECT_THAT(best.reason, HasSubstr("Of the 3 that are as good"));
  rows[2].leaving.contacts = 500;
  rows[2].leaving.held = 20;
  EXPECT_EQ(recommend(rows, {}).row, &rows[1]);  // it holds contacts outside
  rows[0].tick = 1e-6;
  rows[1].tick = 2e-6;
  EXPECT_EQ(recommend(rows, {20, {}, {}}).row, &rows[0]);
  EXPECT_EQ(recommend(rows, {1, {}, {}}).row, nullptr);
}

}  // namespace
}  // namespace gliss
