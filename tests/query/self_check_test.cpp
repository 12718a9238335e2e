// A HIP made as G - d n has its contact at G, if d is well below the least radius of curvature.
#include <cstdlib>

#include "gliss/build/build_cache.h"
#include "gliss/engine/engine.h"
#include "gliss/generate/generate.h"
#include "gliss/query/contact_tracker.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using oracle::Rng;

// 1e6 samples a mesh with GLISS_LONG_TESTS set.
std::size_t sample_count() { return std::getenv("GLISS_LONG_TESTS") ? 1'000'000 : 100'000; }

void expect_contacts_at_their_points(const std::string& name, const Mesh& mesh) {
  BuildReport report;
  const PatchCache cache = test::cache_of(mesh, Precision::kDouble, true, &report);
  const double depth = 0.2 * cache.smallest_rho(), size = test::size_of(mesh);
  Rng rng(31);
  std::vector<DomainPoint> at(sample_count());
  for (std::size_t i = 0; i < at.size(); ++i) {
    at[i].face = static_cast<std::uint32_t>(i % mesh.face_count());
    const int n = static_cast<int>(mesh.valence(at[i].face));
    const test::Vec2 X = oracle::random_inside<double>(rng, n);
    at[i].xi = X.x(), at[i].eta = X.y();
  }
  const auto engine = make_tbb_engine();
  std::vector<SurfacePoint> points(at.size());
  const auto surface = engine->reside(cache);
  surface->evaluate(at, points);
  std::vector<Vec3> hips;
  for (const SurfacePoint& point : points) hips.push_back(point.position - depth * point.normal);
  std::vector<Contact> contacts(at.size());
  surface->project(hips, {}, contacts);

  // Where the mesh passes through itself, another sheet may be nearer than G: then tracking, which
  // stays on its sheet, has to find G.
  ContactTracker tracker(cache, {});
  std::size_t missed = 0, nearer = 0;
  std::uint32_t first = kNone;
  int iterations = 0;
  test::Worst error;
  std::size_t buried = 0;
  for (std::size_t i = 0; i < at.size(); ++i) {
    // Inside another part a point is none of the union's surface.
    if (nearest(cache, points[i].position + 1e-6 * size * points[i].normal).touching) {
      ++buried;
      continue;
    }
    const Vec3 tracked = tracker.track(hips[i], at[i]).scp;
    const bool other = std::abs(contacts[i].distance) < depth * (1 - 1e-6);
    const double e = std::max((tracked - points[i].position).norm(),
                              other ? 0 : (contacts[i].scp - points[i].position).norm());
    nearer += other;
    error.add(e / size);
    iterations = std::max(iterations, contacts[i].iterations);
    if (!(e <= 1e-9 * size) && missed++ == 0) first = at[i].face;
  }
  EXPECT_LT(buried, at.size() / 2);
  EXPECT_EQ(missed, 0u) << "first: face " << first;
  test::record(name,
               "depth {:.3g} of size, {} of {} missed, {} in other parts, {} nearer to another "
               "sheet; worst {:.2g} of "
               "size, at most {} iterations",
               depth / size, missed, at.size(), buried, nearer, error.value, iterations);
}

TEST(SelfCheck, every_contact_of_the_knot_is_at_its_point) {
  expect_contacts_at_their_points("torus knot", torus_knot().mesh);
}

class SharedSelfCheck : public test::SharedTest {};

TEST_F(SharedSelfCheck, every_contact_of_the_teeth_is_at_its_point) {
  expect_contacts_at_their_points("teeth", test::load_shared("meshes/teeth32_ngon"));
}

}  // namespace
}  // namespace gliss
