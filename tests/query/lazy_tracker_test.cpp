#include "gliss/query/lazy_tracker.h"
#include "gliss/build/build_cache.h"

#include <gtest/gtest.h>

#include "gliss/generate/generate.h"

namespace gliss {
namespace {

// A path round the tube of the knot, from outside to 2 mm beneath and along.
std::vector<Vec3> path_on(const PatchCache& cache) {
  std::vector<Vec3> path;
  for (int i = 0; i < 400; ++i) {
    const std::uint32_t face = 600 + static_cast<std::uint32_t>(i / 20);
    const double t = -0.6 + 1.2 * (i % 20) / 20.0;
    const SurfacePoint p = evaluate(cache, {face, t * 0.70710678, t * 0.70710678});
    path.push_back(p.position - (i < 50 ? 0.06 * i - 1 : 2.0) * p.normal);
  }
  return path;
}

TEST(LazyTracker, follows_the_same_contact_as_the_whole_cache) {
  const Mesh mesh = torus_knot().mesh;
  const PatchCache cache = build_cache(mesh);
  ContactTracker whole(cache, {});
  LazyTracker lazy(mesh);
  int touching = 0;
  for (const Vec3& hip : path_on(cache)) {
    const Contact expected = whole.tick(hip), contact = lazy.tick(hip);
    touching += contact.touching;
    ASSERT_EQ(contact.touching, expected.touching);
    ASSERT_LT((contact.scp - expected.scp).norm(), 1e-8);
    ASSERT_LT((contact.push - expected.push).norm(), 1e-8);
  }
  EXPECT_GT(touching, 300);
}

TEST(LazyTracker, builds_only_what_is_near) {
  const Mesh mesh = torus_knot().mesh;
  LazyTracker lazy(mesh);
  lazy.tick(mesh.positions[100]);
  EXPECT_LT(lazy.built(), 60u);
}

TEST(LazyMesh, shares_with_its_regions_what_is_known_of_the_whole_mesh) {
  const LazyMesh lazy(torus_knot().mesh);
  const std::uint32_t face = 600;
  const LazyRegion region = lazy.build({&face, 1});
  EXPECT_EQ(region.cache.face_valence.read().data(), lazy.base().face_valence.read().data());
  EXPECT_TRUE(region.cache.face_patch.empty());
  for (std::uint32_t p = 0; p < region.cache.patch_count(); ++p)
    EXPECT_EQ(region.cache.first_patch(region.cache.patch_face[p]), p);
  EXPECT_EQ(region.cache.first_patch(0), kNone);
}

}  // namespace
}  // namespace gliss
