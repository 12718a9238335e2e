// Compares the examination of patches whose curvature is from second derivatives with the search by
// differences that it stands for: no fold that one finds may escape the other.

#include <array>

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

constexpr std::uint32_t kMostSides = 8;  // that there are second derivatives for

const ValenceTables& fold_tables() {
  static const ValenceTables all = make_valence_tables(std::vector<char>(kMostSides + 1, 1));
  return all;
}

// The mesh with its vertices moved and their normals tilted at random.
Mesh shaken(Mesh mesh, Rng& rng, double shake, double tilt) {
  mesh = test::with_normals(mesh);
  for (Vec3& p : mesh.positions) p += shake * oracle::random_unit(rng);
  for (Vec3& m : mesh.normals) m = oracle::random_tilt(rng, m, tilt);
  return mesh;
}

PatchDraft in_form(const PatchDraft& d, std::uint32_t form) {
  PatchDraft r = d;
  r.form = form;
  r.control.resize(kernels<double>().control_reals(form, d.valence()));
  take_to_form(d.corner.data(), d.control_data(), form, fold_tables(), r.control.data());
  return r;
}

// The patches of a mesh with vertex normals, of a size near 1: of each face the fair one, the
// paper's, and that with ribbons for cross tangents.
class Drafts {
 public:
  explicit Drafts(const Mesh& mesh)
      : mesh_(test::with_normals(mesh)),
        topology_(build_topology(mesh_)),
        frame_{mesh_, Vec3::Zero(), 1 / test::size_of(mesh_)},
        faces_(all_corners(static_cast<std::uint32_t>(mesh_.face_count()))),
        sides_(frame_, topology_, faces_, serial_for) {}

  template <class Visit>
  void for_each(Visit visit) const {
    for (const std::uint32_t f : faces_) {
      const std::uint32_t n = mesh_.valence(f);
      if (n > kMostSides) continue;
      FaceCorners face;
      for (std::uint32_t s = mesh_.face_begin[f]; s < mesh_.face_begin[f + 1]; ++s) {
        face.position.push_back(frame_.position(s));
        face.normal.push_back(frame_.normal(s));
      }
      sides_.sides_of({&f, 1}, face.side);
      visit(draft_patch(face, all_corners(n)), f);
      const PatchDraft d = draft_paper(face, all_corners(n));
      visit(d, f);
      visit(in_form(d, kFormRibbon), f);
    }
  }

 private:
  const Mesh mesh_;
  const Topology topology_;
  const MeshFrame frame_;
  const std::vector<std::uint32_t> faces_;
  const FairSides sides_;
};

// The numbers of the shape that all probes give; `table`: that of second derivatives, or null.
std::array<double, kShapeReals> shape_by(const double* probes, const double* table,
                                         const PatchDraft& d) {
  const std::uint32_t n = d.valence();
  double axes[kFrameReals];
  std::array<double, kShapeReals> reals;
  d.frame.store(axes);
  kernels<double>().examine(fold_tables().domain_of(n), probes, 0, fold_tables().probe_count[n],
                            d.control.data(), d.form, d.corner.data(), d.triangle.data(), axes, n,
                            table, nullptr, reals.data());
  return reals;
}

std::array<double, kShapeReals> all_probes(const PatchDraft& d, bool by_second) {
  const std::uint32_t n = d.valence();
  return shape_by(fold_tables().probes_of(n),
                  by_second ? fold_tables().second_of(d.form, n) : nullptr, d);
}

PatchShape by_all_probes(const PatchDraft& d, bool by_second) {
  PatchShape shape = shape_from(all_probes(d, by_second).data());
  if (!(d.inward_share > 0)) shape.least_cosine = -1;
  return shape;
}
PatchShape by_differences(const PatchDraft& d) { return by_all_probes(d, false); }

// The largest curvature within the outermost ring of probes, which stand in the centre instead.
double curvature_inside(const PatchDraft& d, bool by_second) {
  const Kernels<double>& k = kernels<double>();
  const std::uint32_t n = d.valence(), levels = k.probe_levels(n);
  const double* all = fold_tables().probes_of(n);
  std::vector<double> probes(all, all + k.probe_reals(n)), table(k.second_reals(d.form, n));
  for (std::uint32_t i = 0; i < n * levels; ++i) {
    const std::size_t place = k.probe_place(n, levels, i);
    probes[place] = probes[probes.size() / 2 + place] = 0;
  }
  if (by_second) k.fill_second(fold_tables().domain_of(n), d.form, n, probes.data(), table.data());
  return shape_by(probes.data(), by_second ? table.data() : nullptr, d)[kShapeCurvature];
}

// True if a build says so.
bool folds(const PatchDraft& d, PatchShape shape) {
  if (may_fold_unseen(shape))
    shape.least_cosine = std::min(shape.least_cosine, least_cosine_closely(d, fold_tables()));
  return is_folded(shape);
}

// True if a build at a level spares the paper's patch an examination.
bool is_spared(const PatchDraft& d, std::uint32_t form) {
  PatchSamples samples;
  examine(in_form(d, form), fold_tables(), &samples);
  return samples.is_gentle && keeps_direction(d.frame, d.control_data(), fold_tables());
}

struct Search {
  std::size_t patches = 0, gentle = 0, folded = 0, lost = 0, won = 0, spared = 0, let_through = 0;
  void add(const PatchDraft& d) {
    PatchSamples samples;
    const bool before = folds(d, by_differences(d)),
               now = folds(d, examine(d, fold_tables(), &samples));
    ++patches, gentle += samples.is_gentle, folded += before, lost += before && !now,
        won += now && !before;
    if (d.form != kFormPaper) return;
    for (const std::uint32_t form : {kFormRibbon, kFormBezier}) {
      if ((form == kFormBezier && d.valence() > 4) || !is_spared(d, form)) continue;
      ++spared, let_through += before;
    }
  }
  std::string text() const {
    return fmt::format(
        "{} patches, {} of them gentle: {} fold, {} of them not found, {} found besides; {} spared "
        "at a level, {} of them fold",
        patches, gentle, folded, lost, won, spared, let_through);
  }
};

void expect_all_found(const Search& search) {
  EXPECT_EQ(search.lost, 0u) << search.text();
  EXPECT_EQ(search.let_through, 0u) << search.text();
  EXPECT_GT(search.gentle, search.patches / 50) << search.text();
  EXPECT_GT(search.spared, search.patches / 50) << search.text();
  fmt::print("  {}\n", search.text());
}

std::vector<Mesh> meshes_of_all_valences(Rng& rng) {
  return {test::random_sphere(rng, 40, 1, 0.2), torus(12, 8).mesh, goldberg(2).mesh,
          shaken(prism(7).mesh, rng, 0.5, 0.2), shaken(prism(8).mesh, rng, 0.5, 0.2)};
}

TEST(FoldSearch, second_derivatives_agree_with_differences) {
  Rng rng(61);
  for (const Mesh& mesh : meshes_of_all_valences(rng)) {
    Drafts(mesh).for_each([](const PatchDraft& d, std::uint32_t face) {
      SCOPED_TRACE(face);
      const PatchShape a = by_all_probes(d, true), b = by_differences(d);
      EXPECT_LE((a.second_form - b.second_form).norm(), 1e-4 * (1 + b.second_form.norm()));
      ASSERT_NE(fold_tables().second_of(d.form, d.valence()), nullptr);
      const double curvature = curvature_inside(d, false);
      EXPECT_NEAR(curvature_inside(d, true), curvature, 2e-4 * curvature);
      // At corners it depends on the direction, and so on the step: more so where sides are
      // blended.
      const bool is_blend = d.form != kFormSextic && d.form != kFormBezier;
      EXPECT_NEAR(a.rho_min, b.rho_min, (is_blend ? 0.1 : 1e-2) * b.rho_min);
      EXPECT_NEAR(a.least_cosine, b.least_cosine, is_blend ? 1e-11 : 1e-12);
      // Widened by what that curvature bends between samples.
      const double bent = is_blend ? 1e-2 : 1e-3;
      EXPECT_NEAR(a.sag, b.sag, bent * b.sag + 1e-9);
      EXPECT_LE((a.low - b.low).norm() + (a.high - b.high).norm(), bent);
    });
  }
}

TEST(FoldSearch, samples_are_those_of_the_patch) {
  Rng rng(62);
  for (const Mesh& mesh : meshes_of_all_valences(rng)) {
    Drafts(mesh).for_each([](const PatchDraft& d, std::uint32_t) {
      PatchSamples samples;
      examine(d, fold_tables(), &samples);
      const std::uint32_t n = d.valence(), coarse = kernels<double>().probe_coarse(n),
                          count = samples.is_gentle ? coarse : samples.count;
      const double* xi = fold_tables().probes_of(n);
      std::vector<double> rows(kCutRows * count);
      double axes[kFrameReals];
      d.frame.store(axes);
      const double stretch2 =
          kernels<double>().sample(fold_tables().domain_of(n), d.control.data(), d.form, axes, n,
                                   xi, xi + samples.count, count, rows.data());
      EXPECT_NEAR(samples.stretch2, stretch2, 1e-12 * stretch2);
      const double most = d.form == kFormCurved ? 1e-10 : 1e-12;  // its weights change fast
      for (std::size_t row = 0; row < kCutRows; ++row) {
        for (std::uint32_t i = 0; i < std::min(count, fold_tables().probe_count[n]); ++i)
          ASSERT_NEAR(samples.rows[row * samples.count + i], rows[row * count + i], most);
      }
    });
  }
}

// A gentle patch is as its fewer probes say: beside what all of them find, its bounds hold, and its
// turn and curvature are nearly the same.
TEST(FoldSearch, fewer_probes_tell_all_of_gentle_patches) {
  Rng rng(64);
  const std::vector<Mesh> meshes{torus_knot(60, 12).mesh,
                                 goldberg(3).mesh,
                                 irregular(torus(24, 12), 1).mesh,
                                 test::random_sphere(rng, 400, 1),
                                 shaken(prism(7).mesh, rng, 0.1, 0.02),
                                 shaken(torus(24, 12).mesh, rng, 0.3, 0.05)};
  std::size_t patches = 0, gentle = 0;
  for (const Mesh& mesh : meshes) {
    Drafts(mesh).for_each([&](const PatchDraft& d, std::uint32_t face) {
      SCOPED_TRACE(fmt::format("face {}, form {}", face, d.form));
      PatchSamples samples;
      const PatchShape few = examine(d, fold_tables(), &samples);
      const std::array<double, kShapeReals> reals = all_probes(d, true);
      const PatchShape all = by_all_probes(d, true);
      ++patches, gentle += samples.is_gentle;
      if (!samples.is_gentle) {
        EXPECT_EQ(few.least_cosine, all.least_cosine);
        EXPECT_EQ(few.rho_min, all.rho_min);
        return;
      }
      EXPECT_NEAR(few.least_cosine, all.least_cosine, 1e-3);
      EXPECT_GT(few.least_cosine, 0.7);
      EXPECT_NEAR(few.rho_min, all.rho_min, 0.15 * all.rho_min);
      EXPECT_EQ(few.second_form, all.second_form);
      const auto triple = [&](std::size_t at) { return Vec3(&reals[at]); };
      EXPECT_TRUE((few.box.low.array() <= triple(kShapeLow).array()).all());
      EXPECT_TRUE((few.box.high.array() >= triple(kShapeHigh).array()).all());
      EXPECT_TRUE((few.low.array() <= triple(kShapeAlongLow).array()).all());
      EXPECT_TRUE((few.high.array() >= triple(kShapeAlongHigh).array()).all());
      EXPECT_GE(few.sag, std::sqrt(reals[kShapeSag2]));
    });
  }
  EXPECT_GT(gentle, patches / 4);
  EXPECT_LT(gentle, patches * 3 / 4);
}

// 10^6 of them with GLISS_LONG_TESTS.
TEST(FoldSearch, loses_no_fold_of_random_faces) {
  const std::size_t most = std::getenv("GLISS_LONG_TESTS") ? 1'000'000 : 10'000;
  Rng rng(63);
  Search search;
  const auto add = [&](const Mesh& mesh) {
    Drafts(mesh).for_each([&](const PatchDraft& d, std::uint32_t) { search.add(d); });
  };
  while (search.patches < most) {
    const double tilt = oracle::uniform(rng, 0.3, 1.4);
    add(test::random_sphere(rng, 60, 1, tilt));
    test::SheetOptions sheet;
    sheet.tilt = tilt;
    sheet.has_quads = true;
    add(test::random_sheet(rng, sheet));
    const double shake = oracle::uniform(rng, 0, 4);
    add(shaken(torus(12, 8).mesh, rng, shake, tilt));
    for (const int n : {5, 6, 8}) add(shaken(prism(n).mesh, rng, shake, tilt));
    for (const Mesh& calm : {torus(24, 16).mesh, goldberg(3).mesh})
      add(shaken(calm, rng, 0.05 * shake, 0.05 * tilt));
  }
  EXPECT_GT(search.folded, search.patches / 50) << search.text();
  expect_all_found(search);
}

class SharedFoldSearch : public test::SharedTest {};

TEST_F(SharedFoldSearch, loses_no_fold_of_found_meshes) {
  Search search;
  int meshes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(test::shared_path("meshes"))) {
    if (entry.path().extension() != ".obj") continue;
    try {
      const Mesh mesh = test::load_shared("meshes/" + entry.path().stem().string());
      Drafts(mesh).for_each([&](const PatchDraft& d, std::uint32_t) { search.add(d); });
      ++meshes;
    } catch (const MeshError&) {  // some are there to be refused
    }
  }
  EXPECT_GE(meshes, 29);
  EXPECT_GT(search.folded, 0u) << search.text();
  expect_all_found(search);
}

}  // namespace
}  // namespace gliss
