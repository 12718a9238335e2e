// Asks everything that says whether a hand is in a solid, and compares with the solids themselves.
#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>
#include <tuple>

#include "gliss/engine/opencl.h"
#include "gliss/generate/generate.h"
#include "gliss/surface/base_triangles.h"
#include "gliss/surface/names.h"
#include "gliss/validate/validate.h"
#include "tests/oracle/brute_force.h"
#include "tests/oracle/union_oracle.h"
#include "tests/support/require.h"
#include "tests/support/sharp_meshes.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

// A mesh, and how far a point is from the solid that it approximates: below 0 inside, and no
// farther than it is.
struct Solid {
  Mesh mesh;
  std::function<double(const Vec3&)> distance;
};

Solid exact_solid(const Generated& made, bool sharp) {
  return {sharp ? test::with_creases(made.mesh) : made.mesh,
          [exact = made.exact](const Vec3& x) { return exact->nearest(x).distance; }};
}

// A ball with a cavity, in which there is a ball.
Solid nested_solid() {
  Mesh mesh = nested_balls({20, -13, 7}).mesh;
  validate(mesh);
  return {mesh, [](const Vec3& x) {
            const double r = x.norm();
            return std::max(r - 20, std::min(13 - r, r - 7));
          }};
}

// A convex solid of flat faces, all of whose edges are sharp.
Solid convex_solid(std::vector<Vec3> positions,
                   const std::vector<std::vector<std::uint32_t>>& faces) {
  Mesh mesh;
  mesh.unit = 1e-3;
  mesh.positions = std::move(positions);
  std::vector<std::pair<Vec3, Vec3>> planes;
  for (const auto& face : faces) {
    mesh.corner_vertex.insert(mesh.corner_vertex.end(), face.begin(), face.end());
    mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corner_vertex.size()));
    const Vec3 &a = mesh.positions[face[0]], &b = mesh.positions[face[1]],
               &c = mesh.positions[face[2]];
    planes.emplace_back(a, (b - a).cross(c - a).normalized());
  }
  return {test::with_creases(mesh), [planes](const Vec3& x) {
            double most = -std::numeric_limits<double>::infinity();
            for (const auto& [at, normal] : planes) most = std::max(most, normal.dot(x - at));
            return most;
          }};
}

// Two flat faces meet in its edge at 2 degrees.
Solid wedge_solid() {
  const double half = 20 * std::tan(test::kDegree);
  return convex_solid(
      {{0, 0, 0}, {20, 0, -half}, {20, 0, half}, {0, 15, 0}, {20, 15, -half}, {20, 15, half}},
      {{0, 1, 2}, {3, 5, 4}, {0, 3, 4, 1}, {0, 2, 5, 3}, {1, 4, 5, 2}});
}

Solid box_solid() { return exact_solid(cube(3, 20), true); }
Solid torus_solid() { return exact_solid(torus(), false); }
Solid tetrahedron_solid() {
  return convex_solid({{0, 0, 0}, {20, 1, 0}, {3, 16, 0}, {5, 4, 12}},
                      {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
}

// All of them, in a row.
Solid row_of_solids() {
  std::vector<std::function<double(const Vec3&)>> distances;
  std::vector<Mesh> meshes;
  for (Solid (*make)() : {nested_solid, box_solid, torus_solid, tetrahedron_solid, wedge_solid}) {
    const Solid one = make();
    const Vec3 to(90.0 * static_cast<double>(meshes.size()), 0, 0);
    Mesh mesh = test::moved(one.mesh, to);
    mesh.normals.clear(), mesh.corner_normal.clear(), mesh.sharp.clear();
    meshes.push_back(mesh);
    distances.push_back([to, d = one.distance](const Vec3& x) { return d(x - to); });
  }
  Mesh all = test::joined(meshes);
  validate(all);
  return {test::with_creases(all), [distances](const Vec3& x) {
            double least = std::numeric_limits<double>::infinity();
            for (const auto& distance : distances) least = std::min(least, distance(x));
            return least;
          }};
}

struct NamedSolid {
  const char* name;
  Solid (*make)();
};
const NamedSolid kSolids[] = {{"nested_balls", nested_solid},
                              {"box", box_solid},
                              {"torus", torus_solid},
                              {"tetrahedron", tetrahedron_solid},
                              {"wedge", wedge_solid}};
const NamedSolid kRow{"row", row_of_solids};

// How far points of patches and of polygons are from the solid at most.
struct Departures {
  double patches = 0, polygons = 0;
};

Departures departures_of(const PatchCache& cache, const Solid& solid) {
  constexpr int kSteps = 12;
  Departures most;
  const auto add = [&](double& to, const Vec3& x) {
    to = std::max(to, std::abs(solid.distance(x)));
  };
  std::vector<DomainPoint> points;
  for (std::uint32_t face = 0; face < cache.mesh_face_count; ++face) {
    const std::uint32_t n = cache.face_valence[face];
    for (std::uint32_t k = 0; k < n; ++k) {
      for (int i = 0; i <= kSteps; ++i) {
        const DomainPoint side = on_side(face, n, k, 1.0 * i / kSteps);
        for (int j = 0; j <= kSteps; ++j)
          points.push_back({face, side.xi * j / kSteps, side.eta * j / kSteps});
      }
    }
  }
  std::vector<SurfacePoint> on(points.size());
  evaluate(cache, points, on);
  for (const SurfacePoint& p : on) add(most.patches, p.position);
  std::visit(
      [&](const auto& s) {
        for (std::uint32_t patch = 0; patch < cache.patch_count(); ++patch) {
          for_base_triangles(s, patch, Vec3::Zero(), [&](const BaseTriangle& t) {
            for (int i = 0; i <= kSteps; ++i) {
              for (int j = 0; i + j <= kSteps; ++j) {
                const double a = 1.0 * i / kSteps, b = 1.0 * j / kSteps;
                add(most.polygons,
                    cache.origin + (t[0] + a * (t[1] - t[0]) + b * (t[2] - t[0])) / cache.scale);
              }
            }
          });
        }
      },
      cache.surface);
  return most;
}

class Inside : public ::testing::TestWithParam<std::tuple<NamedSolid, const char*, Precision>> {};

// A million points each with GLISS_LONG_TESTS set.
TEST_P(Inside, is_inside_by_every_method_and_backend) {
  const bool is_long = std::getenv("GLISS_LONG_TESTS") != nullptr;
  const std::size_t count = is_long ? 1'000'000 : 1'000;
  const auto& [named, level, precision] = GetParam();
  const Solid solid = named.make();
  BuildOptions options;
  options.precision = precision;
  options.level = find_surface(level).value();
  const PatchCache cache = build_cache(solid.mesh, options);
  const Departures departs = departures_of(cache, solid);
  const double rounding =
      (precision == Precision::kDouble ? 1e-13 : 1e-6) * test::size_of(solid.mesh);

  std::vector<std::unique_ptr<Engine>> engines;
  engines.push_back(make_serial_engine());
  engines.push_back(make_tbb_engine(2));
  // To compile for a device takes seconds each.
  if (is_long || named.make == kRow.make) {
    try {
      OpenClOptions on_device;
      on_device.smallest_batch = 1;
      engines.push_back(make_opencl_engine(on_device));
    } catch (const DeviceError& error) {
      if (!is_long) GLISS_SKIP_UNLESS_REQUIRED(error.what());
    }
  }
  oracle::Rng rng(11);
  for (const auto& engine : engines) {
    std::vector<Vec3> hips;
    for (std::size_t i = 0; i < count; ++i)
      hips.push_back(test::random_in_box(rng, solid.mesh, 1.1));
    const auto surface = engine->reside(cache);
    for (const Method method : {Method::kGregory, Method::kShaded, Method::kFlat}) {
      const double near =
          rounding + 1.05 * (method == Method::kGregory ? departs.patches : departs.polygons);
      std::vector<Contact> found(count);
      surface->nearest(hips, {&method, 1}, {}, found);
      std::size_t wrong = 0, judged = 0;
      for (std::size_t i = 0; i < count; ++i) {
        const double distance = solid.distance(hips[i]);
        if (std::abs(distance) <= near) continue;
        ++judged;
        wrong += found[i].touching != (distance < 0);
      }
      EXPECT_EQ(wrong, 0u) << method_name(method) << " by " << engine->name();
      EXPECT_GT(judged, count / 2);
      test::record(fmt::format("{} by {}", method_name(method), engine->name()),
                   "{} wrong of {} beyond {:.2g} mm", wrong, judged, near);
    }
  }
}

std::string name_of_case(const ::testing::TestParamInfo<Inside::ParamType>& info) {
  const auto& [solid, level, precision] = info.param;
  std::string name = fmt::format("{}_{}_{}", solid.name, level, precision_name(precision));
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}
const auto kBothPrecisions = ::testing::Values(Precision::kDouble, Precision::kFloat);
INSTANTIATE_TEST_SUITE_P(, Inside,
                         ::testing::Combine(::testing::ValuesIn(kSolids),
                                            ::testing::Values("exact", "ribbon", "bezier", "table",
                                                              "fair", "fair-ribbon", "fair-bezier",
                                                              "fair-table"),
                                            kBothPrecisions),
                         name_of_case);
INSTANTIATE_TEST_SUITE_P(OnDevices, Inside,
                         ::testing::Combine(::testing::Values(kRow), ::testing::Values("fair"),
                                            kBothPrecisions),
                         name_of_case);

// Frusta from knives to blocks, with the creases of the usual rule: some of their edges turn by
// little and some by nearly all, and what it leaves smooth meets at corners of what it keeps sharp.
TEST(InsideFrusta, is_inside_with_the_usual_creases) {
  oracle::Rng rng(4);
  for (int made = 0; made < 60; ++made) {
    const std::uint32_t n = 3 + static_cast<std::uint32_t>(made) % 3;
    const double high = std::pow(10, oracle::uniform(rng, -0.3, 1.6)),
                 narrow = oracle::uniform(rng, 0.1, 0.95), flat = oracle::uniform(rng, 0.4, 1);
    std::vector<Vec3> corners;
    for (const double z : {high / 2, -high / 2}) {
      for (std::uint32_t k = 0; k < n; ++k) {
        const double angle = 2 * std::numbers::pi * k / n, size = z > 0 ? 20 * narrow : 20;
        corners.emplace_back(size * std::cos(angle), flat * size * std::sin(angle), z);
      }
    }
    std::vector<std::vector<std::uint32_t>> faces(2);
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t next = (k + 1) % n;
      faces[0].push_back(k);
      faces[1].push_back(2 * n - 1 - k);
      faces.push_back({k, n + k, n + next, next});
    }
    const Solid solid = convex_solid(corners, faces);
    const PatchCache cache = build_cache(test::with_creases(solid.mesh, {}));
    const double off = cache.departure.distance + 1e-3 * test::size_of(solid.mesh);
    for (int i = 0; i < 1000; ++i) {
      const Vec3 x = test::random_in_box(rng, solid.mesh, 1.15);
      const double distance = solid.distance(x);
      if (std::abs(distance) <= off) continue;
      EXPECT_EQ(nearest(cache, x).touching, distance < 0)
          << n << " sides, " << high << " high, " << narrow << " narrow, at " << x.transpose();
    }
  }
}

}  // namespace
}  // namespace gliss
