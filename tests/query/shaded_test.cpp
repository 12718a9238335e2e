// Force shading, which Gliss is compared with, against an oracle of its own.
#include "gliss/generate/generate.h"
#include "gliss/mesh/triangulate.h"
#include "gliss/query/contact_tracker.h"
#include "tests/oracle/brute_force.h"
#include "tests/oracle/shading_oracle.h"

namespace gliss {
namespace {

using oracle::Rng, oracle::uniform;
using test::Worst;
using Exact = oracle::Polygon<long double>;
using ExactVec = oracle::Vec<long double>;

struct ShadedCase {
  std::string name;
  Mesh mesh;
  double depth;  // of the HIPs, at most; mesh's unit
};

// A star of 2 * points corners: planar, concave at every second one, normals tilted at random.
Mesh star(int points) {
  Rng rng(93);
  test::Polygon polygon;
  for (int k = 0; k < 2 * points; ++k) {
    const double angle = std::numbers::pi * k / points, radius = k % 2 ? 5 : 10;
    polygon.positions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0);
    polygon.normals.push_back(oracle::random_tilt(rng, Vec3::UnitZ(), 0.6));
  }
  Mesh mesh = test::mesh_of(polygon);
  mesh.source = "star";
  return mesh;
}

std::vector<ShadedCase> cases() {
  std::vector<ShadedCase> all;
  const auto add = [&](const std::string& name, const Mesh& mesh, double depth) {
    all.push_back({name, test::with_normals(mesh), depth});
  };
  add("knot, quads", torus_knot(60, 8).mesh, 1);
  add("irregular torus, triangles", irregular(torus(), 5).mesh, 0.5);
  add("goldberg, pentagons and hexagons", goldberg(3).mesh, 1);
  add("banana", banana().mesh, 0.5);
  add("prism of 7 sides", prism(7).mesh, 1);
  add("prism of 100 sides", prism(100).mesh, 0.1);
  add("star of 10 corners", star(5), 0.3);
  Rng rng(92);
  for (const int n : {3, 5, 9, 20})
    add(fmt::format("open polygon of {} sides", n),
        test::mesh_of(oracle::random_polygon(rng, n, 0.5, 0.03)), 0.02);
  return all;
}

// The triangles of a face that it is measured by.
std::vector<test::Triangle> triangles_of_face(const Mesh& mesh, std::uint32_t face) {
  const test::Polygon polygon = test::polygon_of(mesh, face);
  std::vector<std::uint32_t> corners;
  triangulate(polygon.positions, oracle::face_normal(polygon), corners);
  std::vector<test::Triangle> triangles;
  for (std::size_t i = 0; i < corners.size(); i += 3)
    triangles.push_back({polygon.positions[corners[i]], polygon.positions[corners[i + 1]],
                         polygon.positions[corners[i + 2]]});
  return triangles;
}

Exact exact_polygon(const Mesh& mesh, std::uint32_t face) {
  return oracle::with_unit_normals(oracle::cast<long double>(test::polygon_of(mesh, face)));
}

// A HIP beneath a random point of a random face.
Vec3 random_hip(Rng& rng, const ShadedCase& of) {
  const auto face = static_cast<std::uint32_t>(rng() % of.mesh.face_count());
  const std::vector<test::Triangle> triangles = triangles_of_face(of.mesh, face);
  const auto& [a, b, c] = triangles[rng() % triangles.size()];
  const double s = std::sqrt(uniform(rng, 0, 1)), t = uniform(rng, 0, 1);
  const Vec3 up = (b - a).cross(c - a).normalized();
  return (1 - s) * a + s * (1 - t) * b + s * t * c - uniform(rng, 0.05, 1) * of.depth * up;
}

class Shaded : public ::testing::TestWithParam<Precision> {
 protected:
  static bool is_float() { return GetParam() == Precision::kFloat; }
};
INSTANTIATE_TEST_SUITE_P(, Shaded, ::testing::Values(Precision::kDouble, Precision::kFloat),
                         [](const auto& info) {
                           return info.param == Precision::kFloat ? "float" : "double";
                         });

// Nearest and tracked alike: size of the flat force, direction of the blended normals.
TEST_P(Shaded, pushes_along_normals_blended_by_mean_values) {
  QueryOptions options;
  options.method = Method::kShaded;
  for (const ShadedCase& of : cases()) {
    // Not tamed: a face that is split would be measured as the triangles of its patches.
    const PatchCache cache = test::cache_of(of.mesh, GetParam(), false);
    const double size = test::size_of(of.mesh);
    std::vector<test::Triangle> triangles;
    for (std::uint32_t face = 0; face < of.mesh.face_count(); ++face)
      for (const test::Triangle& triangle : triangles_of_face(of.mesh, face))
        triangles.push_back(triangle);
    Rng rng(91);
    Worst distance, normal, push;
    int touching = 0, turned = 0;
    for (int i = 0; i < 1000; ++i) {
      const Vec3 hip = random_hip(rng, of);
      Contact contact = nearest(cache, hip, options);
      if (i % 2) contact = ContactTracker(cache, options).track(hip, contact.at);
      distance.add(std::abs(std::abs(contact.distance) -
                            test::nearest_by_brute_force(triangles, hip).distance) /
                   size);
      if (!contact.touching || (contact.flags & kOnBorder)) continue;
      ++touching;
      const Exact polygon = exact_polygon(of.mesh, contact.at.face);
      const ExactVec scp = contact.scp.cast<long double>(), there = hip.cast<long double>();
      const ExactVec want = oracle::shaded_push(polygon, scp, there);
      normal.add(oracle::angle<double>(contact.normal,
                                       oracle::shaded_normal(polygon, scp).cast<double>()));
      push.add((contact.push - want.cast<double>()).norm() / size);
      turned += oracle::angle<double>(contact.push, contact.scp - hip) > 0.01;
    }
    test::record(
        of.name,
        "{} touching, {} turned; distance {:.2g} of size, normal {:.2g} rad, push {:.2g} of size",
        touching, turned, distance.value, normal.value, push.value);
    EXPECT_GT(touching, 700) << of.name;
    EXPECT_GT(turned, 300) << of.name << ": the test sees shading";
    EXPECT_LE(distance.value, is_float() ? 2e-7 : 2e-15) << of.name;
    EXPECT_LE(normal.value, is_float() ? 2e-6 : 1e-14) << of.name;
    EXPECT_LE(push.value, is_float() ? 1e-7 : 1e-15) << of.name;
  }
}

// The oracle keeps its own promise: it reproduces linear functions, on sides and corners too.
TEST(ShadingOracle, reproduces_what_is_linear) {
  Rng rng(94);
  for (const int n : {3, 4, 7, 30}) {
    std::vector<oracle::Vec2<long double>> corners;
    for (int k = 0; k < n; ++k)
      corners.push_back(uniform(rng, 0.6, 1) * oracle::domain_corner<long double>(n, k));
    for (int i = 0; i < 500; ++i) {
      const auto k = static_cast<std::size_t>(rng()) % corners.size();
      const auto &a = corners[k], &b = corners[(k + 1) % corners.size()];
      const auto along = static_cast<long double>(i % 5 ? uniform(rng, 0, 1) : i % 2),
                 inside = static_cast<long double>(i % 7 ? uniform(rng, 0, 1) : 1);
      const oracle::Vec2<long double> at = inside * ((1 - along) * a + along * b);
      const std::vector<long double> lambda = oracle::mean_values(corners, at);
      oracle::Vec2<long double> back(0, 0);
      long double sum = 0;
      for (std::size_t j = 0; j < corners.size(); ++j)
        back += lambda[j] * corners[j], sum += lambda[j];
      EXPECT_LE((back - at).norm(), 1e-15L);
      EXPECT_LE(std::abs(sum - 1), 1e-17L);
    }
  }
}

}  // namespace
}  // namespace gliss
