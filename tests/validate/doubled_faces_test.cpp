// Faces that are there twice, the second time turned over.
#include <gmock/gmock.h>

#include <map>

#include "gliss/generate/generate.h"
#include "gliss/validate/validate.h"

namespace gliss {
namespace {

using ::testing::Contains;
using ::testing::Key;
using ::testing::Pair;
using ::testing::UnorderedElementsAre;

std::map<std::string, std::size_t> found_in(Mesh& mesh, const LoadOptions& options = {}) {
  std::vector<Finding> findings;
  validate(mesh, options, &findings);
  std::map<std::string, std::size_t> counts;
  for (const Finding& finding : findings) counts[finding.code] = finding.count;
  return counts;
}

void add_face(Mesh& mesh, const std::vector<std::uint32_t>& vertices) {
  mesh.corner_vertex.insert(mesh.corner_vertex.end(), vertices.begin(), vertices.end());
  mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corner_vertex.size()));
}
void add_turned(Mesh& mesh, std::uint32_t face) {
  const auto corners = mesh.corner_vertex.begin();
  std::vector<std::uint32_t> vertices(corners + mesh.face_begin[face],
                                      corners + mesh.face_begin[face + 1]);
  std::reverse(vertices.begin(), vertices.end());
  add_face(mesh, vertices);
}

// nx x 1 x 1 cubes in a row, each with all of its six faces.
Mesh cells(std::uint32_t nx) {
  Mesh mesh;
  for (std::uint32_t x = 0; x <= nx; ++x) {
    for (const double y : {0.0, 1.0}) {
      for (const double z : {0.0, 1.0}) mesh.positions.emplace_back(x, y, z);
    }
  }
  mesh.face_begin = {0};
  for (std::uint32_t x = 0; x < nx; ++x) {
    const std::uint32_t a = 4 * x, b = a + 4;  // (y, z): 00, 01, 10, 11
    for (const std::vector<std::uint32_t>& face :
         std::vector<std::vector<std::uint32_t>>{{a, a + 1, a + 3, a + 2},
                                                 {b, b + 2, b + 3, b + 1},
                                                 {a, b, b + 1, a + 1},
                                                 {a + 2, a + 3, b + 3, b + 2},
                                                 {a, a + 2, b + 2, b},
                                                 {a + 1, b + 1, b + 3, a + 3}})
      add_face(mesh, face);
  }
  return mesh;
}

TEST(DoubledFaces, on_a_closed_mesh_are_dropped) {
  for (const std::vector<std::uint32_t>& twice :
       {std::vector<std::uint32_t>{7}, std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5}}) {
    Mesh mesh = nested_balls({10}).mesh;
    const std::size_t faces = mesh.face_count();
    for (const std::uint32_t face : twice) add_turned(mesh, face);
    EXPECT_THAT(found_in(mesh), UnorderedElementsAre(Pair("doubled-face", twice.size())));
    EXPECT_EQ(mesh.face_count(), faces);
  }
}

TEST(DoubledFaces, of_all_of_a_closed_mesh_are_dropped) {
  Mesh mesh = nested_balls({10}).mesh;
  const auto faces = static_cast<std::uint32_t>(mesh.face_count());
  for (std::uint32_t face = 0; face < faces; ++face) add_turned(mesh, face);
  EXPECT_THAT(found_in(mesh), UnorderedElementsAre(Pair("doubled-face", faces)));
  EXPECT_EQ(mesh.face_count(), faces);
}

TEST(DoubledFaces, between_the_cells_of_a_volume_are_removed) {
  Mesh mesh = cells(3);
  EXPECT_THAT(found_in(mesh), UnorderedElementsAre(Pair("doubled-face", 2u)));
  EXPECT_EQ(mesh.face_count(), 14u);
}

TEST(DoubledFaces, of_a_strict_check_are_non_manifold_edges) {
  Mesh mesh = cells(3);
  EXPECT_THROW(found_in(mesh, {.strict = true}), MeshError);
}

TEST(DoubledFaces, of_an_open_sheet_stay) {
  Mesh mesh = cells(1);
  mesh.face_begin.resize(2);
  mesh.corner_vertex.resize(4);
  add_turned(mesh, 0);
  found_in(mesh);
  EXPECT_EQ(mesh.face_count(), 2u);
}

TEST(DoubledFaces, elsewhere_are_told_as_a_soup) {
  Mesh mesh;
  mesh.face_begin = {0};
  mesh.positions = {{0, 0, 0}, {0, 0, 1}};
  for (std::uint32_t i = 0; i < 400; ++i) {
    if (i % 4 == 0) {
      mesh.positions.emplace_back(i, 0, 0);
      mesh.positions.emplace_back(i, 0, 1);
    }
    mesh.positions.emplace_back(i + std::cos(i), std::sin(i), 0.5);
    const std::uint32_t pole = 2 + 6 * (i / 4);
    add_face(mesh, {pole, pole + 1, pole + 2 + i % 4});
  }
  EXPECT_THAT(found_in(mesh), Contains(Key("soup")));
}

}  // namespace
}  // namespace gliss
