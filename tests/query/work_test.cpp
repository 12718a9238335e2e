// Work along paths, closed loops of them, and that nearest points make no energy where force
// shading does.
#include "gliss/query/work.h"

#include <numbers>

#include "gliss/generate/generate.h"
#include "gliss/query/trace.h"
#include "gliss/walk/walk.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

Vec3 on_circle(double turns, double radius = 2) {
  const double angle = 2 * std::numbers::pi * turns;
  return radius * Vec3(std::cos(angle), std::sin(angle), 0);
}

TEST(ClosedLoops, are_found_where_a_path_comes_back_and_only_there) {
  std::vector<Vec3> path{Vec3(9, 0, 0)};  // from aside
  for (int i = 1; i < 100; ++i) path.push_back(Vec3(9 - 0.07 * i, 0, 0));
  const std::size_t first = path.size();
  for (int i = 0; i <= 400; ++i) path.push_back(on_circle(i / 200.0));  // twice round
  const std::vector<PathLoop> loops = closed_loops(path);
  ASSERT_EQ(loops.size(), 2u);
  for (const PathLoop& loop : loops) {
    EXPECT_GE(loop.begin + 1, first);
    EXPECT_NEAR(static_cast<double>(loop.end - loop.begin), 200, 2);
    EXPECT_LT((path[loop.end] - path[loop.begin]).norm(), 0.04);
  }
  EXPECT_GE(loops[1].begin, loops[0].end);
  path.resize(first + 150);
  EXPECT_TRUE(closed_loops(path).empty());
}

TEST(ClosedLoops, take_no_rest_for_one) {
  EXPECT_TRUE(closed_loops({}).empty());
  EXPECT_TRUE(closed_loops(std::vector<Vec3>(1000, Vec3(1, 2, 3))).empty());
  std::vector<Vec3> rest;
  for (int i = 0; i < 10'000; ++i) rest.push_back(Vec3(1e-6 * (i % 2), 0, 1e-6 * (i % 3)));
  EXPECT_TRUE(closed_loops(rest).empty());
  rest.push_back(Vec3::Constant(std::nan("")));
  EXPECT_TRUE(closed_loops(rest).empty());
}

TEST(LoopGain, is_all_of_the_work_of_a_whirl_and_none_of_a_spring) {
  std::vector<Vec3> path;
  for (int i = 0; i <= 300; ++i) path.push_back(on_circle(i / 300.0));
  const std::vector<PathLoop> loops = closed_loops(path);
  ASSERT_EQ(loops.size(), 1u);
  LoopMeter whirl(loops, 0), against(loops, 0), spring(loops, 3),
      line(std::span<const PathLoop>{}, 0);
  for (const Vec3& x : path) {
    whirl.add(x, Vec3(-x.y(), x.x(), 0));
    against.add(x, Vec3(x.y(), -x.x(), 0));
    spring.add(x, 3 * (Vec3(1, 1, 0) - x));
    line.add(x, x);
  }
  const double area = 4 * std::numbers::pi;
  EXPECT_NEAR(whirl.largest().gain, 1, 1e-3);
  EXPECT_LT(whirl.largest().error, 1e-3);
  EXPECT_TRUE(whirl.largest().is_certain());
  EXPECT_NEAR(whirl.work().net, 2 * area, 2e-3 * area);
  EXPECT_NEAR(against.largest().gain, -1, 1e-3);
  EXPECT_TRUE(against.largest().is_certain());
  EXPECT_NEAR(spring.largest().gain, 0, 1e-12);
  EXPECT_FALSE(spring.largest().is_certain());
  EXPECT_GT(spring.work().gross, 1);
  EXPECT_TRUE(std::isnan(line.largest().gain));
}

// Once round an inclined circle under many faces of a ball of 10 mm.
double gain_round(const PatchCache& cache, Method method, int ticks) {
  const Eigen::AngleAxisd tilt(1, Vec3(3, 2, 1).normalized());
  std::vector<Vec3> hips;
  for (int i = 0; i <= ticks; ++i)
    hips.push_back(Vec3(0.4, 0.3, 0.2) + tilt * on_circle(static_cast<double>(i) / ticks, 7.5));
  TraceOptions options;
  options.methods = {method};
  return std::abs(trace(cache, hips, options)[0].loop_gain.gain);
}

TEST(LoopGain, of_nearest_points_falls_with_the_square_of_the_step) {
  const Mesh ball = test::with_normals(goldberg(3).mesh);
  const PatchCache cache = test::cache_of(ball);
  const double coarse = gain_round(cache, Method::kGregory, 500);
  const double fine = gain_round(cache, Method::kGregory, 8000);
  EXPECT_LT(fine, 1e-5);
  EXPECT_LT(fine, coarse / 64);  // 256 but for the kinks at edges
  EXPECT_GT(gain_round(cache, Method::kShaded, 8000), 1e-4);
}

TEST(LoopGain, is_unknown_where_no_loop_stays_in_contact) {
  const Mesh ball = test::with_normals(goldberg(3).mesh);
  const PatchCache cache = test::cache_of(ball);
  const double depth = walk_depth(ball);
  auto loops = loop_paths(ball, build_topology(ball), depth, 5);
  ASSERT_FALSE(loops.empty());
  EXPECT_FALSE(std::isnan(loop_gain(cache, {}, loops).gain));
  for (auto& loop : loops) {
    for (std::size_t i = loop.size() / 4; i < loop.size() / 3; ++i)
      loop[i] += 2 * depth * loop[i].normalized();
  }
  EXPECT_TRUE(std::isnan(loop_gain(cache, {}, loops).gain));
}

TEST(LoopGain, of_nearest_points_is_nothing_on_any_generated_mesh) {
  for (const Generated& made : {torus_knot(), torus(), goldberg(), banana()}) {
    const Mesh mesh = test::with_normals(made.mesh);
    const Topology topology = build_topology(mesh);
    const double depth = walk_depth(mesh);
    const auto loops = loop_paths(mesh, topology, depth, 20);
    ASSERT_EQ(loops.size(), 20u);
    QueryOptions shaded;
    shaded.method = Method::kShaded;
    for (const Construction construction : {Construction::kPaper, Construction::kFair}) {
      BuildOptions options;
      options.level.construction = construction;
      const PatchCache cache = build_cache(mesh, topology, options);
      const LoopGain gain = loop_gain(cache, {}, loops);
      EXPECT_LT(gain.gain, 1e-6) << mesh.source;
      EXPECT_LT(gain.error, 1e-3) << mesh.source;
      const LoopGain made_up = loop_gain(cache, shaded, loops);
      EXPECT_TRUE(made_up.is_certain()) << mesh.source;
      EXPECT_GT(made_up.gain, 100 * gain.gain) << mesh.source;
    }
  }
}

}  // namespace
}  // namespace gliss
