#include <limits>

#include "gliss/generate/generate.h"
#include "gliss/mesh/topology.h"
#include "gliss/validate/validate.h"
#include "tests/support/mesh_files.h"

namespace gliss {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;
using ValidateTest = MeshFiles;

const LoadOptions kStrict{.strict = true};

TEST_F(ValidateTest, a_sound_mesh_has_no_findings_and_does_not_change) {
  const Mesh first = load("cube.obj", kCube);
  EXPECT_THAT(codes(), IsEmpty());
  Mesh again = first;
  validate(again, {}, &findings_);
  EXPECT_THAT(codes(), IsEmpty());
  EXPECT_EQ(again.corner_vertex, first.corner_vertex);
}

TEST_F(ValidateTest, meshes_made_in_memory_are_checked_as_well) {
  const auto refused = [](auto spoil) {
    Mesh mesh = prism(4).mesh;
    mesh.source = "a";
    spoil(mesh);
    return test::message_of<MeshError>([&] { validate(mesh); });
  };
  EXPECT_EQ(refused([](Mesh&) {}), "");
  EXPECT_EQ(
      refused([](Mesh& m) { m.positions[2].y() = std::numeric_limits<double>::quiet_NaN(); }),
      fmt::format("a: vertex 2: ({}, nan, -5) is not finite", prism(4).mesh.positions[2].x()));
  EXPECT_EQ(refused([](Mesh& m) { m.positions[2] = Vec3(1e80, 0, 0); }),
            "a: vertex 2: (1e+80, 0, 0) is beyond 1e+60");
  EXPECT_EQ(refused([](Mesh& m) { m.corner_vertex[5] = 8; }),
            "a: face 1: vertex index 8 is out of range (8 vertices)");
  EXPECT_EQ(refused([](Mesh& m) { m.corner_vertex.pop_back(); }),
            "a: the arrays do not fit together");
  EXPECT_EQ(refused([](Mesh& m) { m.face_begin = {}; }), "a: the arrays do not fit together");
  EXPECT_EQ(refused([](Mesh& m) { m.normals.push_back(Vec3::UnitX()); }),
            "a: the arrays do not fit together");
  EXPECT_EQ(refused([](Mesh& m) {
              m.normals.push_back(Vec3(0, 0, std::numeric_limits<double>::infinity()));
              m.corner_normal.assign(m.corner_vertex.size(), 0);
            }),
            "a: normal 0 (0, 0, inf) is not finite");
}

TEST_F(ValidateTest, every_error_is_found_before_the_first_is_thrown) {
  EXPECT_EQ(refusal("a.obj", kCube + "f 1 2\nf 1 3 5\nf 1 1\n", kStrict),
            "a.obj:15: face 6: only 2 distinct vertices, a face needs 3");
  EXPECT_EQ(count("too-few-vertices"), 2u);
  EXPECT_EQ(count("non-manifold-edge"), 1u);  // 1-5 has two faces already; 1-2 has no third one
}

TEST_F(ValidateTest, repeated_corners_are_removed_with_their_normals) {
  const Mesh mesh = load("a.obj",
                         "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 0 1 1\nvn 1 0 1\n"
                         "f 1//1 2//2 2//2 3//3 1//1\n");
  EXPECT_EQ(count("repeated-corner"), 2u);
  EXPECT_THAT(face_vertices(mesh, 0), ElementsAre(1, 2, 0));
  EXPECT_THAT(mesh.corner_normal, ElementsAre(1, 2, 0));
}

TEST_F(ValidateTest, duplicates_are_removed_and_later_faces_keep_number_and_line) {
  const Mesh mesh = load("a.obj",
                         "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv .2 .5 0\n"
                         "f 1 2 3\nf 2 3 1\nf 1 3 4\nf 3 1 2\n");
  EXPECT_EQ(mesh.face_count(), 2u);
  EXPECT_THAT(mesh.face_line, ElementsAre(6, 8));
  EXPECT_EQ(count("duplicate-face"), 2u);
  EXPECT_THAT(findings_[0].message, HasSubstr("a.obj:7: face 1: is face 0 again and removed"));
  for (const Finding& finding : findings_) {
    if (finding.code == "open-border") {
      EXPECT_EQ(finding.face, 0u);
    }
  }
}

TEST_F(ValidateTest, flipped_faces_are_turned_back_with_their_normals) {
  std::string text = kCubeVertices;
  text += "vn 0 0 -1\nvn 0 0 1\nvn 1 0 0\nvn 0 1 0\nvn -1 0 0\n";
  // the second and the fourth are turned over
  text +=
      "f 4//1 3//1 2//1 1//1\nf 8//2 7//3 6//4 5//5\nf 1 2 6 5\nf 6 7 3 2\nf 3 4 8 7\nf 4 1 5 8\n";
  const Mesh mesh = load("a.obj", text);
  EXPECT_EQ(count("flipped-face"), 2u);
  EXPECT_EQ(count("inside-out-part"), 0u);
  EXPECT_THAT(face_vertices(mesh, 1), ElementsAre(7, 4, 5, 6));
  EXPECT_THAT(std::vector(mesh.corner_normal.begin() + 4, mesh.corner_normal.begin() + 8),
              ElementsAre(1, 4, 3, 2));
  EXPECT_EQ(mesh.face_line[1], 15u);
}

TEST_F(ValidateTest, the_majority_wins_and_closed_parts_point_outward) {
  load("a.obj", std::string(kCubeVertices) +
                    "f 1 2 3 4\nf 8 7 6 5\nf 5 6 2 1\nf 6 7 3 2\nf 7 8 4 3\nf 4 1 5 8\n");
  EXPECT_THAT(codes(), UnorderedElementsAre("flipped-face", "inside-out-part"));
  EXPECT_EQ(count("flipped-face"), 1u);
}

TEST_F(ValidateTest, the_first_face_of_an_open_part_is_no_better_than_the_others) {
  const Mesh mesh = load("a.obj", std::string(kCubeVertices) + "f 1 2 3 4\nf 1 2 6 5\nf 2 3 7 6\n");
  EXPECT_EQ(count("flipped-face"), 1u);
  EXPECT_THAT(face_vertices(mesh, 0), ElementsAre(0, 3, 2, 1));
  EXPECT_THAT(face_vertices(mesh, 1), ElementsAre(0, 1, 5, 4));
}

TEST_F(ValidateTest, parts_are_turned_one_by_one) {
  Mesh mesh = prism(5).mesh;
  const Mesh other = prism(6).mesh;
  const auto offset = static_cast<std::uint32_t>(mesh.positions.size());
  for (const Vec3& p : other.positions) mesh.positions.push_back(p + Vec3(1e6, 0, 0));
  for (std::size_t face = 0; face < other.face_count(); ++face) {
    std::vector<std::uint32_t> vertices = face_vertices(other, face);
    std::reverse(vertices.begin(), vertices.end());
    for (const std::uint32_t v : vertices) mesh.corner_vertex.push_back(offset + v);
    mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corner_vertex.size()));
  }
  validate(mesh, {}, &findings_);
  EXPECT_THAT(codes(), UnorderedElementsAre("inside-out-part", "several-parts"));
  EXPECT_EQ(count("inside-out-part"), 1u);
  EXPECT_EQ(count("several-parts"), 2u);
}

TEST_F(ValidateTest, a_moebius_strip_is_refused) {
  EXPECT_THAT(refusal("a.obj",
                      "v 0 0 0\nv 3 0 0\nv 2 3 0\nv 0 -1 1\nv 3 0 1\nv 2 3 1\n"
                      "f 1 2 5 4\nf 2 3 6 5\nf 3 4 1 6\n"),
              HasSubstr("cannot be turned"));
}

TEST_F(ValidateTest, a_third_face_at_an_edge_is_cut_open_or_refused) {
  const std::string book =
      "v 0 0 0\nv 0 0 1\nv 1 0 0\nv 1 0 1\nv 0 1 0\nv 0 1 1\nv -1 0 0\nv -1 0 1\n"
      "f 1 3 4 2\nf 1 5 6 2\nf 1 7 8 2\n";
  EXPECT_EQ(refusal("book.obj", book, kStrict),
            "book.obj:9: face 0: edge 1-0 is shared by 3 faces (0, 1, 2)");
  EXPECT_EQ(refusal("book.obj", book, {.keep_non_manifold = true}),
            refusal("book.obj", book, kStrict));
  const Mesh mesh = load("book.obj", book);
  EXPECT_EQ(mesh.face_count(), 3u);
  EXPECT_EQ(mesh.positions.size(), 12u);
  EXPECT_EQ(count("several-parts"), 3u);
  EXPECT_EQ(count("non-manifold-edge"), 1u);
  EXPECT_EQ(count("non-manifold-vertex"), 0u);  // its ends go without saying
}

TEST_F(ValidateTest, cubes_that_touch_along_an_edge_come_apart_closed) {
  const std::string cubes = kCube +
                            "v 2 1 0\nv 2 2 0\nv 1 2 0\nv 2 1 1\nv 2 2 1\nv 1 2 1\n"
                            "f 11 10 9 3\nf 7 12 13 14\nf 3 9 12 7\nf 9 10 13 12\n"
                            "f 10 11 14 13\nf 11 3 7 14\n";
  EXPECT_THAT(refusal("a.obj", cubes, kStrict), HasSubstr("is shared by 4 faces (3, 4, 8, 11)"));
  const Mesh mesh = load("a.obj", cubes);
  EXPECT_EQ(mesh.positions.size(), 16u);
  EXPECT_THAT(codes(),
              UnorderedElementsAre("non-manifold-edge", "several-parts", "parts-intersect"));
  const Topology topology = build_topology(mesh);
  EXPECT_EQ(topology.part_count, 2u);
  EXPECT_EQ(topology.border_side_count, 0u);
}

TEST_F(ValidateTest, a_bow_tie_is_cut_open_or_refused) {
  const std::string tie = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv -1 0 0\nv 0 -1 0\nf 1 2 3\nf 1 4 5\n";
  EXPECT_EQ(refusal("a.obj", tie, kStrict), "a.obj:7: face 1: touches face 0 at vertex 0 only");
  const Mesh mesh = load("a.obj", tie);
  EXPECT_EQ(mesh.positions.size(), 6u);
  EXPECT_EQ(mesh.positions[mesh.corner_vertex[3]], Vec3(0, 0, 0));
  EXPECT_EQ(count("non-manifold-vertex"), 1u);
  EXPECT_EQ(count("coincident-vertices"), 0u);  // not in the file
}

TEST_F(ValidateTest, faces_without_extent_are_refused_where_it_is_strict) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_EQ(refusal("a.obj", vertices + "f 1 2 3", kStrict), "a.obj:6: face 0: has no area");
  EXPECT_EQ(refusal("a.obj", vertices + "f 1 2 4 5", kStrict),
            "a.obj:6: face 0: the side from vertex 1 to 3 has no length");
  EXPECT_EQ(refusal("a.obj", vertices + "f 1 2 5 1 3 5", kStrict),
            "a.obj:6: face 0: comes back to vertex 0; export it with its faces cut into triangles");
}

// ---- Mended -------------------------------------------------------------------------------------

// The corners of a mesh, [face][corner].
std::vector<std::vector<std::uint32_t>> all_faces(const Mesh& mesh) {
  std::vector<std::vector<std::uint32_t>> faces;
  for (std::size_t face = 0; face < mesh.face_count(); ++face)
    faces.push_back(face_vertices(mesh, face));
  return faces;
}

TEST_F(ValidateTest, a_file_without_any_sound_face_is_refused) {
  EXPECT_EQ(refusal("a.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"),
            "a.obj: no face of the file is left");
  EXPECT_EQ(count("zero-area-face"), 1u);
  // Nor is there a vertex to which the one without a place could be moved.
  EXPECT_EQ(refusal("a.obj", "v 0 0 0\nv nan 0 0\nf\n"), "a.obj: no face of the file is left");
}

TEST_F(ValidateTest, faces_of_two_vertices_are_removed_and_named) {
  const Mesh mesh = load("a.obj", kCube + "f 1 2\nf 1 2 1 2\n");
  EXPECT_EQ(count("too-few-vertices"), 2u);
  EXPECT_EQ(mesh.face_count(), 6u);
  EXPECT_THAT(mesh.lost_faces, ElementsAre(6, 7));
}

TEST_F(ValidateTest, a_side_without_length_becomes_a_vertex) {
  // A strip of two quads and the triangle between, whose shortest side has both ends at one place.
  const Mesh mesh = load("a.obj",
                         "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1 1 0\nv 2 0 0\nv 2 1 0\n"
                         "f 1 2 3 4\nf 2 5 3\nf 2 6 7 5\n");
  EXPECT_EQ(count("zero-length-side"), 1u);
  EXPECT_THAT(all_faces(mesh), ElementsAre(ElementsAre(0, 1, 2, 3), ElementsAre(1, 5, 6, 2)));
  EXPECT_THAT(mesh.lost_faces, ElementsAre(1));
  EXPECT_EQ(build_topology(mesh).border_side_count, 6u);
}

TEST_F(ValidateTest, the_corner_of_a_triangle_without_area_joins_the_face_beyond) {
  // Two triangles below, one above, and between them one whose corners lie on a line.
  const std::string flat =
      "v 0 0 0\nv 2 0 0\nv 1 0 0\nv 1 1 0\nv 0 -1 0\nv 2 -1 0\n"
      "f 1 2 4\nf 2 1 3\nf 1 5 3\nf 3 6 2\n";
  const Mesh mesh = load("a.obj", flat);
  EXPECT_EQ(count("zero-area-face"), 1u);
  EXPECT_THAT(all_faces(mesh), ElementsAre(ElementsAre(2, 1, 3), ElementsAre(2, 3, 0),
                                           ElementsAre(0, 4, 2), ElementsAre(2, 5, 1)));
  EXPECT_THAT(mesh.face_line, ElementsAre(7, 7, 9, 10));
  EXPECT_THAT(mesh.lost_faces, ElementsAre(1));
  // No crack is left: each side along the line has its twin.
  const Topology topology = build_topology(mesh);
  EXPECT_EQ(topology.part_count, 1u);
  EXPECT_EQ(topology.border_side_count, 6u);
}

TEST_F(ValidateTest, triangles_without_area_beside_each_other_are_taken_one_by_one) {
  // Four on one line, a fan from its first vertex.
  std::string text = "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nv 4 0 0\nv 5 0 0\nv 0 1 0\n";
  text += "f 1 6 7\nf 6 1 5\nf 5 1 4\nf 4 1 3\nf 3 1 2\n";
  const Mesh mesh = load("a.obj", text);
  EXPECT_EQ(count("zero-area-face"), 4u);
  EXPECT_EQ(mesh.face_count(), 5u);
  EXPECT_EQ(build_topology(mesh).border_side_count, 7u);
}

TEST_F(ValidateTest, a_face_that_touches_itself_is_cut_there_but_not_one_with_a_hole) {
  const std::string vertices =
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv -1 0 0\nv -1 -1 0\nv 0 2 0\nv .2 .5 0\nv .6 .5 0\n";
  const Mesh mesh = load("a.obj", vertices + "f 1 2 3 1 4 5\n");
  EXPECT_EQ(count("self-touching-face"), 1u);
  EXPECT_THAT(all_faces(mesh), ElementsAre(ElementsAre(0, 1, 2), ElementsAre(5 + 3, 3, 4)));
  EXPECT_THAT(mesh.lost_faces, IsEmpty());
  // A side that is gone to and fro is dropped.
  EXPECT_THAT(all_faces(load("a.obj", vertices + "f 1 2 6 2 3\n")),
              ElementsAre(ElementsAre(0, 1, 2)));
  EXPECT_THAT(refusal("a.obj", vertices + "f 1 2 3 6 1 7 8 3 7\n"), HasSubstr("comes back"));
  EXPECT_THAT(refusal("a.obj",
                      "v 0 0 0\nv 9 0 0\nv 0 9 0\nv 1 1 0\nv 1 3 0\nv 3 1 0\n"
                      "f 1 2 3 1 4 5 6 4\n"),
              HasSubstr("comes back to vertex 0"));
}

TEST_F(ValidateTest, seams_are_welded_where_that_closes_borders) {
  // A cube whose faces have vertices of their own.
  std::string soup;
  const Mesh cube = load("cube.obj", kCube);
  for (const std::uint32_t vertex : cube.corner_vertex) {
    const Vec3& p = cube.positions[vertex];
    soup += fmt::format("v {} {} {}\n", p.x(), p.y(), p.z());
  }
  for (int face = 0; face < 6; ++face)
    soup += "f -" + fmt::format("{} -{} -{} -{}\n", 24 - 4 * face, 23 - 4 * face, 22 - 4 * face,
                                21 - 4 * face);
  const Mesh mesh = load("soup.obj", soup);
  EXPECT_THAT(codes(), ElementsAre("welded-vertices"));
  EXPECT_EQ(count("welded-vertices"), 16u);
  const Topology topology = build_topology(mesh);
  EXPECT_EQ(topology.part_count, 1u);
  EXPECT_EQ(topology.border_side_count, 0u);
  for (const LoadOptions& unwelded : {kStrict, LoadOptions{.weld = -1}}) {
    load("soup.obj", soup, unwelded);
    EXPECT_EQ(count("coincident-vertices"), 16u);
    EXPECT_EQ(count("open-border"), 24u);
  }
}

TEST_F(ValidateTest, vertices_that_are_nearly_at_one_place_are_welded_on_request) {
  const std::string apart =
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 1.0005 0 0\nv 1 1.0005 0\nv 2 1 0\nf 1 2 3\nf 4 6 5\n";
  EXPECT_EQ(build_topology(load("a.obj", apart)).border_side_count, 6u);
  EXPECT_EQ(build_topology(load("a.obj", apart, {.weld = 4e-4})).border_side_count, 6u);
  EXPECT_EQ(build_topology(load("a.obj", apart, {.weld = 6e-4})).border_side_count, 4u);
  EXPECT_EQ(count("welded-vertices"), 2u);
}

TEST_F(ValidateTest, sheets_of_two_sides_and_edges_of_three_are_not_welded) {
  // A square and its back, with vertices of its own: no solid would come of it.
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  load("a.obj", square + square + "f 1 2 3 4\nf 8 7 6 5\n");
  EXPECT_EQ(count("welded-vertices"), 0u);
  EXPECT_EQ(count("open-border"), 8u);
  // Three sheets at one edge, each with vertices of its own.
  load("a.obj",
       "v 0 0 0\nv 0 0 1\nv 1 0 0\nv 0 0 0\nv 0 0 1\nv 0 1 0\nv 0 0 0\nv 0 0 1\nv -1 0 0\n"
       "f 1 2 3\nf 4 5 6\nf 7 8 9\n");
  EXPECT_EQ(count("welded-vertices"), 0u);
}

TEST_F(ValidateTest, normals_of_facets_are_made_anew_unless_the_file_is_to_be_believed) {
  // A sphere with one normal a face, as programs write it that know nothing of smooth surfaces.
  const Mesh sphere = goldberg(2, 10).mesh;
  const auto faceted = [](Mesh mesh) {
    mesh.normals.clear(), mesh.corner_normal.clear();
    for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
      mesh.normals.push_back(newell_normal(mesh, face).normalized());
      mesh.corner_normal.insert(mesh.corner_normal.end(), mesh.valence(face), face);
    }
    return mesh;
  };
  const auto normals = [&](Mesh mesh, const LoadOptions& options) {
    findings_.clear();
    validate(mesh, options, &findings_);
    return mesh.normals.size();
  };
  EXPECT_EQ(normals(faceted(sphere), {}), 0u);
  EXPECT_THAT(codes(), ElementsAre("facet-normals"));
  EXPECT_EQ(normals(faceted(sphere), {.normals = NormalSource::kFile}), sphere.face_count());
  EXPECT_EQ(normals(faceted(sphere), kStrict), sphere.face_count());
  EXPECT_EQ(normals(faceted(sphere), {.creases = {.normals = true}}), sphere.face_count());
  // Its own smooth normals stay, but where others are asked for.
  EXPECT_EQ(normals(sphere, {}), sphere.normals.size());
  EXPECT_EQ(normals(sphere, {.normals = NormalSource::kMade}), 0u);
  // The flat sides of a box that are divided are no facets.
  const Mesh box = cube(3, 10).mesh;
  EXPECT_EQ(normals(faceted(box), {}), box.face_count());
}

TEST_F(ValidateTest, normals_end_up_whole_and_of_unit_length) {
  const Mesh mesh = load("a.obj",
                         "v 0 0 0\nv 0 1 0\nv 0 0 1\nv 0 1 1\nvn 0 0 0\nvn 2 0 0\n"
                         "f 1//1 2//2 3//2\nf 2 4 3\n");
  EXPECT_EQ(count("zero-normal"), 1u);
  EXPECT_EQ(count("non-unit-normal"), 1u);
  EXPECT_EQ(count("missing-normal"), 1u);
  ASSERT_EQ(mesh.corner_normal.size(), 6u);
  for (const std::uint32_t normal : mesh.corner_normal) {
    EXPECT_EQ(mesh.normals.at(normal), Vec3(1, 0, 0));
  }
}

TEST_F(ValidateTest, odd_normals_are_warned_of) {
  load("a.obj",
       "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvn 0 0 1\nvn 0 0.6 0.8\nvn 0 0 -1\n"
       "f 1//3 2//1 3//1\nf 2//1 4//1 3//2\n",
       {.creases = {.none = true}});
  EXPECT_EQ(count("sharp-normals"), 1u);
  EXPECT_EQ(count("normals-against-face"), 1u);
  EXPECT_EQ(load("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1 2 3").normals.size(), 0u);
  EXPECT_EQ(count("unused-normals"), 1u);
}

TEST_F(ValidateTest, shapes_are_warned_of_and_counted) {
  load("a.obj", "v 0 0 0\nv 2 0 0\nv .3 .3 0\nv 0 2 0\nv 9 9 9\nf 1 2 3 4");
  EXPECT_THAT(codes(), UnorderedElementsAre("unused-vertices", "open-border", "concave"));
  EXPECT_EQ(count("open-border"), 4u);
  load("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 .3\nv 0 1 0\nf 1 2 3 4");
  EXPECT_EQ(count("non-planar"), 1u);
  EXPECT_EQ(count("concave"), 0u);
  load("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 0 -0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 4 6 5",
       {.weld = -1});
  EXPECT_EQ(count("coincident-vertices"), 2u);
}

TEST_F(ValidateTest, findings_do_not_depend_on_scale) {
  const Mesh made = load(
      "a.obj", "v 0 0 0\nv 2 0 0\nv .3 .3 .2\nv 0 2 0\nv 2 2 0\nf 1 2 3 4\nf 2 5 3\nf 3 5 4\n");
  const std::vector<std::string> expected = codes();
  for (const double scale : {0x1p-90, 0x1p90}) {
    Mesh mesh = made;
    for (Vec3& p : mesh.positions) p *= scale;
    findings_.clear();
    validate(mesh, {}, &findings_);
    EXPECT_EQ(codes(), expected);
  }
}

}  // namespace
}  // namespace gliss
