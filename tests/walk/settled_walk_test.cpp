// Walks beneath edges, seams, thin parts and rims: with `settle`, as trackers have it by default,
// no force leaps and no contact is lost under force, whatever the method.
#include "gliss/build/build_cache.h"
#include "gliss/generate/generate.h"
#include "gliss/surface/names.h"
#include "gliss/walk/walk.h"
#include "tests/extremes/extremes.h"
#include "tests/oracle/union_oracle.h"
#include "tests/support/lazy_tracker.h"
#include "tests/support/open_meshes.h"
#include "tests/support/sharp_meshes.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

// A surface that walks are felt on.
struct Felt {
  std::string name;
  PatchCache cache;
  Method method = Method::kGregory;
};

// Both constructions, with the mesh's creases, and the baselines, which have none.
std::vector<Felt> surfaces_of(const Mesh& mesh, const Mesh& creased) {
  std::vector<Felt> all;
  for (const Construction construction : {Construction::kFair, Construction::kPaper}) {
    BuildOptions options;
    options.level.construction = construction;
    PatchCache cache = test::unlimited_cache(creased, options);
    all.push_back({surface_name(cache.level), std::move(cache)});
  }
  for (const Method method : {Method::kShaded, Method::kFlat}) {
    all.push_back({std::string(method_name(method)),
                   build_base(mesh, build_topology(mesh), Precision::kDouble), method});
  }
  return all;
}

std::vector<Walk> paths_on(const Mesh& mesh, double depth, std::uint64_t few) {
  WalkOptions options;
  options.depth = depth;
  options.seed = 5;
  options.walkers = test::samples(few, 500'000) / options.ticks;
  return walk_paths(mesh, build_topology(mesh), options);
}

// Walks at 0.5 % and 0.1 % of the size. Adds to `leaps` the jumps without settling.
void expect_no_leap(const std::string& name, const Mesh& raw, bool has_creases,
                    std::uint64_t& leaps) {
  const Mesh mesh = test::with_normals(raw);
  for (const Felt& surface : surfaces_of(mesh, has_creases ? test::with_creases(raw) : mesh)) {
    for (const double deep : {1.0, 0.2}) {
      const double depth = deep * walk_depth(mesh);
      const std::vector<Walk> walks = paths_on(mesh, depth, 40'000);
      QueryOptions leaping{{}, surface.method};
      const QueryOptions settling = leaping;
      leaping.settle = 0;
      const FeltWalks before = feel_walks(surface.cache, leaping, walks, depth);
      const FeltWalks felt = feel_walks(surface.cache, settling, walks, depth);
      const std::string which = fmt::format("{}, {}, {} % deep", name, surface.name, 0.5 * deep);
      leaps += before.jumps();
      // A contact that has ended is gone within 5 x settle, so that a push above 5 k d fades by
      // more than a jump a tick.
      const double most = std::max(ForceStatistics::kJump * depth,
                                   0.04 * felt.largest_force + 2 * WalkOptions{}.step * depth);
      EXPECT_LE(felt.largest_step, most) << which;
      EXPECT_LE(felt.jumps(), before.jumps()) << which;
      EXPECT_EQ(felt.lost, 0u) << which;
      if (surface.method == Method::kGregory) {
        // If walks are few, one may lead along an edge, or begin deep within another part.
        EXPECT_LT(felt.settling_share(), std::getenv("GLISS_LONG_TESTS") ? 0.05 : 0.1) << which;
      }
      EXPECT_EQ(before.settling, 0u);
      test::record(which, "jumps {} and {}, largest step {:.2f} and {:.2f} k d, slides {:.2f} %",
                   before.jumps(), felt.jumps(), before.largest_step / depth,
                   felt.largest_step / depth, 100 * felt.settling_share());
    }
  }
}

TEST(SettledWalk, leaps_over_no_crease) {
  std::uint64_t leaps = 0;
  for (const auto& [name, mesh] : {std::pair("cube", cube(3, 20).mesh),
                                   {"cylinder", cylinder().mesh},
                                   {"prism", prism(5).mesh},
                                   {"L", test::l_solid()},
                                   {"notch", test::corner_solid()}})
    expect_no_leap(name, mesh, true, leaps);
  EXPECT_GT(leaps, 10u);
}

TEST(SettledWalk, leaps_over_no_seam) {
  const Mesh ball = goldberg(3, 10).mesh, box = cube(2, 16).mesh;
  std::uint64_t leaps = 0;
  for (const auto& [name, mesh] :
       {std::pair("balls", test::joined({ball, test::moved(ball, Vec3(14, 0.4, 0.3))})),
        {"boxes", test::joined({box, test::moved(box, Vec3(9, 7, 0.5))})},
        {"ball in box", test::joined({box, test::moved(ball, Vec3(8, 8.2, 9))})}})
    expect_no_leap(name, mesh, false, leaps);
  EXPECT_GT(leaps, 0u);
}

TEST(SettledWalk, leaps_in_no_thin_part_and_over_no_rim) {
  std::uint64_t leaps = 0;
  for (const auto& [name, mesh] : {std::pair("plate", thin_plate().mesh),
                                   {"fin", fin().mesh},
                                   {"sheet", test::sheet(1.5)},
                                   {"half torus", test::half_torus()}})
    expect_no_leap(name, mesh, false, leaps);
  EXPECT_GT(leaps, 0u);
}

// A tracker whose patches are built on the way feels what one feels that has them all, also where
// it slides over the rim of what is built.
TEST(SettledWalk, is_felt_alike_where_patches_are_built_on_the_way) {
  std::size_t slides = 0;
  for (const Generated& made : {fin(), thin_plate()}) {
    const Mesh mesh = test::with_normals(made.mesh);
    const PatchCache cache = build_cache(mesh);
    const double depth = walk_depth(mesh);
    for (const Walk& walk : paths_on(mesh, depth, 40'000)) {
      test::LazyTracker lazy(mesh, {.rings = 2});
      ContactTracker whole(cache, {});
      ForceStatistics felt(depth);
      for (std::size_t i = 0; i < walk.hips.size(); ++i) {
        const Contact got = lazy.tick(walk.hips[i]), want = whole.tick(walk.hips[i]);
        if (i + 1 >= Walk::kEntry) felt.add(got.touching, got.push, is_settling(got.flags));
        ASSERT_LT((got.push - want.push).norm(), 0.1 * depth) << mesh.source << " " << i;
        slides += is_settling(want.flags);
      }
      EXPECT_EQ(felt.jumps(), 0u) << mesh.source;
      EXPECT_EQ(felt.lost, 0u) << mesh.source;
    }
  }
  EXPECT_GT(slides, 100u);
}

}  // namespace
}  // namespace gliss
