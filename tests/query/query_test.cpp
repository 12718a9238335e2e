// The global nearest point: against brute force, against points whose answer is known, by every
// solver, inside and outside, on borders.
#include "gliss/generate/generate.h"
#include "gliss/query/contact_tracker.h"
#include "tests/oracle/brute_force.h"
#include "tests/support/open_meshes.h"
#include "tests/support/sharp_meshes.h"

namespace gliss {
namespace {

using oracle::Rng;
using test::Vec2, test::Worst;

struct Named {
  const char* name;
  Mesh mesh;
};

// Few patches each, of 3 to 11 sides.
std::vector<Named> small_meshes() {
  return {{"goldberg", test::with_normals(goldberg(2).mesh)},
          {"torus", test::with_normals(torus(12, 8).mesh)},
          {"torus knot", test::with_normals(torus_knot(48, 8).mesh)},
          {"banana", test::with_normals(banana(13, 7).mesh)},
          {"fin", test::with_normals(fin(6).mesh)}};
}

// A random point of the surface that lies on no side.
SurfacePoint random_point(Rng& rng, const Mesh& mesh, const PatchCache& cache) {
  const auto face = static_cast<std::uint32_t>(rng() % mesh.face_count());
  const int n = static_cast<int>(mesh.valence(face));
  return test::at(cache, face, oracle::random_inside<double>(rng, n));
}

// HIPs near and far, inside and outside, on the surface, its edges and its vertices.
std::vector<Vec3> hips_for(Rng& rng, const Mesh& mesh, const PatchCache& cache, int each) {
  std::vector<Vec3> hips;
  for (int i = 0; i < each; ++i) {
    for (const double grown : {1.0, 1.5, 20.0}) {
      hips.push_back(test::random_in_box(rng, mesh, grown));
    }
    const SurfacePoint point = random_point(rng, mesh, cache);
    hips.push_back(point.position);
    hips.push_back(point.position - 0.01 * test::size_of(mesh) * point.normal);
    const auto face = static_cast<std::uint32_t>(rng() % mesh.face_count());
    const int n = static_cast<int>(mesh.valence(face)), k = i % n;
    for (const double t : {0.0, oracle::uniform(rng, 0, 1)}) {
      const SurfacePoint edge = test::at(cache, face, oracle::on_side(n, k, t));
      hips.push_back(edge.position);
      hips.push_back(edge.position + 0.02 * test::size_of(mesh) * edge.normal);
    }
  }
  return hips;
}

// Expects what holds of every contact, whatever the HIP.
void expect_sound(const PatchCache& cache, const Contact& contact, const Vec3& hip, double size) {
  ASSERT_TRUE(in_domain(cache, contact.at));
  const SurfacePoint point = evaluate(cache, contact.at);
  EXPECT_LE((contact.scp - point.position).norm(), 1e-13 * size);
  EXPECT_LE(oracle::angle<double>(contact.normal, point.normal), 1e-6);
  EXPECT_NEAR((contact.scp - hip).norm(), std::abs(contact.distance), 1e-13 * size);
  EXPECT_EQ(contact.touching, contact.distance < 0);
  EXPECT_TRUE(contact.flags & kConverged);
}

TEST(Nearest, agrees_with_brute_force) {
  Rng rng(21);
  for (const auto& [name, mesh] : small_meshes()) {
    SCOPED_TRACE(name);
    const PatchCache cache = test::paper_cache_of(mesh, Precision::kDouble, false);
    const test::PatchBruteForce brute_force(mesh);
    const double size = test::size_of(mesh);
    Worst distance;
    int iterations = 0;
    for (const Vec3& hip : hips_for(rng, mesh, cache, 4)) {
      const Contact contact = nearest(cache, hip);
      expect_sound(cache, contact, hip, size + hip.norm());
      const double want = brute_force.nearest(hip).distance;
      distance.add(std::abs(std::abs(contact.distance) - want) / size);
      iterations = std::max(iterations, contact.iterations);
    }
    EXPECT_LE(distance.value, 1e-11);
    test::record(name, "distance {:.2g} of size, at most {} iterations", distance.value,
                 iterations);
  }
}

// A minimum within half the radius of curvature is the only one of the patches beside its own too:
// nothing is asked of them. Each start from one of them takes two evaluations.
TEST(Nearest, starts_from_no_patch_that_joins_smoothly) {
  const Mesh mesh = test::with_normals(torus(24, 16, 30, 10).mesh);
  const PatchCache cache = test::cache_of(mesh);
  Rng rng(27);
  constexpr int kHips = 1000;
  for (const double depth : {1.0, 3.0}) {
    int iterations = 0;
    for (int i = 0; i < kHips; ++i) {
      const SurfacePoint point = random_point(rng, mesh, cache);
      const Contact contact = nearest(cache, point.position - depth * point.normal);
      EXPECT_NEAR(contact.distance, -depth, 1e-9);
      iterations += contact.iterations;
    }
    EXPECT_LE(iterations, depth * kHips + 2 * kHips);
    test::record("torus", "{:.1f} iterations, {} mm deep", iterations / double{kHips}, depth);
  }
}

// Cheaper than a search, so it can ask more often: no sample of the surface may be nearer.
TEST(Nearest, is_nearer_than_every_sample_up_to_ten_sizes_away) {
  Rng rng(22);
  std::vector<Mesh> meshes;
  for (const Generated& made : {torus_knot(), goldberg(), banana(), fin()})
    meshes.push_back(test::with_normals(made.mesh));
  meshes.push_back(test::with_normals(test::rounded_plate()));
  meshes.push_back(test::with_creases(test::rounded_plate()));
  for (const Mesh& mesh : meshes) {
    SCOPED_TRACE(mesh.source);
    const PatchCache cache = test::cache_of(mesh);
    std::vector<Vec3> samples;
    for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
      for (const Vec2& X : oracle::sample_domain<double>(static_cast<int>(mesh.valence(face)), 8)) {
        samples.push_back(test::at(cache, face, X).position);
      }
    }
    int missed = 0, asked = 0;
    Worst miss;
    for (const double grown : {1.0, 2.0, 6.0, 20.0}) {
      for (int i = 0; i < 150; ++i, ++asked) {
        const Vec3 hip = test::random_in_box(rng, mesh, grown);
        double least = std::numeric_limits<double>::infinity();
        for (const Vec3& p : samples) least = std::min(least, (p - hip).squaredNorm());
        const double excess = std::abs(nearest(cache, hip).distance) - std::sqrt(least);
        if (!(excess <= 1e-12 * (test::size_of(mesh) + hip.norm()))) ++missed, miss.add(excess);
      }
    }
    EXPECT_EQ(missed, 0) << "of " << asked << ", by up to " << miss.value << " mm";
  }
}

TEST(Nearest, solvers_agree) {
  Rng rng(24);
  for (const auto& [name, mesh] : small_meshes()) {
    const PatchCache cache = test::cache_of(mesh);
    const double depth = 0.2 * cache.smallest_rho(), size = test::size_of(mesh);
    Worst newton, gauss_newton, paper;
    for (int i = 0; i < 500; ++i) {
      const SurfacePoint point = random_point(rng, mesh, cache);
      const Vec3 hip = point.position + oracle::uniform(rng, -depth, depth) * point.normal;
      const auto error = [&](Solver solver) {
        QueryOptions options;
        options.solver = solver;
        const Contact contact = nearest(cache, hip, options);
        EXPECT_LE(ContactTracker(cache, options).track(hip, contact.at).iterations,
                  options.max_iterations);
        return (contact.scp - point.position).norm() / size;
      };
      newton.add(error(Solver::kNewton));
      gauss_newton.add(error(Solver::kGaussNewton));
      paper.add(error(Solver::kPaper));
    }
    EXPECT_LE(newton.value, 1e-9) << name;
    EXPECT_LE(gauss_newton.value, 1e-8) << name;
    EXPECT_LE(paper.value, 5e-3) << name;
    test::record(name, "newton {:.2g}, gauss-newton {:.2g}, paper {:.2g} of size", newton.value,
                 gauss_newton.value, paper.value);
  }
}

TEST(Nearest, is_negative_inside_and_positive_outside) {
  Rng rng(25);
  for (const Generated& made : {torus_knot(), torus(), goldberg()}) {
    ASSERT_TRUE(made.exact);
    const PatchCache cache = test::cache_of(made.mesh);
    Worst error;
    for (int i = 0; i < 2000; ++i) {
      const Vec3 hip = test::random_in_box(rng, made.mesh, 1.2);
      const Contact contact = nearest(cache, hip);
      const double want = made.exact->nearest(hip).distance;
      error.add(std::abs(contact.distance - want));
      EXPECT_EQ(contact.push.norm() > 0, contact.touching);
    }
    // The patches follow the surface, of 10 to 100 mm, as well as this; a wrong sign is a larger
    // error.
    EXPECT_LE(error.value, 0.2);
    test::record(made.mesh.source, "{:.3g} mm from the exact distance", error.value);
  }
}

// Acute edges and corners, whose faces have normals of their own: no face's normal tells alone.
TEST(Nearest, knows_inside_from_outside_at_creases) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {10, 0, 0}, {3, 2, 0}, {4, 1, 9}};
  for (const std::array<std::uint32_t, 3>& face :
       {std::array{0u, 2u, 1u}, std::array{0u, 1u, 3u}, std::array{1u, 2u, 3u},
        std::array{2u, 0u, 3u}}) {
    const Vec3 &a = mesh.positions[face[0]], &b = mesh.positions[face[1]],
               &c = mesh.positions[face[2]];
    for (const std::uint32_t v : face) {
      mesh.corner_vertex.push_back(v);
      mesh.corner_normal.push_back(static_cast<std::uint32_t>(mesh.normals.size()));
    }
    mesh.normals.push_back((b - a).cross(c - a).normalized());
    mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corner_vertex.size()));
  }
  const PatchCache cache = test::cache_of(mesh);
  Rng rng(27);
  int inside = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 hip = test::random_in_box(rng, mesh, 1.5);
    double above = -1e9;  // the highest of the planes
    for (std::uint32_t f = 0; f < 4; ++f)
      above = std::max(above, mesh.normals[f].dot(hip - mesh.positions[mesh.corner_vertex[3 * f]]));
    const Contact contact = nearest(cache, hip);
    EXPECT_EQ(contact.touching, above < 0) << hip.transpose() << ", " << above;
    inside += above < 0;
  }
  EXPECT_GT(inside, 100);
}

TEST(Nearest, stops_at_the_borders_of_an_open_mesh) {
  Rng rng(26);
  for (const double width : {2.0, 0.05}) {
    const Mesh mesh = test::open_strip(8, width);
    const PatchCache cache = test::paper_cache_of(mesh);
    const test::PatchBruteForce brute_force(mesh);
    for (int i = 0; i < 20; ++i) {
      const bool beyond = i % 2 == 0;
      const double y = beyond ? oracle::uniform(rng, 0.6, 2) : oracle::uniform(rng, -0.4, 0.4);
      const Vec3 hip(oracle::uniform(rng, 0.5, 7.5), y * width, oracle::uniform(rng, -0.02, 0.02));
      const Contact contact = nearest(cache, hip);
      EXPECT_EQ((contact.flags & kOnBorder) != 0, beyond) << hip.transpose();
      EXPECT_NEAR(std::abs(contact.distance), brute_force.nearest(hip).distance, 1e-11);
    }
  }
}

}  // namespace
}  // namespace gliss
