// Meshes that cost more than others: every build, search and tick has a bound, told here by what it
// counts. Small ones; seconds of large ones are measured elsewhere.
#include "tests/validate/hostile_meshes.h"
#include "gliss/build/build_cache.h"
#include "gliss/validate/validate.h"
#include "tests/support/poll_gap.h"

#include "gliss/engine/engine.h"
#include "gliss/query/contact_tracker.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

struct Hostile {
  const char* name;
  Mesh mesh;
};

std::vector<Hostile> all() {
  std::vector<Hostile> meshes{{"fan", test::fan(60)},
                              {"coincident shells", test::coincident_shells(40)},
                              {"many parts", test::many_parts(60)},
                              {"needles", test::needles(30)}};
  for (Hostile& h : meshes) validate(h.mesh);
  return meshes;
}

std::vector<Vec3> hips_near(const PatchCache& cache) {
  const Box box = cache.bounds();
  oracle::Rng rng(3);
  std::vector<Vec3> hips{Vec3::Zero(), Vec3(0, 0, 0.9), Vec3(0, 0, 1.1)};
  for (int i = 0; i < 60; ++i) {
    Vec3 mix;
    for (double& x : mix) x = oracle::uniform(rng, -0.1, 1.1);
    hips.push_back(box.low + mix.cwiseProduct(box.high - box.low));
  }
  return hips;
}

TEST(HostileMeshes, are_searched_within_the_default_budget) {
  for (const Hostile& hostile : all()) {
    const PatchCache cache = build_cache(hostile.mesh);
    int most = 0;
    for (const Vec3& hip : hips_near(cache)) {
      const Contact c = nearest(cache, hip);
      EXPECT_TRUE(c.scp.allFinite() && c.normal.allFinite() && std::isfinite(c.distance));
      most = std::max(most, c.iterations);
      QueryOptions brief;
      brief.budget = 500;
      const Contact found = nearest(cache, hip, brief);
      EXPECT_LE(found.iterations, brief.budget + 8 * (brief.max_iterations + 1)) << hostile.name;
      EXPECT_LE(found.clear, std::abs(c.distance) + 1e-12) << hostile.name;
    }
    EXPECT_LE(most, QueryOptions().budget + QueryOptions().max_iterations) << hostile.name;
    test::record(hostile.name, "{} patches, at most {} evaluations", cache.patch_count(), most);
  }
}

TEST(HostileMeshes, are_followed_within_the_budget_of_a_tick) {
  for (const Hostile& hostile : all()) {
    const PatchCache cache = build_cache(hostile.mesh);
    ContactTracker tracker(cache, {});
    int most = 0;
    for (int i = 0; i < 400; ++i) {
      const Vec3 hip(0.05 * std::cos(0.1 * i), 0.05 * std::sin(0.1 * i), 1.2 - 0.002 * i);
      const Contact c = tracker.tick(hip);
      EXPECT_TRUE(c.push.allFinite());
      most = std::max(most, c.iterations);
    }
    EXPECT_LE(most, ContactTracker::kTickEvaluations) << hostile.name;
  }
}

// A walk round the pole passes hundreds of sides, which count besides the evaluations.
TEST(HostileMeshes, round_a_pole_count_what_a_walk_passes) {
  const PatchCache cache = test::paper_cache_of(test::fan(1000));
  QueryOptions brief;
  brief.budget = 2000;
  int least = brief.budget, unfinished = 0;
  for (int i = 0; i < 12; ++i) {
    const Contact c =
        nearest(cache, Vec3(0.1 * std::cos(i), 0.1 * std::sin(i), 0.1 + 0.1 * i), brief);
    if ((c.flags & kUnfinished) == 0) continue;
    ++unfinished;
    least = std::min(least, c.iterations);
  }
  EXPECT_GT(unfinished, 0);
  EXPECT_LT(least, brief.budget * 19 / 20);
  test::record("pole", "{} evaluations", least);
}

// Thousands of patches meet here, and the search after that takes long as well.
TEST(HostileMeshes, are_stopped_while_their_parts_are_compared) {
  struct Stop {};
  const Mesh mesh = test::crowd(30);
  int calls = 0;
  const auto build = [&](int most) {
    BuildBackend backend;
    calls = 0;
    test::PollGap gap;
    bool is_examined = false;
    backend.progress = [&](std::size_t faces) { is_examined = faces == mesh.face_count(); };
    backend.poll = [&] {
      gap.poll();
      if (is_examined && ++calls == most) throw Stop();
    };
    build_cache(mesh, {}, nullptr, backend);
    gap.expect_promised();
  };
  build(0);
  EXPECT_GT(calls, 3);
  EXPECT_THROW(build(calls), Stop);
}

// Two faces of 150 sides: each is examined many times, and sampled at 40,000 nodes for a table.
TEST(HostileMeshes, are_stopped_while_a_face_of_many_sides_is_built) {
  struct Stop {};
  const Mesh mesh = prism(150).mesh;
  for (const Level::Kind kind : {Level::kExact, Level::kTable}) {
    BuildOptions options;
    options.level.kind = kind;
    options.level.cells = 32;
    options.level.construction = Construction::kPaper;
    int calls = 0;
    const auto build = [&](int most) {
      test::PollGap gap;
      calls = 0;
      const auto engine = make_tbb_engine(1, [&] {
        gap.poll();
        if (++calls == most) throw Stop();
      });
      engine->build(mesh, options);
      gap.expect_promised();
    };
    build(0);
    EXPECT_THROW(build(calls / 2), Stop);
  }
}

// A copy adds nothing to the union that it is in: its search costs no more than that of a surface.
TEST(HostileMeshes, at_one_place_bury_nothing) {
  Mesh one = test::coincident_shells(1), many = test::coincident_shells(40);
  const PatchCache single = build_cache(one), copies = build_cache(many);
  const auto& s = std::get<1>(copies.surface);
  EXPECT_EQ(copies.patch_count(), 40 * single.patch_count());
  EXPECT_TRUE(s.part.empty());
  EXPECT_TRUE(s.partner.empty());
  for (const Vec3& hip : hips_near(single)) {
    const Contact a = nearest(single, hip), b = nearest(copies, hip);
    EXPECT_EQ(a.touching, b.touching);
    EXPECT_NEAR(a.distance, b.distance, 1e-12);
  }
  // Nor does one beside another part that all of them meet.
  const Mesh other = test::octahedron(Eigen::Matrix3d::Identity(), Vec3(0.7, 0.1, 0.2));
  const auto pairs = [](const Mesh& mesh) {
    return std::get<1>(build_cache(mesh).surface).partner.size();
  };
  EXPECT_EQ(pairs(test::joined({one, other})), 2u);
  EXPECT_EQ(pairs(test::joined({one, one, one, other})), 6u);
}

}  // namespace
}  // namespace gliss
