// Pictures of surfaces: few points that cover them, with the curvature of their faces.
#include "gliss/sweep/surface_picture.h"

#include "gliss/generate/generate.h"
#include "gliss/query/query.h"
#include "gliss/walk/fidelity.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

TEST(SurfacePicture, points_lie_on_the_surface_and_know_the_curvature_of_their_face) {
  const Mesh ball = irregular(goldberg(4, 10), 2).mesh;
  const PatchCache cache = test::cache_of(ball);
  const SurfacePicture picture = picture_of(cache, 5000);
  const std::size_t points = picture.face.size();
  ASSERT_GT(points, 1800u);
  ASSERT_LE(points, 5000u);
  ASSERT_EQ(picture.position.size(), 3 * points);
  ASSERT_EQ(picture.normal.size(), 3 * points);
  ASSERT_EQ(picture.spot.size(), points);
  ASSERT_EQ(picture.curvature.size(), points);
  ASSERT_EQ(picture.departure.size(), points);
  for (std::size_t i = 0; i < points; ++i) {
    EXPECT_LE(std::abs(nearest(cache, vector_at(&picture.position[3 * i])).distance), 1e-5);
    EXPECT_GT(vector_at(&picture.normal[3 * i]).dot(vector_at(&picture.position[3 * i])), 9.9);
    EXPECT_FLOAT_EQ(picture.curvature[i],
                    static_cast<float>(1 / cache.rho_min[cache.first_patch(picture.face[i])]));
    const double flat =
        nearest(cache, vector_at(&picture.position[3 * i]), {{}, Method::kFlat}).distance;
    EXPECT_NEAR(picture.departure[i], std::abs(flat), 1e-5);
  }
  EXPECT_TRUE(std::is_sorted(picture.face.begin(), picture.face.end()));
  EXPECT_NEAR(picture.p50, 0.1, 0.003);  // 1 / radius
  EXPECT_LE(picture.p50, picture.p99);
  EXPECT_LE(picture.p99, picture.largest);
  EXPECT_FLOAT_EQ(*std::max_element(picture.curvature.begin(), picture.curvature.end()),
                  static_cast<float>(picture.largest));
}

// Wherever one looks, a spot is at hand: with many rings, with one, and where points are left out.
TEST(SurfacePicture, spots_cover_the_surface) {
  for (const auto& [mesh, most] : {std::pair(torus(24, 12).mesh, 10000),
                                   {goldberg().mesh, 8000},
                                   {irregular(torus(24, 12), 1).mesh, 1200}}) {
    const PatchCache cache = test::cache_of(mesh);
    const SurfacePicture picture = picture_of(cache, static_cast<std::size_t>(most));
    const auto places = spread_points(cache, 2000);
    std::size_t bare = 0;
    for (const DomainPoint& place : places) {
      const Vec3 x = evaluate(cache, place).position;
      bool covered = false;
      for (std::size_t i = 0; i < picture.face.size() && !covered; ++i)
        covered = (vector_at(&picture.position[3 * i]) - x).norm() <=
                  static_cast<double>(picture.spot[i]) / 2;
      bare += !covered;
    }
    EXPECT_LE(static_cast<double>(bare), 0.02 * static_cast<double>(places.size()))
        << mesh.source << ", " << picture.face.size() << " points";
  }
}

TEST(SurfacePicture, has_as_many_points_as_it_may_where_faces_are_more) {
  const Mesh mesh = torus(40, 30).mesh;
  const PatchCache fair = test::cache_of(mesh), paper = test::paper_cache_of(mesh);
  const SurfacePicture picture = picture_of(fair, 1000), other = picture_of(paper, 1000);
  ASSERT_EQ(picture.face.size(), 1000u);
  EXPECT_GT(picture.face.back(), 1190u);  // from all over the mesh
  EXPECT_EQ(picture.face, other.face);
}

}  // namespace
}  // namespace gliss
