// Holds for every tick: it evaluates patches no more often than ContactTracker says, and tells how
// often that was. Evaluations are counted in evaluate_form itself.
#include <cstdlib>

#include "gliss/query/contact_tracker.h"
#include "tests/counting/counting.h"
#include "tests/support/sharp_meshes.h"
#include "tests/validate/hostile_meshes.h"

namespace gliss {

void counting::break_promise(const char* promise, const char* file, int line) {
  if (++broken <= 5) ADD_FAILURE_AT(file, line) << "does not hold: " << promise;
}

namespace {

using counting::counts, oracle::Rng, oracle::uniform;

Vec3 within(Rng& rng, double reach) {
  return {uniform(rng, -reach, reach), uniform(rng, -reach, reach), uniform(rng, -reach, reach)};
}

// Balls of 42 faces and radius 1 whose middles lie 1.7 from the first's.
Mesh crowd_of_balls(int balls) {
  Rng rng(1);
  const Mesh ball = goldberg(2, 1.0).mesh;
  std::vector<Mesh> parts{ball};
  while (static_cast<int>(parts.size()) < balls)
    parts.push_back(test::moved(ball, 1.7 * within(rng, 1).normalized()));
  return test::joined(parts);
}

// What the ticks of a path took, and where they did not tell so.
struct Ticks {
  std::int64_t count = 0, touching = 0, over = 0, untold = 0, worst = 0;
  int worst_told = 0;

  void add(const Contact& contact) {
    ++count;
    touching += contact.touching;
    over += counts.evaluations > ContactTracker::kTickEvaluations;
    // A walk round a corner that very many sides share counts besides.
    untold += counts.told < counts.evaluations ||
              contact.iterations != std::max<std::int64_t>(counts.iterations - 1, 0);
    if (counts.evaluations <= worst) return;
    worst = counts.evaluations;
    worst_told = contact.iterations;
  }
  void expect_kept(const std::string& what) const {
    EXPECT_EQ(over, 0) << what;
    EXPECT_EQ(untold, 0) << what;
    EXPECT_EQ(counting::broken, 0) << what;
    test::record(what, "{} ticks, {} touching, {} over; the worst {} evaluations, {} iterations",
                 count, touching, over, worst, worst_told);
  }
};

int tick_count() { return std::getenv("GLISS_LONG_TESTS") ? 100'000 : 1500; }

// A hand that goes about the mesh, slowly and fast, and leaps at times.
Ticks follow(const PatchCache& cache, const QueryOptions& options, bool tells_all = false) {
  const Box box = cache.bounds();
  const double size = (box.high - box.low).norm() / 2;
  ContactTracker tracker(cache, options);
  Rng rng(2);
  Vec3 hip = Vec3::Zero();
  double pace = 0;
  Ticks ticks;
  for (int i = 0; i < tick_count(); ++i) {
    if (i % 50 == 0) {
      pace = uniform(rng, 0, 0.1) * (i % 100 == 0 ? 1 : 0.1);
      hip = (box.low + box.high) / 2 + within(rng, 0.7 * size);
    } else {
      hip += within(rng, pace * size);
    }
    counts = {};
    ticks.add(tracker.tick(hip));
    if (tells_all) {
      EXPECT_EQ(counts.told, counts.evaluations);
    }
  }
  return ticks;
}

class Counting : public ::testing::TestWithParam<int> {};

TEST_P(Counting, finds_no_tick_over_its_bound_in_a_crowd) {
  for (const Precision precision : {Precision::kDouble, Precision::kFloat}) {
    const PatchCache cache = build_cache(crowd_of_balls(GetParam()), {.precision = precision});
    for (const double friction : {0.0, 0.5}) {
      QueryOptions options;
      options.friction = {friction, friction};
      const Ticks ticks = follow(cache, options, true);
      ticks.expect_kept(fmt::format("{}, friction {}",
                                    precision == Precision::kFloat ? "float" : "double", friction));
      EXPECT_GT(ticks.touching, ticks.count / 40);
    }
  }
}

// A contact that a search of few evaluations gives is that of one without a bound, or says that it
// may be another.
TEST_P(Counting, finds_no_contact_of_a_spent_search_that_says_nothing) {
  const PatchCache cache = build_cache(crowd_of_balls(GetParam()));
  Rng rng(3);
  int finished = 0, unfinished = 0, untold = 0;
  std::vector<Contact> from(1), few(1), all(1);
  for (int i = 0; i < tick_count() / 8; ++i) {
    const std::vector<Vec3> at{within(rng, 2)}, to{at[0] + within(rng, 0.2)};
    const Contact begin = nearest(cache, at[0]);
    const std::vector<DomainPoint> start{begin.at};
    track(cache, to, start, {}, all);
    for (const int budget : {1, 5, 10, 20, 50}) {
      QueryOptions brief;
      brief.budget = budget;
      track(cache, to, start, brief, few);
      const bool is_same = few[0].scp == all[0].scp && few[0].touching == all[0].touching;
      const bool says_so = (few[0].flags & kUnfinished) != 0;
      untold += !is_same && !says_so;
      finished += !says_so;
      unfinished += says_so;
    }
  }
  EXPECT_EQ(untold, 0);
  EXPECT_EQ(counting::broken, 0);
  EXPECT_GT(finished, 0);
  if (GetParam() > 1) {
    EXPECT_GT(unfinished, 0);
  }
  test::record("tracked", "{} finished, {} not, {} others than without a bound untold", finished,
               unfinished, untold);
}

INSTANTIATE_TEST_SUITE_P(, Counting, ::testing::Values(1, 2, 7, 31, 61),
                         [](const auto& info) { return std::to_string(info.param); });

struct Named {
  const char* name;
  Mesh (*make)();
};
constexpr Named kMeshes[] = {
    {"knot", [] { return torus_knot().mesh; }},
    {"fin", [] { return fin().mesh; }},
    {"banana", [] { return banana().mesh; }},
    {"thin_plate", [] { return thin_plate().mesh; }},
    {"prism", [] { return prism(40).mesh; }},
    {"irregular_torus", [] { return irregular(torus(), 1).mesh; }},
    {"creases", [] { return test::with_creases(test::l_solid()); }},
    {"fan", [] { return test::fan(60); }},
    {"wide_fan", [] { return test::fan(300); }},
    {"needles", [] { return test::needles(200); }},
    {"crowd", [] { return test::crowd(20); }},
    {"coincident_shells", [] { return test::coincident_shells(8); }},
};

class CountingMeshes : public ::testing::TestWithParam<Named> {};

TEST_P(CountingMeshes, finds_no_tick_over_its_bound) {
  for (const Construction construction : {Construction::kFair, Construction::kPaper}) {
    const PatchCache cache =
        build_cache(GetParam().make(), {.level = {.construction = construction}});
    for (const Solver solver : {Solver::kNewton, Solver::kGaussNewton, Solver::kPaper}) {
      QueryOptions options;
      options.solver = solver;
      follow(cache, options)
          .expect_kept(fmt::format("{}, solver {}",
                                   construction == Construction::kFair ? "fair" : "paper",
                                   static_cast<int>(solver)));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, CountingMeshes, ::testing::ValuesIn(kMeshes),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace gliss
