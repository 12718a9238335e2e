// A search that may spend only so many evaluations: what it leaves out it says, with a distance
// that holds.
#include "tests/extremes/extreme_surfaces.h"

namespace gliss {
namespace {

using oracle::Rng, oracle::uniform;
using test::Extreme;

QueryOptions with_budget(int budget) {
  QueryOptions options;
  options.budget = budget;
  return options;
}

Vec3 anywhere(Rng& rng, const Extreme& e) {
  return e.middle() + uniform(rng, 0, 1) * e.size * oracle::random_unit(rng);
}

class SearchBudget : public ::testing::TestWithParam<const char*> {};

TEST_P(SearchBudget, leaves_nothing_nearer_than_it_says) {
  const Extreme& e = test::extreme(GetParam());
  Rng rng(5);
  int unfinished = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec3 hip = i == 0 ? Vec3::Zero() : anywhere(rng, e);
    const double distance = std::abs(nearest(e.cache, hip).distance);
    for (const int budget : {1, 5, 20}) {
      const Contact c = nearest(e.cache, hip, with_budget(budget));
      EXPECT_LE(c.iterations, budget + QueryOptions().max_iterations);
      const double rounding = 1e-12 * e.size;
      EXPECT_LE(c.clear, distance + rounding);
      const bool finished = !(c.flags & kUnfinished);
      if (finished) {
        EXPECT_NEAR(c.clear, std::abs(c.distance), rounding);
        EXPECT_NEAR(std::abs(c.distance), distance, 1e-9 * e.size);
      }
      unfinished += !finished;
    }
  }
  EXPECT_GT(unfinished, 0);
}

TEST_P(SearchBudget, changes_nothing_where_it_suffices) {
  const Extreme& e = test::extreme(GetParam());
  Rng rng(6);
  for (int i = 0; i < 300; ++i) {
    const Vec3 hip = anywhere(rng, e);
    const Contact all = nearest(e.cache, hip), c = nearest(e.cache, hip, with_budget(1'000'000));
    EXPECT_EQ(all.scp, c.scp);
    EXPECT_EQ(all.flags, c.flags);
    EXPECT_EQ(all.iterations, c.iterations);
    EXPECT_NEAR(c.clear, std::abs(c.distance), 1e-12 * e.size);
  }
}

INSTANTIATE_TEST_SUITE_P(, SearchBudget, ::testing::Values("knot", "fin", "sphere"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace gliss
