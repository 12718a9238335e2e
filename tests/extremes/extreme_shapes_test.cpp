// Normals and shapes at the edge of what a mesh may hold: right, or flagged and finite and closed.
#include "gliss/build/build_cache.h"
#include "gliss/validate/validate.h"
#include "tests/extremes/extreme_judge.h"
#include "tests/extremes/extreme_polygons.h"
#include "tests/support/mesh_files.h"

namespace gliss {
namespace {

using oracle::Rng;
using test::hold, test::Judge, test::Judgement, test::Polygon;

// Figures, and why some miss their goals.
constexpr const char *kPosition = "position of sound patches, of size",
                     *kSlope = "slopes of sound patches, of size",
                     *kNormal = "normal of sound patches, rad",
                     *kBoundary = "boundary of flagged patches, of size, times soundness",
                     *kGap = "gap across edges, of size", *kUnit = "normals off length 1",
                     *kFolds = "share of faces that fold and are not flagged",
                     *kDegenerate = "share of faces with a degenerate ribbon that are not flagged";
constexpr const char
    *kNearlyDegenerate = "a ribbon may be as weak as 1e-2 before it is flagged",
    *kWeakFlagged = "T of a weak ribbon of a flagged face is only as good as its soundness",
    *kBetweenProbes = "a build looks at points; a fold may lie between them",
    *kFrame = "coordinates are rounded to 1e-16 of the mesh, which turns its short edges",
    *kTooShort = "an edge of 1e-9 of its face is below its rounding to float";

// The values that a figure reaches where they are more than its goal, in double and float.
struct Missed {
  const char* figure;
  double in_double, in_float;
  const char* why;
};

const std::vector<Missed> kWildNormals{{kPosition, 1e-12, 1e-5, kNearlyDegenerate},
                                       {kSlope, 1e-11, 1e-3, kNearlyDegenerate},
                                       {kNormal, 1e-12, 1e-4, kNearlyDegenerate},
                                       {kGap, 1e-14, 1e-5, kNearlyDegenerate},
                                       {kFolds, 1e-3, 1e-3, kBetweenProbes}};

struct Made {
  std::string name;
  Precision precision;
  Construction construction;
};

void PrintTo(const Made& made, std::ostream* out) { *out << made.name; }

class ExtremeShapes : public ::testing::TestWithParam<Made> {
 protected:
  static bool is_float() { return GetParam().precision == Precision::kFloat; }
  // Faces of five and more sides that do not fold are the same patches in both constructions.
  static bool is_made(int sides) {
    return sides <= 4 || GetParam().construction == Construction::kPaper;
  }
  static Judge judge_of(std::uint64_t seed) {
    return {GetParam().precision, GetParam().construction, seed};
  }
  static PatchCache cache_of(const Polygon& polygon, BuildReport& report) {
    return test::cache_of(test::mesh_of(polygon), GetParam().precision, true, &report,
                          GetParam().construction);
  }

  static void conclude(const char* what, const Judgement& j, const std::vector<Missed>& missed) {
    const auto bound = [&](const char* figure, double goal) {
      test::Bound b{"Numbers: normals and shapes",
                    fmt::format("{}: {}, {}", what, figure, GetParam().name), goal};
      for (const Missed& m : missed) {
        const double reached = is_float() ? m.in_float : m.in_double;
        if (std::string(figure) != m.figure || reached <= goal) continue;
        b.limit = reached;
        b.limited_by = m.why;
      }
      return b;
    };
    hold(bound(kPosition, is_float() ? 2e-6 : 1e-13), j.sound.position);
    hold(bound(kSlope, is_float() ? 5e-6 : 1e-13), j.sound.slope);
    hold(bound(kNormal, is_float() ? 5e-6 : 1e-13), j.sound.normal);
    hold(bound(kBoundary, is_float() ? 2e-6 : 1e-14), j.boundary);
    hold(bound(kGap, is_float() ? 1e-6 : 1e-14), j.gap);
    hold(bound(kUnit, 1e-15), j.unit_normal);
    const auto never = [&](const char* figure, const test::Times& times) {
      hold(bound(figure, 0), static_cast<double>(times.count) / static_cast<double>(j.faces),
           j.faces);
      if (times.count > 0) fmt::print("    first: {}\n", times.first);
    };
    never("points that are not finite, a face", j.not_finite);
    never(kFolds, j.folds);
    never(kDegenerate, j.degenerate);
    test::record(what, "{} faces, {} flagged, {} meshes refused", j.faces, j.flagged, j.refused);
  }
};
INSTANTIATE_TEST_SUITE_P(
    , ExtremeShapes,
    ::testing::Values(Made{"double", Precision::kDouble, Construction::kPaper},
                      Made{"float", Precision::kFloat, Construction::kPaper},
                      Made{"fair, double", Precision::kDouble, Construction::kFair},
                      Made{"fair, float", Precision::kFloat, Construction::kFair}),
    test::kNameOf);

// The polygon and one beyond its longest side: a neighbour far smaller than the mesh would have
// corners rounded to the size of the mesh.
Mesh with_neighbour(Rng& rng, const Polygon& polygon, double tilt) {
  int longest = 0;
  const auto length = [&](int k) { return (polygon.position(k + 1) - polygon.position(k)).norm(); };
  for (int k = 1; k < polygon.size(); ++k) longest = length(k) > length(longest) ? k : longest;
  const int sides = 3 + static_cast<int>(rng() % 6);
  return test::mesh_of(
      polygon, longest,
      oracle::with_unit_normals(oracle::random_neighbour(rng, polygon, longest, sides, tilt)));
}

TEST_P(ExtremeShapes, bear_normals_tilted_from_0_to_180_degrees) {
  Judge judge = judge_of(111);
  Rng rng(112);
  for (int tilt = 0; tilt <= 180; tilt += 10) {
    for (const int n : {3, 4, 5, 6, 8, 12}) {
      if (!is_made(n)) continue;
      for (std::uint64_t i = 0; i < test::samples(2, 60); ++i) {
        judge.judge(with_neighbour(rng, test::tilted(rng, n, tilt * oracle::kDegree), 0.5),
                    fmt::format("tilt {} of {} sides, {}", tilt, n, i));
      }
    }
  }
  conclude("tilts of 0 to 180 degrees", judge.found(), kWildNormals);
}

TEST_P(ExtremeShapes, bear_normals_that_leave_ribbons_undefined) {
  Judge judge = judge_of(113);
  Rng rng(114);
  for (std::uint64_t i = 0; i < test::samples(3, 100); ++i) {
    for (const int n : {3, 4, 5, 6, 9}) {
      if (!is_made(n)) continue;
      for (const test::NamedPolygon& p : test::degenerate_normals(rng, n)) {
        const Polygon right = oracle::with_unit_normals(
            oracle::random_neighbour(rng, p.polygon, 0, 3 + static_cast<int>(rng() % 6), 0.5));
        judge.judge(test::mesh_of(p.polygon, 0, right), fmt::format("{}, {}", p.name, i));
      }
    }
  }
  conclude("degenerate normals", judge.found(), kWildNormals);
}

TEST_P(ExtremeShapes, may_be_slivers_stars_saddles_or_cross_themselves) {
  Judge judge = judge_of(115);
  Rng rng(116);
  for (std::uint64_t i = 0; i < test::samples(1, 100); ++i) {
    for (const test::NamedPolygon& p : test::odd_shapes(rng)) {
      if (!is_made(p.polygon.size())) continue;
      judge.judge(with_neighbour(rng, p.polygon, 0.3), fmt::format("{}, {}", p.name, i));
    }
  }
  conclude("odd shapes", judge.found(),
           {{kBoundary, 1e-12, 1e-4, kWeakFlagged},
            {kGap, 1e-12, 1e-3, kWeakFlagged},
            {kFolds, 0.02, 0.02, kBetweenProbes}});
}

TEST_P(ExtremeShapes, may_have_edges_of_hardly_any_length) {
  Judge some = judge_of(117), hardly_any = judge_of(117);
  Rng rng(118);
  for (std::uint64_t i = 0; i < test::samples(1, 100); ++i) {
    for (const double length : {1e-3, 1e-5, 1e-7, 1e-9, 1e-12, 1e-15, 1e-20, 1e-60}) {
      for (const test::NamedPolygon& p : test::short_edges(rng, length)) {
        if (!is_made(p.polygon.size())) continue;
        (length < 1e-10 ? hardly_any : some)
            .judge(with_neighbour(rng, p.polygon, 0.3), fmt::format("{}, {}", p.name, i));
      }
    }
  }
  conclude("edges of 1e-3 to 1e-9 of a face", some.found(),
           {{kPosition, 1e-7, 0, kFrame},
            {kSlope, 1e-6, 0, kFrame},
            {kNormal, 1e-7, 0, kFrame},
            {kSlope, 0, 10, kTooShort},
            {kNormal, 0, 1e-2, kTooShort},
            {kFolds, 0, 0.1, kTooShort}});
  conclude("edges of 1e-12 to 1e-60 of a face", hardly_any.found(),
           {{kPosition, 0.1, 0.1, kFrame},
            {kSlope, 1, 10, kFrame},
            {kNormal, 0.1, 1, kFrame},
            {kFolds, 0, 0.1, kTooShort}});
}

// Where the curves at a corner turn back by little, the patch folds in a place as small.
TEST_P(ExtremeShapes, with_corners_hardly_reflex_are_flagged) {
  std::uint64_t missed = 0, count = 0;
  for (const int n : {3, 4, 5, 6}) {
    for (const double inward : {0.1, 1e-2, 1e-3, 1e-4, 1e-6}) {
      Polygon polygon = test::regular(n);
      const Vec3 middle = (polygon.position(0) + polygon.position(1)) / 2;
      polygon.positions.insert(polygon.positions.begin() + 1, (1 - inward) * middle);
      polygon.normals.push_back(Vec3::UnitZ());
      BuildReport report;
      const PatchCache cache = cache_of(polygon, report);
      const SurfacePoint corner = test::at(cache, 0, oracle::domain_corner(n + 1, 1));
      missed += report.flagged_faces.empty() && corner.normal.z() < 0;
      ++count;
    }
  }
  hold(
      {"Numbers: normals and shapes",
       fmt::format("share of hardly reflex corners that reverse the normal and are not flagged, {}",
                   GetParam().name),
       0},
      static_cast<double>(missed) / static_cast<double>(count), count);
}

// A vertex in the middle of a straight side, as where finer faces meet coarser ones. Between equal
// normals G_xi and G_eta are parallel at its corner, which has a normal all the same; between
// others the corner may be reflex, and the patch folds there.
TEST_P(ExtremeShapes, may_have_corners_of_180_degrees) {
  Rng rng(119);
  test::WorstPlace normal;
  std::uint64_t wrong_side = 0, asked = 0, folded = 0, curved = 0;
  for (std::uint64_t i = 0; i < test::samples(20, 500); ++i) {
    const int n = 3 + static_cast<int>(i % 4);
    const bool flat = i % 2 == 0;
    Polygon polygon = flat ? test::regular(n) : oracle::random_polygon(rng, n, 0.2);
    const Vec3 middle = (polygon.position(0) + polygon.position(1)) / 2;
    polygon.positions.insert(polygon.positions.begin() + 1, middle);
    polygon.normals.insert(polygon.normals.begin() + 1, oracle::face_normal(polygon));
    polygon = oracle::with_unit_normals(polygon);
    BuildReport report;
    const PatchCache cache = cache_of(polygon, report);
    const SurfacePoint corner = test::at(cache, 0, oracle::domain_corner(n + 1, 1));
    const double turn = oracle::angle<double>(corner.normal, polygon.normal(1));
    if (flat) {
      normal.add(turn, [&] { return fmt::format("{} sides", n + 1); });
    } else {
      ++curved;
      folded += report.flagged_faces.empty() && turn > std::numbers::pi / 2;
    }
    for (const double depth : {-0.05, -0.001, 0.001, 0.05}) {
      const bool inside = depth > 0;
      wrong_side += nearest(cache, middle - depth * polygon.normal(1)).touching != inside;
      ++asked;
    }
  }
  const auto row = [&](const char* what, double goal, double limit, const char* why) {
    return test::Bound{"Numbers: normals and shapes",
                       fmt::format("corners of 180 degrees: {}, {}", what, GetParam().name), goal,
                       limit, why};
  };
  hold(row("normal where they are flat, rad", is_float() ? 1e-5 : 1e-9, is_float() ? 1e-5 : 1e-9,
           ""),
       normal);
  const auto share = [](std::uint64_t part, std::uint64_t all) {
    return static_cast<double>(part) / static_cast<double>(all);
  };
  hold(row("share that fold there and are not flagged", 0, 0, ""), share(folded, curved), curved);
  hold(row("share of HIPs at the corner on the wrong side", 0, 0, ""), share(wrong_side, asked),
       asked);
}

TEST(ExtremeEdges, of_no_length_are_refused_by_name_where_it_is_strict) {
  for (const int n : {3, 4, 9}) {
    Polygon polygon = test::regular(n);
    polygon.positions[1] = polygon.positions[0];
    Mesh mesh = test::mesh_of(polygon);
    mesh.source = "a";
    const std::string refusal = "a: face 0: the side from vertex 0 to 1 has no length";
    const LoadOptions strict{.strict = true};
    EXPECT_EQ(test::message_of<MeshError>([&] { validate(mesh, strict); }), refusal);
    mesh.positions[1].z() = 1e-200;  // its square is none
    EXPECT_EQ(test::message_of<MeshError>([&] { validate(mesh, strict); }), refusal);
  }
}

}  // namespace
}  // namespace gliss
