// Parts within parts: solids, cavities and rooms.
#include <gmock/gmock.h>

#include "gliss/generate/generate.h"
#include "gliss/validate/validate.h"

namespace gliss {
namespace {

using ::testing::UnorderedElementsAre;

// Six times the volume of each ball of `count`, all of as many faces.
std::vector<double> volumes(const Mesh& mesh, std::size_t count) {
  std::vector<double> volume(count, 0.0);
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    const std::uint32_t begin = mesh.face_begin[face];
    const auto at = [&](std::uint32_t c) { return mesh.positions[mesh.corner_vertex[c]]; };
    for (std::uint32_t c = begin + 1; c + 1 < mesh.face_begin[face + 1]; ++c)
      volume[face * count / mesh.face_count()] += at(begin).dot(at(c).cross(at(c + 1)));
  }
  return volume;
}

struct Checked {
  std::vector<std::string> codes;
  std::vector<int> signs;  // of the balls' volumes
};

Checked check(const std::vector<double>& radii, const LoadOptions& options = {}) {
  Mesh mesh = nested_balls(radii).mesh;
  std::vector<Finding> findings;
  validate(mesh, options, &findings);
  Checked checked;
  for (const Finding& finding : findings) checked.codes.push_back(finding.code);
  for (const double volume : volumes(mesh, radii.size()))
    checked.signs.push_back(volume > 0 ? 1 : -1);
  return checked;
}

TEST(NestedParts, keep_cavities_at_any_depth) {
  const Checked hollow = check({20, -10});
  EXPECT_THAT(hollow.codes, UnorderedElementsAre("several-parts", "cavity"));
  EXPECT_EQ(hollow.signs, (std::vector<int>{1, -1}));
  const Checked deep = check({-5, 10, 20, -15});
  EXPECT_THAT(deep.codes, UnorderedElementsAre("several-parts", "cavity"));
  EXPECT_EQ(deep.signs, (std::vector<int>{-1, 1, 1, -1}));
}

TEST(NestedParts, turn_outward_as_one) {
  const Checked hollow = check({-20, 10});
  EXPECT_THAT(hollow.codes, UnorderedElementsAre("several-parts", "inside-out-part", "cavity"));
  EXPECT_EQ(hollow.signs, (std::vector<int>{1, -1}));
}

TEST(NestedParts, in_a_cavity_are_no_cavities) {
  const Checked checked = check({20, -15, -10});
  EXPECT_THAT(checked.codes, UnorderedElementsAre("several-parts", "inside-out-part", "cavity"));
  EXPECT_EQ(checked.signs, (std::vector<int>{1, -1, 1}));
}

TEST(NestedParts, in_a_solid_are_told) {
  EXPECT_THAT(check({20, 10}).codes, UnorderedElementsAre("several-parts", "part-inside-part"));
}

TEST(NestedParts, that_are_rooms_stay_so_where_the_file_says_it) {
  const Checked room = check({-20}, {.orient = Orient::kFile});
  EXPECT_THAT(room.codes, UnorderedElementsAre("room"));
  EXPECT_EQ(room.signs, std::vector<int>{-1});
  const Checked column = check({-20, 10}, {.orient = Orient::kFile});
  EXPECT_THAT(column.codes, UnorderedElementsAre("several-parts", "room"));
  EXPECT_EQ(column.signs, (std::vector<int>{-1, 1}));
}

TEST(NestedParts, that_are_inside_out_are_refused_by_a_strict_check) {
  EXPECT_THROW(check({-20}, {.strict = true}), MeshError);
  EXPECT_THAT(check({-20}, {.strict = true, .orient = Orient::kFile}).codes,
              UnorderedElementsAre("room"));
}

TEST(NestedParts, that_are_open_are_turned_over_where_that_is_asked_for) {
  const auto open = [](double radius, const LoadOptions& options) {
    Mesh mesh = nested_balls({radius}).mesh;
    mesh.face_begin.pop_back();
    mesh.corner_vertex.resize(mesh.face_begin.back());
    std::vector<Finding> findings;
    validate(mesh, options, &findings);
    std::vector<std::string> codes;
    for (const Finding& finding : findings) codes.push_back(finding.code);
    return codes;
  };
  EXPECT_THAT(open(20, {}), UnorderedElementsAre("open-border"));
  EXPECT_THAT(open(-20, {}), UnorderedElementsAre("open-border", "faces-inward"));
  EXPECT_THAT(open(-20, {.flip = true}), UnorderedElementsAre("open-border"));
}

}  // namespace
}  // namespace gliss
