#include <benchmark/benchmark.h>
#include <embree3/rtcore.h>

#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>

#include "bench/peers/peers.h"
#include "bench/samples.h"

namespace gliss::bench {
namespace {

// A scene of one geometry.
class Scene {
 public:
  Scene(const Mesh& mesh, RTCGeometryType type)
      // Room for every irregular patch, in MiB. A number of threads given here would be oneTBB's,
      // and ours.
      : device_(rtcNewDevice("tessellation_cache_size=4096")),
        scene_(rtcNewScene(device_)),
        geometry_(rtcNewGeometry(device_, type)) {
    // Embree reads the four bytes beyond a position too, and asserts that they are a finite number.
    auto* const vertices = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry_, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                4 * sizeof(float), mesh.positions.size()));
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      const Eigen::Vector3f p = mesh.positions[v].cast<float>();
      std::copy(p.data(), p.data() + 3, vertices + 4 * v);
      vertices[4 * v + 3] = 0;
    }
    const bool triangles = type == RTC_GEOMETRY_TYPE_TRIANGLE;
    const std::size_t corners = mesh.corner_vertex.size();
    auto* const indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
        geometry_, RTC_BUFFER_TYPE_INDEX, 0, triangles ? RTC_FORMAT_UINT3 : RTC_FORMAT_UINT,
        (triangles ? 3 : 1) * sizeof(std::uint32_t), triangles ? corners / 3 : corners));
    std::copy(mesh.corner_vertex.begin(), mesh.corner_vertex.end(), indices);
    if (!triangles) {
      auto* const sides = static_cast<std::uint32_t*>(
          rtcSetNewGeometryBuffer(geometry_, RTC_BUFFER_TYPE_FACE, 0, RTC_FORMAT_UINT,
                                  sizeof(std::uint32_t), mesh.face_count()));
      std::fill(sides, sides + mesh.face_count(), 4u);
    }
    rtcCommitGeometry(geometry_);
    rtcAttachGeometry(scene_, geometry_);
    rtcCommitScene(scene_);
    if (rtcGetDeviceError(device_) != RTC_ERROR_NONE)
      throw std::runtime_error("Embree takes no " + mesh.source);
  }
  ~Scene() {
    rtcReleaseGeometry(geometry_);
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  RTCScene scene() const { return scene_; }
  RTCGeometry geometry() const { return geometry_; }

 private:
  RTCDevice device_;
  RTCScene scene_;
  RTCGeometry geometry_;
};

// Nearest point of triangle a b c to x (Ericson 2005, 5.1.5).
Eigen::Vector3f foot_on_triangle(const Eigen::Vector3f& a, const Eigen::Vector3f& b,
                                 const Eigen::Vector3f& c, const Eigen::Vector3f& x) {
  const Eigen::Vector3f ab = b - a, ac = c - a, ax = x - a, bx = x - b, cx = x - c;
  const float d1 = ab.dot(ax), d2 = ac.dot(ax);
  if (d1 <= 0 && d2 <= 0) return a;
  const float d3 = ab.dot(bx), d4 = ac.dot(bx);
  if (d3 >= 0 && d4 <= d3) return b;
  const float vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  const float d5 = ab.dot(cx), d6 = ac.dot(cx);
  if (d6 >= 0 && d5 <= d6) return c;
  const float vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  const float va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  const float over = 1 / (va + vb + vc);
  return a + vb * over * ab + vc * over * ac;
}

struct Triangles {
  explicit Triangles(const Mesh& mesh)
      : scene(mesh, RTC_GEOMETRY_TYPE_TRIANGLE), corner_vertex(mesh.corner_vertex) {
    for (const Vec3& p : mesh.positions) positions.push_back(p.cast<float>());
  }
  Scene scene;
  std::vector<Eigen::Vector3f> positions;
  std::vector<std::uint32_t> corner_vertex;
};

struct Nearest {
  const Triangles* triangles;
  Eigen::Vector3f foot;
};

bool try_triangle(RTCPointQueryFunctionArguments* arguments) {
  auto& nearest = *static_cast<Nearest*>(arguments->userPtr);
  RTCPointQuery& query = *arguments->query;
  const Triangles& t = *nearest.triangles;
  const std::uint32_t* corners = &t.corner_vertex[3 * std::size_t{arguments->primID}];
  const Eigen::Vector3f x(query.x, query.y, query.z);
  const Eigen::Vector3f foot = foot_on_triangle(t.positions[corners[0]], t.positions[corners[1]],
                                                t.positions[corners[2]], x);
  const float distance = (foot - x).norm();
  if (!(distance < query.radius)) return false;
  query.radius = distance;
  nearest.foot = foot;
  return true;
}

}  // namespace

Work embree_evaluate(const Mesh& mesh, Order order) {
  const auto scene = std::make_shared<Scene>(mesh, RTC_GEOMETRY_TYPE_SUBDIVISION);
  const CallPoints<double> points(order, mesh.face_count());
  std::vector<float> u, v;
  for (std::size_t i = 0; i < kCallPoints; ++i) {
    const QuadPoint p = quad_point(points.xi[i], points.eta[i]);
    u.push_back(p.u);
    v.push_back(p.v);
  }
  const auto out = std::make_shared<std::vector<float>>(9 * kCallPoints);
  return {static_cast<double>(kCallPoints), [=, faces = points.patch] {
            RTCInterpolateNArguments a{};
            a.geometry = scene->geometry();
            a.primIDs = faces.data();
            a.u = u.data();
            a.v = v.data();
            a.N = static_cast<unsigned>(kCallPoints);
            a.bufferType = RTC_BUFFER_TYPE_VERTEX;
            a.P = out->data();
            a.dPdu = out->data() + 3 * kCallPoints;
            a.dPdv = out->data() + 6 * kCallPoints;
            a.valueCount = 3;
            rtcInterpolateN(&a);
            benchmark::DoNotOptimize(out->data());
          }};
}

Work embree_nearest(const Mesh& mesh, const std::vector<Vec3>& hips) {
  const auto triangles = std::make_shared<Triangles>(mesh);
  std::vector<Eigen::Vector3f> points;
  for (const Vec3& hip : hips) points.push_back(hip.cast<float>());
  return {static_cast<double>(points.size()), [=] {
            for (const Eigen::Vector3f& x : points) {
              Nearest nearest{triangles.get(), {}};
              RTCPointQuery query{x.x(), x.y(), x.z(), 0, std::numeric_limits<float>::infinity()};
              RTCPointQueryContext context;
              rtcInitPointQueryContext(&context);
              rtcPointQuery(triangles->scene.scene(), &query, &context, try_triangle, &nearest);
              benchmark::DoNotOptimize(nearest.foot);
            }
          }};
}

}  // namespace gliss::bench
