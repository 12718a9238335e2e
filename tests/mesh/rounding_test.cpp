// Rounded creases as a mesh: which faces and vertices there are, and where.
#include "gliss/mesh/rounding.h"

#include <gmock/gmock.h>

#include <random>

#include "gliss/validate/validate.h"
#include "tests/support/mesh_files.h"
#include "tests/support/sharp_meshes.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using test::kDegree;
using testing::HasSubstr;

Mesh with_rounding(Mesh mesh, double radius, const CreaseRules& rules = {.angle = 40 * kDegree}) {
  mesh = test::with_creases(std::move(mesh), rules);
  round_creases(mesh, radius);
  return mesh;
}

Mesh with_rounded_edges(Mesh mesh, double radius, const std::vector<VertexPair>& edges) {
  const Topology topology = build_topology(mesh);
  std::vector<std::uint32_t> sides;
  for (const VertexPair& edge : edges) sides.push_back(find_inner_edge(mesh, topology, edge));
  mark_creases(mesh, topology, {}, sides);
  round_creases(mesh, radius);
  return mesh;
}

// Holds that a rounded mesh is one that the checks accept as they do the sharp one, with its faces
// first, one normal a vertex, and no crease.
void expect_rounded(const Mesh& mesh, const Mesh& shape) {
  ASSERT_EQ(mesh.face_count(),
            shape.face_count() + mesh.strips.size() + mesh.rounded_corners.size());
  EXPECT_TRUE(mesh.sharp.empty());
  EXPECT_EQ(mesh.corner_normal, mesh.corner_vertex);
  EXPECT_EQ(mesh.normals.size(), mesh.positions.size());
  for (const Vec3& n : mesh.normals) EXPECT_NEAR(n.norm(), 1, 1e-14);
  for (const Vec3& p : mesh.positions) EXPECT_TRUE(p.allFinite());
  EXPECT_EQ(mesh.tangents.size(), 2 * mesh.corner_vertex.size());
  EXPECT_EQ(build_topology(mesh).border_side_count == 0,
            build_topology(shape).border_side_count == 0);
  // Warnings apart, of shapes that corners have, there is nothing that there was not.
  const auto codes = [](Mesh checked) {
    std::vector<Finding> findings;
    validate(checked, {}, &findings);
    std::vector<std::string> found;
    for (const Finding& finding : findings)
      if (finding.code != "non-planar" && finding.code != "concave" &&
          finding.code != "normals-against-face" && finding.code != "fold")
        found.push_back(finding.code);
    return found;
  };
  Mesh plain = shape;
  plain.normals.clear(), plain.corner_normal.clear();
  EXPECT_EQ(codes(mesh), codes(plain)) << shape.source;
}

TEST(Rounding, a_cube_gets_a_strip_for_each_edge_and_a_corner_for_each_vertex) {
  const Mesh shape = test::cube(), mesh = with_rounding(shape, 0.1);
  expect_rounded(mesh, shape);
  EXPECT_EQ(mesh.strips.size(), 2 * 12u);
  EXPECT_EQ(mesh.rounded_corners.size(), 3 * 8u);
  for (std::size_t f = 0; f < mesh.face_count(); ++f) EXPECT_EQ(mesh.valence(f), 4u);
  for (std::uint32_t c = 0; c < mesh.corner_vertex.size(); ++c) {
    const Vec3 &p = mesh.positions[mesh.corner_vertex[c]], &n = mesh.normals[mesh.corner_normal[c]];
    // A ball of 0.1 that rests there has its centre 0.1 within the cube.
    const Vec3 centre = p.cwiseMax(0.1).cwiseMin(0.9);
    EXPECT_LT((p - centre - 0.1 * n).norm(), c < mesh.face_begin[6 + 24] ? 1e-15 : 2e-6);
  }
}

// The corners at edges that turn by theta are at the distance r tan(theta / 2).
TEST(Rounding, faces_end_where_the_ball_touches_them) {
  for (const int sides : {3, 4, 6, 8}) {
    const Mesh shape = prism(sides).mesh;
    const Mesh mesh = with_rounding(shape, 1e-3);
    expect_rounded(mesh, shape);
    const double wide = std::tan(std::numbers::pi / sides),
                 edge = 20 * std::sin(std::numbers::pi / sides);
    for (std::uint32_t f = 0; f < shape.face_count(); ++f) {
      if (shape.valence(f) != 4 || sides == 4) continue;
      double width = 0, height = 0;
      for (std::uint32_t c = mesh.face_begin[f]; c < mesh.face_begin[f + 1]; ++c)
        for (std::uint32_t d = mesh.face_begin[f]; d < c; ++d) {
          const Vec3 apart =
              mesh.positions[mesh.corner_vertex[c]] - mesh.positions[mesh.corner_vertex[d]];
          height = std::max(height, std::abs(apart.z()));
          width = std::max(width, std::hypot(apart.x(), apart.y()));
        }
      EXPECT_NEAR(width, edge - 2 * wide, 1e-13);
      EXPECT_NEAR(height, 10 - 2, 1e-13);
    }
  }
}

// Each crease and each corner of every kind, and in triangles: what was closed is closed.
TEST(Rounding, what_was_closed_is_closed) {
  for (const auto& [shape, radius, creases, corners] :
       {std::tuple(test::l_solid(), 0.2, 22, 10 * 3 + 2 * 4),
        std::tuple(test::in_triangles(test::l_solid()), 0.1, 22, 10 * 3 + 2 * 4),
        std::tuple(test::corner_solid(), 0.2, 30, 45), std::tuple(prism(12).mesh, 1e-3, 24, 0),
        std::tuple(cylinder(24, 3).mesh, 1e-3, 48, 0),
        std::tuple(test::in_triangles(prism(12).mesh), 0.3e-3, 24, 0)}) {
    const Mesh mesh = with_rounding(shape, radius);
    expect_rounded(mesh, shape);
    EXPECT_EQ(mesh.strips.size(), 2 * creases) << shape.source;
    EXPECT_EQ(mesh.rounded_corners.size(), corners) << shape.source;
  }
}

// The concave edge of an L moves outward, to where a ball in the notch touches its faces.
TEST(Rounding, a_concave_crease_is_filled) {
  const Mesh shape = test::l_solid(), mesh = with_rounding(shape, 0.2);
  std::size_t concave = 0;
  for (std::size_t i = 0; i < mesh.strips.size(); ++i) {
    const auto& [a, b] = mesh.strips[i];
    if (shape.positions[a].head<2>() != Eigen::Vector2d(1, 1) ||
        shape.positions[b].head<2>() != Eigen::Vector2d(1, 1))
      continue;
    ++concave;
    const std::size_t face = shape.face_count() + i;
    for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c) {
      const Vec3 p =
          mesh.positions[mesh.corner_vertex[c]] - 0.2 * -mesh.normals[mesh.corner_normal[c]];
      EXPECT_LT((p.head<2>() - Eigen::Vector2d(1.2, 1.2)).norm(), 1e-15) << p.transpose();
    }
  }
  EXPECT_EQ(concave, 2u);  // faces of one strip
}

// One edge of the ridge's four has a dart: its strip is a triangle. The other end is at the border.
TEST(Rounding, a_dart_tapers_to_its_end_and_a_border_ends_a_crease) {
  const Mesh shape = test::ridge(), mesh = with_rounding(shape, 0.05, {.angle = 80 * kDegree});
  expect_rounded(mesh, shape);
  EXPECT_EQ(mesh.strips.size(), 2 * 4u);
  EXPECT_TRUE(mesh.rounded_corners.empty());
  std::size_t triangles = 0, beside = 0;
  for (std::size_t f = shape.face_count(); f < mesh.face_count(); ++f)
    if (mesh.valence(f) == 3) ++triangles;
  EXPECT_EQ(triangles, 2u);
  // The faces beside the ridge keep to the roof, and the dart is where it was.
  for (std::uint32_t c = 0; c < shape.corner_vertex.size(); ++c) {
    const Vec3 &p = mesh.positions[mesh.corner_vertex[c]],
               &was = shape.positions[shape.corner_vertex[c]];
    if (was.x() != 0 || was.y() <= 0) {
      EXPECT_EQ(p, was);
      continue;
    }
    ++beside;
    EXPECT_NEAR(std::abs(p.x()), 0.05 * std::sqrt(0.5), 1e-15);
    EXPECT_NEAR(p.z(), -std::abs(p.x()), 1e-15);
    EXPECT_EQ(p.y(), was.y());
  }
  EXPECT_EQ(beside, 4 * 4 - 2u);
  EXPECT_EQ(build_topology(mesh).border_side_count, build_topology(shape).border_side_count + 2);
}

// Two of the three edges of a corner: the third runs between their other faces as before.
TEST(Rounding, creases_may_bend_at_a_vertex) {
  const Mesh shape = test::cube();
  const auto vertex = [&](const Vec3& at) {
    return static_cast<std::uint32_t>(
        std::find(shape.positions.begin(), shape.positions.end(), at) - shape.positions.begin());
  };
  const std::uint32_t o = vertex({0, 0, 0}), x = vertex({1, 0, 0}), y = vertex({0, 1, 0});
  const Mesh mesh = with_rounded_edges(shape, 0.1, {{o, x}, {o, y}});
  expect_rounded(mesh, shape);
  ASSERT_EQ(mesh.strips.size(), 2 * 2u);
  for (std::size_t f = 6; f < 10; ++f) EXPECT_EQ(mesh.valence(f), 3u);  // both end in darts
  EXPECT_EQ(mesh.positions.size(), 8 + 2u);
}

// Whatever is marked: a third of the edges by chance, on closed and open meshes. A strip may have
// no room where edges bend sharply; else what is left is a mesh as sound as it was.
TEST(Rounding, any_marks_leave_a_sound_mesh) {
  std::mt19937 chance(5);
  for (int round = 0; round < 20; ++round) {
    for (const Mesh& shape :
         {torus(12, 6).mesh, goldberg(2).mesh, test::ridge(), banana(9, 5).mesh, test::cube(),
          test::in_triangles(torus(9, 6).mesh), test::in_triangles(test::corner_solid())}) {
      Mesh mesh = shape;
      if (round % 2 == 0) mesh.normals.clear(), mesh.corner_normal.clear();
      const Topology topology = build_topology(mesh);
      std::vector<std::uint32_t> sides;
      for (std::uint32_t side = 0; side < topology.side_twin.size(); ++side)
        if (topology.side_twin[side] != kNone && chance() % 3 == 0) sides.push_back(side);
      mark_creases(mesh, topology, {}, sides);
      round_creases(mesh, 1e-3 * mesh.unit);
      expect_rounded(mesh, shape);
    }
  }
}

TEST(Rounding, what_has_nothing_to_round_stays) {
  const Mesh smooth = torus().mesh;
  EXPECT_EQ(hash_of(with_rounding(smooth, 1e-3, {.angle = 100 * kDegree})), hash_of(smooth));
  // One edge that ends within the mesh at both ends fades at both.
  const Mesh shape = test::cube(), mesh = with_rounded_edges(shape, 0.1, {{0, 1}});
  EXPECT_EQ(hash_of(mesh), hash_of(shape));
  EXPECT_TRUE(mesh.strips.empty() && mesh.sharp.empty());
  // An edge between two faces of one plane, which a smoothing group may part.
  Mesh flat;
  flat.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0}, {2, 1, 0}};
  flat.corner_vertex = {0, 1, 2, 3, 1, 4, 5, 2};
  flat.face_begin = {0, 4, 8};
  EXPECT_EQ(hash_of(with_rounded_edges(flat, 0.1, {{1, 2}})), hash_of(flat));
}

// Faces smaller than the radius: those at creases are stretched, and what is behind makes way.
TEST(Rounding, a_radius_may_span_several_rings_of_faces) {
  const Mesh fine = test::without_normals(gliss::cube(20, 20).mesh);
  for (const Mesh& shape :
       {fine, test::in_triangles(fine), test::shaken(test::in_triangles(fine), 0.3, 1)}) {
    for (const double r : {1.5, 3.0, 8.0}) {
      const Mesh mesh = with_rounding(shape, r * shape.unit);
      expect_rounded(mesh, shape);
      const std::size_t flat = shape.face_count(), strips = flat + mesh.strips.size();
      for (std::size_t f = 0; f < strips; ++f) {
        for (std::uint32_t c = mesh.face_begin[f]; c < mesh.face_begin[f + 1]; ++c) {
          const Vec3 &p = mesh.positions[mesh.corner_vertex[c]],
                     &n = mesh.normals[mesh.corner_normal[c]];
          const Vec3 centre = p.cwiseMax(r - 10).cwiseMin(10 - r);
          EXPECT_LT((p - centre - r * n).norm(), 1e-13) << f;
        }
      }
    }
  }
}

TEST(Rounding, several_rings_at_notches_holes_and_rims) {
  const Mesh wall = test::without_normals(cylinder(64, 40, 20, 40).mesh);
  for (const auto& [shape, radius] :
       {std::pair(test::fine_l_solid(8), 0.35),
        std::pair(test::in_triangles(test::fine_l_solid(8)), 0.25),
        std::pair(test::drilled_plate(64, 0.5), 4.9),
        std::pair(test::drilled_plate(128, 0.55), 4.9), std::pair(wall, 4.0),
        std::pair(test::in_triangles(wall), 4.0)}) {
    const Mesh mesh = with_rounding(shape, radius * shape.unit);
    expect_rounded(mesh, shape);
  }
}

// Whatever is marked, and however large the radius: it is refused, or leaves a sound mesh.
TEST(Rounding, any_marks_and_radii_leave_a_sound_mesh) {
  std::mt19937 chance(7);
  int rounded = 0, refused = 0;
  for (int round = 0; round < 12; ++round) {
    for (const Mesh& shape :
         {torus(24, 12).mesh, test::ridge(8), test::in_triangles(torus(18, 12).mesh),
          test::fine_l_solid(3), test::in_triangles(test::fine_l_solid(3))}) {
      Mesh mesh = shape;
      const Topology topology = build_topology(mesh);
      std::vector<std::uint32_t> sides;
      for (std::uint32_t side = 0; side < topology.side_twin.size(); ++side)
        if (topology.side_twin[side] != kNone && chance() % 12 == 0) sides.push_back(side);
      mark_creases(mesh, topology, {.angle = 60 * kDegree}, sides);
      try {
        round_creases(mesh, (0.01 + 0.04 * (round % 4)) *
                                (box_of(mesh).high - box_of(mesh).low).norm() * mesh.unit);
      } catch (const MeshError&) {
        ++refused;
        continue;
      }
      ++rounded;
      expect_rounded(mesh, shape);
    }
  }
  EXPECT_GT(rounded, 5);
  EXPECT_GT(refused, 5);
}

std::string refusal_of(const Mesh& shape, double radius) {
  return test::message_of<MeshError>([&] { with_rounding(shape, radius); });
}

// The radius that is named fits, also where it spans several rings.
TEST(Rounding, the_largest_radius_that_fits_spans_many_rings) {
  const Mesh fine = test::without_normals(gliss::cube(20, 20).mesh),
             wall = test::without_normals(cylinder(64, 40, 20, 40).mesh),
             notch = test::fine_l_solid(8);
  for (const auto& [shape, least] :
       {std::pair(fine, 9.8), std::pair(test::in_triangles(fine), 9.8),
        std::pair(test::shaken(test::in_triangles(fine), 0.3, 1), 9.8), std::pair(wall, 19.0),
        std::pair(test::in_triangles(wall), 19.0), std::pair(notch, 0.38),
        std::pair(test::in_triangles(notch), 0.28),
        std::pair(test::drilled_plate(128, 0.55), 4.9)}) {
    const std::string refusal = refusal_of(shape, 50 * shape.unit), last = "that fits is ";
    const double fits = 1e-3 * std::stod(refusal.substr(refusal.find(last) + last.size()));
    test::record(shape.source, "{:.4g}", fits / shape.unit);
    EXPECT_GT(fits, least * shape.unit);
    EXPECT_NO_THROW(with_rounding(shape, fits)) << refusal;
  }
}

TEST(Rounding, a_radius_without_room_is_refused_with_the_largest_that_fits) {
  EXPECT_EQ(refusal_of(test::cube(), 0.6),
            "boxes: face 0: no room for creases of radius 600 mm beside it; the largest that fits "
            "is 495 mm");
  EXPECT_NO_THROW(with_rounding(test::cube(), 0.495));
  // A face with a notch: the strips of its arms meet before its border does.
  EXPECT_THAT(refusal_of(test::l_solid(), 0.5), HasSubstr("the largest that fits is 495 mm"));
  EXPECT_NO_THROW(with_rounding(test::l_solid(), 0.495));
  // A neck of 0.1 between two wide parts, which no side of the face is as short as.
  const Mesh neck = [] {
    Mesh mesh;
    mesh.source = "neck";
    const std::vector<Eigen::Vector2d> outline{{0, 0}, {1, 0.45}, {2, 0},
                                               {2, 1}, {1, 0.55}, {0, 1}};
    for (const double z : {0.0, 1.0})
      for (const auto& p : outline) mesh.positions.emplace_back(p.x(), p.y(), z);
    for (std::uint32_t i = 0; i < 6; ++i) mesh.corner_vertex.push_back(5 - i);
    mesh.face_begin.push_back(6);
    for (std::uint32_t i = 0; i < 6; ++i) mesh.corner_vertex.push_back(6 + i);
    mesh.face_begin.push_back(12);
    for (std::uint32_t i = 0; i < 6; ++i) {
      const std::uint32_t j = (i + 1) % 6;
      mesh.corner_vertex.insert(mesh.corner_vertex.end(), {i, j, 6 + j, 6 + i});
      mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corner_vertex.size()));
    }
    return mesh;
  }();
  EXPECT_THAT(refusal_of(neck, 0.06), HasSubstr("the largest that fits is 45.1 mm"));
  EXPECT_NO_THROW(with_rounding(neck, 0.04));
  // A mesh that is refused stays as it was.
  Mesh mesh = test::with_creases(test::cube());
  const std::uint64_t before = hash_of(mesh);
  EXPECT_THROW(round_creases(mesh, 1), MeshError);
  EXPECT_EQ(hash_of(mesh), before);
}

// Lines and units: of a file in mm.
TEST(Rounding, names_the_line_of_a_face_and_gives_it_to_strips) {
  Mesh shape = gliss::cube(1, 20).mesh;
  for (std::uint32_t f = 0; f < 6; ++f) shape.face_line.push_back(100 + f);
  shape.source = "part.obj";
  EXPECT_THAT(refusal_of(shape, 12e-3),
              HasSubstr("part.obj:100: face 0: no room for creases of radius 12 mm beside it; the "
                        "largest that fits is 9.9 mm"));
  const Mesh mesh = with_rounding(shape, 2e-3);
  ASSERT_EQ(mesh.face_line.size(), mesh.face_count());
  EXPECT_EQ(mesh.face_line[5], 105u);
  for (std::size_t f = 6; f < mesh.face_count(); ++f)
    EXPECT_THAT(mesh.face_line[f], testing::AllOf(testing::Ge(100u), testing::Le(105u)));
}

}  // namespace
}  // namespace gliss
