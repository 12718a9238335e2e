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

std::string shared_path(const std::string& name);

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
Mesh mesh_of(const Polygon& polygon);

// A face of a mesh that has normals.
Polygon polygon_of(const Mesh& mesh, std::size_t face);

// Calls visit(side, twin) once for every edge of two faces.
template <class Visit>
void for_each_inner_edge(const Topology& topology, Visit visit) {
  for (std::uint32_t side = 0; side < topology.side_twin.size(); ++side) {
    const std::uint32_t twin = topology.side_twin[side];
    if (twin != kNone && side < twin) visit(side, twin);
  }
}

// Many points of a side of a face, in the order of `t`.
std::vector<SurfacePoint> along_side(const PatchCache& cache, const Mesh& mesh,
                                     const Topology& topology, std::uint32_t side,
                                     const std::vector<double>& t);

PatchKind kind_of(const PatchCache& cache, std::uint32_t face);

Mesh with_normals(Mesh mesh);

Mesh load_shared(const std::string& name);

// The diagonal of its box.
double size_of(const Mesh& mesh);

// Patches as vertex normals alone have them, as the oracles do: thin parts bulge, which makes them
// harder to touch than what complete_mesh makes of them.
PatchCache unlimited_cache(Mesh mesh, const BuildOptions& options = {},
                           BuildReport* report = nullptr);
PatchCache cache_of(const Mesh& mesh, Precision precision = Precision::kDouble, bool tame = true,
                    BuildReport* report = nullptr,
                    Construction construction = Level{}.construction);
PatchCache paper_cache_of(const Mesh& mesh, Precision precision = Precision::kDouble,
                          bool tame = true, BuildReport* report = nullptr);

// Options of trackers whose contacts leap where nearest points do, as in the paper.
inline QueryOptions leaping(Method method = Method::kGregory) {
  QueryOptions options;
  options.method = method;
  options.settle = 0;
  return options;
}

SurfacePoint at(const PatchCache& cache, std::uint32_t face, const Vec2& X);

// Takes the numbers of a face's patch away, as no file can: its points and normals are none.
void break_patch(PatchCache& cache, std::uint32_t face);

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
