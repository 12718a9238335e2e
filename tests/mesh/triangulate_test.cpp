#include "gliss/mesh/triangulate.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/sharp_meshes.h"

namespace gliss::test {
namespace {

double height_over_longest_side(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  return (b - a).cross(c - a).norm() / (longest * longest);
}

// The feet of a comb's gaps lie on one line, but for the rounding of files.
TEST(Triangulate, makes_no_slivers_of_corners_on_one_line) {
  oracle::Rng rng(3);
  for (const std::uint32_t teeth : {2u, 3u, 5u, 8u, 20u}) {
    const Mesh mesh = comb(rng, teeth, 1);
    for (const std::size_t face : {0, 1}) {
      std::vector<Vec3> corners;
      for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c)
        corners.push_back(mesh.positions[mesh.corner_vertex[c]]);
      const Vec3 normal = newell_normal(mesh, face);
      std::vector<std::uint32_t> triangles;
      triangulate(corners, normal, triangles);
      ASSERT_EQ(triangles.size(), 3 * (corners.size() - 2));
      double all = 0;
      for (std::size_t t = 0; t < triangles.size(); t += 3) {
        const Vec3 &a = corners[triangles[t]], &b = corners[triangles[t + 1]],
                   &c = corners[triangles[t + 2]];
        EXPECT_GT(normal.dot((b - a).cross(c - a)), 0);
        EXPECT_GT(height_over_longest_side(a, b, c), 1e-3) << teeth << " teeth";
        all += (b - a).cross(c - a).norm();
      }
      EXPECT_NEAR(all, normal.norm(), 1e-6 * all);
    }
  }
}

}  // namespace
}  // namespace gliss::test
