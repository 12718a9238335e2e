// Polygons that fold over their neighbours: their winding number says what is inside.
#include <gtest/gtest.h>

#include <random>

#include "gliss/build/build_cache.h"
#include "gliss/generate/generate.h"
#include "gliss/query/contact_tracker.h"
#include "gliss/query/query.h"
#include "gliss/surface/winding.h"

namespace gliss {
namespace {

constexpr double kBall = 20;  // mm

// A ball of triangles, some vertices of which have slid over their neighbours.
Mesh folded_ball(int slid) {
  Mesh mesh = irregular(goldberg(6, kBall), 3).mesh;
  mesh.normals.clear();
  mesh.corner_normal.clear();
  for (int i = 0; i < slid; ++i) {
    const std::uint32_t face = 100 * static_cast<std::uint32_t>(i) + 50,
                        corner = mesh.face_begin[face];
    Vec3& vertex = mesh.positions[mesh.corner_vertex[corner]];
    const Vec3 other = mesh.positions[mesh.corner_vertex[corner + 1]];
    vertex = kBall * (vertex + 2 * (other - vertex)).normalized();
  }
  return mesh;
}

// HIPs whose state differs from the ball's, of those that patches cannot reach.
int wrong_of(const PatchCache& cache, Method method) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-25, 25);
  int wrong = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vec3 x(uniform(random), uniform(random), uniform(random));
    if (std::abs(x.norm() - kBall) < 2) continue;
    QueryOptions query;
    query.method = method;
    const Contact c = nearest(cache, x, query);
    wrong += c.touching != (x.norm() < kBall);
    if (c.touching) {
      EXPECT_GT((c.scp - x).dot(c.normal), 0);
      EXPECT_NEAR((c.push - (c.scp - x)).norm(), 0, 1e-4);
    }
  }
  return wrong;
}

class Winding : public ::testing::TestWithParam<Precision> {};
INSTANTIATE_TEST_SUITE_P(, Winding, ::testing::Values(Precision::kFloat, Precision::kDouble));

TEST_P(Winding, says_what_is_inside_of_faces_that_fold) {
  BuildOptions options;
  options.precision = GetParam();
  const PatchCache cache = build_cache(folded_ball(4), options);
  ASSERT_NE(cache.winding, nullptr);
  PatchCache without = cache;
  without.winding = nullptr;
  EXPECT_GT(wrong_of(without, Method::kGregory), 0);
  EXPECT_EQ(wrong_of(cache, Method::kGregory), 0);
  EXPECT_EQ(wrong_of(cache, Method::kFlat), 0);
}

TEST_P(Winding, lets_a_hand_begin_inside) {
  BuildOptions options;
  options.precision = GetParam();
  const PatchCache cache = build_cache(folded_ball(4), options);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-18, 18);
  for (int i = 0; i < 300; ++i) {
    const Vec3 x(uniform(random), uniform(random), uniform(random));
    if (x.norm() > 18) continue;
    ContactTracker tracker(cache, {});
    EXPECT_TRUE(tracker.tick(x).touching);
    EXPECT_TRUE(tracker.tick(x + Vec3(0.01, 0, 0)).touching);
  }
}

TEST_P(Winding, is_not_asked_where_nothing_folds) {
  BuildOptions options;
  options.precision = GetParam();
  EXPECT_EQ(build_cache(folded_ball(0), options).winding, nullptr);
  EXPECT_EQ(build_cache(fin().mesh, options).winding, nullptr);
  EXPECT_EQ(build_cache(thin_plate().mesh, options).winding, nullptr);
}

}  // namespace
}  // namespace gliss
