// Hands in cavities of solids.
#include <gtest/gtest.h>

#include <random>

#include "gliss/build/build_cache.h"
#include "gliss/generate/generate.h"
#include "gliss/query/contact_tracker.h"
#include "gliss/query/query.h"
#include "gliss/validate/validate.h"
#include "tests/oracle/union_oracle.h"

namespace gliss {
namespace {

// A ball of 20 mm with a cavity of 15, in which there is one of 10 with a cavity of 5.
Mesh matryoshka() {
  Mesh mesh = nested_balls({20, -15, 10, -5}, 6).mesh;
  validate(mesh);
  return mesh;
}
bool is_solid(double r) { return (r < 20 && r > 15) || (r < 10 && r > 5); }

struct CavityCase {
  Precision precision;
  Level::Kind level;
  Construction construction;
};
class Cavities : public ::testing::TestWithParam<CavityCase> {
 protected:
  static PatchCache built() {
    const CavityCase& c = GetParam();
    BuildOptions options;
    options.precision = c.precision;
    options.level = {c.level, c.level == Level::kTable ? kTableCells : 0, c.construction};
    return build_cache(matryoshka(), options);
  }
};

TEST_P(Cavities, are_free_by_every_method) {
  const PatchCache cache = built();
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-22, 22);
  std::vector<Vec3> hips;
  while (hips.size() < 2000) {
    const Vec3 x(uniform(random), uniform(random), uniform(random));
    const double r = x.norm(), wall = 5 * std::round(r / 5);
    if (wall < 5 || wall > 20 || std::abs(r - wall) > 0.02 * wall) hips.push_back(x);
  }
  for (const Method method : {Method::kGregory, Method::kShaded, Method::kFlat}) {
    QueryOptions query;
    query.method = method;
    std::vector<Contact> found(hips.size());
    nearest(cache, hips, {&method, 1}, query, found);
    int wrong = 0;
    for (std::size_t i = 0; i < hips.size(); ++i)
      wrong += found[i].touching != is_solid(hips[i].norm());
    EXPECT_EQ(wrong, 0) << static_cast<int>(method);
  }
}

TEST_P(Cavities, push_a_hand_away_from_their_walls) {
  const PatchCache cache = built();
  for (const Method method : {Method::kGregory, Method::kShaded, Method::kFlat}) {
    QueryOptions query;
    query.method = method;
    ContactTracker tracker(cache, query);
    const Vec3 way = Vec3(1, 2, 3).normalized();
    // From within the outer cavity into its wall, back, and into the ball there.
    for (double r = 12.5; r < 15.5; r += 0.05) {
      const bool touches = tracker.tick(r * way).touching;
      if (std::abs(r - 15) > 0.2) {
        EXPECT_EQ(touches, r > 15) << r;
      }
    }
    EXPECT_GT(tracker.tick(15.5 * way).push.dot(-way), 0.3);
    for (double r = 15.5; r > 9.5; r -= 0.05) tracker.tick(r * way);
    EXPECT_GT(tracker.tick(9.5 * way).push.dot(way), 0.3);
  }
}

// Each of two hollow balls that overlap has its own cavity.
TEST(Cavity, belongs_to_the_solid_that_holds_all_of_it) {
  for (const double apart : {20.0, 22.0, 24.0}) {
    Mesh first = nested_balls({20, -14}, 8).mesh, second = nested_balls({24, -20}, 8).mesh;
    for (Vec3& p : second.positions) p.x() += apart;
    Mesh mesh = test::joined({first, second});
    validate(mesh);
    const PatchCache cache = build_cache(mesh);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> along(-20, apart + 24), across(-24, 24);
    int wrong = 0, judged = 0;
    while (judged < 2000) {
      const Vec3 x(along(random), across(random), across(random));
      const double r = x.norm(), q = (x - Vec3(apart, 0, 0)).norm();
      const auto near = [](double a, double b) { return std::abs(a - b) < 0.4; };
      if (near(r, 20) || near(r, 14) || near(q, 24) || near(q, 20)) continue;
      ++judged;
      const bool solid = (r < 20 && r > 14) || (q < 24 && q > 20);
      wrong += nearest(cache, x).touching != solid;
    }
    EXPECT_EQ(wrong, 0) << apart;
  }
}

// An open part that is wound inward encloses nothing: in a ball it is buried, wherever its walls
// are.
TEST(Cavity, is_closed) {
  Mesh mesh = nested_balls({20, -10}, 6).mesh;
  std::vector<std::uint32_t> begin{0}, vertex;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    double lowest = 20;
    for (std::uint32_t c = mesh.face_begin[f]; c < mesh.face_begin[f + 1]; ++c)
      lowest = std::min(lowest, mesh.positions[mesh.corner_vertex[c]].z());
    const Vec3 any = mesh.positions[mesh.corner_vertex[mesh.face_begin[f]]];
    if (any.norm() < 15 && lowest > 5) continue;
    vertex.insert(vertex.end(), mesh.corner_vertex.begin() + mesh.face_begin[f],
                  mesh.corner_vertex.begin() + mesh.face_begin[f + 1]);
    begin.push_back(static_cast<std::uint32_t>(vertex.size()));
  }
  Mesh bowl;
  bowl.positions = mesh.positions;
  bowl.face_begin = begin;
  bowl.corner_vertex = vertex;
  validate(bowl);
  const PatchCache cache = build_cache(bowl);
  for (const double z : {-9.0, -5.0, 0.0, 5.0, 9.0, 12.0}) {
    const Contact contact = nearest(cache, Vec3(0.1, 0.2, z));
    EXPECT_TRUE(contact.touching) << z;
    EXPECT_NEAR(contact.distance, Vec3(0.1, 0.2, z).norm() - 20, 0.1) << z;
  }
}

INSTANTIATE_TEST_SUITE_P(
    , Cavities,
    ::testing::Values(CavityCase{Precision::kDouble, Level::kExact, Construction::kFair},
                      CavityCase{Precision::kFloat, Level::kExact, Construction::kFair},
                      CavityCase{Precision::kDouble, Level::kTable, Construction::kFair},
                      CavityCase{Precision::kFloat, Level::kBezier, Construction::kPaper}));

}  // namespace
}  // namespace gliss
