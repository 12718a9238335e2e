// Holds that these do not change the answer: where a mesh lies, how large it is, how its corners
// are numbered, which hand it is.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cstring>

#include "gliss/generate/generate.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using oracle::Rng;
using test::at, test::cache_of, test::Polygon, test::Vec2;

constexpr int kMostSides = 9;

// A polygon, and a point of its domain.
struct Case {
  Polygon polygon;
  Vec2 X;
  int sides() const { return polygon.size(); }
};

Case any_case() {
  Rng rng(*rc::gen::arbitrary<std::uint64_t>());
  const int n = *rc::gen::inRange(3, kMostSides + 1);
  Case made{oracle::with_unit_normals(oracle::random_polygon(rng, n, 50 * oracle::kDegree)), {}};
  made.X = oracle::random_inside<double>(rng, n);
  return made;
}

PatchCache cache_of_polygon(const Polygon& polygon) {
  return cache_of(test::mesh_of(polygon), Precision::kDouble, false);
}

SurfacePoint point_of(const Polygon& polygon, const Vec2& X) {
  return at(cache_of_polygon(polygon), 0, X);
}

void expect_near(const Vec3& got, const Vec3& want, double bound) {
  RC_ASSERT((got - want).norm() <= bound);
}

RC_GTEST_PROP(Invariance, rigid_motions_move_the_patch, ()) {
  const Case made = any_case();
  Rng rng(*rc::gen::arbitrary<std::uint64_t>());
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(oracle::uniform(rng, 0, 6), oracle::random_unit(rng)).toRotationMatrix();
  const Vec3 shift = oracle::uniform(rng, 0, 10) * oracle::random_unit(rng);
  Polygon moved = made.polygon;
  for (Vec3& p : moved.positions) p = turn * p + shift;
  for (Vec3& n : moved.normals) n = (turn * n).normalized();
  const SurfacePoint a = point_of(made.polygon, made.X), b = point_of(moved, made.X);
  expect_near(b.position, turn * a.position + shift, 1e-12);
  expect_near(b.d_xi, turn * a.d_xi, 1e-12);
  expect_near(b.d_eta, turn * a.d_eta, 1e-12);
}

template <class Real>
bool same_bits(const Real& a, const Real& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

// Bit for bit, and so of every contact: a mesh in millimetres is the mesh in metres, but for its
// unit.
RC_GTEST_PROP(Invariance, powers_of_two_scale_every_bit, ()) {
  const Case made = any_case();
  const double scale = std::ldexp(1.0, *rc::gen::inRange(-90, 91));
  const Precision precision = *rc::gen::element(Precision::kFloat, Precision::kDouble);
  Polygon scaled = made.polygon;
  for (Vec3& p : scaled.positions) p *= scale;
  const PatchCache cache = cache_of(test::mesh_of(made.polygon), precision);
  const PatchCache scaled_cache = cache_of(test::mesh_of(scaled), precision);
  const SurfacePoint a = at(cache, 0, made.X), b = at(scaled_cache, 0, made.X);
  RC_ASSERT(same_bits<Vec3>(scale * a.position, b.position));
  RC_ASSERT(same_bits<Vec3>(scale * a.d_xi, b.d_xi));
  RC_ASSERT(same_bits<Vec3>(scale * a.d_eta, b.d_eta));
  RC_ASSERT(same_bits(a.normal, b.normal));
  const Vec3 hip = a.position - 0.01 * a.normal;
  const Contact c = nearest(cache, hip), d = nearest(scaled_cache, scale * hip);
  RC_ASSERT(same_bits<Vec3>(scale * c.scp, d.scp));
  RC_ASSERT(same_bits<Vec3>(scale * c.push, d.push));
  RC_ASSERT(same_bits(c.normal, d.normal));
  RC_ASSERT(c.iterations == d.iterations);
}

// Corner `by` becomes corner 0, and the domain turns with it.
RC_GTEST_PROP(Invariance, which_corner_comes_first_turns_the_domain, ()) {
  const Case made = any_case();
  const int n = made.sides(), by = *rc::gen::inRange(1, n);
  Polygon relabelled = made.polygon;
  std::rotate(relabelled.positions.begin(), relabelled.positions.begin() + by,
              relabelled.positions.end());
  std::rotate(relabelled.normals.begin(), relabelled.normals.begin() + by,
              relabelled.normals.end());
  const double angle = -2 * std::numbers::pi * by / n;
  const Eigen::Rotation2Dd turn(angle);
  const SurfacePoint a = point_of(made.polygon, made.X), b = point_of(relabelled, turn * made.X);
  expect_near(b.position, a.position, 1e-13);
  expect_near(b.d_xi * std::cos(angle) + b.d_eta * std::sin(angle), a.d_xi, 1e-13 * n);
  RC_ASSERT(oracle::angle<double>(a.normal, b.normal) <= 1e-10);
}

// Corners in the other order, normals turned over: the same surface, seen from its other side.
RC_GTEST_PROP(Invariance, reversal_turns_the_patch_over, ()) {
  const Case made = any_case();
  Polygon reversed = made.polygon;
  std::reverse(reversed.positions.begin() + 1, reversed.positions.end());
  std::reverse(reversed.normals.begin() + 1, reversed.normals.end());
  for (Vec3& n : reversed.normals) n = -n;
  const SurfacePoint a = point_of(made.polygon, made.X);
  const SurfacePoint b = point_of(reversed, {made.X.x(), -made.X.y()});
  expect_near(b.position, a.position, 1e-13);
  expect_near(b.d_xi, a.d_xi, 1e-12);
  expect_near(b.d_eta, -a.d_eta, 1e-12);
  RC_ASSERT(oracle::angle<double>(a.normal, -b.normal) <= 1e-10);
}

RC_GTEST_PROP(Invariance, a_mirror_shows_the_mirrored_patch, ()) {
  const Case made = any_case();
  const auto mirror = [](const Vec3& v) { return Vec3(-v.x(), v.y(), v.z()); };
  Polygon mirrored;  // its corners run the other way round
  for (int k = 0; k < made.sides(); ++k) {
    mirrored.positions.push_back(mirror(made.polygon.position(-k)));
    mirrored.normals.push_back(mirror(made.polygon.normal(-k)));
  }
  const SurfacePoint a = point_of(made.polygon, made.X);
  const SurfacePoint b = point_of(mirrored, {made.X.x(), -made.X.y()});
  expect_near(b.position, mirror(a.position), 1e-13);
  RC_ASSERT(oracle::angle<double>(b.normal, mirror(a.normal)) <= 1e-10);
}

// Contacts of a whole mesh move with it.
RC_GTEST_PROP(Invariance, contacts_move_with_the_mesh, ()) {
  static const Mesh mesh = goldberg(2).mesh;
  static const PatchCache cache = cache_of(mesh);
  Rng rng(*rc::gen::arbitrary<std::uint64_t>());
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(oracle::uniform(rng, 0, 6), oracle::random_unit(rng)).toRotationMatrix();
  const Vec3 shift = oracle::uniform(rng, 0, 100) * oracle::random_unit(rng);
  Mesh moved = mesh;
  for (Vec3& p : moved.positions) p = turn * p + shift;
  for (Vec3& n : moved.normals) n = (turn * n).normalized();
  const Vec3 hip = oracle::uniform(rng, 8, 20) * oracle::random_unit(rng);
  const Contact a = nearest(cache, hip), b = nearest(cache_of(moved), turn * hip + shift);
  RC_ASSERT(std::abs(a.distance - b.distance) <= 1e-12 * 20);
  expect_near(b.scp, turn * a.scp + shift, 1e-7);
}

}  // namespace
}  // namespace gliss
