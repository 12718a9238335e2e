// Polygons that fold over their neighbours: their winding number says what is inside.
#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "gliss/build/build_cache.h"
#include "gliss/generate/generate.h"
#include "gliss/mesh/solid_angle.h"
#include "gliss/mesh/triangulate.h"
#include "gliss/query/contact_tracker.h"
#include "gliss/query/query.h"
#include "gliss/surface/winding.h"
#include "tests/support/sharp_meshes.h"

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

// A flat star whose rim is as sharp as a knife: its other end is half as large.
Mesh knife() {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> inner(6, 16);
  std::vector<Vec3> top, bottom;
  for (int k = 0; k < 10; ++k) {
    const double angle = std::numbers::pi * k / 5, radius = k % 2 == 0 ? inner(random) : kBall;
    const Vec3 at(radius * std::cos(angle), radius * std::sin(angle), 0);
    top.push_back(at + Vec3(0, 0, 0.2));
    bottom.push_back(0.5 * at - Vec3(0, 0, 0.2));
  }
  return test::with_creases(test::prism_between(top, bottom), {.angle = 75 * test::kDegree});
}

// How often the polygons go round x: 0 or 1 and more.
bool is_inside(const std::vector<Vec3>& triangles, const Vec3& x) {
  double angle = 0;
  for (std::size_t i = 0; i < triangles.size(); i += 3)
    angle += solid_angle(triangles[i] - x, triangles[i + 1] - x, triangles[i + 2] - x);
  return angle > 2 * std::numbers::pi;
}

// HIPs whose state is not that of the polygons, of those that lie between no patch and its polygon.
int wrong_of(const PatchCache& cache, const WindingTree& tree, const Mesh& mesh, Method method) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-25, 25);
  const std::vector<Vec3> triangles = triangles_of(mesh);
  int wrong = 0, judged = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vec3 x(uniform(random), uniform(random), uniform(random));
    QueryOptions query;
    query.method = method;
    const Contact c = nearest(cache, x, query);
    if (method == Method::kGregory ? tree.may_be_between((x - cache.origin) * cache.scale,
                                                         std::abs(c.distance) * cache.scale)
                                   : std::abs(c.distance) < 1e-4)
      continue;
    ++judged;
    wrong += c.touching != is_inside(triangles, x);
    if (c.touching) {
      EXPECT_GT((c.scp - x).dot(c.normal), 0);
      EXPECT_NEAR((c.push - (c.scp - x)).norm(), 0, 1e-4);
    }
  }
  EXPECT_GT(judged, 3000);
  return wrong;
}

class Winding : public ::testing::TestWithParam<Precision> {};
INSTANTIATE_TEST_SUITE_P(, Winding, ::testing::Values(Precision::kFloat, Precision::kDouble));

// ... and mirrored over their neighbours: the farther they go, the more patches depart.
Mesh mirrored_ball() {
  Mesh mesh = folded_ball(0);
  for (std::uint32_t face = 49; face < mesh.face_count(); face += 300) {
    const std::uint32_t* v = &mesh.corner_vertex[mesh.face_begin[face]];
    mesh.positions[v[0]] = 2 * mesh.positions[v[1]] - mesh.positions[v[0]];
  }
  return mesh;
}

// The winding number decides where patches close a wedge of polygons as well.
TEST_P(Winding, says_what_is_inside_of_faces_that_fold) {
  BuildOptions options;
  options.precision = GetParam();
  for (const Mesh& mesh : {folded_ball(4), mirrored_ball(), knife()}) {
    const PatchCache cache = build_cache(mesh, options);
    ASSERT_NE(cache.winding, nullptr);
    PatchCache without = cache;
    without.winding = nullptr;
    EXPECT_GT(wrong_of(without, *cache.winding, mesh, Method::kGregory), 0);
    EXPECT_EQ(wrong_of(cache, *cache.winding, mesh, Method::kGregory), 0);
    EXPECT_EQ(wrong_of(cache, *cache.winding, mesh, Method::kFlat), 0);
  }
}

Mesh without_face(const Mesh& mesh, std::uint32_t face) {
  Mesh open = mesh;
  const auto begin = open.corner_vertex.begin() + mesh.face_begin[face],
             end = open.corner_vertex.begin() + mesh.face_begin[face + 1];
  open.corner_vertex.erase(begin, end);
  open.face_begin.erase(open.face_begin.begin() + face);
  for (std::size_t f = face; f < open.face_begin.size(); ++f)
    open.face_begin[f] -= mesh.valence(face);
  return open;
}

// A hole and a stray face say nothing of the rest.
TEST_P(Winding, says_it_beside_a_hole_and_an_open_part) {
  BuildOptions options;
  options.precision = GetParam();
  const Mesh folded = folded_ball(4);
  Mesh stray = test::joined({folded, test::moved(folded_ball(0), Vec3(100, 0, 0))});
  for (auto f = static_cast<std::uint32_t>(stray.face_count()); --f > folded.face_count();)
    stray = without_face(stray, f);
  for (const auto& [mesh, face] :
       {std::pair{without_face(folded, 300), 300u}, std::pair{stray, ~0u}}) {
    const PatchCache cache = build_cache(mesh, options);
    ASSERT_FALSE(cache.open.empty());
    ASSERT_NE(cache.winding, nullptr);
    const std::vector<Vec3> triangles = triangles_of(folded);
    std::mt19937 random(2);
    std::uniform_real_distribution<double> uniform(-25, 25);
    int wrong = 0;
    for (int i = 0; i < 2000; ++i) {
      const Vec3 x(uniform(random), uniform(random), uniform(random));
      QueryOptions query;
      query.method = Method::kFlat;
      const Contact c = nearest(cache, x, query);
      if (!(c.flags & kOnBorder) && std::abs(c.distance) > 1e-4)
        wrong += c.touching != is_inside(triangles, x);
    }
    EXPECT_EQ(wrong, 0) << face;
  }
}

// Half a ball is the skin of what is behind it, however far.
TEST_P(Winding, leaves_open_parts_with_large_holes_as_they_are) {
  BuildOptions options;
  options.precision = GetParam();
  Mesh half = folded_ball(4);
  for (auto f = static_cast<std::uint32_t>(half.face_count()); f-- > 0;) {
    if (half.positions[half.corner_vertex[half.face_begin[f]]].z() < 0)
      half = without_face(half, f);
  }
  EXPECT_EQ(build_cache(half, options).winding, nullptr);
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
  EXPECT_EQ(build_cache(without_face(folded_ball(0), 7), options).winding, nullptr);
  EXPECT_EQ(build_cache(fin().mesh, options).winding, nullptr);
  EXPECT_EQ(build_cache(thin_plate().mesh, options).winding, nullptr);
}

}  // namespace
}  // namespace gliss
