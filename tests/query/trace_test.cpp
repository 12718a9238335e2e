// Traces: what they count, that they follow the nearest point, that a closed path ends as it began.
#include "gliss/query/trace.h"

#include "gliss/generate/generate.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

// Round a torus, beneath its surface, from a place where no two facets are equally near.
std::vector<Vec3> ring(int ticks, double depth) {
  std::vector<Vec3> hips;
  for (int i = 0; i < ticks; ++i) {
    const double t = 0.1 + 2 * std::numbers::pi * i / (ticks - 1), around = 3 * t;
    const double radius = 30 + (10 - depth) * std::cos(around);
    hips.push_back({radius * std::cos(t), radius * std::sin(t), (10 - depth) * std::sin(around)});
  }
  hips.back() = hips.front();
  return hips;
}

TEST(Trace, follows_the_nearest_point) {
  const PatchCache cache = test::cache_of(torus().mesh);
  const std::vector<Vec3> hips = ring(4000, 1);
  test::Worst error;
  const auto found = trace(cache, hips, {}, [&](std::size_t i, std::span<const TraceStep> steps) {
    EXPECT_EQ(steps.size(), 3u);
    error.add((steps[0].contact.scp - nearest(cache, hips[i]).scp).norm());
    EXPECT_LE((steps[0].force - contact_force(cache, steps[0].contact, 500)).norm(), 0);
  });
  EXPECT_LE(error.value, 1e-6);
  for (const TraceStatistics& s : found) {
    EXPECT_EQ(s.ticks, hips.size());
    EXPECT_EQ(s.touching, hips.size());
    EXPECT_EQ(s.entries, 1u);
    EXPECT_NEAR(s.largest_force, 0.5, 0.2);
  }
}

TEST(Trace, ends_with_the_force_it_began_with_on_a_closed_path) {
  const PatchCache cache = test::cache_of(torus().mesh);
  const std::vector<Vec3> hips = ring(3000, 0.8);
  std::vector<Vec3> first, last;
  trace(cache, hips, {}, [&](std::size_t i, std::span<const TraceStep> steps) {
    auto* kept = i == 0 ? &first : i + 1 == hips.size() ? &last : nullptr;
    for (const TraceStep& step : steps) {
      if (kept) kept->push_back(step.force);
    }
  });
  ASSERT_EQ(first.size(), last.size());
  for (std::size_t i = 0; i < first.size(); ++i) EXPECT_LE((first[i] - last[i]).norm(), 1e-9);
}

TEST(Trace, counts_entries_and_ticks_in_contact) {
  const PatchCache cache = test::cache_of(torus().mesh);
  std::vector<Vec3> hips;
  for (const double depth : {-1.0, 1.0, 2.0, -1.0, -2.0, 1.0, -1.0}) {
    hips.push_back({40 - depth, 0.1, 0.1});
  }
  TraceOptions options;
  options.methods = {Method::kGregory};
  const auto found = trace(cache, hips, options);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].ticks, 7u);
  EXPECT_EQ(found[0].touching, 3u);
  EXPECT_EQ(found[0].entries, 2u);
  EXPECT_NEAR(found[0].largest_force, 1, 0.05);
  EXPECT_NEAR(found[0].largest_step, 1, 0.05);  // leaves from 2 mm
  EXPECT_EQ(found[0].lost, 2u);
  EXPECT_EQ(found[0].jumps(), 5u);  // in, deeper, out, in, out
}

TEST(Trace, ends_with_what_its_sink_throws) {
  struct Stop {};
  const PatchCache cache = test::cache_of(torus().mesh);
  std::size_t ticks = 0;
  EXPECT_THROW(trace(cache, ring(100, 1), {},
                     [&](std::size_t i, std::span<const TraceStep>) {
                       ticks = i + 1;
                       if (ticks == 10) throw Stop();
                     }),
               Stop);
  EXPECT_EQ(ticks, 10u);
}

}  // namespace
}  // namespace gliss
