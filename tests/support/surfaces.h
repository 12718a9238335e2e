// Meshes for the tests of the surface, as the library and as the oracle see them; and worst errors.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "gliss/build/build_cache.h"
#include "gliss/files/mesh_file.h"
#include "gliss/mesh/topology.h"
#include "gliss/query/query.h"
#include "gliss/surface/patch_cache.h"
#include "tests/support/places.h"
#include "tests/support/points.h"

namespace gliss::test {

using Polygon = oracle::Polygon<double>;
using Vec2 = oracle::Vec2<double>;

inline std::string shared_path(const std::string& name) {
  return std::string(test::kShared) + "/" + name;
}

// Skips where the folder of shared meshes is absent.
class SharedTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(shared_path("meshes"))) {
      GTEST_SKIP() << "skipped: ../shared is absent";
    }
  }
};

// An open mesh of one face.
inline Mesh mesh_of(const Polygon& polygon) {
  Mesh mesh;
  mesh.positions = polygon.positions;
  mesh.normals = polygon.normals;
  const auto n = static_cast<std::uint32_t>(polygon.size());
  mesh.face_begin.push_back(n);
  for (std::uint32_t k = 0; k < n; ++k) mesh.corner_vertex.push_back(k);
  mesh.corner_normal = mesh.corner_vertex;
  return mesh;
}

// A face of a mesh that has normals.
inline Polygon polygon_of(const Mesh& mesh, std::size_t face) {
  Polygon polygon;
  for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c) {
    polygon.positions.push_back(mesh.positions[mesh.corner_vertex[c]]);
    polygon.normals.push_back(mesh.normals[mesh.corner_normal[c]]);
  }
  return polygon;
}

// Calls visit(side, twin) once for every edge of two faces.
template <class Visit>
void for_each_inner_edge(const Topology& topology, Visit visit) {
  for (std::uint32_t side = 0; side < topology.side_twin.size(); ++side) {
    const std::uint32_t twin = topology.side_twin[side];
    if (twin != kNone && side < twin) visit(side, twin);
  }
}

// Many points of a side of a face, in the order of `t`.
inline std::vector<SurfacePoint> along_side(const PatchCache& cache, const Mesh& mesh,
                                            const Topology& topology, std::uint32_t side,
                                            const std::vector<double>& t) {
  const std::uint32_t face = topology.side_face[side];
  const int n = static_cast<int>(mesh.valence(face));
  const int k = static_cast<int>(side - mesh.face_begin[face]);
  std::vector<DomainPoint> at;
  for (const double x : t) {
    const Vec2 X = oracle::on_side(n, k, x);
    at.push_back({face, X.x(), X.y()});
  }
  std::vector<SurfacePoint> points(t.size());
  evaluate(cache, at, points);
  return points;
}

inline PatchKind kind_of(const PatchCache& cache, std::uint32_t face) {
  return cache.kind[cache.face_patch[face]];
}

inline Mesh with_normals(Mesh mesh) {
  add_vertex_normals(mesh);
  return mesh;
}

inline Mesh load_shared(const std::string& name) {
  return with_normals(load_mesh(shared_path(name + ".obj")));
}

// The diagonal of its box.
inline double size_of(const Mesh& mesh) {
  Vec3 low = mesh.positions.front(), high = low;
  for (const Vec3& p : mesh.positions) low = low.cwiseMin(p), high = high.cwiseMax(p);
  return (high - low).norm();
}

inline PatchCache cache_of(const Mesh& mesh, Precision precision = Precision::kDouble,
                           bool tame = true, BuildReport* report = nullptr) {
  BuildOptions options;
  options.precision = precision;
  options.tame = tame;
  return build_cache(mesh, options, report);
}

inline SurfacePoint at(const PatchCache& cache, std::uint32_t face, const Vec2& X) {
  return evaluate(cache, {face, X.x(), X.y()});
}

// Takes the numbers of a face's patch away, as no file can: its points and normals are none.
inline void break_patch(PatchCache& cache, std::uint32_t face) {
  auto& surface = std::get<Surface<double>>(cache.surface);
  const std::size_t begin = 3 * std::size_t{surface.control_begin[cache.face_patch[face]]};
  surface.control[begin] = std::numeric_limits<double>::quiet_NaN();
}

// The largest of many errors; a NaN stays.
struct Worst {
  double value = 0;
  void add(double error) {
    if (!(error <= value)) value = error;
  }
};

// A figure that the test reached: in its XML and on the terminal.
template <class... Args>
void record(const std::string& name, fmt::format_string<Args...> format, Args&&... args) {
  const std::string text = fmt::format(format, std::forward<Args>(args)...);
  std::string key = name;
  std::replace_if(
      key.begin(), key.end(), [](unsigned char c) { return !std::isalnum(c); }, '_');
  ::testing::Test::RecordProperty(key, text);
  fmt::print("  {}: {}\n", name, text);
}

}  // namespace gliss::test
