#include <clocale>
#include <locale>
#include <system_error>

#include "gliss/files/mesh_file.h"
#include "gliss/generate/generate.h"
#include "tests/support/mesh_files.h"

namespace gliss {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using MeshTest = MeshFiles;

void expect_same(const Mesh& read, const Mesh& made) {
  EXPECT_EQ(read.positions, made.positions);
  EXPECT_EQ(read.face_begin, made.face_begin);
  EXPECT_EQ(read.corner_vertex, made.corner_vertex);
}

TEST_F(MeshTest, n_gons_survive_every_format) {
  for (const int sides : {3, 5, 300, 1000}) {
    const Mesh made = prism(sides).mesh;
    save_obj(made, path("prism.obj"));
    expect_same(load_mesh(path("prism.obj")), made);
    expect_same(load("prism.off", to_off(made)), made);
    for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
      expect_same(load("prism.ply", to_ply(made, format)), made);
    }
    EXPECT_THAT(codes(), IsEmpty());
  }
}

TEST_F(MeshTest, more_than_1000_sides_are_refused) {
  std::string text = "OFF\n1001 1 0\n";
  for (int i = 0; i < 1001; ++i) text += fmt::format("{} {} 0\n", i, i * i);
  text += "1001";
  for (int i = 0; i < 1001; ++i) text += fmt::format(" {}", i);
  EXPECT_EQ(refusal("a.off", text), "a.off:1004: face 0: 1001 sides, at most 1000 are possible");
}

TEST_F(MeshTest, saved_normals_come_back) {
  const Mesh made = torus_knot().mesh;
  save_obj(made, path("knot.obj"), "a knot\nin two lines");
  const Mesh read = load_mesh(path("knot.obj"), {.unit = 1e-3}, &findings_);
  expect_same(read, made);
  EXPECT_EQ(read.normals, made.normals);
  EXPECT_EQ(read.corner_normal, made.corner_normal);
  EXPECT_EQ(read.unit, 1e-3);
  EXPECT_THAT(codes(), IsEmpty());
}

TEST_F(MeshTest, saving_to_nowhere_throws) {
  EXPECT_THROW(save_obj(prism().mesh, path("no/such/folder.obj")), std::system_error);
}

TEST_F(MeshTest, obj_reads_every_form_of_a_corner) {
  const std::string head = std::string(kCubeVertices) + "vt 0 0\nvn 0 0 1\n";
  for (const char* face :
       {"f 5 6 7", "f 5/1 6/1 7/1", "f 5//1 6//1 7//1", "f 5/1/1 6/1/1 7/1/1", "f -4 -3 -2",
        "f -4/-1/-1 -3/-1/-1 -2/-1/-1", "f 5 \\\n 6 \\\r\n 7", "  f\t5 6 7 # comment", "fo 5 6 7",
        "o f\ng f 1 2\ns 1\nusemtl f\nmtllib f\nf 5 6 7"}) {
    const Mesh mesh = load("a.obj", head + face);
    EXPECT_THAT(face_vertices(mesh, 0), ElementsAre(4, 5, 6)) << face;
    EXPECT_EQ(count("unused-normals") == 0, !mesh.normals.empty()) << face;
  }
}

TEST_F(MeshTest, obj_lines_may_end_any_way) {
  for (const char* ending : {"\r\n", "\r"}) {
    std::string text;
    for (const char c : kCube) text += c == '\n' ? std::string(ending) : std::string(1, c);
    EXPECT_EQ(load("a.obj", text).face_count(), 6u);
    EXPECT_THAT(codes(), IsEmpty());
  }
  EXPECT_EQ(load("a.obj", "\xEF\xBB\xBF" + kCube).face_count(), 6u);
}

TEST_F(MeshTest, a_face_may_come_before_its_vertices) {
  EXPECT_EQ(load("a.obj", "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0").face_line,
            std::vector<std::uint32_t>{1});
}

TEST_F(MeshTest, unknown_statements_are_counted_once) {
  load("a.obj", "curv 1 2\nv 0 0 0 1 0 0\nv 1 0 0 2\nv 0 1 0 1\nl 1 2\nf 1 2 3");
  EXPECT_EQ(count("unknown-statement"), 2u);
  EXPECT_EQ(count("ignored-weight"), 1u);
  EXPECT_THAT(findings_[0].message, HasSubstr("a.obj:1: statement 'curv' is ignored"));
}

TEST_F(MeshTest, a_comment_or_a_name_cannot_swallow_a_face) {
  EXPECT_EQ(load("a.obj", kCube + "# C:\\teeth\\\n").face_count(), 6u);
  EXPECT_EQ(load("a.obj", "# C:\\teeth\\\n" + kCube).face_count(), 6u);
  EXPECT_EQ(refusal("a.obj", std::string(kCubeVertices) + "f 5 6 7\ng teeth\\\nf 5 7 8\n"),
            "a.obj: the file has 2 faces with 6 corners, but 1 with 3 were read");
}

TEST_F(MeshTest, obj_refusals_name_the_line) {
  const auto refused = [&](const std::string& line) {
    return refusal("a.obj", kCubeVertices + line, {.strict = true});
  };
  EXPECT_EQ(refused("f 1 2 99"), "a.obj:9: face 0: vertex index 99 is out of range (8 vertices)");
  EXPECT_EQ(refused("f 1 2 -9"), "a.obj:9: face 0: vertex index -9 is out of range (8 vertices)");
  EXPECT_EQ(refused("f 1 2 0"),
            "a.obj:9: face 0: vertex index 0 is out of range (8 vertices): OBJ counts from 1");
  EXPECT_EQ(refused("f 1 2 99999999999"),
            "a.obj:9: face 0: vertex index 99999999999 is out of range (8 vertices)");
  EXPECT_EQ(refused("f 1//2 2//1 3//1\nvn 0 0 1"),
            "a.obj:9: face 0: normal index 2 is out of range (1 normals)");
  for (const char* corner :
       {"/", "//", "/1", "1///", "1/2/3/4", "1/x", "x", "1.0", "1//1/", "+-1"}) {
    EXPECT_EQ(
        refused(fmt::format("\nf 2 3 {}", corner)),
        fmt::format("a.obj:10: face 0: '{}' is not a corner (v, v/vt, v//vn or v/vt/vn)", corner));
  }
  EXPECT_EQ(refused("f 1 2"), "a.obj:9: face 0: only 2 distinct vertices, a face needs 3");
  EXPECT_EQ(refused("f"), "a.obj:9: face 0: only 0 distinct vertices, a face needs 3");
  EXPECT_EQ(refused("f 1 2 1 2"), "a.obj:9: face 0: only 2 distinct vertices, a face needs 3");
  EXPECT_EQ(refused("v 1 2"), "a.obj:9: coordinate is missing");
  EXPECT_EQ(refused("v 1 2,5 3"),
            "a.obj:9: coordinate '2,5' is not a number: decimals follow a point, not a comma");
  EXPECT_EQ(refused("v 1 nan 3\nf 1 2 9"), "a.obj:9: vertex 8: (1, nan, 3) is not finite");
  EXPECT_EQ(refused("v 1 1e999 3\nf 1 2 9"), "a.obj:9: vertex 8: (1, inf, 3) is not finite");
  EXPECT_EQ(refused("vn 1 -inf 3"), "a.obj:9: normal is not finite (-inf)");
  EXPECT_EQ(refused(""), "a.obj: there are 8 vertices and no faces: points alone have no surface");
}

TEST_F(MeshTest, numbers_are_those_of_c) {
  const Mesh mesh = load("a.obj", "v +1.5e0 .5 -5.\nv 1e-400 4.9e-324 0\nv 1E2 -0 0\nf 1 2 3");
  EXPECT_EQ(mesh.positions[0], Vec3(1.5, 0.5, -5));
  EXPECT_EQ(mesh.positions[1], Vec3(0, 4.9e-324, 0));
  EXPECT_EQ(mesh.positions[2], Vec3(100, 0, 0));
}

TEST_F(MeshTest, off_reads_colours_and_normals) {
  EXPECT_EQ(load("a.off", "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 255 0 0\n").face_count(), 1u);
  EXPECT_EQ(load("a.off", "# c\nCOFF\n3 1\n0 0 0 1 1 1\n1 0 0 1 1 1 1 # c\n\n0 1 0 1 1 1\n3 0 1 2")
                .face_line,
            std::vector<std::uint32_t>{8});
  const Mesh mesh = load("a.off", "NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n");
  EXPECT_EQ(mesh.normals.size(), 3u);
  EXPECT_EQ(mesh.corner_normal, mesh.corner_vertex);
}

TEST_F(MeshTest, off_counts_may_not_lie) {
  const std::string vertices = "0 0 0\n1 0 0\n0 1 0\n";
  EXPECT_EQ(refusal("a.off", "OFF\n3 2 0\n" + vertices + "3 0 1 2\n"),
            "a.off: the file ends after 1 of 2 faces");
  EXPECT_EQ(refusal("a.off", "OFF\n4 0 0\n" + vertices),
            "a.off: the file ends after 3 of 4 vertices");
  EXPECT_EQ(refusal("a.off", "OFF\n3 1 0\n" + vertices + "3 0 1 2\n3 2 1 0\n"),
            "a.off:7: unexpected '3' after the 1 faces that the header counts");
  EXPECT_EQ(refusal("a.off", "OFF\n4 1 0\n" + vertices + "3 0 1 2\n"), "a.off:6: unexpected '2'");
  EXPECT_EQ(refusal("a.off", "OFF\n3 1 0\n" + vertices + "4 0 1 2\n"),
            "a.off:6: vertex index is missing");
  EXPECT_EQ(refusal("a.off", "OFF\n3 1 0\n0 0 0 1\n1 0 0\n0 1 0\n3 0 1 2\n"),
            "a.off:3: a number too many after vertex 0");
  EXPECT_EQ(refusal("a.off", "OFF\n3 1 0\n" + vertices + "3 0 1 3\n"),
            "a.off:6: face 0: vertex index 3 is out of range (3 vertices)");
  EXPECT_EQ(refusal("a.off", "OFF\n3 1 0\n" + vertices + "3 0 1 -1\n"),
            "a.off:6: face 0: vertex index -1 is out of range");
  EXPECT_EQ(refusal("a.off", "OFF\n3 1 0\n" + vertices + "3 0 1 \\\n2\n"),
            "a.off:6: vertex index '\\' is not an integer");
  EXPECT_EQ(refusal("a.off", "4OFF\n"),
            "a.off:1: the header must be OFF, COFF, NOFF or STOFF, not '4OFF'");
}

TEST_F(MeshTest, ply_reads_normals_and_every_integer_type) {
  for (const char* type : {"char", "uchar", "short", "ushort", "int", "uint", "int8", "uint32"}) {
    const Mesh mesh = load(
        "a.ply", fmt::format("ply\r\nformat ascii 1.0\r\nelement vertex 3\r\nproperty float x\r\n"
                             "property float y\r\nproperty float z\r\nproperty float nx\r\n"
                             "property float ny\r\nproperty float nz\r\nelement face 1\r\n"
                             "property list {} {} vertex_index\r\nend_header\r\n0 0 0 0 0 1\r\n"
                             "1 0 0 0 0 1\r\n0 1 0 0 0 1\r\n3 0 1 2\r\n",
                             type, type));
    EXPECT_THAT(face_vertices(mesh, 0), ElementsAre(0, 1, 2));
    EXPECT_EQ(mesh.normals.size(), 3u);
  }
}

// Vertices come in the order in which triangles have them; the places are those of float.
TEST_F(MeshTest, stl_shares_the_vertices_that_its_triangles_do_not) {
  const Mesh made = torus_knot(20, 6).mesh;
  for (const bool ascii : {true, false}) {
    const Mesh read = load("knot.stl", to_stl(made, ascii));
    EXPECT_THAT(codes(), IsEmpty());
    ASSERT_EQ(read.positions.size(), made.positions.size());
    ASSERT_EQ(read.face_count(), 2 * made.face_count());
    std::size_t triangle = 0;
    for (std::size_t face = 0; face < made.face_count(); ++face) {
      const std::vector<std::uint32_t> quad = face_vertices(made, face);
      for (std::size_t k = 1; k + 1 < quad.size(); ++k, ++triangle) {
        const std::vector<std::uint32_t> corners = face_vertices(read, triangle);
        for (std::size_t i = 0; i < 3; ++i) {
          const Vec3& p = made.positions[quad[i == 0 ? 0 : k + i - 1]];
          EXPECT_EQ(read.positions[corners[i]].cast<float>(), p.cast<float>());
        }
      }
    }
  }
}

TEST_F(MeshTest, no_truncated_stl_is_read) {
  for (const bool ascii : {true, false}) {
    std::string text = to_stl(prism(3).mesh, ascii);
    if (ascii) text.resize(text.size() - 1);  // a line ending
    for (std::size_t size = 0; size < text.size(); ++size) {
      // Without the last triangle the count may be what is wrong, which is said.
      const bool is_whole = !ascii && size + 50 == text.size();
      EXPECT_EQ(refusal("a.stl", text.substr(0, size)) == "", is_whole) << ascii << " " << size;
      EXPECT_EQ(count("count-mismatch"), is_whole ? 1u : 0u);
    }
    EXPECT_EQ(refusal("a.stl", text), "");
    EXPECT_EQ(refusal("a.stl", text + "\n1") == "", !ascii);
    EXPECT_EQ(count("extra-data"), ascii ? 0u : 1u);
  }
}

TEST_F(MeshTest, no_truncated_file_is_read) {
  const Mesh made = prism(3).mesh;
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    std::string text = to_ply(made, format);
    if (text.ends_with(" \n")) text.resize(text.size() - 2);
    for (std::size_t size = 0; size < text.size(); ++size) {
      // An ascii number cut short is a number again: only the last one can pass unseen.
      if (std::string(format) == "ascii" && text.find(' ', size) == std::string::npos) continue;
      EXPECT_NE(refusal("a.ply", text.substr(0, size)), "") << format << " " << size;
    }
    EXPECT_EQ(refusal("a.ply", text), "");
    EXPECT_NE(refusal("a.ply", text + " 1"), "");
  }
  const std::string text = to_ply(made, "binary_big_endian");
  const std::size_t body = text.find("end_header\n") + 11;
  constexpr std::size_t kVertex = 3 * 8 + 1 + 1 + 2 * 2;  // bytes
  EXPECT_EQ(refusal("a.ply", text.substr(0, body + 6 * kVertex - 1)),
            "a.ply: the file ends in vertex 5 of 6");
}

TEST_F(MeshTest, huge_counts_in_a_header_take_no_memory) {
  EXPECT_THAT(
      refusal("a.ply",
              "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000000\n"
              "property float x\nproperty float y\nproperty float z\nend_header\n123456789012"),
      HasSubstr("the file ends in vertex 1 of 4000000000000"));
  EXPECT_THAT(refusal("a.off", "OFF\n4000000000000 1 0\n0 0 0\n"),
              HasSubstr("the file ends after 1 of 4000000000000 vertices"));
}

TEST_F(MeshTest, a_locale_with_a_comma_does_not_matter) {
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  const std::string c_before = std::setlocale(LC_ALL, nullptr);
  const std::locale before = std::locale::global(std::locale(std::locale(), new Comma));
  std::setlocale(LC_ALL, "de_DE.UTF-8");  // where it is installed
  const Mesh made = prism(1000, 1234.5, 0.25).mesh;
  save_obj(made, path("a.obj"));
  expect_same(load_mesh(path("a.obj")), made);
  expect_same(load("a.off", to_off(made)), made);
  EXPECT_EQ(load("b.obj", "v 0 1e-400 0\nv 1.5 0 0\nv 0 1 0\nf 1 2 3").positions[1].x(), 1.5);
  std::locale::global(before);
  std::setlocale(LC_ALL, c_before.c_str());
}

TEST_F(MeshTest, files_that_cannot_be_read_are_named) {
  EXPECT_EQ(refusal("a.glb", ""),
            "a.glb: the file must end in one of .obj, .off, .ply, .stl, which Blender and MeshLab "
            "export");
  EXPECT_THROW(load_mesh(path("missing.obj")), MeshError);
  EXPECT_THROW(load_mesh(path("obj")), MeshError);
  std::filesystem::create_directory(path("folder.obj"));
  EXPECT_THROW(load_mesh(path("folder.obj")), MeshError);
  EXPECT_THROW(load("a.obj", kCube, {.unit = 0}), MeshError);
}

}  // namespace
}  // namespace gliss
