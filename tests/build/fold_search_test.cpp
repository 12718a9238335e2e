// Compares the examination of fair patches, whose curvature is from second derivatives, with the
// search by differences that it stands for: no fold that one finds may escape the other.
#include "gliss/build/fair_sides.h"
#include "gliss/build/patch_draft.h"
#include "gliss/generate/generate.h"
#include "gliss/surface/instances.h"
#include "gliss/surface/layout.h"
#include "tests/support/random_meshes.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using oracle::Rng;

const ValenceTables& fold_tables() {
  static const ValenceTables all = make_valence_tables(std::vector<char>(5, 1));
  return all;
}

// The fair patches of a mesh with vertex normals, of a size near 1.
class FairDrafts {
 public:
  explicit FairDrafts(const Mesh& mesh)
      : mesh_(test::with_normals(mesh)),
        topology_(build_topology(mesh_)),
        frame_{mesh_, Vec3::Zero(), 1 / test::size_of(mesh_)},
        faces_(all_corners(static_cast<std::uint32_t>(mesh_.face_count()))),
        sides_(frame_, topology_, faces_, serial_for) {}

  template <class Visit>
  void for_each(Visit visit) const {
    for (const std::uint32_t f : faces_) {
      const std::uint32_t n = mesh_.valence(f);
      if (n > 4) continue;
      FaceCorners face;
      for (std::uint32_t s = mesh_.face_begin[f]; s < mesh_.face_begin[f + 1]; ++s) {
        face.position.push_back(frame_.position(s));
        face.normal.push_back(frame_.normal(s));
      }
      sides_.sides_of(f, face.side);
      visit(draft_patch(face, all_corners(n)), f);
    }
  }

 private:
  const Mesh mesh_;
  const Topology topology_;
  const MeshFrame frame_;
  const std::vector<std::uint32_t> faces_;
  const FairSides sides_;
};

PatchShape by_differences(const PatchDraft& d) {
  const std::uint32_t n = d.valence();
  double axes[kFrameReals], reals[kShapeReals];
  d.frame.store(axes);
  kernels<double>().examine(fold_tables().domain_of(n), fold_tables().probes_of(n),
                            fold_tables().probe_count[n], d.control.data(), d.form, d.corner.data(),
                            d.triangle.data(), axes, n, nullptr, nullptr, reals);
  PatchShape shape = shape_from(reals, n);
  if (!(d.turned > 0)) shape.turn = -1;
  return shape;
}

// True if a build says so.
bool folds(const PatchDraft& d, PatchShape shape) {
  if (may_fold_unseen(shape)) shape.turn = std::min(shape.turn, closer_turn(d, fold_tables()));
  return is_folded(shape);
}

struct Search {
  std::size_t faces = 0, folded = 0, lost = 0, won = 0;
  void add(const PatchDraft& d) {
    const bool before = folds(d, by_differences(d)), now = folds(d, examine(d, fold_tables()));
    ++faces, folded += before, lost += before && !now, won += now && !before;
  }
  std::string text() const {
    return fmt::format("{} fair faces: {} fold, {} of them not found, {} found besides", faces,
                       folded, lost, won);
  }
};

TEST(FoldSearch, second_derivatives_agree_with_differences) {
  Rng rng(61);
  for (const Mesh& mesh : {test::random_sphere(rng, 40, 1, 0.2), torus(12, 8).mesh}) {
    FairDrafts(mesh).for_each([](const PatchDraft& d, std::uint32_t face) {
      SCOPED_TRACE(face);
      const PatchShape a = examine(d, fold_tables()), b = by_differences(d);
      EXPECT_LE((a.bend - b.bend).norm(), 1e-4 * (1 + b.bend.norm()));
      // At corners it depends on the direction, and so on the step.
      EXPECT_NEAR(a.rho_min, b.rho_min, 1e-2 * b.rho_min);
      EXPECT_NEAR(a.turn, b.turn, 1e-12);
      EXPECT_NEAR(a.sag, b.sag, 1e-3 * b.sag + 1e-9);
      EXPECT_LE((a.low - b.low).norm() + (a.high - b.high).norm(), 1e-3);
    });
  }
}

TEST(FoldSearch, samples_are_those_of_the_patch) {
  Rng rng(62);
  for (const Mesh& mesh : {test::random_sphere(rng, 40, 1, 0.2), torus(12, 8).mesh}) {
    FairDrafts(mesh).for_each([](const PatchDraft& d, std::uint32_t) {
      PatchSamples samples;
      examine(d, fold_tables(), &samples);
      const std::uint32_t n = d.valence();
      std::vector<double> rows(samples.rows.size());
      double axes[kFrameReals];
      d.frame.store(axes);
      const double stretch2 =
          kernels<double>().sample(fold_tables().domain_of(n), d.control.data(), d.form, axes, n,
                                   fold_tables().probes_of(n), samples.count, rows.data());
      EXPECT_NEAR(samples.stretch2, stretch2, 1e-12 * stretch2);
      for (std::size_t row = 0; row < kCutRows; ++row) {
        for (std::uint32_t i = 0; i < fold_tables().probe_count[n]; ++i)
          ASSERT_NEAR(samples.rows[row * samples.count + i], rows[row * samples.count + i], 1e-12);
      }
    });
  }
}

// 10^6 of them with GLISS_LONG_TESTS.
TEST(FoldSearch, loses_no_fold_of_random_faces) {
  const std::size_t most = std::getenv("GLISS_LONG_TESTS") ? 1'000'000 : 10'000;
  Rng rng(63);
  Search search;
  const auto add = [&](const Mesh& mesh) {
    FairDrafts(mesh).for_each([&](const PatchDraft& d, std::uint32_t) { search.add(d); });
  };
  while (search.faces < most) {
    const double tilt = oracle::uniform(rng, 0.3, 1.4);
    add(test::random_sphere(rng, 60, 1, tilt));
    test::SheetOptions sheet;
    sheet.tilt = tilt;
    sheet.has_quads = true;
    add(test::random_sheet(rng, sheet));
    Mesh quads = torus(12, 8).mesh;
    const double shake = oracle::uniform(rng, 0, 4);
    for (Vec3& p : quads.positions) p += shake * oracle::random_unit(rng);
    for (Vec3& m : quads.normals) m = oracle::random_tilt(rng, m, tilt);
    add(quads);
  }
  EXPECT_EQ(search.lost, 0u) << search.text();
  EXPECT_GT(search.folded, search.faces / 50) << search.text();
  fmt::print("  {}\n", search.text());
}

class SharedFoldSearch : public test::SharedTest {};

TEST_F(SharedFoldSearch, loses_no_fold_of_found_meshes) {
  Search search;
  int meshes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(test::shared_path("meshes"))) {
    if (entry.path().extension() != ".obj") continue;
    try {
      const Mesh mesh = test::load_shared("meshes/" + entry.path().stem().string());
      FairDrafts(mesh).for_each([&](const PatchDraft& d, std::uint32_t) { search.add(d); });
      ++meshes;
    } catch (const MeshError&) {  // some are there to be refused
    }
  }
  EXPECT_GE(meshes, 29);
  EXPECT_EQ(search.lost, 0u) << search.text();
  EXPECT_GT(search.folded, 0u) << search.text();
  fmt::print("  {}\n", search.text());
}

}  // namespace
}  // namespace gliss
