// The surface beside creases, judged by points of it alone: flat, round and closed where it shall
// be, and smooth across every edge that no crease cuts.
#include <gtest/gtest.h>

#include "gliss/surface/names.h"

#include "tests/support/joints.h"
#include "tests/support/sharp_meshes.h"

namespace gliss::test {
namespace {

std::vector<Level> levels() {
  std::vector<Level> all;
  for (const Construction construction : {Construction::kPaper, Construction::kFair})
    for (const Level::Kind kind : {Level::kExact, Level::kRibbon, Level::kBezier})
      all.push_back({kind, 0, construction});
  return all;
}

PatchCache cache_at(const Mesh& mesh, const Level& level, BuildReport* report = nullptr) {
  BuildOptions options;
  options.level = level;
  return build_cache(mesh, options, report);
}

// With the normals that the level's construction makes.
Mesh sharpened(Mesh mesh, const Level& level) {
  add_vertex_normals(mesh, normal_weights(level.construction));
  return mesh;
}

TEST(CreaseSurface, faces_of_boxes_and_prisms_are_flat_to_rounding) {
  Worst off, tilt;
  for (const Mesh& shape : {cube(), in_triangles(cube()), l_solid(), in_triangles(l_solid()),
                            corner_solid(), prism(6).mesh, prism(3).mesh, prism(9).mesh}) {
    for (const Level& level : levels()) {
      const Mesh mesh = sharpened(with_creases(shape, {.angle = 30 * kDegree}), level);
      BuildReport report;
      const PatchCache cache = cache_at(mesh, level, &report);
      EXPECT_TRUE(report.flagged_faces.empty()) << shape.source;
      const double size = size_of(mesh);
      for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        const Vec3 normal = newell_normal(mesh, f).normalized();
        const Vec3& on = mesh.positions[mesh.corner_vertex[mesh.face_begin[f]]];
        for (const SurfacePoint& p : points_of(cache, f)) {
          off.add(std::abs((p.position - on).dot(normal)) / size);
          tilt.add((p.normal - normal).norm());
        }
      }
    }
  }
  record("off the planes, of the size", "{:.1e}", off.value);
  record("normals off", "{:.1e} rad", tilt.value);
  EXPECT_LT(off.value, 1e-15);
  EXPECT_LT(tilt.value, 1e-14);
}

Mesh in_order(const Mesh& mesh, const std::vector<std::uint32_t>& faces) {
  Mesh ordered;
  ordered.source = mesh.source;
  ordered.positions = mesh.positions;
  for (const std::uint32_t f : faces) {
    for (std::uint32_t s = mesh.face_begin[f]; s < mesh.face_begin[f + 1]; ++s)
      ordered.corner_vertex.push_back(mesh.corner_vertex[s]);
    ordered.face_begin.push_back(static_cast<std::uint32_t>(ordered.corner_vertex.size()));
  }
  return ordered;
}

// Patches are built together with others of their kind, whatever faces lie between: here caps whose
// many sides are not fair.
TEST(CreaseSurface, a_face_is_the_same_wherever_it_stands) {
  const Mesh shape = prism(40).mesh;
  const auto count = static_cast<std::uint32_t>(shape.face_count());
  std::vector<std::uint32_t> quads, mixed;
  for (std::uint32_t f = 0; f < count; ++f) {
    if (shape.valence(f) == 4) quads.push_back(f);
  }
  mixed = quads;
  for (std::uint32_t f = 0; f < count; ++f) {
    if (shape.valence(f) != 4) mixed.insert(mixed.begin() + 3, f);
  }
  for (const Level& level : levels()) {
    const PatchCache cache = cache_at(sharpened(with_creases(shape), level), level),
                     other =
                         cache_at(sharpened(with_creases(in_order(shape, mixed)), level), level);
    for (std::uint32_t f = 0; f < count; ++f) {
      const auto there = points_of(cache, mixed[f]), here = points_of(other, f);
      ASSERT_EQ(there.size(), here.size());
      for (std::size_t i = 0; i < here.size(); ++i)
        ASSERT_LT((there[i].position - here[i].position).norm(), 1e-12) << f;
    }
  }
}

// A cylinder of radius 10: how far its caps are off their planes, the rims and the side off the
// radius.
TEST(CreaseSurface, a_cylinder_is_round_and_its_caps_are_flat) {
  for (const auto& [around, most_side, most_rim] :
       {std::tuple(12, 9e-4, 5e-7), std::tuple(16, 3e-4, 1e-7), std::tuple(64, 1.2e-6, 1e-10)}) {
    for (const Level& level : levels()) {
      const Mesh mesh = sharpened(with_creases(prism(around).mesh), level);
      const PatchCache cache = cache_at(mesh, level);
      Worst cap, rim, side, tilt;
      for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        const bool is_cap = mesh.valence(f) != 4;
        for (const SurfacePoint& p : points_of(cache, f)) {
          const Vec3 radial = Vec3(p.position.x(), p.position.y(), 0);
          if (is_cap) {
            cap.add(std::abs(std::abs(p.position.z()) - 5));
            EXPECT_LT(Vec3(p.normal.x(), p.normal.y(), 0).norm(), 1e-13);
          } else {
            side.add(std::abs(radial.norm() - 10) / 10);
            tilt.add(oracle::angle<double>(p.normal, radial));
          }
        }
        for (std::uint32_t s = mesh.face_begin[f]; is_cap && s < mesh.face_begin[f + 1]; ++s) {
          for (const SurfacePoint& p : along_side(cache, mesh, build_topology(mesh), s, places()))
            rim.add(std::abs(std::hypot(p.position.x(), p.position.y()) - 10) / 10);
        }
      }
      record(fmt::format("{} of {}", surface_name(level), around),
             "cap {:.1e}, rim {:.1e}, side {:.1e}, normals {:.1e} rad", cap.value / 10, rim.value,
             side.value, tilt.value);
      EXPECT_LT(cap.value / 10, 1e-15);
      EXPECT_LT(rim.value, most_rim);
      EXPECT_LT(side.value, most_side);
    }
  }
}

// Caps cut into triangles: where two sides of one lie on the rim, its corner is straight.
TEST(CreaseSurface, triangles_with_two_sides_on_a_rim_are_flat) {
  for (const Level& level : levels()) {
    const Mesh mesh = sharpened(with_creases(in_triangles(prism(12).mesh)), level);
    BuildReport report;
    const PatchCache cache = cache_at(mesh, level, &report);
    Worst off, tilt;
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
      const Vec3 face = newell_normal(mesh, f).normalized();
      if (std::abs(face.z()) < 0.5) continue;
      for (const SurfacePoint& p : points_of(cache, f)) {
        off.add(std::abs(std::abs(p.position.z()) - 5));
        tilt.add((p.normal - face).norm());
      }
    }
    record(surface_name(level), "{:.1e} off, normals {:.1e} rad; {} flagged", off.value, tilt.value,
           report.flagged_faces.size());
    EXPECT_EQ(report.bent, 0u);
    EXPECT_LT(off.value, 1e-14);
    EXPECT_LT(tilt.value, 1e-9);
  }
}

TEST(CreaseSurface, is_closed_at_cuts_and_smooth_elsewhere) {
  std::vector<Mesh> meshes{with_creases(prism(12).mesh),
                           with_creases(in_triangles(prism(12).mesh)),
                           with_creases(ridge(), {.angle = 80 * kDegree}),
                           with_creases(in_triangles(ridge()), {.angle = 80 * kDegree}),
                           with_creases(fin().mesh),
                           with_creases(in_triangles(fin().mesh))};
  // A tenth of the edges by chance: darts, corners and borders of all kinds.
  oracle::Rng chance(3);
  for (Mesh mesh : {torus(16, 10).mesh, in_triangles(torus(16, 10).mesh), goldberg(3).mesh,
                    ridge(6), in_triangles(banana(14, 8).mesh)}) {
    const Topology topology = build_topology(mesh);
    std::vector<std::uint32_t> sides;
    for (std::uint32_t side = 0; side < topology.side_twin.size(); ++side)
      if (topology.side_twin[side] != kNone && chance() % 20 == 0) sides.push_back(side);
    mark_creases(mesh, topology, {}, sides);
    meshes.push_back(mesh);
  }
  for (const Mesh& marked : meshes) {
    for (const Level& level : levels()) {
      const Mesh mesh = sharpened(marked, level);
      BuildReport report;
      const Joints found = joints_of(mesh, cache_at(mesh, level, &report));
      EXPECT_LT(found.gap.value, 1e-14) << mesh.source << " " << surface_name(level);
      EXPECT_LT(found.off_curve.value, 1e-14) << mesh.source << " " << surface_name(level);
      EXPECT_LT(found.bend.value, 1e-11) << mesh.source << " " << surface_name(level);
      record(mesh.source + " " + surface_name(level),
             "gap {:.1e}, off the curve {:.1e}, normals {:.1e} rad; {} flagged, {} bent",
             found.gap.value, found.off_curve.value, found.bend.value, report.flagged_faces.size(),
             report.bent);
    }
  }
}

// The ridge that fades: its sharp half is a roof of two planes, and past the dart it is a cone. A
// fair patch knows how its vertices bend, and so sees a face farther.
TEST(CreaseSurface, a_fading_ridge_is_sharp_to_its_end) {
  for (const Level& level : levels()) {
    const Mesh mesh = sharpened(with_creases(ridge(), {.angle = 80 * kDegree}), level);
    const PatchCache cache = cache_at(mesh, level);
    const double roof = level.construction == Construction::kFair ? 0.5 : 0.25;
    Worst off;
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
      double least = 1;
      for (std::uint32_t c = mesh.face_begin[f]; c < mesh.face_begin[f + 1]; ++c)
        least = std::min(least, mesh.positions[mesh.corner_vertex[c]].y());
      if (least < roof) continue;
      for (const SurfacePoint& p : points_of(cache, f))
        off.add(std::abs(p.position.z() + std::abs(p.position.x())));
    }
    record(surface_name(level), "{:.1e} off the roof", off.value);
    EXPECT_LT(off.value, 1e-14);
  }
}

}  // namespace
}  // namespace gliss::test
