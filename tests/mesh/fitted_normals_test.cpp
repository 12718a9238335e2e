// Normals of meshes without: those of quadrics where the surface is smooth.
#include "gliss/mesh/fitted_normals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "gliss/generate/generate.h"
#include "gliss/mesh/creases.h"
#include "gliss/mesh/topology.h"
#include "tests/support/sharp_meshes.h"

namespace gliss {
namespace {

using test::kDegree;

// Root mean square of the angles between two sets of normals, rad.
double apart(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    sum += std::pow(2 * std::asin((a[i] - b[i]).norm() / 2), 2);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

// The exact normals of a generated mesh, [vertex].
std::vector<Vec3> exact_normals(const Generated& made) {
  std::vector<Vec3> normals;
  for (const Vec3& p : made.mesh.positions) normals.push_back(made.exact->nearest(p).normal);
  return normals;
}

std::vector<FittedNormal> fit(const Mesh& mesh, const std::vector<Vec3>& start) {
  return fitted_normals(mesh, mesh.corner_vertex, start);
}

TEST(FittedNormals, are_exact_on_spheres) {
  const Generated made = irregular(goldberg(), 3);
  const std::vector<Vec3> exact = exact_normals(made);
  std::vector<Vec3> start = exact;
  for (std::size_t v = 0; v < start.size(); ++v)
    start[v] = (start[v] + 0.2 * start[v].unitOrthogonal()).normalized();
  const std::vector<FittedNormal> fitted = fit(made.mesh, start);
  std::vector<Vec3> normals;
  for (const FittedNormal& f : fitted) {
    normals.push_back(f.normal);
    EXPECT_LE(f.error, 0.02);
  }
  EXPECT_LE(apart(normals, exact), 0.02);  // the start, 0.2 rad off, in two passes
  EXPECT_LE(apart(vertex_normals(made.mesh, NormalWeights::kSmooth), exact), 1e-9);
}

TEST(FittedNormals, halve_the_error_on_irregular_tori_and_ellipsoids) {
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
    for (const Generated& made : {irregular(torus(), seed), irregular(ellipsoid(), seed)}) {
      const std::vector<Vec3> exact = exact_normals(made);
      const double smooth = apart(vertex_normals(made.mesh, NormalWeights::kSmooth), exact);
      EXPECT_LE(smooth, 0.5 * apart(vertex_normals(made.mesh), exact)) << seed;
    }
  }
}

// The error falls with the size of faces: that of means by angles by the first power on irregular
// meshes, a quadric's by the second, a cubic's by the third.
TEST(FittedNormals, fall_with_the_third_power_of_the_size_of_faces) {
  for (const bool is_irregular : {false, true}) {
    const auto error = [&](int frequency) {
      Generated made = ellipsoid(frequency);
      if (is_irregular) made = irregular(std::move(made), 3);
      return apart(vertex_normals(made.mesh, NormalWeights::kSmooth), exact_normals(made));
    };
    EXPECT_LE(error(8), error(4) / 5) << is_irregular;
    EXPECT_LE(error(8), (is_irregular ? 0.08 : 0.04) * kDegree);
  }
}

// Two edges reach round a tube of 5 sides: a cubic would lean by degrees.
TEST(FittedNormals, thin_tubes_are_not_worse_than_by_quadrics) {
  for (const int around : {5, 7, 10}) {
    Generated made = torus(3 * around, around);
    EXPECT_LE(apart(vertex_normals(made.mesh, NormalWeights::kSmooth), exact_normals(made)),
              2.2 * kDegree)
        << around;
  }
}

// Quadrics alone turn 1.4 times as far.
TEST(FittedNormals, noise_turns_them_by_less_than_twice_what_it_turns_the_mean_by_angles) {
  Generated made = torus(60, 30);
  std::mt19937_64 random(5);
  std::normal_distribution<double> shift(0, 0.05);
  const std::vector<Vec3> exact = exact_normals(made);
  for (Vec3& p : made.mesh.positions) p += Vec3(shift(random), shift(random), shift(random));
  EXPECT_LE(apart(vertex_normals(made.mesh, NormalWeights::kSmooth), exact),
            1.7 * apart(vertex_normals(made.mesh), exact));
}

TEST(FittedNormals, too_few_vertices_leave_the_start) {
  const Mesh tetrahedron = [] {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.face_begin = {0, 3, 6, 9, 12};
    mesh.corner_vertex = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
    return mesh;
  }();
  const std::vector<Vec3> start = vertex_normals(tetrahedron);
  const std::vector<FittedNormal> fitted = fit(tetrahedron, start);
  for (std::size_t v = 0; v < start.size(); ++v) {
    EXPECT_EQ(fitted[v].normal, start[v]);
    EXPECT_TRUE(std::isinf(fitted[v].error));
  }
  EXPECT_EQ(vertex_normals(tetrahedron, NormalWeights::kSmooth), start);
}

TEST(FittedNormals, edges_between_flat_faces_are_no_quadric) {
  Mesh cube = gliss::cube(4).mesh;
  cube.normals.clear();
  cube.corner_normal.clear();
  const std::vector<Vec3> start = vertex_normals(cube);
  const std::vector<FittedNormal> fitted = fit(cube, start);
  const std::vector<Vec3> smooth = vertex_normals(cube, NormalWeights::kSmooth);
  for (std::size_t v = 0; v < start.size(); ++v) {
    int sides = 0;
    for (int i = 0; i < 3; ++i)
      sides += std::abs(std::abs(cube.positions[v][i]) - 5) < 1e-9 ? 1 : 0;
    if (sides < 2) continue;
    EXPECT_GE(fitted[v].error, 0.2);
    EXPECT_LE((smooth[v] - start[v]).norm(), 1e-9)
        << cube.positions[v].transpose() << " error " << fitted[v].error;
  }
}

TEST(FittedNormals, nothing_counts_beyond_a_crease) {
  Mesh round = cylinder(24, 6).mesh;
  round.normals.clear();
  round.corner_normal.clear();
  mark_creases(round, build_topology(round), {.angle = 0.7});
  add_vertex_normals(round, NormalWeights::kSmooth);
  ASSERT_FALSE(round.sharp.empty());
  for (std::size_t c = 0; c < round.corner_vertex.size(); ++c) {
    const Vec3& p = round.positions[round.corner_vertex[c]];
    const Vec3& n = round.normals[round.corner_normal[c]];
    const Vec3 outward = Vec3(p.x(), p.y(), 0).normalized();
    EXPECT_LE(std::min((n - outward).norm(), 1 - std::abs(n.z())), 1e-3) << c;
  }
}

TEST(FittedNormals, do_not_depend_on_scale) {
  Mesh mesh = irregular(torus(), 1).mesh;
  const std::vector<Vec3> normals = vertex_normals(mesh, NormalWeights::kSmooth);
  for (const double scale : {0x1p-90, 0x1p90}) {
    Mesh scaled = mesh;
    for (Vec3& p : scaled.positions) p *= scale;
    const std::vector<Vec3> other = vertex_normals(scaled, NormalWeights::kSmooth);
    EXPECT_LE(apart(other, normals), 1e-9);
  }
}

}  // namespace
}  // namespace gliss
