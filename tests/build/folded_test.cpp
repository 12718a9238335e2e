// Feels as a hand does where faces fold: paths across every flagged face.
#include "gliss/build/build_cache.h"
#include "gliss/query/contact_tracker.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using test::Worst;

struct Path {
  std::uint32_t face;
  std::vector<Vec3> hips;
  double depth;
};

// Across a face from the middle of one side to that of another and a little beyond, beneath the
// straight line between them: the boundary curves are those of any patch of this face.
Path path_across(const Mesh& mesh, const PatchCache& cache, std::uint32_t face, int from, int to,
                 double depth) {
  constexpr int kSteps = 200;  // across the face
  const int n = static_cast<int>(mesh.valence(face));
  const test::Polygon polygon = test::polygon_of(mesh, face);
  const auto normal = [&](int k) {
    return (polygon.normal(k) + polygon.normal(k + 1)).normalized();
  };
  const Vec3 a = test::at(cache, face, oracle::on_side(n, from, 0.5)).position;
  const Vec3 b = test::at(cache, face, oracle::on_side(n, to, 0.5)).position;
  Path path{face, {}, depth};
  for (int i = -kSteps / 5; i <= kSteps + kSteps / 5; ++i) {
    const double t = static_cast<double>(i) / kSteps;
    const Vec3 down = ((1 - t) * normal(from) + t * normal(to)).normalized();
    path.hips.push_back((1 - t) * a + t * b - depth * down);
  }
  return path;
}

// Counts what happens from tick to tick along all paths where the HIP stays within twice their
// depth: where the surface rises far above the line, the HIP may be as near to its other side.
// Jumps are relative to the force at the path's depth.
struct Feel {
  // lost: contacts, under more than 20 % of the force, though the HIP is inside.
  int paths = 0, flips = 0, lost = 0;
  Worst jump;
  std::string first_flips;
};

void follow(const PatchCache& cache, const Path& path, Feel& feel) {
  ContactTracker tracker(cache, {});
  Contact last = tracker.tick(path.hips.front());
  ++feel.paths;
  for (std::size_t i = 1; i < path.hips.size(); ++i) {
    const Contact contact = tracker.tick(path.hips[i]);
    const bool shallow = std::max(contact.push.norm(), last.push.norm()) <= 2 * path.depth;
    if (contact.touching && last.touching && shallow) {
      feel.jump.add((contact.push - last.push).norm() / path.depth);
      const bool strong = std::min(contact.push.norm(), last.push.norm()) > 1e-3 * path.depth;
      if (strong && contact.push.dot(last.push) < 0 && ++feel.flips <= 8) {
        feel.first_flips += fmt::format(
            "\n    path across face {} (kind {}): tick {} from face {} to {} (kind {}), depth "
            "{:.2f} "
            "to {:.2f}",
            path.face, static_cast<int>(test::kind_of(cache, path.face)), i, last.at.face,
            contact.at.face, static_cast<int>(test::kind_of(cache, contact.at.face)),
            -last.distance / path.depth, -contact.distance / path.depth);
      }
    }
    feel.lost += last.touching && !contact.touching && last.push.norm() > 0.2 * path.depth &&
                 nearest(cache, path.hips[i]).touching;
    last = contact;
  }
}

class SharedFolded : public test::SharedTest, public ::testing::WithParamInterface<const char*> {};
// fish_control has a fin of two faces back to back, thinner than the depth; on body_male1591 two
// sheets cross, on fair ones at a face that is bent.
INSTANTIATE_TEST_SUITE_P(, SharedFolded,
                         ::testing::Values("spot_control", "fish_control", "body_male1591"),
                         [](const auto& info) { return std::string(info.param); });

void expect_no_flip(const Mesh& mesh, Construction construction) {
  BuildReport report;
  const PatchCache tamed = test::cache_of(mesh, Precision::kDouble, true, &report, construction);
  const PatchCache exact = test::cache_of(mesh, Precision::kDouble, false, nullptr, construction);
  Feel with, without;
  for (const std::uint32_t face : report.flagged_faces) {
    const int n = static_cast<int>(mesh.valence(face));
    for (int from = 0; from < n; ++from) {
      const int to = (from + n / 2) % n;
      const Path path = path_across(mesh, exact, face, from, to, 0.005 * test::size_of(mesh));
      follow(tamed, path, with);
      follow(exact, path, without);
    }
  }
  EXPECT_EQ(with.flips, 0) << with.first_flips;
  EXPECT_EQ(with.lost, 0);
  test::record(
      mesh.source,
      "{} paths over {} flagged faces: tamed {} flips, {} lost, largest jump {:.3g} of the "
      "force; as they were {} flips, {} lost, {:.3g}",
      with.paths, report.flagged_faces.size(), with.flips, with.lost, with.jump.value,
      without.flips, without.lost, without.jump.value);
}

TEST_P(SharedFolded, no_force_flips_across_flagged_faces) {
  const Mesh mesh = test::load_shared(std::string("meshes/") + GetParam());
  expect_no_flip(mesh, Construction::kPaper);
  expect_no_flip(mesh, Construction::kFair);
}

}  // namespace
}  // namespace gliss
