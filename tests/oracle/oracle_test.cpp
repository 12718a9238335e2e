// The oracle against the golden patches and against what the paper promises of its surface.
#include "tests/oracle/oracle.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string>

#include "tests/support/places.h"
#include "tests/support/points.h"

namespace gliss::oracle {
namespace {

Vec<double> vec(const nlohmann::json& j) {
  return {j[0].get<double>(), j[1].get<double>(), j[2].get<double>()};
}

void expect_golden(std::ifstream file) {
  const nlohmann::json golden = nlohmann::json::parse(file);
  ASSERT_FALSE(golden["patches"].empty());

  double worst_G = 0, worst_slope = 0, worst_normal = 0, worst_C = 0, worst_T = 0, worst_dT = 0;
  for (const auto& patch : golden["patches"]) {
    Polygon<double> polygon;
    for (const auto& p : patch["positions"]) polygon.positions.push_back(vec(p));
    for (const auto& m : patch["normals"]) polygon.normals.push_back(vec(m));
    ASSERT_EQ(polygon.size(), patch["n"].get<int>());
    // They are stored rounded; the golden values were computed from unit normals.
    polygon = with_unit_normals(polygon);
    const double size = size_of(polygon);
    const auto keep_worst = [](double& worst, const Vec<double>& got, const nlohmann::json& want,
                               double unit) {
      const double error = (got - vec(want)).norm() / unit;
      if (!(error <= worst)) worst = error;  // keeps a NaN
    };
    for (std::size_t i = 0; i < patch["xi_eta"].size(); ++i) {
      const auto& X = patch["xi_eta"][i];
      const Sample<double> s = evaluate(polygon, X[0].get<double>(), X[1].get<double>());
      keep_worst(worst_G, s.G, patch["G"][i], size);
      keep_worst(worst_slope, s.G_xi, patch["G_xi"][i], size);
      keep_worst(worst_slope, s.G_eta, patch["G_eta"][i], size);
      keep_worst(worst_normal, s.normal, patch["normal"][i], 1);
    }
    for (int k = 0; k < polygon.size(); ++k) {
      const auto& edge = patch["edges"][static_cast<std::size_t>(k)];
      for (std::size_t i = 0; i < patch["t"].size(); ++i) {
        const Side<double> s = side(polygon, k, patch["t"][i].get<double>());
        keep_worst(worst_C, s.C, edge["C"][i], size);
        keep_worst(worst_C, s.dC, edge["dC"][i], size);
        keep_worst(worst_T, s.T, edge["T"][i], size);
        keep_worst(worst_dT, s.dT, edge["dT"][i], size);
      }
    }
  }
  EXPECT_LT(worst_G, 1e-11);
  EXPECT_LT(worst_slope, 1e-11);
  EXPECT_LT(worst_normal, 1e-11);
  EXPECT_LT(worst_C, 1e-11);
  EXPECT_LT(worst_T, 1e-11);
  EXPECT_LT(worst_dT, 1e-11);
  const auto record = [](const char* name, double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.2g", value);
    ::testing::Test::RecordProperty(name, text);
  };
  record("worst_G", worst_G);
  record("worst_slope", worst_slope);
  record("worst_normal", worst_normal);
  record("worst_C", worst_C);
  record("worst_T", worst_T);
  record("worst_dT", worst_dT);
}

TEST(Oracle, agrees_with_the_golden_patches) {
  expect_golden(std::ifstream(std::string(test::kTests) + "/oracle/golden.json"));
}

TEST(Oracle, agrees_with_further_golden_patches) {
  std::ifstream file(std::string(test::kShared) + "/golden/patches.json");
  if (!file) GTEST_SKIP() << "skipped: ../shared is absent";
  expect_golden(std::move(file));
}

TEST(Oracle, WeightsSumToOneAndAreExactAtCorners) {
  Rng rng(1);
  for (int n : {3, 4, 5, 6, 16, 100, 480, 1000}) {
    for (int i = 0; i < 20; ++i) {
      const Vec2<double> X = random_inside<double>(rng, n);
      const std::vector<double> w = weights(n, X.x(), X.y());
      EXPECT_NEAR(std::accumulate(w.begin(), w.end(), 0.0), 1, 1e-14) << n;
      EXPECT_TRUE(std::all_of(w.begin(), w.end(), [](double x) { return x >= 0; })) << n;
    }
    for (int k : {0, 1, n / 2, n - 1}) {
      const Vec2<double> corner = domain_corner(n, k);
      EXPECT_EQ(weights(n, corner.x(), corner.y())[static_cast<std::size_t>(k)], 1) << n;
    }
  }
}

// A second road to (5): w_k / w_l = (d_{l-1} d_l / (d_{k-1} d_k))^2, as every other factor cancels.
TEST(Oracle, WeightsOfManySidesHaveTheRightRatios) {
  Rng rng(2);
  for (int n : {72, 480, 1000}) {
    const Vec2<double> X = random_inside<double>(rng, n);
    const auto product = [&](int k) {
      return side_distance(n, k - 1, X.x(), X.y()).value * side_distance(n, k, X.x(), X.y()).value;
    };
    long double sum = 0;
    for (int k = 0; k < n; ++k) sum += std::pow(product(k), -2.0L);
    const std::vector<double> w = weights(n, X.x(), X.y());
    for (int k = 0; k < n; ++k) {
      const double expected = static_cast<double>(std::pow(product(k), -2.0L) / sum);
      EXPECT_NEAR(w[static_cast<std::size_t>(k)], expected, 1e-15 * (1 + expected));
    }
  }
}

// On side k the patch is C_k(t), runs along it at C_k'(t), and has n_c as its normal.
TEST(Oracle, PatchInterpolatesItsBoundary) {
  Rng rng(3);
  for (int n = 3; n <= 12; ++n) {
    const Polygon<double> polygon = random_polygon(rng, n, 40 * kDegree);
    const double size = size_of(polygon);
    for (int k = 0; k < n; ++k) {
      for (double t : {0.0, 1e-9, 0.3, 0.5, 0.9, 1.0}) {
        const Vec2<double> X = on_side(n, k, t);
        const Vec2<double> along = domain_corner(n, k + 1) - domain_corner(n, k);
        const Sample<double> s = evaluate(polygon, X.x(), X.y());
        const Side<double> expected = side(polygon, k, t);
        EXPECT_LT((s.G - expected.C).norm(), 1e-14 * size) << n << " " << k << " " << t;
        EXPECT_LT((s.G_xi * along.x() + s.G_eta * along.y() - expected.dC).norm(), 1e-13 * size)
            << n << " " << k << " " << t;
        EXPECT_LT(angle(s.normal, expected.n_c), 1e-12) << n << " " << k << " " << t;
      }
      EXPECT_LT(angle(side(polygon, k, 0).n_c, polygon.normal(k)), 1e-14);
      EXPECT_LT(angle(side(polygon, k, 1).n_c, polygon.normal(k + 1)), 1e-14);
    }
  }
}

TEST(Oracle, CrossTangentsEndInTheNeighbouringSides) {
  Rng rng(4);
  for (int n = 3; n <= 12; ++n) {
    const Polygon<double> polygon = random_polygon(rng, n, 60 * kDegree);
    for (int k = 0; k < n; ++k) {
      EXPECT_LT((side(polygon, k, 0).T + side(polygon, k - 1, 1).dC).norm(), 1e-14);
      EXPECT_LT((side(polygon, k, 1).T - side(polygon, k + 1, 0).dC).norm(), 1e-14);
    }
  }
}

TEST(Oracle, NormalsAgreeAcrossASharedEdge) {
  Rng rng(5);
  for (int i = 0; i < 60; ++i) {
    const int n = 3 + i % 6, m = 3 + i / 6 % 6, k = i % n;
    const Polygon<double> a = random_polygon(rng, n, 40 * kDegree);
    const Polygon<double> b = random_neighbour(rng, a, k, m, 40 * kDegree);
    for (double t : {0.0, 1e-6, 0.25, 0.5, 0.8, 1.0}) {
      const Vec2<double> X = on_side(n, k, t), Y = on_side(m, 0, 1 - t);
      const Sample<double> left = evaluate(a, X.x(), X.y()), right = evaluate(b, Y.x(), Y.y());
      EXPECT_LT((left.G - right.G).norm(), 1e-14 * size_of(a));
      EXPECT_LT(angle(left.normal, right.normal), 1e-9) << n << " " << m << " " << t;
    }
  }
}

TEST(Oracle, DerivativesAreThoseOfCentralDifferences) {
  using S = long double;
  Rng rng(6);
  const S h = 1e-6L;
  for (int n : {3, 4, 5, 8, 16}) {
    const auto polygon = random_polygon<S>(rng, n, 40 * kDegree);
    for (int i = 0; i < 10; ++i) {
      const Vec2<S> X = random_inside<S>(rng, n);
      const auto G = [&](S xi, S eta) { return evaluate(polygon, xi, eta).G; };
      const Sample<S> s = evaluate(polygon, X.x(), X.y());
      const Vec<S> by_xi = (G(X.x() + h, X.y()) - G(X.x() - h, X.y())) / (2 * h);
      const Vec<S> by_eta = (G(X.x(), X.y() + h) - G(X.x(), X.y() - h)) / (2 * h);
      EXPECT_LT((s.G_xi - by_xi).norm(), 1e-8L) << n;
      EXPECT_LT((s.G_eta - by_eta).norm(), 1e-8L) << n;

      const S t = static_cast<S>(uniform(rng, 0, 1));
      const Side<S> a = side(polygon, i % n, t - h), b = side(polygon, i % n, t + h);
      EXPECT_LT((side(polygon, i % n, t).dC - (b.C - a.C) / (2 * h)).norm(), 1e-10L) << n;
      EXPECT_LT((side(polygon, i % n, t).dT - (b.T - a.T) / (2 * h)).norm(), 1e-8L) << n;
    }
  }
}

TEST(Oracle, StaysFiniteUpToAThousandSides) {
  Rng rng(7);
  for (int n : {64, 300, 1000}) {
    const Polygon<double> polygon = random_polygon(rng, n, 20 * kDegree);
    const Vec2<double> corner = domain_corner(n, 1), middle = on_side(n, 2, 0.5);
    const Vec2<double> centre(0, 0), near_side = 0.999999 * middle;
    for (const Vec2<double>& X : {centre, corner, middle, near_side}) {
      const Sample<double> s = evaluate(polygon, X.x(), X.y());
      EXPECT_TRUE(s.G.allFinite() && s.G_xi.allFinite() && s.G_eta.allFinite()) << n;
      EXPECT_NEAR(s.normal.norm(), 1, 1e-12) << n;
    }
    EXPECT_LT((evaluate(polygon, corner.x(), corner.y()).G - polygon.position(1)).norm(), 1e-14);
    EXPECT_LT((evaluate(polygon, middle.x(), middle.y()).G - side(polygon, 2, 0.5).C).norm(),
              1e-14);
  }
}

// G - d n has its nearest point at G, as d is below the radius of curvature.
TEST(Oracle, NearestFindsTheFootOfAnOffsetPoint) {
  Rng rng(8);
  for (int n : {3, 4, 6}) {
    const Polygon<double> polygon = random_polygon(rng, n, 20 * kDegree, 0.1);
    for (double d : {0.02, -0.02}) {
      const Vec2<double> X = 0.8 * random_inside<double>(rng, n);
      const Sample<double> s = evaluate(polygon, X.x(), X.y());
      const Nearest<double> found = nearest(polygon, s.G - d * s.normal, 8, 2);
      EXPECT_LT((Vec2<double>(found.xi, found.eta) - X).norm(), 1e-12) << n;
      EXPECT_NEAR(found.distance, std::abs(d), 1e-13) << n;
      EXPECT_LT((found.G - s.G).norm(), 1e-12) << n;
    }
  }
}

// Beyond a side the foot lies on that side, and the way to it is square to the side.
TEST(Oracle, NearestStopsAtTheBoundary) {
  Rng rng(9);
  for (int n : {3, 5}) {
    const Polygon<double> polygon = random_polygon(rng, n, 20 * kDegree, 0.1);
    const Side<double> s = side(polygon, 1, 0.4);
    const Vec<double> outward = s.dC.cross(s.n_c).normalized();
    const Nearest<double> found = nearest(polygon, s.C + 0.03 * outward, 8, 2);
    EXPECT_LT((Vec2<double>(found.xi, found.eta) - on_side(n, 1, 0.4)).norm(), 1e-12) << n;
    EXPECT_NEAR(found.distance, 0.03, 1e-13) << n;

    const Vec<double> centre =
        std::accumulate(polygon.positions.begin(), polygon.positions.end(), Vec<double>(0, 0, 0)) /
        n;
    const Vec<double> away = polygon.position(2) - centre;
    const Nearest<double> corner = nearest(polygon, polygon.position(2) + away, 8, 2);
    EXPECT_LT((corner.G - polygon.position(2)).norm(), 1e-14) << n;
    EXPECT_LT(corner.residual, 1e-14) << n;
  }
}

}  // namespace
}  // namespace gliss::oracle
