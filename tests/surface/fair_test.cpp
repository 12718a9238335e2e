// The fair construction: its triangles and its polygons of more sides against the oracle, smooth
// across every edge, and as curved as what they stand for.
#include "tests/oracle/fair_oracle.h"

#include <cstring>

#include "gliss/generate/generate.h"
#include "gliss/mesh/regions.h"
#include "gliss/mesh/sectors.h"
#include "gliss/validate/validate.h"
#include "tests/support/patch_errors.h"
#include "tests/support/random_meshes.h"
#include "tests/support/sharp_meshes.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using oracle::Rng;
using test::at, test::Vec2, test::Worst;

PatchCache fair_cache(const Mesh& mesh, Precision precision = Precision::kDouble, bool tame = true,
                      BuildReport* report = nullptr) {
  BuildOptions options;
  options.precision = precision;
  options.tame = tame;
  options.level.construction = Construction::kFair;
  return test::unlimited_cache(mesh, options, report);
}

// Meshes that meet every branch of the construction, and the share of their triangles that may
// fold.
struct FairCase {
  std::string name;
  Mesh mesh;
  double folded = 0;
};
std::vector<FairCase> cases() {
  Rng rng(19);
  std::vector<FairCase> made;
  const auto add = [&](const std::string& name, Mesh mesh, double folded) {
    validate(mesh, {.creases = {.none = true}});
    made.push_back({name, std::move(mesh), folded});
  };
  add("sheet", test::random_sheet(rng, {}), 0);
  add("noisy sheet", test::random_sheet(rng, {.tilt = 0.3}), 0.05);
  add("steep sheet", test::random_sheet(rng, {.wave = 1.5, .tilt = 0.6}), 0.5);
  add("sphere", test::random_sphere(rng, 60, 10), 0);
  add("noisy sphere", test::random_sphere(rng, 60, 10, 0.5), 0.05);
  add("torus", test::random_torus(rng, 150, 10, 4), 0.05);
  add("mixed sheet", test::random_sheet(rng, {.tilt = 0.2, .has_quads = true}), 0.05);
  add("steep mixed sheet", test::random_sheet(rng, {.wave = 1.2, .tilt = 0.5, .has_quads = true}),
      0.2);
  add("shaken mixed sheet",
      test::random_sheet(rng, {.shake = 0.6, .wave = 0.3, .tilt = 0.1, .has_quads = true}), 0.3);
  add("seam", test::random_sheet(rng, {.tilt = 0.1, .has_seam = true}), 0.05);
  add("dart", test::random_sheet(rng, {.tilt = 0.1, .has_dart = true}), 0.05);
  add("another steep sheet", test::random_sheet(rng, {.wave = 1.5, .tilt = 0.6}), 0.5);
  return made;
}

class FairTest : public ::testing::TestWithParam<Precision> {
 protected:
  static bool is_float() { return GetParam() == Precision::kFloat; }
  static Vec2 held(const Vec2& X) { return is_float() ? X.cast<float>().cast<double>() : X; }
};
INSTANTIATE_TEST_SUITE_P(, FairTest, ::testing::Values(Precision::kDouble, Precision::kFloat),
                         [](const auto& info) {
                           return info.param == Precision::kFloat ? "float" : "double";
                         });

// Points inside, near sides, on sides and on corners.
std::vector<Vec2> points_of_polygon(Rng& rng, int n) {
  std::vector<Vec2> points{Vec2::Zero()};
  for (int i = 0; i < 12; ++i) points.push_back(oracle::random_inside<double>(rng, n));
  for (int k = 0; k < n; ++k) {
    points.push_back(oracle::domain_corner(n, k));
    for (const double t : {1e-9, 0.25, 0.5, oracle::uniform(rng, 0, 1)})
      points.push_back(oracle::on_side(n, k, t));
    for (const double inward : {1e-12, 1e-6, 1e-3}) {
      points.push_back((1 - inward) * oracle::on_side(n, k, oracle::uniform(rng, 0, 1)));
      points.push_back((1 - inward) * oracle::domain_corner(n, k));
    }
  }
  return points;
}
std::vector<Vec2> points_of_triangle(Rng& rng) { return points_of_polygon(rng, 3); }

TEST_P(FairTest, triangles_agree_with_the_oracle) {
  const double bound = is_float() ? 1e-6 : 1e-11;
  Rng rng(20);
  oracle::FairClamps all;
  for (const FairCase& c : cases()) {
    const Topology topology = build_topology(c.mesh);
    const oracle::Fair fair(c.mesh, topology);
    const PatchCache cache = fair_cache(c.mesh, GetParam(), false);
    test::Errors errors;
    int triangles = 0, folded = 0;
    for (std::uint32_t f = 0; f < c.mesh.face_count(); ++f) {
      if (c.mesh.valence(f) != 3) continue;
      ++triangles;
      if (cache.folded[cache.first_patch(f)] != 0) {
        ++folded;
        continue;
      }
      const double size = oracle::size_of(test::polygon_of(c.mesh, f));
      for (const Vec2& X : points_of_triangle(rng)) {
        const Vec2 Y = held(X);
        errors.add(at(cache, f, Y), fair.evaluate(f, Y), size);
      }
    }
    EXPECT_GT(triangles, 50) << c.name;
    EXPECT_LE(folded, c.folded * triangles) << c.name;
    errors.expect_below(bound, bound, bound, c.name);
    all += fair.clamps();
  }
  // Every branch was met.
  EXPECT_GE(std::min(all.curvature, all.twist), 5);
}

TEST_P(FairTest, polygons_agree_with_the_oracle) {
  Rng rng(28);
  for (const int n : {5, 6, 7, 8, 12, 31}) {
    // u loses n^2 roundings of the distances.
    const double bound = (is_float() ? 2e-6 : 1e-11) * (n > 12 ? 10 : 1);
    test::Errors errors;
    int judged = 0;
    for (int i = 0; i < 8; ++i) {
      const auto polygon = oracle::with_unit_normals(oracle::random_polygon(rng, n, 0.3));
      const Mesh mesh = test::mesh_of(polygon);
      const Topology topology = build_topology(mesh);
      const oracle::Fair fair(mesh, topology);
      const PatchCache cache = fair_cache(mesh, GetParam(), false);
      if (cache.folded[0] != 0) continue;
      ++judged;
      for (const Vec2& X : points_of_polygon(rng, n)) {
        const Vec2 Y = held(X);
        errors.add(at(cache, 0, Y), fair.evaluate(0, Y), oracle::size_of(polygon));
      }
    }
    EXPECT_GE(judged, 4) << n;
    errors.expect_below(bound, bound, bound, fmt::format("{} sides", n));
  }
}

TEST_P(FairTest, corners_have_the_normals_of_their_vertices) {
  Worst position, normal;
  for (const FairCase& c : cases()) {
    const PatchCache cache = fair_cache(c.mesh, GetParam());
    const double size = test::size_of(c.mesh);
    for (std::uint32_t f = 0; f < c.mesh.face_count(); ++f) {
      if (test::kind_of(cache, f) == PatchKind::kBent) continue;
      const test::Polygon polygon = test::polygon_of(c.mesh, f);
      for (int k = 0; k < polygon.size(); ++k) {
        const SurfacePoint got = at(cache, f, oracle::domain_corner(polygon.size(), k));
        position.add((got.position - polygon.position(k)).norm() / size);
        normal.add(oracle::angle<double>(got.normal, polygon.normal(k)));
      }
    }
  }
  EXPECT_LE(position.value, is_float() ? 3e-7 : 2e-15);
  EXPECT_LE(normal.value, is_float() ? 1e-5 : 1e-12);
  test::record("corners", "position {:.2g}, normal {:.2g}", position.value, normal.value);
}

// ---- Across edges -------------------------------------------------------------------------------

constexpr int kFairPointsPerEdge = 15;

// Edges by what meets there, and the largest angle between the normals of both sides, rad.
struct Met {
  int edges = 0;
  Worst angle;
};
struct FairCrossing {
  Met triangles, quad, pentagon, tamed, seam;
  Worst gap;  // relative to the size of the mesh
  int bent = 0;
};

FairCrossing cross_fair_edges(const Mesh& mesh, const PatchCache& cache) {
  const Topology topology = build_topology(mesh);
  std::vector<double> forward, backward;
  for (int i = 0; i < kFairPointsPerEdge; ++i) {
    forward.push_back(i / (kFairPointsPerEdge - 1.0));
    backward.push_back(1 - forward.back());
  }
  FairCrossing result;
  test::for_each_inner_edge(topology, [&](std::uint32_t side, std::uint32_t twin) {
    const std::uint32_t faces[] = {topology.side_face[side], topology.side_face[twin]};
    bool tamed = false, bent = false;
    std::uint32_t most = 0;
    for (const std::uint32_t f : faces) {
      tamed = tamed || test::kind_of(cache, f) != PatchKind::kPlain;
      bent = bent || test::kind_of(cache, f) == PatchKind::kBent;
      most = std::max(most, mesh.valence(f));
    }
    const auto a = test::along_side(cache, mesh, topology, side, forward);
    const auto b = test::along_side(cache, mesh, topology, twin, backward);
    const bool seam = !shares_normals(mesh, topology, side);
    Met& met = seam        ? result.seam
               : tamed     ? result.tamed
               : most == 3 ? result.triangles
               : most == 4 ? result.quad
                           : result.pentagon;
    if (bent)
      ++result.bent;
    else
      ++met.edges;
    for (std::size_t i = 0; i < a.size(); ++i) {
      // Both sides of a seam have curves of their own (7): only the ends meet.
      if (seam && i != 0 && i + 1 != a.size()) continue;
      result.gap.add((a[i].position - b[i].position).norm() / test::size_of(mesh));
      if (!bent) met.angle.add(oracle::angle<double>(a[i].normal, b[i].normal));
    }
  });
  return result;
}

TEST_P(FairTest, normals_agree_across_every_edge) {
  const double bound = is_float() ? 1e-5 : 1e-10;
  FairCrossing all;
  int bent = 0;
  std::uint32_t eased = 0, split = 0;
  for (const FairCase& c : cases()) {
    BuildReport report;
    const FairCrossing found =
        cross_fair_edges(c.mesh, fair_cache(c.mesh, GetParam(), true, &report));
    EXPECT_LE(found.gap.value, is_float() ? 1e-6 : 1e-12) << c.name;
    for (const auto part : {&FairCrossing::triangles, &FairCrossing::quad, &FairCrossing::pentagon,
                            &FairCrossing::tamed}) {
      EXPECT_LE((found.*part).angle.value, bound) << c.name;
      (all.*part).edges += (found.*part).edges;
      (all.*part).angle.add((found.*part).angle.value);
    }
    all.gap.add(found.gap.value);
    bent += found.bent;
    eased += report.eased, split += report.split;
  }
  // Each kind of edge was met.
  EXPECT_GT(all.triangles.edges, 500);
  EXPECT_GT(all.quad.edges, 20);
  EXPECT_GE(all.pentagon.edges, 4);
  EXPECT_GT(all.tamed.edges, 5);
  test::record("edges",
               "gap {:.2g}; triangles {} {:.2g}, quad {} {:.2g}, pentagon {} {:.2g}, "
               "tamed {} {:.2g} ({} eased, {} split); bent {}",
               all.gap.value, all.triangles.edges, all.triangles.angle.value, all.quad.edges,
               all.quad.angle.value, all.pentagon.edges, all.pentagon.angle.value, all.tamed.edges,
               all.tamed.angle.value, eased, split, bent);
}

// A seam that ends inside the mesh is felt along its sides alone.
TEST_P(FairTest, a_dart_is_smooth_beyond_its_seam) {
  for (const bool has_quads : {false, true}) {
    Rng rng(27);
    const Mesh mesh =
        test::random_sheet(rng, {.cells = 9, .has_quads = has_quads, .has_dart = true});
    const FairCrossing found = cross_fair_edges(mesh, fair_cache(mesh, GetParam()));
    const double bound = is_float() ? 1e-5 : 1e-10;
    EXPECT_LE(found.triangles.angle.value, bound);
    EXPECT_LE(found.quad.angle.value, bound);
    EXPECT_LE(found.gap.value, is_float() ? 1e-6 : 1e-12);
    EXPECT_EQ(found.bent, 0);
    EXPECT_GT(found.triangles.edges, 100);
    EXPECT_EQ(found.seam.edges, 4);
    EXPECT_GT(found.seam.angle.value, 0.3);
    test::record(has_quads ? "dart, mixed" : "dart",
                 "gap {:.2g}; triangles {} {:.2g}, quad {} {:.2g}", found.gap.value,
                 found.triangles.edges, found.triangles.angle.value, found.quad.edges,
                 found.quad.angle.value);
  }
}

// ---- At vertices --------------------------------------------------------------------------------

// The distance of the turn of the normal along the sides at vertices from what the shape operators
// there say, relative to these: along a side, its normal curvature, and across it, its twist.
struct Residual {
  Worst curvature, twist;
  int sides = 0;
};
Residual residual_at_vertices(const Mesh& mesh, const Topology& topology, const PatchCache& cache,
                              const oracle::Fair& fair) {
  const double h = 1e-3;
  Residual residual;
  for (std::uint32_t s = 0; s < mesh.corner_vertex.size(); ++s) {
    if (!fair.side(s).has_shape || fair.side(s).is_clamped) continue;
    const auto p = test::along_side(cache, mesh, topology, s, {0, h, 2 * h, 3 * h, 4 * h});
    // One-sided differences along the side, exact up to the fourth power.
    const auto slope = [&](auto of) {
      return Vec3((-25 * of(p[0]) + 48 * of(p[1]) - 36 * of(p[2]) + 16 * of(p[3]) - 3 * of(p[4])) /
                  (12 * h));
    };
    const Vec3 d = slope([](const SurfacePoint& q) { return q.position; });
    const Vec3 turn = slope([](const SurfacePoint& q) { return q.normal; }) / d.norm();
    const Vec3 t = d.normalized(), b = p[0].normal.cross(t);
    const Eigen::Matrix3d S = fair.shape(mesh.corner_vertex[s])->cast<double>();
    residual.curvature.add(std::abs(t.dot(turn - S * t)) / S.norm());
    residual.twist.add(std::abs(b.dot(turn - S * t)) / S.norm());
    ++residual.sides;
  }
  return residual;
}

TEST(Fair, sides_at_a_vertex_have_its_second_fundamental_form) {
  for (const double tilt : {0.0, 0.1}) {
    Rng rng(21);
    const Mesh mesh = test::random_sheet(rng, {.cells = 9, .tilt = tilt});
    const Topology topology = build_topology(mesh);
    const oracle::Fair fair(mesh, topology);
    const Residual own = residual_at_vertices(mesh, topology, fair_cache(mesh), fair);
    const Residual paper = residual_at_vertices(mesh, topology, test::paper_cache_of(mesh), fair);
    EXPECT_GT(own.sides, 400);
    EXPECT_LE(own.curvature.value, 1e-8);
    EXPECT_LE(own.twist.value, 1e-8);
    EXPECT_GE(paper.curvature.value, 0.1);  // the test sees a difference
    EXPECT_GE(paper.twist.value, 0.5);
    test::record(fmt::format("second fundamental form, tilt {}", tilt),
                 "curvature {:.2g}, twist {:.2g}; paper {:.2g}, {:.2g}", own.curvature.value,
                 own.twist.value, paper.curvature.value, paper.twist.value);
  }
}

// ---- Known shapes -------------------------------------------------------------------------------

// Curvatures over the true one.
struct Curvatures {
  double median, p99, largest;
};
Curvatures curvatures_of(const PatchCache& cache, double radius) {
  std::vector<double> ratio;
  for (std::uint32_t p = 0; p < cache.patch_count(); ++p)
    ratio.push_back(radius / cache.rho_min[p]);
  std::sort(ratio.begin(), ratio.end());
  return {ratio[ratio.size() / 2], ratio[ratio.size() * 99 / 100], ratio.back()};
}

// Slivers of irregular() reach far more than others.
constexpr Curvatures kSphere{1.02, 1.05, 1.10}, kTorus{1.05, 1.3, 2}, kEllipsoid{1.05, 1.3, 2},
    kCylinder{1.02, 1.05, 1.10}, kIrregular{1.05, 3.5, 120}, kTorusOwn{1.2, 2, 5};

void record(const std::string& name, const Curvatures& fair, const Curvatures& paper) {
  test::record(name, "{:.3g} / {:.3g} / {:.3g}; paper {:.3g} / {:.3g} / {:.3g}", fair.median,
               fair.p99, fair.largest, paper.median, paper.p99, paper.largest);
}

// Faces that lie in a plane with all their normals, beside others that bend away from it.
TEST(Fair, flat_faces_stay_flat_beside_bends) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    Rng rng(seed);
    Mesh mesh = test::random_sheet(rng, {.cells = 10, .wave = 0, .has_quads = seed == 3});
    mesh.normals.clear();
    mesh.corner_normal.clear();
    for (Vec3& p : mesh.positions) p.z() = 0.15 * std::pow(std::max(0.0, p.x() - 5), 2);
    const PatchCache cache = fair_cache(mesh);
    const Mesh made = test::with_normals(mesh);
    std::size_t flat = 0;
    double tilt = 0, height = 0;
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
      bool is_flat = true;
      for (std::uint32_t c = mesh.face_begin[f]; c < mesh.face_begin[f + 1]; ++c) {
        const Vec3& n = made.normals[made.corner_normal[c]];
        is_flat = is_flat && mesh.positions[mesh.corner_vertex[c]].z() == 0 &&
                  std::hypot(n.x(), n.y()) < 1e-9;
      }
      if (!is_flat) continue;
      ++flat;
      for (int i = 0; i < 20; ++i) {
        const SurfacePoint p =
            at(cache, f, oracle::random_inside<double>(rng, static_cast<int>(mesh.valence(f))));
        tilt = std::max(tilt, std::hypot(p.normal.x(), p.normal.y()));
        height = std::max(height, std::abs(p.position.z()));
      }
    }
    EXPECT_GE(flat, 50u);
    EXPECT_LE(tilt, 1e-9) << seed;
    EXPECT_LE(height, 1e-9) << seed;
  }
}

TEST(Fair, random_spheres_are_as_curved_as_spheres) {
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
    Rng rng(seed);
    const Mesh mesh = test::random_sphere(rng, 400, 10);
    const Curvatures fair = curvatures_of(fair_cache(mesh), 10);
    const Curvatures paper = curvatures_of(test::paper_cache_of(mesh), 10);
    EXPECT_LE(fair.median, kSphere.median);
    EXPECT_LE(fair.p99, kSphere.p99);
    EXPECT_LE(fair.largest, kSphere.largest);
    EXPECT_GE(paper.p99, 50 * fair.p99);
    record(fmt::format("sphere {}", seed), fair, paper);
  }
}

TEST(Fair, pentagons_and_hexagons_of_spheres_are_as_curved_as_spheres) {
  for (const int frequency : {2, 4}) {
    const Mesh mesh = goldberg(frequency, 10).mesh;
    const Curvatures fair = curvatures_of(fair_cache(mesh), 10);
    const Curvatures paper = curvatures_of(test::paper_cache_of(mesh), 10);
    EXPECT_LE(fair.largest, frequency == 2 ? 1.2 : 1.1);
    EXPECT_GE(paper.median, 2.7);
    record(fmt::format("goldberg {}", frequency), fair, paper);
  }
}

TEST(Fair, random_tori_are_hardly_more_curved_than_tori) {
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
    Rng rng(seed);
    const Mesh mesh = test::random_torus(rng, 500, 10, 4);
    const Curvatures fair = curvatures_of(fair_cache(mesh), 4);
    const Curvatures paper = curvatures_of(test::paper_cache_of(mesh), 4);
    EXPECT_LE(fair.median, kTorus.median);
    EXPECT_LE(fair.p99, kTorus.p99);
    EXPECT_LE(fair.largest, kTorus.largest);
    EXPECT_GE(paper.p99, 50 * fair.p99);
    record(fmt::format("torus {}", seed), fair, paper);

    Mesh own = mesh;  // makes its normals by itself
    own.normals.clear();
    own.corner_normal.clear();
    const Curvatures fair_own = curvatures_of(fair_cache(own), 4);
    EXPECT_LE(fair_own.p99, kTorusOwn.p99);
    EXPECT_LE(fair_own.largest, kTorusOwn.largest);
    record(fmt::format("torus {}, own normals", seed), fair_own,
           curvatures_of(test::paper_cache_of(own), 4));
  }
}

// Curvatures over the largest true one at points of the patch, for patches of triangles.
template <class TrueCurvature>
Curvatures curvatures_of(const Mesh& mesh, const PatchCache& cache, TrueCurvature true_curvature) {
  Rng rng(5);
  std::vector<double> ratio;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    if (mesh.valence(f) != 3) continue;
    double there = 0;
    for (const Vec2& X : points_of_triangle(rng))
      there = std::max(there, true_curvature(at(cache, f, X).position));
    for (std::uint32_t p = cache.first_patch(f);
         p < cache.patch_count() && cache.patch_face[p] == f; ++p)
      ratio.push_back(1 / (cache.rho_min[p] * there));
  }
  std::sort(ratio.begin(), ratio.end());
  return {ratio[ratio.size() / 2], ratio[ratio.size() * 99 / 100], ratio.back()};
}

// The largest of the ellipsoid with these half axes, near a point of it: that of the Hessian of its
// function in the tangent plane, over the length of the gradient.
double ellipsoid_curvature(const Vec3& half, const Vec3& on) {
  const Vec3 weights = half.cwiseAbs2().cwiseInverse(), gradient = on.cwiseProduct(weights);
  const Vec3 n = gradient.normalized(), a = n.unitOrthogonal(), b = n.cross(a);
  const auto second = [&](const Vec3& u, const Vec3& v) { return u.dot(weights.cwiseProduct(v)); };
  const double aa = second(a, a), ab = second(a, b), bb = second(b, b);
  return ((aa + bb) / 2 + std::hypot((aa - bb) / 2, ab)) / gradient.norm();
}

const Vec3 kHalfAxes(20, 12, 8);
double on_ellipsoid(const Vec3& x) { return ellipsoid_curvature(kHalfAxes, x); }
double on_cylinder(const Vec3&) { return 0.1; }

void expect_hardly_more_curved(const std::string& name, const Mesh& mesh,
                               double (*true_curvature)(const Vec3&), const Curvatures& most) {
  const Curvatures fair = curvatures_of(mesh, fair_cache(mesh), true_curvature);
  const Curvatures paper = curvatures_of(mesh, test::paper_cache_of(mesh), true_curvature);
  EXPECT_LE(fair.median, most.median);
  EXPECT_LE(fair.p99, most.p99);
  EXPECT_LE(fair.largest, most.largest);
  EXPECT_GE(paper.p99, 50 * fair.p99);
  record(name, fair, paper);
}

TEST(Fair, random_ellipsoids_and_cylinders_are_hardly_more_curved_than_these) {
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
    Rng rng(seed);
    expect_hardly_more_curved(fmt::format("ellipsoid {}", seed),
                              test::random_ellipsoid(rng, 400, kHalfAxes), on_ellipsoid,
                              kEllipsoid);
    expect_hardly_more_curved(fmt::format("cylinder {}", seed),
                              test::random_cylinder(rng, 400, 10, 40), on_cylinder, kCylinder);
  }
}

// The points of gliss generate --irregular fall as near to each other as they will.
TEST(Fair, irregular_ellipsoids_and_cylinders_are_curved_as_these_but_for_slivers) {
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
    expect_hardly_more_curved(fmt::format("irregular ellipsoid {}", seed),
                              irregular(ellipsoid(6, 40, 24, 16), seed).mesh, on_ellipsoid,
                              kIrregular);
    expect_hardly_more_curved(fmt::format("irregular cylinder {}", seed),
                              irregular(cylinder(24, 16, 10, 40), seed).mesh, on_cylinder,
                              kIrregular);
  }
}

// Root mean square of the error of the push to a surface's nearest points over the depth, of HIPs
// beneath the vertices of a dense mesh of the shape.
double error_of_force(const PatchCache& cache, const Mesh& dense, double depth) {
  double sum = 0;
  for (std::size_t c = 0; c < dense.corner_vertex.size(); ++c) {
    const Vec3 hip =
        dense.positions[dense.corner_vertex[c]] - depth * dense.normals[dense.corner_normal[c]];
    const Vec3 push = nearest(cache, hip).scp - hip;
    sum += (push - depth * dense.normals[dense.corner_normal[c]]).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(dense.corner_vertex.size())) / depth;
}

// The aim is half of the paper's, with the shape's normals and with those that each construction
// makes by itself.
TEST(Fair, force_beneath_random_shapes_errs_half_as_much_as_the_papers) {
  struct Shape {
    const char* name;
    Generated coarse, dense;
  };
  for (const Shape& shape :
       {Shape{"torus", torus(), torus(60, 25)}, Shape{"ellipsoid", ellipsoid(), ellipsoid(7)},
        Shape{"sphere", goldberg(), goldberg(7)}}) {
    for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
      Mesh mesh = irregular(shape.coarse, seed).mesh;
      for (const bool exact : {true, false}) {
        if (!exact) {
          mesh.normals.clear();
          mesh.corner_normal.clear();
        }
        const double fair = error_of_force(fair_cache(mesh), shape.dense.mesh, 1);
        const double paper = error_of_force(test::paper_cache_of(mesh), shape.dense.mesh, 1);
        EXPECT_LE(fair, 0.5 * paper) << shape.name << ' ' << seed << ' ' << exact;
        test::record(
            fmt::format("force, {} {}, {} normals", shape.name, seed, exact ? "exact" : "own"),
            "{:.3g}; paper {:.3g}; {:.2f} of it", fair, paper, fair / paper);
      }
    }
  }
}

// ---- Order ----------------------------------------------------------------------------------

// With exact normals the distance falls with the length of sides by its fourth power, the angle to
// the true normal by its third: between a mesh and one of half that length.
TEST(Fair, triangles_leave_smooth_shapes_by_the_fourth_power_and_normals_by_the_third) {
  const auto errors = [](const Generated& shape) {
    Mesh mesh = test::in_triangles(shape.mesh);
    mesh.normals = shape.mesh.normals;
    mesh.corner_normal = mesh.corner_vertex;
    const PatchCache cache = fair_cache(mesh);
    Rng rng(24);
    double distance = 0, turn = 0;
    int count = 0;
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
      for (int i = 0; i < 20; ++i, ++count) {
        const SurfacePoint p = at(cache, f, oracle::random_inside<double>(rng, 3));
        const ExactSurface::Point truth = shape.exact->nearest(p.position);
        distance += truth.distance * truth.distance;
        turn += truth.normal.cross(p.normal).squaredNorm();
      }
    }
    return std::array{std::sqrt(distance / count), std::sqrt(turn / count)};
  };
  for (const auto& [name, coarse, fine] :
       {std::tuple{"torus", torus(30, 14), torus(60, 28)},
        std::tuple{"knot", torus_knot(136, 10), torus_knot(272, 20)}}) {
    const auto a = errors(coarse), b = errors(fine);
    const double distance = std::log2(a[0] / b[0]), normals = std::log2(a[1] / b[1]);
    EXPECT_GT(distance, 3.6) << name;
    EXPECT_GT(normals, 2.7) << name;
    test::record(name, "distance by h^{:.2f}, normals by h^{:.2f}", distance, normals);
  }
}

// ---- Invariance ---------------------------------------------------------------------------------

// Points of every face of both caches.
template <class Visit>
void for_points(const Mesh& mesh, const PatchCache& a, const PatchCache& b, Visit visit) {
  Rng rng(22);
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const int n = static_cast<int>(mesh.valence(f));
    for (int i = 0; i < 6; ++i) {
      const Vec2 X = i < 3 ? oracle::on_side(n, i, oracle::uniform(rng, 0, 1))
                           : oracle::random_inside<double>(rng, n);
      visit(f, at(a, f, X), at(b, f, X));
    }
  }
}

TEST(Fair, rigid_motions_move_the_surface) {
  Rng rng(23);
  const Mesh mesh = test::random_sheet(rng, {.tilt = 0.2, .has_quads = true});
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(oracle::uniform(rng, 0, 6), oracle::random_unit(rng)).toRotationMatrix();
  const Vec3 shift(3, -8, 5);
  Mesh moved = mesh;
  for (Vec3& p : moved.positions) p = turn * p + shift;
  for (Vec3& n : moved.normals) n = (turn * n).normalized();
  Worst position, slope;
  for_points(mesh, fair_cache(mesh), fair_cache(moved),
             [&](std::uint32_t, const SurfacePoint& a, const SurfacePoint& b) {
               position.add((b.position - turn * a.position - shift).norm());
               slope.add((b.d_xi - turn * a.d_xi).norm());
             });
  EXPECT_LE(position.value, 1e-12);
  EXPECT_LE(slope.value, 1e-12);
  test::record("moved", "position {:.2g}, slope {:.2g}", position.value, slope.value);
}

bool same_bits(const Vec3& a, const Vec3& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

TEST_P(FairTest, powers_of_two_scale_every_bit) {
  Rng rng(24);
  const Mesh mesh = test::random_sheet(rng, {.tilt = 0.3, .has_quads = true});
  const PatchCache cache = fair_cache(mesh, GetParam());
  for (const int power : {-90, -1, 1, 60}) {
    const double scale = std::ldexp(1.0, power);
    Mesh scaled = mesh;
    for (Vec3& p : scaled.positions) p *= scale;
    bool same = true;
    for_points(mesh, cache, fair_cache(scaled, GetParam()),
               [&](std::uint32_t, const SurfacePoint& a, const SurfacePoint& b) {
                 same = same && same_bits(scale * a.position, b.position) &&
                        same_bits(scale * a.d_xi, b.d_xi) && same_bits(a.normal, b.normal);
               });
    EXPECT_TRUE(same) << "2^" << power;
  }
}

// Vertices in another order: an edge runs the other way, and a face begins at another corner.
TEST(Fair, the_order_of_vertices_does_not_matter) {
  Rng rng(25);
  const Mesh mesh = test::random_sheet(rng, {.tilt = 0.3, .has_quads = true});
  Mesh reversed = mesh;
  std::reverse(reversed.positions.begin(), reversed.positions.end());
  std::reverse(reversed.normals.begin(), reversed.normals.end());
  const auto last = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  for (std::uint32_t& v : reversed.corner_vertex) v = last - v;
  for (std::uint32_t& n : reversed.corner_normal) n = last - n;
  Worst position;
  for_points(mesh, fair_cache(mesh), fair_cache(reversed),
             [&](std::uint32_t, const SurfacePoint& a, const SurfacePoint& b) {
               position.add((b.position - a.position).norm());
             });
  EXPECT_LE(position.value, 1e-12);
  test::record("reversed order", "position {:.2g}", position.value);
}

TEST_P(FairTest, a_region_has_the_bytes_of_the_whole) {
  Rng rng(26);
  Mesh mesh = test::random_sheet(rng, {.cells = 9, .wave = 1.0, .tilt = 0.4, .has_quads = true});
  const Topology topology = build_topology(mesh);
  const PatchCache whole = fair_cache(mesh, GetParam());
  for (const std::uint32_t centre : {0u, 40u, 90u}) {
    BuildOptions options;
    options.precision = GetParam();
    options.level.construction = Construction::kFair;
    options.faces = faces_around(mesh, topology, {&centre, 1}, 2);
    options.like = &whole;
    ASSERT_LT(options.faces.size(), mesh.face_count() / 2);
    const PatchCache region = test::unlimited_cache(mesh, options);
    for (const std::uint32_t f : options.faces) {
      EXPECT_EQ(test::kind_of(region, f), test::kind_of(whole, f));
      EXPECT_EQ(region.rho_min[region.first_patch(f)], whole.rho_min[whole.first_patch(f)]);
      for (int i = 0; i < 8; ++i) {
        const Vec2 X = oracle::random_inside<double>(rng, static_cast<int>(mesh.valence(f)));
        const SurfacePoint a = at(whole, f, X), b = at(region, f, X);
        EXPECT_EQ(std::memcmp(&a, &b, sizeof a), 0) << "face " << f;
      }
    }
  }
}

}  // namespace
}  // namespace gliss
