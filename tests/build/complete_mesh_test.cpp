// Patches stay near their polygons: plates, rods and boxes are as thick as their meshes, smooth
// shapes are what they are without any limit, and patches are as smooth as ever.
#include "gliss/build/complete_mesh.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "gliss/build/build_cache.h"
#include "gliss/generate/generate.h"
#include "gliss/mesh/creases.h"
#include "gliss/query/query.h"
#include "gliss/walk/fidelity.h"
#include "tests/support/random_meshes.h"
#include "tests/support/sharp_meshes.h"

namespace gliss {
namespace {

using test::add_face;

// A box as six quads, or as twelve triangles.
Mesh box(const Vec3& size, bool in_triangles = false) {
  Mesh mesh = test::cube();
  for (Vec3& p : mesh.positions) p = p.cwiseProduct(size);
  return in_triangles ? test::in_triangles(mesh) : mesh;
}

// A rod of `around` sides along z, with n-gon caps. A bend that is finer than it is long lies at
// one of its ends, if it is bent.
Mesh rod(std::uint32_t around, double radius, double length, bool is_bent = false) {
  Mesh mesh;
  mesh.source = is_bent ? "bent rod" : "rod";
  const int rings = is_bent ? 8 : 2;
  for (int i = 0; i < rings; ++i) {
    // A quarter of a circle of 3 radii goes on from the long piece.
    const double angle = is_bent && i > 0 ? (i - 1) * std::numbers::pi / 12 : 0, bend = 3 * radius;
    const Vec3 middle =
        i == 0 ? Vec3::Zero()
               : Vec3(bend * (1 - std::cos(angle)), 0, length + bend * std::sin(angle));
    const Vec3 across(std::cos(angle), 0, -std::sin(angle));
    for (std::uint32_t k = 0; k < around; ++k) {
      const double turn = 2 * std::numbers::pi * k / around;
      mesh.positions.push_back(middle +
                               radius * (std::cos(turn) * across + std::sin(turn) * Vec3::UnitY()));
    }
  }
  const auto at = [&](int ring, std::uint32_t k) {
    return static_cast<std::uint32_t>(ring) * around + k % around;
  };
  for (int i = 0; i + 1 < rings; ++i)
    for (std::uint32_t k = 0; k < around; ++k)
      add_face(mesh, {at(i, k), at(i, k + 1), at(i + 1, k + 1), at(i + 1, k)});
  for (std::uint32_t k = around; k-- > 0;) mesh.corner_vertex.push_back(k);
  mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corner_vertex.size()));
  for (std::uint32_t k = 0; k < around; ++k) mesh.corner_vertex.push_back(at(rings - 1, k));
  mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corner_vertex.size()));
  return mesh;
}

// A slab with round corners of `radius` and a half round rim, as CAD triangulates it: its straight
// sides are strips of two triangles, far longer than they are wide, beside fine arcs.
Mesh rounded_slab(double length, double width, double thickness, double radius, std::uint32_t rim,
                  std::uint32_t corner) {
  Mesh mesh;
  mesh.source = "rounded slab";
  const std::uint32_t around = 4 * (corner + 1);
  for (std::uint32_t i = 0; i <= rim; ++i) {
    const double up = std::numbers::pi * (i / static_cast<double>(rim) - 0.5);
    const double out = radius - thickness / 2 * (1 - std::cos(up));
    for (std::uint32_t k = 0; k < around; ++k) {
      const std::uint32_t quarter = k / (corner + 1), step = k % (corner + 1);
      const double turn = std::numbers::pi / 2 * (quarter + step / static_cast<double>(corner));
      const double x = quarter == 0 || quarter == 3 ? 1 : -1, y = quarter < 2 ? 1 : -1;
      mesh.positions.push_back({x * (length / 2 - radius) + out * std::cos(turn),
                                y * (width / 2 - radius) + out * std::sin(turn),
                                thickness / 2 * std::sin(up)});
    }
  }
  const auto at = [&](std::uint32_t ring, std::uint32_t k) { return ring * around + k % around; };
  for (std::uint32_t i = 0; i < rim; ++i)
    for (std::uint32_t k = 0; k < around; ++k)
      add_face(mesh, {at(i, k), at(i, k + 1), at(i + 1, k + 1), at(i + 1, k)});
  std::vector<std::uint32_t> bottom, top;
  for (std::uint32_t k = 0; k < around; ++k) {
    bottom.push_back(around - 1 - k);
    top.push_back(at(rim, k));
  }
  for (const auto& cap : {bottom, top}) {
    mesh.corner_vertex.insert(mesh.corner_vertex.end(), cap.begin(), cap.end());
    mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corner_vertex.size()));
  }
  return test::in_triangles(mesh);
}

struct Built {
  Mesh mesh;
  Topology topology;
  PatchCache cache;

  explicit Built(Mesh given, Construction construction = Construction::kFair)
      : mesh(std::move(given)), topology(complete_mesh(mesh, construction)) {
    BuildOptions options;
    options.level.construction = construction;
    cache = build_cache(mesh, topology, options);
  }
  // The largest distance of the patches from the polygons.
  double departure() const {
    QueryOptions flat;
    flat.method = Method::kFlat;
    double most = 0;
    std::vector<DomainPoint> at = spread_points(cache, 4000);
    std::vector<SurfacePoint> points(at.size());
    evaluate(cache, at, points);
    for (const SurfacePoint& p : points)
      most = std::max(most, std::abs(nearest(cache, p.position, flat).distance));
    return most;
  }
};

TEST(CompleteMesh, thin_parts_are_as_thick_as_their_meshes) {
  for (const Construction construction : {Construction::kFair, Construction::kPaper}) {
    for (const bool is_sharp : {false, true}) {
      // The middle of the paper's patches does not follow their sides.
      if (!is_sharp && construction == Construction::kPaper) continue;
      const auto departure = [&](Mesh mesh) {
        mark_creases(mesh, build_topology(mesh), {.none = !is_sharp});
        const Built built(std::move(mesh), construction);
        EXPECT_LT(normal_gaps(built.mesh, built.topology, built.cache, Method::kGregory).largest,
                  2e-10)
            << built.mesh.source;
        return built.departure();
      };
      SCOPED_TRACE(std::string(is_sharp ? "sharp" : "smooth") +
                   (construction == Construction::kFair ? ", fair" : ", paper"));
      // A plate's middle may rise by as much again as its edges.
      const double most = is_sharp ? 1e-9 : 2.0 / 3;
      EXPECT_LE(departure(box({40, 40, 0.2})), most * 0.2);
      EXPECT_LE(departure(box({40, 40, 0.2}, true)), most * 0.2);
      EXPECT_LE(departure(box({100, 4, 4})), most * 4);
      EXPECT_LE(departure(rod(12, 0.5, 100)), (is_sharp ? 0.1 : 2.0 / 3) * 1);
      EXPECT_LE(departure(rod(12, 0.2, 60, true)), 2.0 / 3 * 0.4);
    }
  }
}

// No face is sharp, so that nothing but fine arcs at their ends bends the long sides. What bulges
// is a side of the outline, within the plane of the slab.
TEST(CompleteMesh, long_sides_beside_fine_arcs_stay_straight) {
  for (const Mesh& slab :
       {rounded_slab(203.2, 304.8, 12.7, 25.4, 12, 6), rounded_slab(20, 300, 4, 4, 6, 3),
        rounded_slab(150, 150, 1, 20, 8, 10), rounded_slab(60, 16, 8, 6, 16, 16)}) {
    SCOPED_TRACE(fmt::format("{} vertices", slab.positions.size()));
    const Built built(slab);
    const double half = slab.positions.back().z(), side = slab.positions.front().norm();
    EXPECT_LE(built.departure(), std::max(2 * half / 3, 0.01 * side));
    for (const Construction construction : {Construction::kFair, Construction::kPaper}) {
      // The flat of the top, whose rim the round one touches.
      const Built flat(slab, construction);
      const std::vector<DomainPoint> at = spread_points(flat.cache, 20000);
      std::vector<SurfacePoint> points(at.size());
      evaluate(flat.cache, at, points);
      const auto faces = static_cast<std::uint32_t>(slab.face_count());
      const auto on_top =
          std::ranges::count_if(slab.positions, [&](const Vec3& p) { return p.z() == half; });
      const auto cap = static_cast<std::uint32_t>(on_top - 2);  // triangles
      for (std::size_t i = 0; i < at.size(); ++i) {
        if (at[i].face >= faces - cap) {
          EXPECT_NEAR(points[i].position.z(), half, 1e-9 * half);
        }
      }
    }
  }
}

// Its own triangles run round a centre, which is not on those of the polygon.
TEST(CompleteMesh, the_departure_of_a_cut_face_is_measured_from_its_polygon) {
  Mesh saddle = rod(12, 3, 8);
  for (std::size_t k = 12; k < 24; ++k)
    saddle.positions[k].z() += std::cos(std::numbers::pi / 3 * static_cast<double>(k));
  mark_creases(saddle, build_topology(saddle), {.angle = 1});
  const Built built(saddle);
  ASSERT_GT(built.cache.patch_count(), built.cache.mesh_face_count);
  EXPECT_NEAR(built.cache.departure.distance, built.departure(), 0.1 * built.departure());
}

// Nothing is limited where nothing bulges: normals and tangents are those of add_vertex_normals.
TEST(CompleteMesh, smooth_shapes_are_left_alone) {
  test::Rng rng(7);
  const std::vector<Mesh> meshes{torus(12, 8).mesh,
                                 torus_knot(60, 8).mesh,
                                 goldberg(1).mesh,
                                 goldberg(4).mesh,
                                 ellipsoid(3).mesh,
                                 irregular(torus(), 1).mesh,
                                 test::random_sphere(rng, 200, 10),
                                 test::random_ellipsoid(rng, 200, {20, 12, 8})};
  for (const Mesh& mesh : meshes) {
    for (const Mesh& given : {mesh, test::without_normals(mesh)}) {
      for (const Construction construction : {Construction::kFair, Construction::kPaper}) {
        Mesh complete = given, plain = given;
        complete_mesh(complete, construction);
        add_vertex_normals(plain, normal_weights(construction));
        EXPECT_EQ(complete.normals, plain.normals) << mesh.source;
        EXPECT_TRUE(complete.tangents.empty()) << mesh.source;
      }
    }
  }
}

TEST(CompleteMesh, a_complete_mesh_stays_as_it_is) {
  Mesh mesh = box({40, 40, 0.2});
  complete_mesh(mesh, Construction::kFair);
  ASSERT_FALSE(mesh.tangents.empty());
  Mesh again = mesh;
  complete_mesh(again, Construction::kFair);
  EXPECT_EQ(again.normals, mesh.normals);
  EXPECT_EQ(again.tangents, mesh.tangents);
}

// Normals of a file count: only tangents give way.
TEST(CompleteMesh, normals_of_the_mesh_are_kept) {
  Mesh mesh = box({40, 40, 0.2});
  add_vertex_normals(mesh);
  const std::vector<Vec3> normals = mesh.normals;
  const Built built(mesh);
  EXPECT_EQ(built.mesh.normals, normals);
  EXPECT_LT(built.departure(), 2.0 / 3 * 0.2);
}

}  // namespace
}  // namespace gliss
