// The meshes of ../shared, against the counts of its LICENSES.md.
#include <fmt/ranges.h>

#include <map>
#include <set>
#include <sstream>

#include "gliss/files/mesh_file.h"
#include "gliss/mesh/topology.h"
#include "tests/support/mesh_files.h"
#include "tests/support/places.h"

namespace gliss {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

class SharedMeshTest : public MeshFiles {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(meshes_)) GTEST_SKIP() << "skipped: ../shared is absent";
  }
  const std::filesystem::path meshes_ = std::filesystem::path(test::kShared) / "meshes";
};

using Sides = std::map<std::uint32_t, std::size_t>;  // how many faces of each number

struct Expected {
  std::size_t faces;
  bool closed;
  Sides sides;  // empty: not said
};

const std::map<std::string, Expected> kExpected{
    {"teeth32_ngon", {1824, true, {{4, 1792}, {12, 32}}}},
    {"molar_ngon", {57, true, {{4, 56}, {12, 1}}}},
    {"tooth_coarse", {97, true, {{3, 16}, {4, 71}, {5, 8}, {6, 2}}}},
    {"tooth_mid", {384, true, {}}},
    {"tooth_fine_quads", {1536, true, {{4, 1536}}}},
    {"tooth_fine_tris", {3072, true, {{3, 3072}}}},
    {"tooth_nerve_coarse", {179, true, {{3, 62}, {4, 65}, {5, 46}, {6, 6}}}},
    {"hand_webxr", {1157, true, {{4, 1157}}}},
    {"spot_control", {180, true, {{3, 4}, {4, 160}, {5, 16}}}},
    {"spot_quads", {2928, true, {{4, 2928}}}},
    {"fish_control", {112, true, {{3, 8}, {4, 100}, {5, 4}}}},
    {"gums_open", {1768, false, {{4, 1768}}}},
    {"tongue", {224, true, {{4, 224}}}},
    {"body_male1591", {1574, true, {{4, 1570}, {8, 2}, {10, 1}, {16, 1}}}},
    {"body_male_generic", {13650, true, {{4, 13650}}}},
    {"goldberg42", {42, true, {{5, 12}, {6, 30}}}},
    {"goldberg162", {162, true, {{5, 12}, {6, 150}}}},
    {"banana_synth", {409, true, {{4, 407}, {11, 2}}}},
    {"osd_pawn", {589, true, {{4, 588}, {24, 1}}}},
    {"osd_helmet", {58, false, {{4, 58}}}},
    {"osd_gregory_test5", {11, false, {{3, 2}, {4, 7}, {6, 2}}}},
    {"osd_nonquads", {17, false, {{3, 7}, {4, 7}, {5, 1}, {6, 2}}}},
    {"osd_toroidal_tet", {24, true, {{4, 24}}}},
    {"osd_torus", {32, true, {{4, 32}}}},
    {"fish_tris", {1886, true, {{3, 1886}}}},
    {"goathead", {5522, true, {{3, 5522}}}},
    {"hand_open", {1602, false, {{3, 1602}}}},
    {"hand_open_dual", {794, false, {{4, 11}, {5, 128}, {6, 527}, {7, 112}, {8, 16}}}},
    {"koala_low", {7116, true, {{3, 7116}}}},
};

TEST_F(SharedMeshTest, every_face_of_every_file_is_there) {
  std::set<std::string> seen;
  for (const auto& entry : std::filesystem::directory_iterator(meshes_)) {
    const std::string name = entry.path().stem().string();
    if (entry.path().extension() != ".obj" || name.starts_with("osd_nonman")) continue;
    SCOPED_TRACE(name);
    ASSERT_TRUE(kExpected.contains(name));
    seen.insert(name);
    const Expected& expected = kExpected.at(name);
    const Mesh mesh = load_mesh(entry.path().string());
    EXPECT_EQ(mesh.face_count(), expected.faces);
    Sides sides;
    for (std::size_t face = 0; face < mesh.face_count(); ++face) ++sides[mesh.valence(face)];
    if (!expected.sides.empty()) {
      EXPECT_EQ(sides, expected.sides);
    }
    EXPECT_EQ(build_topology(mesh).border_side_count == 0, expected.closed);
  }
  EXPECT_EQ(seen.size(), kExpected.size());
}

// Counted by a script of its own, not by the program.
TEST_F(SharedMeshTest, what_is_odd_about_open_and_non_manifold_meshes_is_found) {
  const auto found = [&](const std::string& name) {
    findings_.clear();
    try {
      load_mesh((meshes_ / (name + ".obj")).string(), {.strict = true}, &findings_);
    } catch (const MeshError&) {
    }
    std::vector<std::string> all;
    for (const Finding& f : findings_) {
      all.push_back(fmt::format("{} {}:{} face {}", f.count, f.code, f.line, f.face));
    }
    return all;
  };
  EXPECT_THAT(found("osd_helmet"), ElementsAre("26 open-border:78 face 0"));
  EXPECT_THAT(found("osd_gregory_test5"), ElementsAre("14 open-border:28 face 2"));
  EXPECT_THAT(found("osd_nonquads"),
              UnorderedElementsAre("26 open-border:39 face 0", "4 several-parts:40 face 1",
                                   "3 non-planar:40 face 1", "2 faces-inward:40 face 1"));
  EXPECT_THAT(found("gums_open"),
              UnorderedElementsAre("168 open-border:1939 face 81", "288 non-planar:1862 face 4"));
  EXPECT_THAT(found("osd_nonman_verts"), ElementsAre("4 non-manifold-vertex:56 face 2"));
  EXPECT_THAT(
      found("osd_nonman_edges"),
      UnorderedElementsAre("17 repeated-corner:172 face 24", "3 too-few-vertices:188 face 40",
                           "1 self-touching-face:206 face 58", "5 non-manifold-edge:149 face 1"));
}

TEST_F(SharedMeshTest, bow_ties_are_cut_open_or_refused_by_name) {
  const std::string file = (meshes_ / "osd_nonman_verts.obj").string();
  EXPECT_THAT(test::message_of<MeshError>([&] { load_mesh(file, {.strict = true}); }),
              HasSubstr("osd_nonman_verts.obj:56: face 2: touches face 0 at vertex 1 only"));
  const Mesh mesh = load_mesh(file, {}, &findings_);
  EXPECT_EQ(mesh.face_count(), 20u);
  EXPECT_EQ(count("non-manifold-vertex"), 4u);
}

// The file also has faces of fewer than three distinct vertices, and one that touches itself.
TEST_F(SharedMeshTest, edges_of_many_faces_are_cut_open_or_refused_by_name) {
  const std::string file = (meshes_ / "osd_nonman_edges.obj").string();
  EXPECT_THROW(load_mesh(file, {.strict = true}), MeshError);
  const Mesh mesh = load_mesh(file, {}, &findings_);
  EXPECT_EQ(count("too-few-vertices"), 4u);  // one of them goes to and fro
  EXPECT_EQ(mesh.lost_faces.size(), 4u);
  EXPECT_GT(count("non-manifold-edge"), 0u);
}

}  // namespace
}  // namespace gliss
