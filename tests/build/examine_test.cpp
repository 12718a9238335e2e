// Compares what sampling finds of a patch with the oracle, at the same points and at others.
#include <Eigen/Eigenvalues>
#include <cstring>

#include "gliss/build/patch_draft.h"
#include "gliss/surface/instances.h"
#include "gliss/surface/layout.h"
#include "tests/oracle/brute_force.h"
#include "tests/support/numbers.h"

namespace gliss {
namespace {

using oracle::Rng;
using test::Polygon;

constexpr std::uint32_t kMost = 40;
using test::kInfinity;

const ValenceTables& tables() {
  static const ValenceTables all = make_valence_tables(std::vector<char>(kMost + 1, 1));
  return all;
}

FaceCorners corners_of(const Polygon& polygon) { return {polygon.positions, polygon.normals}; }

PatchDraft examined(const Polygon& polygon) {
  PatchDraft d =
      draft_patch(corners_of(polygon), all_corners(static_cast<std::uint32_t>(polygon.size())));
  d.shape = examine(d, tables());
  return d;
}

// The polygon in its patch's local frame.
Polygon local(Polygon polygon, const PatchFrame& frame) {
  for (Vec3& p : polygon.positions) p = (p - frame.origin) * frame.scale;
  return polygon;
}

Vec3 along(const PatchFrame& frame, const Vec3& p) {
  return {p.dot(frame.tangent), p.dot(frame.normal.cross(frame.tangent)), p.dot(frame.normal)};
}

double distance_to_base(const PatchDraft& d, const Vec3& p) {
  const auto corner = [&](std::size_t i) { return Vec3(&d.corner[6 * d.triangle[i]]); };
  std::vector<test::Triangle> triangles;
  for (std::size_t t = 0; t < d.triangle.size(); t += 3)
    triangles.push_back({corner(t), corner(t + 1), corner(t + 2)});
  return test::nearest_by_brute_force(triangles, p).distance;
}

// Second fundamental form of the oracle's patch, and the larger |eigenvalue| of its shape operator.
// Differences are those of the kernel: at corners the curvature depends on where it is taken.
struct Curved {
  Vec3 second_form;
  double largest = 0;
};
Curved curved(const Polygon& polygon, double xi, double eta) {
  constexpr double h = 0x1p-17;
  const auto at = [&](double x, double y) { return oracle::evaluate(polygon, x, y); };
  const auto here = at(xi, eta);
  const Vec3 n_xi = (at(xi + h, eta).normal - here.normal) / h,
             n_eta = (at(xi, eta + h).normal - here.normal) / h;
  Eigen::Matrix2d first, second;
  const double mixed = -(here.G_xi.dot(n_eta) + here.G_eta.dot(n_xi)) / 2;
  first << here.G_xi.dot(here.G_xi), here.G_xi.dot(here.G_eta), here.G_xi.dot(here.G_eta),
      here.G_eta.dot(here.G_eta);
  second << -here.G_xi.dot(n_xi), mixed, mixed, -here.G_eta.dot(n_eta);
  const Eigen::Matrix2d shape = first.inverse() * second;
  const Eigen::Vector2d eigen = shape.eigenvalues().real();
  return {{second(0, 0), second(0, 1), second(1, 1)}, eigen.cwiseAbs().maxCoeff()};
}

TEST(Examine, finds_what_the_oracle_finds_at_the_probes) {
  Rng rng(51);
  for (const int n : {3, 4, 5, 6, 7, 12, 40}) {
    SCOPED_TRACE(n);
    const auto valence = static_cast<std::uint32_t>(n);
    const Polygon polygon = oracle::random_polygon(rng, n, 0.4);
    const PatchDraft d = examined(polygon);
    double reals[kShapeReals], frame[kFrameReals];
    d.frame.store(frame);
    const std::uint32_t count = tables().probe_count[valence];
    const double *xi = tables().probes_of(valence),
                 *eta = xi + kernels<double>().probe_reals(valence) / 2;
    kernels<double>().examine(tables().domain_of(valence), xi, 0, count, d.control.data(),
                              kFormPaper, d.corner.data(), d.triangle.data(), frame, valence,
                              nullptr, nullptr, reals);
    const Polygon base = local(polygon, d.frame);
    Vec3 low = Vec3::Constant(kInfinity), high = -low, along_low = low, along_high = high;
    const auto widen = [&](const Vec3& p) {
      low = low.cwiseMin(p), high = high.cwiseMax(p);
      along_low = along_low.cwiseMin(along(d.frame, p));
      along_high = along_high.cwiseMax(along(d.frame, p));
    };
    for (const Vec3& p : base.positions) widen(p);
    double turn = 1, curvature = 0, stretch2 = 0, sag = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto s = oracle::evaluate(base, xi[i], eta[i]);
      widen(s.G);
      turn = std::min(turn, s.normal.dot(d.frame.normal));
      stretch2 = std::max({stretch2, s.G_xi.squaredNorm(), s.G_eta.squaredNorm()});
      sag = std::max(sag, distance_to_base(d, s.G));
      curvature = std::max(curvature, curved(base, xi[i], eta[i]).largest);
    }
    const auto triple = [&](std::size_t at) { return Vec3(reals + at); };
    EXPECT_LE((triple(kShapeLow) - low).norm(), 1e-12);
    EXPECT_LE((triple(kShapeHigh) - high).norm(), 1e-12);
    EXPECT_LE((triple(kShapeAlongLow) - along_low).norm(), 1e-12);
    EXPECT_LE((triple(kShapeAlongHigh) - along_high).norm(), 1e-12);
    EXPECT_NEAR(reals[kShapeLeastCosine], turn, 1e-9);
    EXPECT_NEAR(reals[kShapeStretch2], stretch2, 1e-9 * stretch2);
    EXPECT_NEAR(std::sqrt(reals[kShapeSag2]), sag, 1e-9);
    EXPECT_LE((triple(kShapeSecondForm) - curved(base, 0, 0).second_form).norm(), 1e-6);
    EXPECT_NEAR(reals[kShapeCurvature], curvature, 1e-6 * (1 + curvature));
    EXPECT_EQ(reals[kShapeFinite], 1);
  }
}

TEST(Examine, a_patch_of_a_sphere_has_its_radius) {
  Polygon polygon;
  for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
    polygon.normals.push_back(Vec3(0.1 * x, 0.1 * y, 1).normalized());
    polygon.positions.push_back(5 * polygon.normals.back());
  }
  const PatchDraft d = examined(polygon);
  EXPECT_NEAR(d.shape.rho_min / d.frame.scale, 5, 0.25);  // a patch is not the sphere itself
  EXPECT_NEAR(d.shape.least_cosine, polygon.normals[0].z(), 1e-3);
}

TEST(Examine, bounds_hold_between_the_probes) {
  Rng rng(52);
  for (int i = 0; i < 40; ++i) {
    const int n = 3 + i % 6;
    const Polygon polygon = oracle::random_polygon(rng, n, 0.6);
    const PatchDraft d = examined(polygon);
    const Polygon base = local(polygon, d.frame);
    const PatchShape& s = d.shape;
    for (const auto& X : oracle::sample_domain<double>(n, 40)) {
      const Vec3 p = oracle::evaluate(base, X.x(), X.y()).G, q = along(d.frame, p);
      ASSERT_TRUE((p.array() >= s.box.low.array()).all() &&
                  (p.array() <= s.box.high.array()).all());
      ASSERT_TRUE((q.array() >= s.low.array()).all() && (q.array() <= s.high.array()).all());
      ASSERT_LE(distance_to_base(d, p), s.sag);
    }
  }
}

TEST(Examine, what_is_not_finite_is_folded_and_leaves_no_nan) {
  Rng rng(53);
  const PatchDraft sound = examined(oracle::random_polygon(rng, 4, 0.3));
  ASSERT_FALSE(is_folded(sound.shape));
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), kInfinity, -kInfinity}) {
    for (const std::size_t at : {std::size_t{0}, std::size_t{14}, 3 * kSideReals + kSideLength}) {
      PatchDraft d = sound;
      d.control[at] = bad;
      const PatchShape s = examine(d, tables());
      EXPECT_TRUE(is_folded(s)) << bad << " at " << at;
      EXPECT_TRUE(s.second_form.allFinite());
      EXPECT_FALSE(s.low.hasNaN() || s.high.hasNaN() || s.box.low.hasNaN() || s.box.high.hasNaN());
      EXPECT_FALSE(std::isnan(s.sag) || std::isnan(s.rho_min));
    }
  }
}

TEST(Examine, no_probes_leave_the_base_polygon) {
  Rng rng(54);
  const PatchDraft d = examined(oracle::random_polygon(rng, 5, 0.3));
  double frame[kFrameReals], reals[kShapeReals];
  d.frame.store(frame);
  kernels<double>().examine(nullptr, nullptr, 0, 0, nullptr, kFormPaper, d.corner.data(),
                            d.triangle.data(), frame, 5, nullptr, nullptr, reals);
  Vec3 low = Vec3::Constant(kInfinity), high = -low;
  for (std::size_t k = 0; k < 5; ++k) {
    low = low.cwiseMin(Vec3(&d.corner[6 * k]));
    high = high.cwiseMax(Vec3(&d.corner[6 * k]));
  }
  const PatchShape s = shape_from(reals);
  EXPECT_EQ(s.box.low, low);
  EXPECT_EQ(s.box.high, high);
  EXPECT_EQ(s.sag, 0);
}

// A batch of all valences gives each patch what it has by itself.
TEST(PatchBatch, agrees_with_single_drafts) {
  Rng rng(55);
  std::vector<PatchDraft> drafts;
  std::vector<std::uint32_t> valences;
  for (int i = 0; i < 150; ++i) {
    drafts.push_back(examined(oracle::random_polygon(rng, 3 + i % 38, 0.5)));
    valences.push_back(drafts.back().valence());
  }
  PatchBatch b;
  b.tables = &tables();
  b.resize(valences, std::vector<std::uint32_t>(valences.size(), kFormPaper));
  b.to_build = b.size();
  for (std::size_t p = 0; p < b.size(); ++p) {
    const PatchDraft& d = drafts[p];
    std::copy(d.corner.begin(), d.corner.end(), &b.corner[6 * b.side_begin[p]]);
    std::copy(d.triangle.begin(), d.triangle.end(), &b.triangle[3 * b.first_triangle(p)]);
    d.frame.store(&b.frame[p * kFrameReals]);
  }
  build_patches(b, serial_for);
  for (std::size_t p = 0; p < b.size(); ++p) {
    const PatchDraft& d = drafts[p];
    EXPECT_EQ(b.soundness[p], d.soundness);
    EXPECT_EQ(std::memcmp(&b.control[b.control_begin[p]], d.control.data(),
                          d.control.size() * sizeof(double)),
              0);
  }
}

}  // namespace
}  // namespace gliss
