#include "gliss/lazy/lazy_mesh.h"

#include <gtest/gtest.h>

#include "gliss/build/build_cache.h"
#include "gliss/generate/generate.h"
#include "tests/support/lazy_tracker.h"

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
  test::LazyTracker lazy(mesh);
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
  test::LazyTracker lazy(mesh);
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

// Box by box; a box that is negative is wound inwards.
Mesh boxes(const std::vector<double>& halves) {
  Mesh mesh;
  for (const double half : halves) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (int i = 0; i < 8; ++i)
      mesh.positions.push_back(half * Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
    for (const std::uint32_t corner :
         {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5})
      mesh.corner_vertex.push_back(first + corner);
    for (int face = 0; face < 6; ++face) mesh.face_begin.push_back(mesh.face_begin.back() + 4);
  }
  return mesh;
}

TEST(LazyMesh, needs_all_patches_where_what_is_inside_depends_on_others) {
  EXPECT_FALSE(LazyMesh(boxes({1})).needs_all());
  EXPECT_FALSE(LazyMesh(boxes({2, -1})).needs_all());  // a cavity: its walls' normals say enough
  EXPECT_TRUE(LazyMesh(boxes({2, 1})).needs_all());
  EXPECT_FALSE(LazyMesh(torus_knot().mesh).needs_all());
}

}  // namespace
}  // namespace gliss
