// What other programs write: allowed but seldom forms of the formats, and known slips.
#include "gliss/generate/generate.h"
#include "tests/support/mesh_files.h"

namespace gliss {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using MeshDialects = MeshFiles;
using Faces = std::vector<std::vector<std::uint32_t>>;

Faces faces_of(const Mesh& mesh) {
  Faces faces;
  for (std::size_t face = 0; face < mesh.face_count(); ++face)
    faces.push_back(face_vertices(mesh, face));
  return faces;
}

TEST_F(MeshDialects, obj_fields_may_be_empty) {
  const std::string head = std::string(kCubeVertices) + "vt 0 0\nvn 0 0 1\n";
  for (const char* face : {"f 5// 6// 7//", "f 5/ 6/ 7/", "f 5/1/ 6/1/ 7/1/", "f 5 6/ 7//"}) {
    const Mesh mesh = load("a.obj", head + face);
    EXPECT_THAT(face_vertices(mesh, 0), ElementsAre(4, 5, 6)) << face;
    EXPECT_THAT(mesh.normals, IsEmpty()) << face;
  }
  const Mesh mesh = load("a.obj", head + "f 5// 6//1 7/1/1\n");
  EXPECT_EQ(count("missing-normal"), 1u);
  EXPECT_THAT(face_vertices(mesh, 0), ElementsAre(4, 5, 6));
}

TEST_F(MeshDialects, obj_that_counts_from_0_is_told_so) {
  EXPECT_EQ(refusal("a.obj", std::string(kCubeVertices) + "f 0/0/0 1/1/1 2/2/2\n"),
            "a.obj:9: face 0: vertex index 0 is out of range (8 vertices): OBJ counts from 1");
}

// ---- OFF ----------------------------------------------------------------------------------------

TEST_F(MeshDialects, off_items_go_on_over_lines) {
  const Faces two{{0, 1, 2}, {0, 2, 3}};
  const Mesh mesh = load("a.off",
                         "OFF\n4 2 0\n0 0 0\n1 0\n0\n1 1 0 0 1 0\n3 0 # begins\n\n1\n2 255 0 0\n"
                         "3\n0 2 3\n");
  EXPECT_EQ(faces_of(mesh), two);
  EXPECT_EQ(mesh.positions[1], Vec3(1, 0, 0));
  EXPECT_EQ(mesh.positions[3], Vec3(0, 1, 0));
  EXPECT_THAT(mesh.face_line, ElementsAre(7, 11));
  // A stream of numbers, in lines of any length.
  EXPECT_EQ(faces_of(load("a.off", "OFF 4 2 0\n0 0 0 1 0 0 1\n1 0 0 1 0\n3 0 1 2\n3 0 2 3\n")),
            two);
}

// Lines mean nothing in a file that has fewer of them than items.
TEST_F(MeshDialects, off_is_a_stream_of_words) {
  const Faces two{{0, 1, 2}, {0, 2, 3}};
  for (const char* text : {"OFF\n4\n2\n6\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n",
                           "OFF 4 2 0 0 0 0 1 0 0 1 1 0 0 1 0 3 0 1 2 3 0 2 3",
                           "OFF\n4 2 0\n0 0 0 1 0 0\n1 1 0 0 1 0 # last\n3 0 1 2 3 0 2 3\n",
                           "OFF\n4 2 0\n0 0\n0 1 0 0\n1 1 0 0 1 0 3 0\n1 2 3 0 2 3\n"}) {
    const Mesh mesh = load("a.off", text);
    EXPECT_EQ(faces_of(mesh), two) << text;
    EXPECT_EQ(mesh.positions[1], Vec3(1, 0, 0)) << text;
    EXPECT_EQ(mesh.positions[3], Vec3(0, 1, 0)) << text;
  }
  EXPECT_EQ(refusal("a.off", "OFF 4 2 0 0 0 0 1 0 0 1 1 0 0 1 0 3 0 1 2 3 0 2"),
            "a.off:1: unexpected '0'");
}

TEST_F(MeshDialects, off_lines_that_lack_a_number_or_have_one_too_many_are_named) {
  const std::string rest = "0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  EXPECT_EQ(refusal("a.off", "OFF\n4 4 0\n0 0 0\n1 0 0 1\n" + rest),
            "a.off:4: a number too many after vertex 1");
  EXPECT_EQ(refusal("a.off", "OFF\n4 4 0\n0 0 0\n1 0\n" + rest),
            "a.off:4: a number of vertex 1 is missing");
  EXPECT_EQ(refusal("a.off", "OFF\n2 1 0\n0 0 0 .5 0 0\n.5 1 0 1 0 0\n"),
            "a.off:4: after lines of several vertices, or of columns that the header does not "
            "name, the number of sides '.5' is not an integer");
  EXPECT_EQ(refusal("a.off", "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n4 0 1 2\n3 2 1 0\n"),
            "a.off: the file ends after 1 of 2 faces; face 0 goes on over line 6, or has fewer "
            "than 4 sides");
}

TEST_F(MeshDialects, off_textures_are_skipped) {
  EXPECT_EQ(
      load("a.off", "STOFF\n3 1 0\n0 0 0 .5 .5\n1 0 0 0 1\n0 1 0 1 1\n3 0 1 2\n").face_count(), 1u);
  const std::string vertices = "0 0 0 0 0 1 1 1 1 0 0\n1 0 0 0 0 1 1 1 1 .5 0 0\n";
  EXPECT_EQ(load("a.off", "STCNOFF\n3 1 0\n" + vertices + "0 1 0 0 0 1 1 1 1 1 1\n3 0 1 2\n")
                .normals.size(),
            3u);
  EXPECT_EQ(refusal("a.off", "STOFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
            "a.off:3: a texture of 0 numbers");
}

// The mesh as binary OFF, as Geomview or PMP writes it.
std::string to_binary_off(const Mesh& mesh, bool pmp, std::size_t columns = 0) {
  const bool big = !pmp;
  const auto number = [&](std::size_t value) {
    return to_bytes(static_cast<std::int32_t>(value), big);
  };
  std::string text = number(mesh.positions.size()) + number(mesh.face_count()) + number(0);
  for (const Vec3& p : mesh.positions) {
    for (const double x : p) text += to_bytes(static_cast<float>(x), big);
    for (std::size_t i = 0; i < columns; ++i) text += to_bytes(0.5f, big);
  }
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    text += number(mesh.valence(face));
    for (const std::uint32_t vertex : face_vertices(mesh, face)) text += number(vertex);
    if (pmp) continue;
    text += number(face % 5);
    for (std::size_t i = 0; i < face % 5; ++i) text += to_bytes(1.0f, big);
  }
  return text;
}

TEST_F(MeshDialects, binary_off_is_read) {
  const Mesh made = prism(5).mesh;
  for (const bool pmp : {false, true}) {
    for (const auto& [head, columns] : {std::pair{"OFF BINARY\n", 0},
                                        {"NOFF BINARY\r\n", 3},
                                        {"COFF BINARY\n", 4},
                                        {"STCNOFF BINARY\n", 9}}) {
      const Mesh read = load("a.off", head + to_binary_off(made, pmp, columns));
      EXPECT_EQ(faces_of(read), faces_of(made)) << head;
      for (std::size_t i = 0; i < made.positions.size(); ++i) {
        EXPECT_EQ(read.positions[i].cast<float>(), made.positions[i].cast<float>());
      }
      EXPECT_EQ(read.normals.empty(), columns % 2 == 0) << head;
      EXPECT_EQ(count("non-unit-normal") > 0, columns % 2 == 1) << head;  // (0.5, 0.5, 0.5)
    }
  }
}

TEST_F(MeshDialects, binary_off_has_no_lines) {
  EXPECT_EQ(refusal("a.off", "OFF BINARY\n" + std::string(12 + (18 << 20), '\0')),
            "a.off: 18874368 bytes after the 0 faces that the header counts");
}

TEST_F(MeshDialects, no_truncated_binary_off_is_read) {
  for (const bool pmp : {false, true}) {
    const std::string text = "OFF BINARY\n" + to_binary_off(prism(3).mesh, pmp);
    for (std::size_t size = 0; size < text.size(); ++size)
      EXPECT_NE(refusal("a.off", text.substr(0, size)), "") << pmp << ' ' << size;
    EXPECT_EQ(refusal("a.off", text), "");
    EXPECT_EQ(refusal("a.off", text + "1"),
              "a.off: 1 bytes after the 5 faces that the header counts");
  }
  const std::string text = "OFF BINARY\n" + to_binary_off(prism(3).mesh, false);
  EXPECT_EQ(refusal("a.off", text.substr(0, 11 + 11)), "a.off: the file ends before its counts");
  EXPECT_EQ(refusal("a.off", text.substr(0, text.size() - 1)),
            "a.off: the file ends after 4 of 5 faces");
}

TEST_F(MeshDialects, hostile_counts_of_binary_off_take_no_memory) {
  const auto refused = [&](std::vector<std::int32_t> numbers) {
    std::string text = "OFF BINARY\n";
    for (const std::int32_t number : numbers) text += to_bytes(number, true);
    return refusal("a.off", text);
  };
  constexpr std::int32_t kMost = 0x7fffffff;
  EXPECT_EQ(refused({kMost, 1, 0, 0, 0, 0}), "a.off: the file ends after 1 of 2147483647 vertices");
  EXPECT_EQ(refused({0, kMost, 0}), "a.off: the file ends after 0 of 2147483647 faces");
  EXPECT_EQ(refused({-1, 1, 0}), "a.off: the header counts -1 vertices and 1 faces");
  EXPECT_EQ(refused({0, 1, 0, kMost}), "a.off: the file ends after 0 of 1 faces");
  EXPECT_EQ(refused({0, 1, 0, -2}), "a.off: face 0: -2 sides");
  EXPECT_EQ(refused({0, 1, 0, 1, -1}), "a.off: face 0: vertex index -1 is out of range");
  EXPECT_EQ(refused({0, 1, 0, 1, 0, 5}), "a.off: face 0: a colour of 5 numbers");
}

// ---- PLY ----------------------------------------------------------------------------------------

std::string strips(const std::string& format, const std::vector<std::vector<std::int32_t>>& all) {
  std::string text = fmt::format(
      "ply\nformat {} 1.0\nelement vertex 6\nproperty float x\nproperty float y\n"
      "property float z\nelement tristrips {}\nproperty list int int vertex_indices\nend_header\n",
      format, all.size());
  const auto put = [&](auto value) {
    text += format == "ascii" ? fmt::format("{} ", value)
                              : to_bytes(value, format.ends_with("big_endian"));
  };
  const auto end = [&] {
    if (format == "ascii") text += "\n";
  };
  for (int i = 0; i < 6; ++i)
    put(static_cast<float>(i / 2)), put(static_cast<float>(i % 2)), put(0.f), end();
  for (const auto& strip : all) {
    put(static_cast<std::int32_t>(strip.size()));
    for (const std::int32_t index : strip) put(index);
    end();
  }
  return text;
}

TEST_F(MeshDialects, ply_strips_become_triangles) {
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    const auto read = [&](const std::vector<std::vector<std::int32_t>>& all) {
      return faces_of(load("a.ply", strips(format, all)));
    };
    EXPECT_EQ(read({{0, 2, 1, 3, 4, 5}}), (Faces{{0, 2, 1}, {1, 2, 3}, {1, 3, 4}, {4, 3, 5}}));
    EXPECT_EQ(count("flipped-face"), 0u);
    EXPECT_EQ(read({{0, 2, 1, 3, -1, 2, 4, 3, -1, 5}, {3, 4, 5}}),
              (Faces{{0, 2, 1}, {1, 2, 3}, {2, 4, 3}, {3, 4, 5}}));
    EXPECT_THAT(codes(), ElementsAre("open-border"));
    // Vertices that come twice lead to the next triangle, whose turn is that of its place.
    EXPECT_EQ(read({{0, 2, 1, 3, 3, 2, 4}}), (Faces{{0, 2, 1}, {1, 2, 3}, {3, 2, 4}}));
    EXPECT_EQ(read({{0, 2, 1, 3, 3, 3, 4, 2}}), (Faces{{0, 2, 1}, {1, 2, 3}, {4, 3, 2}}));
    EXPECT_EQ(count("flipped-face"), 0u);
    EXPECT_THAT(refusal("a.ply", strips(format, {{0, 1, 6}})),
                HasSubstr("face 0: vertex index 6 is out of range (6 vertices)"));
    EXPECT_THAT(refusal("a.ply", strips(format, {{0, 1, 2, -2}})),
                HasSubstr("vertex index -2 is out of range"));
    EXPECT_EQ(refusal("a.ply", strips(format, {{0, 1, -1, 2}})),
              "a.ply: there are 6 vertices and no faces: points alone have no surface");
    const std::string text = strips(format, {{0, 2, 1, 3}});
    EXPECT_NE(refusal("a.ply", text.substr(0, text.size() - 4)), "");
  }
}

// ---- STL ----------------------------------------------------------------------------------------

// A prism of 8 triangles with another count, and attributes behind each triangle.
std::string stl(std::uint32_t count, std::size_t attribute = 0, std::size_t payload = 0) {
  const std::string text = to_stl(prism(3).mesh, false);
  std::string changed = text.substr(0, 80) + to_bytes(count, false);
  for (std::size_t at = 84; at < text.size(); at += 50) {
    changed += text.substr(at, 48) + to_bytes(static_cast<std::uint16_t>(attribute), false);
    changed += std::string(payload, 'p');
  }
  return changed;
}

TEST_F(MeshDialects, stl_is_read_by_its_size_where_its_count_is_wrong) {
  const Mesh right = load("a.stl", stl(8));
  EXPECT_THAT(codes(), IsEmpty());
  for (const std::uint32_t count : {0, 1, 7, 9}) {
    for (const std::size_t colour : {0, 0xffff}) {
      const Mesh mesh = load("a.stl", stl(count, colour));
      EXPECT_EQ(mesh.corner_vertex, right.corner_vertex);
      ASSERT_THAT(codes(), ElementsAre("count-mismatch"));
      EXPECT_THAT(findings_[0].message,
                  HasSubstr(fmt::format("the header counts {} triangles, but the size of the file "
                                        "is that of 8; these are read",
                                        count)));
      EXPECT_EQ(findings_[0].severity, Severity::kRepaired);
      EXPECT_NE(refusal("a.stl", stl(count, colour), {.strict = true}), "");
    }
  }
  EXPECT_EQ(refusal("a.stl", stl(10)), "a.stl: the file ends in triangle 8 of 10");
  EXPECT_EQ(refusal("a.stl", stl(0xffffff00)), "a.stl: the file ends in triangle 8 of 4294967040");
  EXPECT_EQ(refusal("a.stl", stl(0) + "x"),
            "a.stl: the header counts 0 triangles, and the file ends in triangle 8");
}

TEST_F(MeshDialects, stl_bytes_after_the_last_triangle_are_skipped) {
  const Mesh right = load("a.stl", stl(8));
  for (const std::size_t colour : {0, 0x8000}) {
    for (const std::size_t tail : {1, 49, 64, 1001}) {
      const std::string text = stl(8, colour) + std::string(tail, 't');
      EXPECT_EQ(load("a.stl", text).corner_vertex, right.corner_vertex);
      ASSERT_THAT(codes(), ElementsAre("extra-data"));
      EXPECT_THAT(
          findings_[0].message,
          HasSubstr(fmt::format("{} bytes after the last of 8 triangles are skipped", tail)));
      EXPECT_NE(refusal("a.stl", text, {.strict = true}), "");
    }
  }
}

TEST_F(MeshDialects, stl_attributes_that_announce_bytes_are_skipped_with_them) {
  const Mesh right = load("a.stl", stl(8));
  for (const std::size_t payload : {1, 4, 100, 65535}) {
    EXPECT_EQ(load("a.stl", stl(8, payload, payload)).corner_vertex, right.corner_vertex);
    EXPECT_THAT(codes(), IsEmpty());
  }
  EXPECT_EQ(refusal("a.stl", stl(8, 4, 5)),
            "a.stl: face 0: 4 bytes of attributes are announced, but those of all 8 triangles do "
            "not fit the size of the file; export it without attributes");
}

TEST_F(MeshDialects, stl_words_may_be_written_apart_or_together) {
  std::string text = to_stl(prism(3).mesh, true);
  const Mesh right = load("a.stl", text);
  const auto replace = [&](const std::string& word, const std::string& by) {
    for (std::size_t at = 0; (at = text.find(word, at)) != text.npos; at += by.size())
      text.replace(at, word.size(), by);
  };
  replace("endsolid", "end solid a");
  replace("endfacet", "END facet");
  replace("endloop", "end loop");
  replace("outer loop", "outerloop");
  for (const char* before : {"", "\xEF\xBB\xBF", "\n  "}) {
    EXPECT_EQ(load("a.stl", before + text).corner_vertex, right.corner_vertex);
    EXPECT_THAT(codes(), IsEmpty());
  }
  EXPECT_EQ(refusal("a.stl", "solid\nend\n"), "a.stl:2: 'end' is not a word of an STL");
}

// ---- All ----------------------------------------------------------------------------------------

TEST_F(MeshDialects, utf_16_is_named_with_the_cure) {
  for (const bool big : {false, true}) {
    std::string text = to_bytes(std::uint16_t{0xfeff}, big);
    for (const char c : kCube) text += to_bytes(static_cast<std::uint16_t>(c), big);
    for (const char* name : {"a.obj", "a.off", "a.ply", "a.stl"}) {
      EXPECT_EQ(refusal(name, text), name + std::string(": is text in UTF-16; save it as UTF-8"));
    }
  }
}

// A square with a square hole, and a bridge from corner 0 to 4.
TEST_F(MeshDialects, a_face_with_a_hole_is_told_the_cure) {
  EXPECT_EQ(refusal("a.obj",
                    "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 1 1 0\nv 1 3 0\nv 3 3 0\nv 3 1 0\n"
                    "f 1 2 3 4 1 5 6 7 8 5\n"),
            "a.obj:9: face 0: comes back to vertex 0; export it with its faces cut into triangles");
}

}  // namespace
}  // namespace gliss
