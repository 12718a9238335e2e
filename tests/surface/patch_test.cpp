// The patch of a single face against the golden patches, which tests/oracle/golden.py made, and the
// oracle.
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/patch_errors.h"

namespace gliss {
namespace {

using oracle::Rng;
using test::at, test::paper_cache_of, test::Errors, test::Polygon, test::Vec2, test::Worst;

class PatchTest : public ::testing::TestWithParam<Precision> {
 protected:
  static bool is_float() { return GetParam() == Precision::kFloat; }
  static double bound() { return is_float() ? 5e-6 : 1e-11; }
  // Directions lose n roundings, for sides are 6 / n of the size; and slopes are up to n / 12 of
  // it.
  static double normal_bound(int n) {
    return n <= 32 ? bound() : std::max(bound(), n * (is_float() ? 0x1p-24 : 0x1p-53));
  }
  static double slope_bound(int n) { return std::max(bound(), n / 48.0 * normal_bound(n)); }
  static void expect_golden(std::ifstream file);
  // A point as the cache's precision holds it: what it rounds away is the caller's loss.
  static Vec2 held(const Vec2& X) { return is_float() ? X.cast<float>().cast<double>() : X; }
};
INSTANTIATE_TEST_SUITE_P(, PatchTest, ::testing::Values(Precision::kDouble, Precision::kFloat),
                         [](const auto& info) {
                           return info.param == Precision::kFloat ? "float" : "double";
                         });

Vec3 vec(const nlohmann::json& j) {
  return {j[0].get<double>(), j[1].get<double>(), j[2].get<double>()};
}

void PatchTest::expect_golden(std::ifstream file) {
  Errors errors;
  Worst curve;
  const nlohmann::json patches = nlohmann::json::parse(file)["patches"];
  ASSERT_GE(patches.size(), 8u);
  for (const auto& golden : patches) {
    Polygon polygon;
    for (const auto& p : golden["positions"]) polygon.positions.push_back(vec(p));
    for (const auto& n : golden["normals"]) polygon.normals.push_back(vec(n).normalized());
    const double size = oracle::size_of(polygon);
    const PatchCache cache = paper_cache_of(test::mesh_of(polygon), GetParam(), false);
    for (std::size_t i = 0; i < golden["xi_eta"].size(); ++i) {
      const Vec2 X(golden["xi_eta"][i][0].get<double>(), golden["xi_eta"][i][1].get<double>());
      const oracle::Sample<double> want{vec(golden["G"][i]), vec(golden["G_xi"][i]),
                                        vec(golden["G_eta"][i]), vec(golden["normal"][i])};
      errors.add(at(cache, 0, X), want, size);
    }
    const int n = polygon.size();
    for (int k = 0; k < n; ++k) {
      const auto& edge = golden["edges"][static_cast<std::size_t>(k)];
      const Vec2 along = oracle::domain_corner(n, k + 1) - oracle::domain_corner(n, k);
      for (std::size_t i = 0; i < golden["t"].size(); ++i) {
        const double t = golden["t"][i].get<double>();
        const SurfacePoint got = at(cache, 0, oracle::on_side(n, k, t));
        const Vec3 slope = along.x() * got.d_xi + along.y() * got.d_eta;
        curve.add((got.position - vec(edge["C"][i])).norm() / size);
        curve.add((slope - vec(edge["dC"][i])).norm() / size);
      }
    }
  }
  errors.expect_below(bound(), bound(), bound(), "golden patches");
  EXPECT_LE(curve.value, bound());
}

TEST_P(PatchTest, agrees_with_the_golden_patches) {
  expect_golden(std::ifstream(std::string(test::kTests) + "/oracle/golden.json"));
}

TEST_P(PatchTest, agrees_with_further_golden_patches) {
  std::ifstream file(test::shared_path("golden/patches.json"));
  if (!file) GTEST_SKIP() << "skipped: ../shared is absent";
  expect_golden(std::move(file));
}

// Normals tilted by no more than what a corner, which turns by 2 pi / n, bears without a fold.
Polygon random_polygon(Rng& rng, int n) {
  const double tilt = std::min(55 * oracle::kDegree, 0.6 * std::sqrt(2 * std::numbers::pi / n));
  return oracle::with_unit_normals(oracle::random_polygon(rng, n, tilt));
}

// Points inside, near sides, on sides and on corners.
std::vector<Vec2> points_of_domain(Rng& rng, int n) {
  const int sides = std::min(n, n > 100 ? 6 : 24), stride = n / sides;
  std::vector<Vec2> points{Vec2::Zero()};
  for (int i = 0; i < 40; ++i) points.push_back(oracle::random_inside<double>(rng, n));
  for (int i = 0; i < sides; ++i) {
    const int k = i * stride;
    points.push_back(oracle::domain_corner(n, k));
    for (const double t : {1e-9, 0.25, 0.5, oracle::uniform(rng, 0, 1), 1 - 1e-9}) {
      points.push_back(oracle::on_side(n, k, t));
    }
    for (const double inward : {1e-12, 1e-6, 1e-3}) {
      points.push_back((1 - inward) * oracle::on_side(n, k, oracle::uniform(rng, 0, 1)));
      points.push_back((1 - inward) * oracle::domain_corner(n, k));
    }
  }
  return points;
}

TEST_P(PatchTest, agrees_with_the_oracle_for_3_to_1000_sides) {
  Rng rng(7);
  std::vector<int> sides{32, 64, 100, 256, 1000};
  for (int n = 3; n <= 20; ++n) sides.push_back(n);
  for (const int n : sides) {
    Errors errors;
    for (int i = 0; i < (n > 20 ? 1 : 4); ++i) {
      const Polygon polygon = random_polygon(rng, n);
      const PatchCache cache = paper_cache_of(test::mesh_of(polygon), GetParam(), false);
      const auto exact = oracle::cast<long double>(polygon);
      for (const Vec2& X : points_of_domain(rng, n)) {
        const Vec2 Y = held(X);
        errors.add(at(cache, 0, Y), oracle::evaluate(exact, Y), 2);
      }
    }
    errors.expect_below(bound(), slope_bound(n), normal_bound(n), fmt::format("{} sides", n));
  }
}

TEST_P(PatchTest, interpolates_corners) {
  Rng rng(8);
  Worst position, normal;
  for (const int n : {3, 4, 5, 6, 12, 32}) {
    const Polygon polygon = random_polygon(rng, n);
    const PatchCache cache = paper_cache_of(test::mesh_of(polygon), GetParam(), false);
    for (int k = 0; k < n; ++k) {
      const SurfacePoint got = at(cache, 0, oracle::domain_corner(n, k));
      position.add((got.position - polygon.position(k)).norm() / 2);
      normal.add(oracle::angle<double>(got.normal, polygon.normal(k)));
    }
  }
  EXPECT_LE(position.value, is_float() ? 3e-7 : 2e-15);
  EXPECT_LE(normal.value, is_float() ? 1e-5 : 1e-13);
  test::record("corners", "position {:.2g}, normal {:.2g}", position.value, normal.value);
}

TEST_P(PatchTest, lanes_give_the_same_bits_as_one_point_at_a_time) {
  Rng rng(9);
  for (const int n : {3, 4, 5, 9, 17, 100}) {
    const Polygon polygon = random_polygon(rng, n);
    const PatchCache cache = paper_cache_of(test::mesh_of(polygon), GetParam(), false);
    std::vector<DomainPoint> at;
    for (const Vec2& X : points_of_domain(rng, n)) at.push_back({0, X.x(), X.y()});
    // Every length up to 40, so that every remainder of every lane count is met.
    for (std::size_t count = 1; count <= 40; ++count) {
      std::vector<SurfacePoint> many(count);
      evaluate(cache, std::span(at).first(count), many);
      for (std::size_t i = 0; i < count; ++i) {
        const SurfacePoint one = evaluate(cache, at[i]);
        ASSERT_EQ(std::memcmp(&one, &many[i], sizeof one), 0) << n << " sides, point " << i;
      }
    }
  }
}

TEST(Domain, holds_its_boundary_and_nothing_outside) {
  Rng rng(11);
  for (const int n : {3, 4, 7, 1000}) {
    const PatchCache cache = paper_cache_of(test::mesh_of(random_polygon(rng, n)));
    for (int k = 0; k < n; ++k) {
      const Vec2 corner = oracle::domain_corner(n, k), middle = oracle::on_side(n, k, 0.5);
      EXPECT_TRUE(in_domain(cache, {0, corner.x(), corner.y()}));
      EXPECT_TRUE(in_domain(cache, {0, middle.x(), middle.y()}));
      EXPECT_FALSE(in_domain(cache, {0, 1.001 * middle.x(), 1.001 * middle.y()}));
    }
    EXPECT_FALSE(in_domain(cache, {1, 0, 0}));
    EXPECT_FALSE(in_domain(cache, {0, std::nan(""), 0}));
  }
}

}  // namespace
}  // namespace gliss
