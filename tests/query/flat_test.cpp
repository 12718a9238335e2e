// The method `flat`: the nearest point of the base polygons.
#include "gliss/generate/generate.h"
#include "gliss/query/contact_tracker.h"
#include "tests/oracle/brute_force.h"
#include "tests/support/require.h"

#ifdef GLISS_WITH_EMBREE
#include <embree3/rtcore.h>
#endif

namespace gliss {
namespace {

using oracle::Rng;
using test::Triangle, test::Worst;

Contact nearest_flat(const PatchCache& cache, const Vec3& hip) {
  QueryOptions options;
  options.method = Method::kFlat;
  return nearest(cache, hip, options);
}

// Every face cut into a fan: a mesh of triangles, whose base polygons leave no choice.
Mesh triangulated(const Mesh& mesh) {
  Mesh cut;
  cut.positions = mesh.positions;
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    const std::uint32_t first = mesh.face_begin[face];
    for (std::uint32_t k = 2; k < mesh.valence(face); ++k) {
      for (const std::uint32_t corner : {first, first + k - 1, first + k}) {
        cut.corner_vertex.push_back(mesh.corner_vertex[corner]);
      }
      cut.face_begin.push_back(static_cast<std::uint32_t>(cut.corner_vertex.size()));
    }
  }
  return test::with_normals(cut);
}

TEST(Flat, agrees_with_brute_force_over_planar_polygons) {
  Rng rng(51);
  for (const Mesh& made : {thin_plate(4, 3).mesh, prism(6).mesh, prism(100).mesh,
                           triangulated(torus_knot(60, 8).mesh), triangulated(banana().mesh)}) {
    const Mesh mesh = test::with_normals(made);
    const PatchCache cache = test::cache_of(mesh);
    const std::vector<Triangle> triangles = test::triangles_of(mesh);
    const double size = test::size_of(mesh);
    Worst error, position;
    for (int i = 0; i < 600; ++i) {
      const Vec3 hip = test::random_in_box(rng, mesh, i % 3 == 0 ? 20 : 1.3);
      const Contact contact = nearest_flat(cache, hip);
      const test::NearestPoint want = test::nearest_by_brute_force(triangles, hip);
      error.add(std::abs(std::abs(contact.distance) - want.distance) / (size + want.distance));
      // It is a point of the triangles, too.
      const auto at_scp = test::nearest_by_brute_force(triangles, contact.scp);
      position.add(at_scp.distance / size);
      EXPECT_NEAR((contact.scp - hip).norm(), std::abs(contact.distance),
                  1e-13 * (size + want.distance));
    }
    EXPECT_LE(error.value, 1e-14) << made.source;
    EXPECT_LE(position.value, 1e-13) << made.source;
  }
}

// From any polygon of a ball it slides to that beneath the HIP, however many lie between.
TEST(Flat, slides_over_as_many_polygons_as_it_takes) {
  Rng rng(53);
  const Mesh mesh = goldberg(5).mesh;
  const PatchCache cache = test::cache_of(mesh);
  for (const Method method : {Method::kFlat, Method::kShaded}) {
    QueryOptions options;
    options.method = method;
    for (int i = 0; i < 300; ++i) {
      const Vec3 hip = oracle::uniform(rng, 11, 14) * oracle::random_unit(rng);
      const auto from = static_cast<std::uint32_t>(rng() % mesh.face_count());
      const Contact contact = ContactTracker(cache, options).track(hip, {from, 0, 0});
      EXPECT_NEAR(contact.distance, nearest(cache, hip, options).distance, 1e-12);
    }
  }
}

#ifdef GLISS_WITH_EMBREE

// Embree finds the candidates in float; each is measured in double.
class EmbreeTriangles {
 public:
  explicit EmbreeTriangles(const Mesh& mesh)
      : triangles_(test::triangles_of(mesh)),
        device_(rtcNewDevice(nullptr)),
        scene_(rtcNewScene(device_)) {
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertex = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                               RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                                               mesh.positions.size()));
    for (const Vec3& p : mesh.positions) {
      for (int i = 0; i < 3; ++i) *vertex++ = static_cast<float>(p[i]);
    }
    auto* index = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(unsigned), mesh.face_count()));
    std::copy(mesh.corner_vertex.begin(), mesh.corner_vertex.end(), index);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }
  ~EmbreeTriangles() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  EmbreeTriangles(const EmbreeTriangles&) = delete;
  EmbreeTriangles& operator=(const EmbreeTriangles&) = delete;

  double distance(const Vec3& point) const {
    Search search{&triangles_, point, std::numeric_limits<double>::infinity()};
    RTCPointQuery query{};
    query.x = static_cast<float>(point.x());
    query.y = static_cast<float>(point.y());
    query.z = static_cast<float>(point.z());
    query.radius = std::numeric_limits<float>::infinity();
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(scene_, &query, &context, &visit, &search);
    return search.distance;
  }

 private:
  struct Search {
    const std::vector<Triangle>* triangles;
    Vec3 point;
    double distance;
  };
  static bool visit(RTCPointQueryFunctionArguments* arguments) {
    auto& search = *static_cast<Search*>(arguments->userPtr);
    const Triangle& triangle = (*search.triangles)[arguments->primID];
    const double d = (test::nearest_on_triangle(triangle, search.point) - search.point).norm();
    if (d >= search.distance) return false;
    search.distance = d;
    arguments->query->radius = static_cast<float>(d * (1 + 1e-5));
    return true;
  }

  std::vector<Triangle> triangles_;
  RTCDevice device_;
  RTCScene scene_;
};

TEST(Flat, agrees_with_embree) {
  Rng rng(52);
  for (const Mesh& made : {torus_knot().mesh, goldberg(8).mesh, banana().mesh}) {
    const Mesh mesh = triangulated(made);
    const PatchCache cache = test::cache_of(mesh);
    const EmbreeTriangles embree(mesh);
    Worst error;
    for (int i = 0; i < 5000; ++i) {
      const Vec3 hip = test::random_in_box(rng, mesh, i % 4 == 0 ? 20 : 1.3);
      const double want = embree.distance(hip);
      error.add(std::abs(std::abs(nearest_flat(cache, hip).distance) - want) /
                (test::size_of(mesh) + want));
    }
    EXPECT_LE(error.value, 1e-14) << made.source;
    test::record(made.source, "{:.2g}", error.value);
  }
}

#else

TEST(Flat, agrees_with_embree) {
#ifdef GLISS_WITH_OTHER_EMBREE
  GTEST_SKIP() << "skipped: this Embree is not of version 3";
#endif
  GLISS_SKIP_UNLESS_REQUIRED("built without Embree 3");
}

#endif

}  // namespace
}  // namespace gliss
