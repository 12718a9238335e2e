// Measures what float caches and places far from the origin cost.
#include "gliss/generate/generate.h"
#include "gliss/query/contact_tracker.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using oracle::Rng;
using test::Worst;

struct Sample {
  DomainPoint at;
  Vec3 hip;
};

// HIPs a little beneath points of the surface: their contacts are well conditioned.
std::vector<Sample> samples_beneath(Rng& rng, const Mesh& mesh, const PatchCache& cache) {
  const double depth = 0.2 * cache.smallest_rho();
  std::vector<Sample> samples;
  for (int i = 0; i < 2000; ++i) {
    const auto face = static_cast<std::uint32_t>(rng() % mesh.face_count());
    const auto X = oracle::random_inside<double>(rng, static_cast<int>(mesh.valence(face)));
    const SurfacePoint point = test::at(cache, face, X);
    const double d = oracle::uniform(rng, -depth, depth);
    samples.push_back({{face, X.x(), X.y()}, point.position - d * point.normal});
  }
  return samples;
}

// Faces of many sides lose n^2 roundings in float: patch_test.cpp.
TEST(Precision, float_finds_the_contacts_of_double) {
  Rng rng(41);
  for (const Generated& made : {torus_knot(), torus(), goldberg(), banana()}) {
    const PatchCache fine = test::cache_of(made.mesh);
    const PatchCache coarse = test::cache_of(made.mesh, Precision::kFloat);
    const double size = test::size_of(made.mesh);
    Worst position, distance, normal;
    for (const Sample& sample : samples_beneath(rng, made.mesh, fine)) {
      const Contact a = nearest(fine, sample.hip), b = nearest(coarse, sample.hip);
      position.add((a.scp - b.scp).norm() / size);
      distance.add(std::abs(a.distance - b.distance) / size);
      normal.add(oracle::angle<double>(a.normal, b.normal));
    }
    EXPECT_LE(position.value, 2e-6) << made.mesh.source;
    EXPECT_LE(distance.value, 2e-6) << made.mesh.source;
    test::record(made.mesh.source, "position {:.2g}, distance {:.2g} of size, normal {:.2g} rad",
                 position.value, distance.value, normal.value);
  }
}

// A knot with features of 1 mm in metres, and the same one 2^20 m away. Its vertices are rounded to
// what that far place can hold, so that both are the same mesh exactly.
TEST(Precision, contacts_are_the_same_a_million_metres_away) {
  Rng rng(42);
  const Vec3 far(0x1p20, -0x1p20, 0x1p20);
  Mesh here = torus_knot().mesh;
  here.unit = 1;
  for (Vec3& p : here.positions) p = (p * (1e-3 / 6) + far) - far;
  Mesh there = here;
  for (Vec3& p : there.positions) p += far;
  const PatchCache near_cache = test::cache_of(here);
  for (const Precision precision : {Precision::kDouble, Precision::kFloat}) {
    const bool is_float = precision == Precision::kFloat;
    const PatchCache far_cache = test::cache_of(there, precision);
    ContactTracker tracker(far_cache, {}), near_tracker(near_cache, {});
    Worst found, tracked;
    for (const Sample& sample : samples_beneath(rng, here, near_cache)) {
      const Vec3 far_hip = sample.hip + far, hip = far_hip - far;
      const auto off = [&](const Contact& there, const Contact& here) {
        return (there.scp - far - here.scp).norm();
      };
      found.add(off(nearest(far_cache, far_hip), nearest(near_cache, hip)));
      tracked.add(off(tracker.track(far_hip, sample.at), near_tracker.track(hip, sample.at)));
    }
    EXPECT_LE(found.value, is_float ? 2e-8 : 2e-9);
    EXPECT_LE(tracked.value, is_float ? 2e-8 : 2e-9);
    test::record(is_float ? "float" : "double", "nearest {:.2g} m, track {:.2g} m", found.value,
                 tracked.value);
  }
}

}  // namespace
}  // namespace gliss
