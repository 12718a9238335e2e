// The surface over rounded creases, judged by points of it alone: flat where it was flat, round
// where a ball rolled, and smooth across every edge.
#include <gtest/gtest.h>

#include "gliss/mesh/rounding.h"
#include "gliss/surface/names.h"
#include "tests/support/joints.h"
#include "tests/support/sharp_meshes.h"

namespace gliss::test {
namespace {

Mesh rounded(const Mesh& shape, double radius, double degrees = 40) {
  Mesh mesh = with_creases(shape, {.angle = degrees * kDegree});
  round_creases(mesh, radius * mesh.unit);
  return mesh;
}

std::vector<Level> smooth_levels() {
  std::vector<Level> all;
  for (const Construction construction : {Construction::kPaper, Construction::kFair})
    for (const Level::Kind kind : {Level::kExact, Level::kRibbon, Level::kBezier})
      all.push_back({kind, 0, construction});
  return all;
}

PatchCache rounded_cache(const Mesh& mesh, const Level& level, BuildReport* report = nullptr) {
  BuildOptions options;
  options.level = level;
  return build_cache(mesh, options, report);
}

// A cube of side 20 with a radius of 2: the ball's centre is at most 8 from the middle on each
// axis, and the surface 2 from the box of these places.
TEST(RoundedSurface, a_cube_is_what_a_ball_leaves_of_it) {
  for (const Mesh& shape :
       {gliss::cube(1, 20).mesh, gliss::cube(4, 20).mesh, in_triangles(gliss::cube(1, 20).mesh)}) {
    const Mesh mesh = rounded(shape, 2);
    for (const Level& level : smooth_levels()) {
      BuildReport report;
      const PatchCache cache = rounded_cache(mesh, level, &report);
      EXPECT_TRUE(report.flagged_faces.empty());
      Worst flat, tilt, strip, strip_tilt, corner, corner_tilt;
      for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        for (const SurfacePoint& p : points_of(cache, f)) {
          const Vec3 centre = p.position.cwiseMax(-8).cwiseMin(8), from = p.position - centre;
          const double off = std::abs(from.norm() - 2) / 2,
                       turned = oracle::angle<double>(from, p.normal);
          if (f < shape.face_count()) {
            flat.add(off), tilt.add(turned);
          } else if (f < shape.face_count() + mesh.strips.size()) {
            strip.add(off), strip_tilt.add(turned);
          } else {
            corner.add(off), corner_tilt.add(turned);
          }
        }
      }
      record(shape.source + " " + surface_name(level),
             "flat {:.1e}, {:.1e} rad; strips {:.1e} of the radius, {:.1e} rad; corners {:.1e}, "
             "{:.1e} rad; least radius {:.3f}",
             flat.value, tilt.value, strip.value, strip_tilt.value, corner.value, corner_tilt.value,
             cache.smallest_rho());
      EXPECT_LT(flat.value, 1e-14);
      EXPECT_LT(tilt.value, 1e-13);
      const bool fair = level.construction == Construction::kFair;
      EXPECT_LT(strip.value, fair ? 1e-5 : 5e-3);
      EXPECT_LT(strip_tilt.value, fair ? 1e-4 : 0.02);
      EXPECT_LT(corner.value, 6e-3);
      EXPECT_LT(corner_tilt.value, 0.03);
      EXPECT_GT(cache.smallest_rho(), 0.65 * 2);
    }
  }
}

// The same where the radius spans three rings of faces, or eight: along edges the surface is a
// cylinder, as if there were no rings.
TEST(RoundedSurface, rings_of_small_faces_change_nothing) {
  const Mesh fine = without_normals(gliss::cube(20, 20).mesh);
  for (const Mesh& shape : {fine, in_triangles(fine), shaken(in_triangles(fine), 0.3, 4)}) {
    for (const double r : {3.0, 8.0}) {
      const Mesh mesh = rounded(shape, r);
      BuildReport report;
      const PatchCache cache =
          rounded_cache(mesh, {Level::kExact, 0, Construction::kFair}, &report);
      EXPECT_TRUE(report.flagged_faces.empty());
      Worst flat, tilt, strip, strip_tilt;
      for (std::uint32_t f = 0; f < shape.face_count() + mesh.strips.size(); ++f) {
        for (const SurfacePoint& p : points_of(cache, f)) {
          const Vec3 from = p.position - p.position.cwiseMax(r - 10).cwiseMin(10 - r);
          const double off = std::abs(from.norm() - r) / r,
                       turned = oracle::angle<double>(from, p.normal);
          (f < shape.face_count() ? flat : strip).add(off);
          (f < shape.face_count() ? tilt : strip_tilt).add(turned);
        }
      }
      record(
          fmt::format("{} {}", shape.source, r),
          "flat {:.1e}, {:.1e} rad; strips {:.1e} of the radius, {:.1e} rad; least radius {:.3f}",
          flat.value, tilt.value, strip.value, strip_tilt.value, cache.smallest_rho() / r);
      EXPECT_LT(flat.value, 1e-14);
      EXPECT_LT(tilt.value, 1e-13);
      EXPECT_LT(strip.value, 1e-5);
      EXPECT_LT(strip_tilt.value, 1e-4);
      EXPECT_GT(cache.smallest_rho(), 0.65 * r);
    }
  }
}

// The rim of a wall of 40 rings, over 8 of which the ball reaches.
TEST(RoundedSurface, a_rim_of_several_rings_is_a_piece_of_a_torus) {
  const Mesh wall = without_normals(cylinder(64, 40, 20, 40).mesh);
  for (const Mesh& shape : {wall, in_triangles(wall)}) {
    const Mesh mesh = rounded(shape, 8);
    const PatchCache cache = rounded_cache(mesh, {Level::kExact, 0, Construction::kFair});
    Worst off, tilt;
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
      for (const SurfacePoint& p : points_of(cache, f)) {
        Vec3 centre = Vec3(p.position.x(), p.position.y(), 0);
        centre = std::min(12.0, centre.norm()) * centre.stableNormalized();
        centre.z() = std::clamp(p.position.z(), -12.0, 12.0);
        off.add(std::abs((p.position - centre).norm() - 8) / 8);
        tilt.add(oracle::angle<double>(p.position - centre, p.normal));
      }
    }
    record(shape.source, "{:.1e} of the radius, {:.1e} rad", off.value, tilt.value);
    EXPECT_LT(off.value, 1e-4);
    EXPECT_LT(tilt.value, 2e-3);
  }
}

// Convex, concave and mixed corners, rims, borders, and creases that end.
TEST(RoundedSurface, is_closed_and_smooth_across_every_edge) {
  struct Case {
    Mesh mesh;
    double radius, degrees = 40;
  };
  for (const auto& [shape, radius, degrees] :
       {Case{cube(), 0.1},
        Case{cube(), 0.4},
        Case{in_triangles(cube()), 0.1},
        Case{l_solid(), 0.2},
        Case{in_triangles(l_solid()), 0.2},
        Case{corner_solid(), 0.2},
        Case{in_triangles(corner_solid()), 0.2},
        Case{prism(3).mesh, 1},
        Case{prism(6).mesh, 1},
        Case{prism(12).mesh, 1},
        Case{in_triangles(prism(12).mesh), 1},
        Case{cylinder(24).mesh, 1},
        Case{in_triangles(cylinder(24).mesh), 1},
        Case{ridge(), 0.05, 80},
        Case{in_triangles(ridge()), 0.05, 80},
        Case{without_normals(gliss::cube(8, 20).mesh), 6},
        Case{shaken(in_triangles(without_normals(gliss::cube(8, 20).mesh)), 0.5, 3), 6},
        Case{fine_l_solid(4), 0.3},
        Case{in_triangles(fine_l_solid(4)), 0.25},
        Case{drilled_plate(64, 0.55), 4.5}}) {
    const Mesh mesh = rounded(shape, radius, degrees);
    EXPECT_GT(mesh.strips.size(), 0u);
    EXPECT_EQ(build_topology(mesh).border_side_count == 0,
              build_topology(shape).border_side_count == 0);
    for (const Level& level : smooth_levels()) {
      BuildReport report;
      const Joints found = joints_of(mesh, rounded_cache(mesh, level, &report));
      record(fmt::format("{} {} {}", shape.source, radius, surface_name(level)),
             "gap {:.1e}, off the curve {:.1e}, normals {:.1e} rad; {} of {} flagged, {} bent",
             found.gap.value, found.off_curve.value, found.bend.value, report.flagged_faces.size(),
             mesh.face_count(), report.bent);
      EXPECT_LT(found.gap.value, 1e-14) << shape.source << " " << surface_name(level);
      EXPECT_LT(found.off_curve.value, 1e-14) << shape.source << " " << surface_name(level);
      EXPECT_LT(found.bend.value, 1e-11) << shape.source << " " << surface_name(level);
      if (level.construction == Construction::kFair) {
        EXPECT_EQ(report.bent, 0u) << shape.source;
      }
    }
  }
}

// The foot of a notch, where two convex creases meet a concave one: round its edge, now an arc of
// radius r, the ball's centre is on a circle of radius 2 r.
TEST(RoundedSurface, the_foot_of_a_notch_is_a_piece_of_a_torus) {
  constexpr double kRadius = 0.2, kMiddle = 1 + kRadius;
  for (const Mesh& shape : {l_solid(), in_triangles(l_solid())}) {
    const Mesh mesh = rounded(shape, kRadius);
    const std::size_t first = mesh.face_count() - mesh.rounded_corners.size();
    for (const Level& level : smooth_levels()) {
      const PatchCache cache = rounded_cache(mesh, level);
      Worst off, tilt;
      std::size_t faces = 0;
      for (std::size_t i = 0; i < mesh.rounded_corners.size(); ++i) {
        const Vec3& foot = shape.positions[mesh.rounded_corners[i]];
        if (foot.x() != 1 || foot.y() != 1) continue;
        ++faces;
        for (const SurfacePoint& p : points_of(cache, static_cast<std::uint32_t>(first + i))) {
          Vec3 centre = p.position - Vec3(kMiddle, kMiddle, 0);
          centre.z() = 0;
          centre = Vec3(kMiddle, kMiddle, 0) + 2 * kRadius * centre.normalized();
          centre.z() = foot.z() == 0 ? kRadius : 1 - kRadius;
          const Vec3 from = p.position - centre;
          off.add(std::abs(from.norm() - kRadius) / kRadius);
          tilt.add(oracle::angle<double>(from, p.normal));
        }
      }
      record(shape.source + " " + surface_name(level),
             "{:.1e} of the radius, {:.1e} rad; least radius {:.3f} of it", off.value, tilt.value,
             cache.smallest_rho() / kRadius);
      EXPECT_EQ(faces, 2 * 4u);
      EXPECT_LT(off.value, 0.03);
      EXPECT_LT(tilt.value, 0.15);
      EXPECT_GT(cache.smallest_rho(), 0.4 * kRadius);
    }
  }
}

// The rim of a cylinder of radius 10: the ball's centre is on a circle.
TEST(RoundedSurface, a_rim_is_a_piece_of_a_torus) {
  for (const auto& [around, most, most_tilt] :
       {std::tuple(12, 0.012, 0.04), std::tuple(24, 6e-3, 0.02), std::tuple(64, 5e-3, 0.02)}) {
    const Mesh mesh = rounded(prism(around).mesh, 1);
    const auto strips = static_cast<std::uint32_t>(mesh.face_count() - mesh.strips.size());
    for (const Level& level : smooth_levels()) {
      const PatchCache cache = rounded_cache(mesh, level);
      Worst cap, rim, tilt;
      for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        for (const SurfacePoint& p : points_of(cache, f)) {
          if (f < strips) {
            if (mesh.valence(f) != 4) cap.add(std::abs(std::abs(p.position.z()) - 5) / 10);
            continue;
          }
          Vec3 centre = 9 * Vec3(p.position.x(), p.position.y(), 0).normalized();
          centre.z() = p.position.z() > 0 ? 4 : -4;
          const Vec3 from = p.position - centre;
          rim.add(std::abs(from.norm() - 1));
          tilt.add(oracle::angle<double>(from, p.normal));
        }
      }
      record(fmt::format("{} of {}", surface_name(level), around),
             "cap {:.1e}, rim {:.1e} of its radius, {:.1e} rad; least radius {:.3f}", cap.value,
             rim.value, tilt.value, cache.smallest_rho());
      EXPECT_LT(cap.value, 1e-14);
      EXPECT_LT(rim.value, most);
      EXPECT_LT(tilt.value, most_tilt);
    }
  }
}

}  // namespace
}  // namespace gliss::test
