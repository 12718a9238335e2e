#include "gliss/mesh/creases.h"

#include <gmock/gmock.h>

#include <random>
#include <set>

#include "gliss/base/units.h"
#include "tests/support/mesh_files.h"
#include "tests/support/random_meshes.h"
#include "tests/support/sharp_meshes.h"

namespace gliss {
namespace {

using test::cube;
using test::in_triangles;
using test::kDegree;
using test::with_creases;
using test::without_normals;

using CreasesTest = MeshFiles;

std::size_t creases_of(const Mesh& mesh) { return crease_edges(mesh, build_topology(mesh)).size(); }

// The mesh with its corners, and them.
struct Sharpened {
  Mesh mesh;
  Topology topology;

  explicit Sharpened(Mesh marked) : mesh(std::move(marked)), topology(build_topology(mesh)) {
    add_vertex_normals(mesh);
  }
  const Vec3& normal(std::uint32_t side) const { return mesh.normals[mesh.corner_normal[side]]; }
  const Vec3& start(std::uint32_t side) const { return mesh.tangents[2 * side]; }
  const Vec3& end(std::uint32_t side) const { return mesh.tangents[2 * side + 1]; }
  Vec3 edge(std::uint32_t side) const {
    return mesh.positions[mesh.corner_vertex[next_side(mesh, topology, side)]] -
           mesh.positions[mesh.corner_vertex[side]];
  }
};

// Expects what every crease and every other edge must have, whatever the marks.
void expect_sound(const Sharpened& s) {
  const Mesh& mesh = s.mesh;
  for (std::uint32_t side = 0; side < s.topology.side_twin.size(); ++side) {
    const std::uint32_t twin = s.topology.side_twin[side];
    ASSERT_NEAR(s.normal(side).norm(), 1, 1e-14);
    if (twin == kNone) {
      EXPECT_TRUE(s.start(side).isZero(0));
      continue;
    }
    const std::uint32_t beyond = next_side(mesh, s.topology, twin);
    if (s.start(side).isZero(0)) {
      ASSERT_TRUE(s.end(side).isZero(0));
      EXPECT_EQ(s.normal(side), s.normal(beyond)) << mesh.source << " side " << side;
      continue;
    }
    // One curve, and a tangent in the tangent planes of both faces.
    ASSERT_EQ(s.start(side), -s.end(twin));
    ASSERT_EQ(s.end(side), -s.start(twin));
    const Vec3 t = s.start(side).normalized();
    EXPECT_LT(std::abs(t.dot(s.normal(side))), 1e-9) << mesh.source << " side " << side;
    EXPECT_LT(std::abs(t.dot(s.normal(beyond))), 1e-9) << mesh.source << " side " << side;
    EXPECT_GT(t.dot(s.edge(side).normalized()), 0) << mesh.source << " side " << side;
  }
}

TEST_F(CreasesTest, rules_are_words_between_commas) {
  const CreaseRules rules = parse_creases("40deg,normals,edges:some/list.txt");
  EXPECT_DOUBLE_EQ(*rules.angle, 40 * kDegree);
  EXPECT_TRUE(rules.normals);
  EXPECT_FALSE(rules.groups);
  EXPECT_EQ(rules.edges, "some/list.txt");
  EXPECT_DOUBLE_EQ(*parse_creases("0.5 rad").angle, 0.5);
  EXPECT_FALSE(parse_creases("groups").are_usual());
  EXPECT_TRUE(parse_creases("auto").plain);
  EXPECT_TRUE(CreaseRules{}.are_usual());
  EXPECT_TRUE(parse_creases("none").none);
  EXPECT_FALSE(parse_creases("none").are_usual());
  for (const char* wrong :
       {"", "40mm", "180deg", "-1deg", "seams", "edges:", "40deg,", "none,auto", "auto,none"})
    EXPECT_THROW(parse_creases(wrong), UnitError) << wrong;
  EXPECT_EQ(
      test::message_of<UnitError>([] { parse_creases("foo"); }),
      "creases: 'foo' is not one of an angle, such as 40deg, auto, normals, groups, edges:FILE and "
      "none");
}

TEST_F(CreasesTest, edges_are_marked_where_faces_turn_by_more_than_the_angle) {
  EXPECT_EQ(creases_of(with_creases(cube())), 12u);
  EXPECT_EQ(creases_of(with_creases(in_triangles(cube()))), 12u);
  EXPECT_EQ(creases_of(with_creases(cube(), {.angle = 91 * kDegree})), 0u);
  EXPECT_TRUE(with_creases(cube(), {.angle = 91 * kDegree}).sharp.empty());
  EXPECT_EQ(creases_of(with_creases(prism(12).mesh)), 24u);
  EXPECT_EQ(creases_of(with_creases(prism(12).mesh, {.angle = 20 * kDegree})), 36u);
  EXPECT_EQ(creases_of(with_creases(test::ridge(), {.angle = 80 * kDegree})), 4u);
  EXPECT_EQ(creases_of(with_creases(test::l_solid())), 22u);
}

// The usual rule: what is meant to be sharp, and what is not.
TEST_F(CreasesTest, unless_told_otherwise_sharp_edges_are_creases) {
  const CreaseRules usual;
  for (const auto& [mesh, count] :
       {std::pair(cube(), 12u), std::pair(in_triangles(cube()), 12u),
        std::pair(gliss::cube(4).mesh, 48u), std::pair(test::l_solid(), 22u),
        std::pair(cylinder(24).mesh, 48u), std::pair(prism(12).mesh, 24u),
        std::pair(prism(4).mesh, 12u)}) {
    EXPECT_EQ(creases_of(with_creases(without_normals(mesh), usual)), count) << mesh.source;
    EXPECT_TRUE(with_creases(mesh, {.none = true}).sharp.empty()) << mesh.source;
  }
  for (const Generated& made : {torus_knot(), torus_knot(30, 6), torus(8, 6), goldberg(1),
                                goldberg(4), ellipsoid(3), irregular(torus(), 1)})
    EXPECT_TRUE(with_creases(without_normals(made.mesh), usual).sharp.empty()) << made.mesh.source;
}

// A ridge of 90 degrees that flattens out to nothing ends somewhere within the mesh. What is sharp
// ends within it where it cuts a corner of others alone.
TEST_F(CreasesTest, by_the_usual_rule_no_crease_begins_within_the_mesh) {
  EXPECT_GT(creases_of(with_creases(test::ridge(), {.angle = 75 * kDegree})), 0u);
  EXPECT_TRUE(with_creases(test::ridge(), CreaseRules{}).sharp.empty());
  test::Rng rng(1);
  std::size_t marked = 0;
  for (int i = 0; i < 20; ++i) {
    const Mesh mesh = with_creases(without_normals(test::random_ellipsoid(rng, 60, {1, 0.6, 0.01})),
                                   CreaseRules{});
    const Topology topology = build_topology(mesh);
    std::vector<int> count(mesh.positions.size(), 0);
    const std::vector<VertexPair> edges = crease_edges(mesh, topology);
    for (const VertexPair& edge : edges)
      for (const std::uint32_t vertex : edge) ++count[vertex];
    for (const auto& [a, b] : edges) {
      EXPECT_TRUE(count[a] > 1 || count[b] > 2) << i;
      EXPECT_TRUE(count[b] > 1 || count[a] > 2) << i;
    }
    marked += edges.size();
  }
  EXPECT_GT(marked, 20u);
}

// A block that narrows, of which some edges turn by little: what is sharp ends at no corner of it.
TEST_F(CreasesTest, by_the_usual_rule_corners_of_creases_are_cut) {
  const auto frustum = [](double narrow, double high) {
    std::vector<Vec3> top, bottom;
    for (const auto& [x, y] :
         {std::pair(10, 10), std::pair(-10, 10), std::pair(-10, -10), std::pair(10, -10)}) {
      top.emplace_back(narrow * x, narrow * y, high);
      bottom.emplace_back(x, y, 0);
    }
    return with_creases(test::prism_between(top, bottom), CreaseRules{});
  };
  EXPECT_EQ(creases_of(frustum(1, 10)), 12u);
  EXPECT_EQ(creases_of(frustum(0.5, 10)), 12u);  // 63 degrees at the narrow end
  EXPECT_EQ(creases_of(frustum(0.5, 3)), 8u);    // 31: the slanted edges end there
  EXPECT_EQ(creases_of(frustum(0.5, 0.1)), 4u);  // slanted faces hardly turn from each other
}

// The normals of a file say what is sharp, where it has some.
TEST_F(CreasesTest, by_the_usual_rule_normals_of_the_mesh_decide) {
  Mesh smooth = cube();
  add_vertex_normals(smooth);
  EXPECT_TRUE(with_creases(smooth, CreaseRules{}).sharp.empty());
  Mesh faceted = without_normals(prism(12).mesh);
  for (std::uint32_t f = 0; f < faceted.face_count(); ++f) {
    faceted.normals.push_back(newell_normal(faceted, f).normalized());
    faceted.corner_normal.insert(faceted.corner_normal.end(), faceted.valence(f), f);
  }
  EXPECT_EQ(creases_of(with_creases(faceted, CreaseRules{})), 36u);
}

double plain_angle(const Mesh& mesh) {
  return plain_crease_angle(mesh, build_topology(mesh)).value_or(0) / kDegree;
}

// Flat and round faces between sharp edges.
TEST_F(CreasesTest, a_machine_part_is_told_by_its_edges) {
  EXPECT_NEAR(plain_angle(gliss::cube(4).mesh), 47.5, 1e-9);  // of 0 and 90 degrees
  EXPECT_NEAR(plain_angle(in_triangles(cube())), 47.5, 1e-9);
  EXPECT_NEAR(plain_angle(in_triangles(test::l_solid())), 47.5, 1e-9);
  EXPECT_NEAR(plain_angle(cylinder(24).mesh), 53, 1e-9);  // of 0, 15 and 90
  EXPECT_NEAR(plain_angle(cylinder(12).mesh), 60.5, 1e-9);
  // Meshes that are meant to be smooth, however coarse; solids all of whose edges are sharp.
  for (const Generated& made : {torus_knot(), torus_knot(30, 6), torus(8, 6), goldberg(1),
                                goldberg(4), irregular(torus(), 1), prism(6)})
    EXPECT_EQ(plain_angle(made.mesh), 0) << made.mesh.source;
  EXPECT_EQ(plain_angle(cube()), 0);
  // Edges that end within the mesh: one face in a hundred is raised at a corner.
  Mesh bumps = gliss::cube(8).mesh;
  for (std::size_t v = 0; v < bumps.positions.size(); v += 7) bumps.positions[v] *= 1.2;
  EXPECT_EQ(plain_angle(bumps), 0);

  const CreaseRules automatic{.plain = true};
  EXPECT_EQ(creases_of(with_creases(cylinder(24).mesh, automatic)), 48u);
  EXPECT_TRUE(with_creases(torus_knot().mesh, automatic).sharp.empty());
}

// A quad with one corner lifted, beside a flat one: its plane leans by 35 degrees, its corners at
// the edge by 0 and by 45.
TEST_F(CreasesTest, a_face_that_is_not_planar_is_asked_beside_the_edge) {
  Mesh mesh = load(
      "bent.obj", "v 0 0 0\nv 1 0 0\nv 1 1 1\nv 0 1 0\nv 0 -1 0\nv 1 -1 0\nf 1 2 3 4\nf 1 5 6 2\n");
  EXPECT_EQ(creases_of(with_creases(mesh, {.angle = 22 * kDegree})), 1u);
  EXPECT_EQ(creases_of(with_creases(mesh, {.angle = 23 * kDegree})), 0u);
}

TEST_F(CreasesTest, corners_of_a_cube_have_the_normals_of_their_faces) {
  for (const Mesh& mesh : {cube(), in_triangles(cube()), test::l_solid(), test::corner_solid(),
                           in_triangles(test::corner_solid()), prism(6).mesh}) {
    const Sharpened s(with_creases(mesh));
    expect_sound(s);
    for (std::uint32_t side = 0; side < s.topology.side_face.size(); ++side) {
      const Vec3 face = newell_normal(s.mesh, s.topology.side_face[side]).normalized();
      EXPECT_LT((s.normal(side) - face).norm(), 1e-15) << mesh.source << " side " << side;
      if (s.start(side).isZero(0)) continue;
      EXPECT_LT((s.start(side) - s.edge(side)).norm(), 1e-14 * s.edge(side).norm());
    }
  }
}

// The top of the cube has a corner within its front edge, where two faces meet below: its edges say
// nothing of a normal there but for rounding.
TEST_F(CreasesTest, a_straight_corner_has_the_normal_of_its_face) {
  for (const char* middle : {"0.5 0 1", "0.3333333333333333 1e-17 1"}) {
    const Sharpened s(with_creases(
        load("straight.obj", fmt::format("{}v {}\nv 0.4 0 0\nf 4 3 2 10 1\nf 5 9 6 7 8\n"
                                         "f 1 10 9 5\nf 10 2 6 9\nf 2 3 7 6\nf 3 4 8 7\n"
                                         "f 4 1 5 8\n",
                                         kCubeVertices, middle))));
    expect_sound(s);
    for (std::uint32_t side = 0; side < s.topology.side_face.size(); ++side) {
      const Vec3 face = newell_normal(s.mesh, s.topology.side_face[side]).normalized();
      EXPECT_LT((s.normal(side) - face).norm(), 1e-14) << side;
    }
  }
}

TEST_F(CreasesTest, a_rim_goes_on_as_the_circle_through_its_vertices) {
  const Sharpened s(with_creases(prism(12).mesh));
  expect_sound(s);
  for (std::uint32_t side = 0; side < s.topology.side_face.size(); ++side) {
    const Vec3& p = s.mesh.positions[s.mesh.corner_vertex[side]];
    const Vec3 radial = Vec3(p.x(), p.y(), 0).normalized();
    const bool is_cap = s.mesh.valence(s.topology.side_face[side]) == 12;
    const Vec3 normal = is_cap ? Vec3(0, 0, p.z() > 0 ? 1 : -1) : radial;
    EXPECT_LT((s.normal(side) - normal).norm(), 1e-15);
    if (s.start(side).isZero(0)) continue;
    EXPECT_LT(std::abs(s.start(side).dot(radial)), 1e-14);
    // The length of a cubic that follows an arc of 30 degrees.
    EXPECT_NEAR(s.start(side).norm(), 4 * std::tan(30 * kDegree / 4) * 10,
                1e-3 * s.edge(side).norm());
  }
}

// The vertex in which the ridge ends keeps one normal; the crease has a tangent there that both
// faces share.
TEST_F(CreasesTest, a_crease_that_ends_within_the_mesh_is_a_dart) {
  const Sharpened s(with_creases(test::ridge(), {.angle = 80 * kDegree}));
  expect_sound(s);
  const std::uint32_t dart = 4 * 9 + 4, rim = 8 * 9 + 4;
  const auto normals_at = [&](std::uint32_t vertex) {
    std::set<std::uint32_t> all;
    for (std::uint32_t side = 0; side < s.topology.side_face.size(); ++side)
      if (s.mesh.corner_vertex[side] == vertex) all.insert(s.mesh.corner_normal[side]);
    return all.size();
  };
  EXPECT_EQ(normals_at(dart), 1u);
  EXPECT_EQ(normals_at(dart + 9), 2u);
  EXPECT_EQ(normals_at(rim), 2u);  // one crease at a border cuts
  EXPECT_EQ(normals_at(dart - 9), 1u);
  const std::uint32_t last = find_inner_edge(s.mesh, s.topology, {dart, dart + 9});
  ASSERT_NE(last, kNone);
  EXPECT_FALSE(s.start(last).isZero(0));
}

// Whatever is marked: a third of the edges by chance, on closed and open meshes.
TEST_F(CreasesTest, any_marks_give_shared_tangents_and_one_normal_elsewhere) {
  std::mt19937 chance(5);
  for (int round = 0; round < 20; ++round) {
    for (Mesh mesh : {torus(12, 6).mesh, goldberg(2).mesh, test::ridge(), banana(9, 5).mesh,
                      in_triangles(torus(9, 6).mesh)}) {
      if (round % 2 == 0) mesh.normals.clear(), mesh.corner_normal.clear();
      const Topology topology = build_topology(mesh);
      std::vector<std::uint32_t> sides;
      for (std::uint32_t side = 0; side < topology.side_twin.size(); ++side)
        if (topology.side_twin[side] != kNone && chance() % 3 == 0) sides.push_back(side);
      mark_creases(mesh, topology, {}, sides);
      expect_sound(Sharpened(mesh));
    }
  }
}

TEST_F(CreasesTest, a_mesh_without_marks_is_left_alone) {
  Mesh mesh = torus().mesh;
  const Mesh before = mesh;
  mark_creases(mesh, build_topology(mesh), {.angle = 100 * kDegree});
  add_vertex_normals(mesh);
  EXPECT_TRUE(mesh.sharp.empty() && mesh.tangents.empty());
  EXPECT_EQ(hash_of(mesh), hash_of(before));
  EXPECT_NE(hash_of(with_creases(cube())), hash_of(cube()));
}

// A cylinder whose file has its exact normals: a seam along each rim.
TEST_F(CreasesTest, normals_that_differ_in_the_file_make_creases_and_stay) {
  Mesh mesh = prism(16).mesh;
  const Topology topology = build_topology(mesh);
  for (std::uint32_t side = 0; side < mesh.corner_vertex.size(); ++side) {
    const Vec3 p = mesh.positions[mesh.corner_vertex[side]];
    const bool is_cap = mesh.valence(topology.side_face[side]) == 16;
    mesh.normals.push_back(is_cap ? Vec3(0, 0, p.z() > 0 ? 1 : -1)
                                  : Vec3(p.x(), p.y(), 0).normalized());
    mesh.corner_normal.push_back(side);
  }
  const Mesh given = mesh;
  mark_creases(mesh, topology, {.normals = true});
  EXPECT_EQ(creases_of(mesh), 32u);
  const Sharpened s(mesh);
  expect_sound(s);
  for (std::uint32_t side = 0; side < mesh.corner_vertex.size(); ++side)
    EXPECT_LT((s.normal(side) - given.normals[side]).norm(), 1e-15);
  // By angle the normals of the file still are the cylinder's.
  mark_creases(mesh, topology, {.angle = 40 * kDegree});
  EXPECT_EQ(creases_of(mesh), 32u);
}

// Normals that are one at each vertex say nothing of a crease that an angle finds.
TEST_F(CreasesTest, one_normal_a_vertex_gives_way_to_creases) {
  Mesh mesh = cube();
  add_vertex_normals(mesh);
  EXPECT_THROW(mark_creases(mesh, build_topology(mesh), {.groups = true}), MeshError);
  mark_creases(mesh, build_topology(mesh), {.normals = true});
  EXPECT_TRUE(mesh.sharp.empty());
  const Sharpened s(with_creases(mesh));
  for (std::uint32_t side = 0; side < s.topology.side_face.size(); ++side) {
    const Vec3 face = newell_normal(s.mesh, s.topology.side_face[side]).normalized();
    EXPECT_LT((s.normal(side) - face).norm(), 1e-15);
  }
  Mesh without = cube();
  EXPECT_THROW(mark_creases(without, build_topology(without), {.normals = true}), MeshError);
}

TEST_F(CreasesTest, smoothing_groups_are_read_from_obj) {
  const std::string grouped = std::string(kCubeVertices) +
                              "f 4 3 2 1\ns 1\nf 5 6 7 8\nf 1 2 6 5\ns 2\nf 2 3 7 6\ns off\n"
                              "f 3 4 8 7\nf 4 1 5 8\n";
  const Mesh mesh = load("groups.obj", grouped, {.creases = {.groups = true}});
  EXPECT_EQ(mesh.face_group, (std::vector<std::uint32_t>{0, 1, 1, 2, 0, 0}));
  EXPECT_EQ(creases_of(mesh), 11u);  // all but the edge within group 1: 4 5 of the file's 5 6
  EXPECT_EQ(mesh.sharp[find_inner_edge(mesh, build_topology(mesh), {4, 5})], 0);
  EXPECT_THAT(refusal("none.obj", kCube, {.creases = {.groups = true}}),
              testing::HasSubstr("names no smoothing groups"));
  EXPECT_THAT(refusal("none.obj", kCube, {.creases = {.normals = true}}),
              testing::HasSubstr("has no normals"));
}

TEST_F(CreasesTest, a_list_of_edges_is_checked_line_by_line) {
  const auto load_list = [&](const std::string& list) {
    return load("cube.obj", kCube, {.creases = {.edges = folder_.write("list.txt", list)}});
  };
  const Mesh mesh = load_list("# one rim\r\n0 1\n\n 2\t1 # the other way\n2 3\n3 0\n");
  EXPECT_EQ(crease_edges(mesh, build_topology(mesh)),
            (std::vector<VertexPair>{{0, 1}, {0, 3}, {1, 2}, {2, 3}}));
  const auto why = [&](const std::string& list) {
    return test::message_of<MeshError>([&] { load_list(list); });
  };
  EXPECT_THAT(why("0 1\n0 2\n"), testing::HasSubstr("list.txt:2: the mesh has no edge 0 2"));
  EXPECT_THAT(why("\n\n0 1 2\n"), testing::HasSubstr("list.txt:3: an edge is two vertex numbers"));
  EXPECT_THAT(why("0 8\n"), testing::HasSubstr("list.txt:1: '8' is not a vertex"));
  EXPECT_THAT(why("0 -1\n"), testing::HasSubstr("'-1' is not a vertex"));
  EXPECT_THAT(why("0 x\n"), testing::HasSubstr("'x' is not a vertex"));
  EXPECT_ANY_THROW(load("cube.obj", kCube, {.creases = {.edges = path("missing.txt")}}));
}

}  // namespace
}  // namespace gliss
