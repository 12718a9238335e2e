#include "gliss/mesh/topology.h"

#include <cmath>
#include <set>

#include "gliss/generate/generate.h"
#include "tests/support/mesh_files.h"

namespace gliss {
namespace {

using TopologyTest = MeshFiles;

void expect_consistent(const Mesh& mesh, const Topology& topology) {
  const auto side_count = static_cast<std::uint32_t>(mesh.corner_vertex.size());
  ASSERT_EQ(topology.side_twin.size(), side_count);
  std::uint32_t border = 0;
  for (std::uint32_t side = 0; side < side_count; ++side) {
    const std::uint32_t next = next_side(mesh, topology, side);
    ASSERT_EQ(prev_side(mesh, topology, next), side);
    ASSERT_EQ(topology.side_face[next], topology.side_face[side]);
    const std::uint32_t twin = topology.side_twin[side];
    if (twin == kNone) {
      ++border;
      continue;
    }
    ASSERT_EQ(topology.side_twin[twin], side);
    ASSERT_EQ(mesh.corner_vertex[twin], mesh.corner_vertex[next]);
    ASSERT_EQ(mesh.corner_vertex[next_side(mesh, topology, twin)], mesh.corner_vertex[side]);
  }
  EXPECT_EQ(topology.border_side_count, border);

  std::size_t met = 0;  // by going round every vertex
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    const std::uint32_t first = topology.vertex_side[v];
    if (first == kNone) continue;
    std::uint32_t side = first;
    do {
      ASSERT_EQ(mesh.corner_vertex[side], v);
      ++met;
      side = next_around(mesh, topology, side);
    } while (side != kNone && side != first);
  }
  EXPECT_EQ(met, side_count);
}

TEST_F(TopologyTest, every_side_is_met_once_around_its_vertex) {
  for (const Mesh& mesh : {torus().mesh, goldberg().mesh, prism(1000).mesh, thin_plate(3, 2).mesh,
                           fin().mesh, banana().mesh}) {
    const Topology topology = build_topology(mesh);
    expect_consistent(mesh, topology);
    EXPECT_EQ(topology.border_side_count, 0u);
    EXPECT_EQ(topology.part_count, 1u);
  }
}

TEST_F(TopologyTest, an_open_fan_starts_where_all_others_follow) {
  const Mesh mesh = load("fan.obj",
                         "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv -1 1 0\nv 5 5 5\n"
                         "f 1 3 4\nf 4 5 1\nf 1 2 3\n");
  const Topology topology = build_topology(mesh);
  expect_consistent(mesh, topology);
  EXPECT_EQ(topology.border_side_count, 5u);
  EXPECT_EQ(topology.vertex_side[5], kNone);
  const std::uint32_t first = topology.vertex_side[0];
  EXPECT_EQ(topology.side_face[first], 2u);
  const std::uint32_t second = next_around(mesh, topology, first);
  EXPECT_EQ(topology.side_face[second], 0u);
  const std::uint32_t third = next_around(mesh, topology, second);
  EXPECT_EQ(topology.side_face[third], 1u);
  EXPECT_EQ(next_around(mesh, topology, third), kNone);
}

TEST_F(TopologyTest, parts_are_counted) {
  const Mesh mesh = load("a.obj",
                         "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\n"
                         "f 1 2 3\nf 4 5 6\nf 6 5 7\n");
  EXPECT_EQ(build_topology(mesh).part_count, 2u);
}

TEST_F(TopologyTest, newell_normal_is_twice_the_area) {
  const Mesh l_shape =
      load("a.obj", "v 9 9 1\nv 11 9 1\nv 11 10 1\nv 10 10 1\nv 10 11 1\nv 9 11 1\nf 1 2 3 4 5 6");
  EXPECT_EQ(newell_normal(l_shape, 0), Vec3(0, 0, 6));
}

TEST_F(TopologyTest, vertex_normals_do_not_depend_on_how_faces_are_cut) {
  const LoadOptions smooth{.creases = {.none = true}};
  Mesh quads = load("cube.obj", kCube, smooth);
  Mesh cut = load("cut.obj",
                  std::string(kCubeVertices) +
                      "f 4 3 2 1\nf 5 6 7\nf 5 7 8\nf 1 2 6\nf 1 6 5\nf 2 3 7 6\n"
                      "f 3 4 8 7\nf 4 1 5 8\n",
                  smooth);
  add_vertex_normals(quads);
  add_vertex_normals(cut);
  EXPECT_EQ(quads.corner_normal, quads.corner_vertex);
  for (std::size_t v = 0; v < 8; ++v) {
    EXPECT_NEAR((quads.normals[v] - cut.normals[v]).norm(), 0, 1e-15);
    const Vec3 outward = (2 * quads.positions[v] - Vec3::Ones()).normalized();
    EXPECT_NEAR((quads.normals[v] - outward).norm(), 0, 1e-15);
  }
}

TEST_F(TopologyTest, a_reflex_corner_weighs_more_than_a_straight_one) {
  Mesh l_shape = load("a.obj",
                      "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\n"
                      "v 0 0 1\nv 2 0 1\nv 2 1 1\nv 1 1 1\nv 1 2 1\nv 0 2 1\n"
                      "f 6 5 4 3 2 1\nf 7 8 9 10 11 12\nf 1 2 8 7\nf 2 3 9 8\nf 3 4 10 9\n"
                      "f 4 5 11 10\nf 5 6 12 11\nf 6 1 7 12\n",
                      {.creases = {.none = true}});
  add_vertex_normals(l_shape);
  EXPECT_NEAR((l_shape.normals[9] - Vec3(1, 1, 3).normalized()).norm(), 0, 1e-15);
}

TEST_F(TopologyTest, vertex_normals_do_not_depend_on_scale) {
  Mesh mesh = banana().mesh;
  add_vertex_normals(mesh);
  for (const double scale : {0x1p-90, 0x1p90}) {
    Mesh scaled = banana().mesh;
    for (Vec3& p : scaled.positions) p *= scale;
    add_vertex_normals(scaled);
    EXPECT_EQ(scaled.normals, mesh.normals);
  }
}

TEST_F(TopologyTest, a_vanishing_normal_becomes_that_of_the_largest_face) {
  // A pillow: two triangles, back to back.
  Mesh mesh = load("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 7 7 7\nf 1 2 3\nf 1 3 2\n");
  add_vertex_normals(mesh);
  for (const Vec3& normal : mesh.normals) {
    EXPECT_NEAR(normal.norm(), 1, 1e-15);
    EXPECT_EQ(std::abs(normal.z()), 1);
  }
}

TEST_F(TopologyTest, normals_of_a_file_are_left_alone) {
  Mesh mesh = goldberg().mesh;
  mesh.normals[0] = Vec3::UnitX();
  add_vertex_normals(mesh);
  EXPECT_EQ(mesh.normals[0], Vec3::UnitX());
}

}  // namespace
}  // namespace gliss
