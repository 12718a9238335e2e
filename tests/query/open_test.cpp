// Contacts with open surfaces: round a vertex that a border runs through.
#include "gliss/query/contact_tracker.h"
#include "gliss/surface/names.h"
#include "tests/support/open_meshes.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

class OpenFan : public ::testing::TestWithParam<Method> {};

// From each of its triangles to each: one of two ways round leads to the border. Between the first
// and the last the nearest point of the first is on the border, and there it stays.
TEST_P(OpenFan, is_walked_both_ways_round) {
  const Mesh mesh = test::fan_of_five();
  const PatchCache cache = test::cache_of(mesh);
  QueryOptions options;
  options.method = GetParam();
  const Vec3 hub = mesh.positions[0];
  for (std::uint32_t to = 0; to < mesh.face_count(); ++to) {
    const Vec3 a = mesh.positions[to + 1], b = mesh.positions[to + 2];
    const Vec3 normal = (a - hub).cross(b - hub).normalized();
    const Vec3 hip = 0.7 * hub + 0.15 * a + 0.15 * b + 0.5 * normal;
    const Contact want = nearest(cache, hip, options);
    EXPECT_EQ(want.at.face, to);
    for (std::uint32_t from = to < 4 ? 0 : 1; from < (to > 0 ? 5u : 4u); ++from) {
      // On patches from the vertex itself.
      const double xi = GetParam() == Method::kGregory ? 1 : 0;
      const Contact got = ContactTracker(cache, options).track(hip, {from, xi, 0});
      EXPECT_EQ(got.at.face, to) << "from " << from;
      EXPECT_NEAR(got.distance, want.distance, 1e-12) << "from " << from << " to " << to;
    }
  }
}

// Ticks of 0.02 mm that come to z = 0 but for rounding, above it or below: the next ones are
// inside.
TEST_P(OpenFan, is_entered_by_a_hip_that_a_tick_leaves_on_it) {
  const PatchCache cache = test::cache_of(test::sheet());
  QueryOptions options;
  options.method = GetParam();
  for (const double rounding : {-1e-12, -1e-16, 0.0, 1e-16, 1e-12}) {
    ContactTracker tracker(cache, options);
    for (int i = 15; i > 0; --i) tracker.tick({0, 0, 0.02 * i});
    tracker.tick({0, 0, rounding});
    const Contact in = tracker.tick({0, 0, -0.02});
    EXPECT_TRUE(in.touching) << rounding;
    EXPECT_NEAR(in.push.z(), 0.02, 1e-12) << rounding;
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, OpenFan,
                         ::testing::Values(Method::kGregory, Method::kShaded, Method::kFlat),
                         [](const auto& info) { return std::string(method_name(info.param)); });

}  // namespace
}  // namespace gliss
