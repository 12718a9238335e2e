// The global nearest point against a dense oracle, where it is hard to find: what is farther than
// the oracle's is wrong, unless it says that it did not converge.
#include <mutex>

#include "gliss/engine/engine.h"
#include "tests/extremes/extreme_hips.h"

namespace gliss {
namespace {

using oracle::Rng, oracle::uniform;
using test::Extreme;

// Values that are reached where they are more than the goal.
struct Reached {
  double excess = 1e-9;   // double: of size
  double farther = 0;     // double, share that is more than 1e-9 of size farther
  double narrow = 1e-6;   // float: of size and distance
  double flagged = 1e-5;  // double, share
  double narrow_flagged = 1e-5;
  double narrow_unsound = 0;  // float, share
};

struct Kind {
  const char* name;
  const char* what;
  Vec3 (*hip)(Rng&, const Extreme&);
  std::vector<const char*> meshes;
  std::uint64_t few, many;
  Reached reached = {};
};

// A judgement of one precision.
struct NearestJudgement {
  double excess = 0;  // farther than the oracle, of contacts that say they converged
  std::string worst;  // the HIP of that
  double flagged_excess = 0;
  std::uint64_t farther = 0, flagged = 0, unsound = 0;

  void add(const NearestJudgement& other) {
    if (!(other.excess <= excess)) excess = other.excess, worst = other.worst;
    flagged_excess = std::max(flagged_excess, other.flagged_excess);
    farther += other.farther, flagged += other.flagged, unsound += other.unsound;
  }
};

void judge(const Extreme& e, const Vec3& hip, double nearest_distance, const Contact& c, double per,
           double goal, NearestJudgement& j) {
  const bool finite = c.scp.allFinite() && c.normal.allFinite() && c.push.allFinite() &&
                      std::isfinite(c.distance) && in_domain(e.cache, c.at);
  const double distance = finite ? (evaluate(e.cache, c.at).position - hip).norm() : 0;
  // Behind an open skin is inside, however deep.
  const bool is_deep = c.touching && e.cache.open.empty() && distance > e.size;
  if (!finite || c.touching != (c.distance < 0) || is_deep) {
    ++j.unsound;
    return;
  }
  const double excess =
      std::max(distance - nearest_distance, std::abs(std::abs(c.distance) - distance)) / per;
  if (!(c.flags & kConverged)) {
    ++j.flagged;
    j.flagged_excess = std::max(j.flagged_excess, excess);
    return;
  }
  j.farther += !(excess <= goal);
  if (!(excess <= j.excess)) {
    j.excess = excess;
    j.worst = fmt::format("({:.17g}, {:.17g}, {:.17g})", hip.x(), hip.y(), hip.z());
  }
}

void record(const Extreme& e, const char* precision, const NearestJudgement& j,
            std::uint64_t count) {
  test::record(e.name + " " + precision,
               "worst {:.2g} at {}, {} farther of {}; {} flagged, worst {:.2g}", j.excess, j.worst,
               j.farther, count, j.flagged, j.flagged_excess);
}

const char* const kMissedMinimum =
    "a second minimum of a patch was nearer, or the distance is flat to rounding about its minimum";
const char* const kFlagged = "a flat minimum takes more than 64 steps, and says so";

void PrintTo(const Kind& kind, std::ostream* out) { *out << kind.what; }

class ExtremeNearest : public ::testing::TestWithParam<Kind> {};

TEST_P(ExtremeNearest, is_never_farther_than_the_oracles) {
  constexpr std::size_t kBlock = 50;
  const Kind& kind = GetParam();
  const auto engine = make_tbb_engine();
  const std::uint64_t each =
      test::samples(kind.few, kind.many) / kind.meshes.size() / kBlock * kBlock + kBlock;
  NearestJudgement wide, narrow;
  std::uint64_t count = 0;
  for (const char* name : kind.meshes) {
    const Extreme& e = test::extreme(name);
    NearestJudgement in_wide, in_narrow;
    std::mutex mutex;
    engine->for_each(each, kBlock, [&](std::size_t begin, std::size_t end) {
      Rng rng(1000 + begin);
      NearestJudgement w, n;
      for (std::size_t i = begin; i < end; ++i) {
        const Vec3 hip = kind.hip(rng, e);
        const double distance = e.oracle.nearest(hip).distance;
        judge(e, hip, distance, nearest(e.cache, hip), e.size, 1e-9, w);
        judge(e, hip, distance, nearest(e.narrow, hip), e.size + distance, 1e-6, n);
      }
      const std::lock_guard lock(mutex);
      in_wide.add(w), in_narrow.add(n);
    });
    record(e, "double", in_wide, each);
    record(e, "float", in_narrow, each);
    wide.add(in_wide), narrow.add(in_narrow);
    count += each;
  }
  EXPECT_EQ(wide.unsound, 0u);
  const Reached& reached = kind.reached;
  const std::string what = std::string("nearest point ") + kind.what;
  const auto share = [&](std::uint64_t some) {
    return static_cast<double>(some) / static_cast<double>(count);
  };
  test::hold({"Projection", what + ": farther than the oracle's, of size", 1e-9, reached.excess,
              kMissedMinimum},
             wide.excess, count);
  test::hold({"Projection", what + ": share that is farther than that", 0, reached.farther,
              kMissedMinimum},
             share(wide.farther), count);
  test::hold({"Projection", what + ", float: farther than the oracle's, of size and distance", 1e-6,
              reached.narrow, kMissedMinimum},
             narrow.excess, count);
  test::hold({"Projection", what + ": share that says it did not converge", 1e-5, reached.flagged,
              kFlagged},
             share(wide.flagged), count);
  test::hold({"Projection", what + ", float: share that is not finite, or far outside and inside",
              0, reached.narrow_unsound, "so far away the side is not told in float"},
             share(narrow.unsound), count);
  test::hold({"Projection", what + ", float: share that says it did not converge", 1e-5,
              reached.narrow_flagged, kFlagged},
             share(narrow.flagged), count);
}

const std::vector<const char*> kAll{"knot",  "torus", "goldberg", "banana",
                                    "plate", "fin",   "sphere",   "fans"};
// Without the sphere: its centre costs a search of all patches.
const std::vector<const char*> kMany{"knot", "torus", "goldberg", "banana", "fin"};
constexpr std::uint64_t kMillion = 1'000'000;

// clang-format off
const Kind kKinds[] = {
    {"edges", "over edges", test::over_an_edge, kAll, 3000, kMillion, {1e-6, 5e-6, 1e-3, 1e-4, 1e-4}},
    {"vertices", "over vertices", test::over_a_vertex, kAll, 3000, kMillion, {1e-6, 5e-6, 1e-3, 1e-4, 1e-4}},
    {"poles", "over poles of valence 24", test::over_a_pole, {"sphere", "fans"}, 1000, kMillion,
     {1e-7, 5e-6, 2e-6, 1e-4, 1e-4}},
    {"medial_axis", "on the medial axis", test::on_the_medial_axis,
     {"knot", "torus", "goldberg", "banana", "plate", "fin", "fans"}, 1000, kMillion,
     {1e-6, 5e-6, 1e-3, 1e-3, 1e-3}},
    {"centres", "at centres of curvature", test::at_a_centre_of_curvature, kMany, 1500, kMillion,
     {1e-6, 5e-6, 1e-3, 1e-3, 1e-3}},
    {"centre", "at the centre of a sphere", test::at_a_centre_of_curvature, {"sphere"}, 1, 2000,
     {1e-7, 0, 1e-5, 0.05, 0.05}},
    {"surface", "exactly on the surface", test::on_the_surface, kAll, 3000, kMillion, {1e-9, 0, 5e-6}},
    {"folds", "inside folds", test::inside_a_fold, {"crumpled"}, 2000, kMillion,
     {1e-6, 5e-6, 1e-3, 1e-4, 1e-4}},
    {"far", "1 to 10 sizes outside", test::far_outside<1>, kAll, 4000, kMillion,
     {1e-6, 5e-6, 1e-3, 1e-4, 1e-4}},
    {"farther", "100 to 1,000 sizes outside", test::far_outside<3>, kAll, 2000, kMillion,
     {1e-6, 5e-6, 1e-3, 1e-4, 1e-4}},
    {"farthest", "100,000 to 1,000,000 sizes outside", test::far_outside<6>, kAll, 2000, kMillion,
     {1e-6, 1e-4, 1e-3, 1e-4, 1e-4, 0.03}}};
// clang-format on

INSTANTIATE_TEST_SUITE_P(, ExtremeNearest, ::testing::ValuesIn(kKinds), test::kNameOf);

// clang-format off
const Kind kOpenKinds[] = {
    {"edges", "over edges of open parts", test::over_an_edge, test::kOpenExtremes, 3000, kMillion,
     {1e-8, 1e-4, 1e-5, 1e-4, 1e-4}},
    {"vertices", "over vertices of open parts", test::over_a_vertex, test::kOpenExtremes, 3000, kMillion,
     {1e-7, 5e-4, 1e-5, 5e-4, 1e-4}},
    {"borders", "past borders", test::past_a_border, test::kOpenExtremes, 3000, kMillion, {1e-9, 0, 1e-5, 1e-3, 1e-4}},
    {"medial_axis", "on the medial axis of open parts", test::on_the_medial_axis, test::kOpenExtremes, 1000, kMillion,
     {1e-4, 5e-3, 1e-4, 2e-3, 1e-4}},
    {"surface", "exactly on the surface of open parts", test::on_the_surface, test::kOpenExtremes, 1000, kMillion},
    {"far", "1 to 10 sizes outside open parts", test::far_outside<1>, test::kOpenExtremes, 1000, kMillion,
     {1e-9, 0, 5e-6, 1e-4, 1e-4}}};

const Kind kFairKinds[] = {
    {"edges", "over edges of fair parts", test::over_an_edge, test::kFairExtremes, 1000, kMillion,
     {1e-4, 1e-3, 5e-5, 1e-3, 1e-4}},
    {"vertices", "over vertices of fair parts", test::over_a_vertex, test::kFairExtremes, 1000, kMillion,
     {1e-6, 1e-3, 1e-5, 1e-3, 1e-4}},
    {"poles", "over poles of valence 24 of fair parts", test::over_a_pole, {"fair sphere"}, 500, kMillion},
    {"borders", "past borders of fair parts", test::past_a_border, {"fair open strip", "fair open fan"}, 1000, kMillion,
     {1e-9, 0, 1e-5, 1e-3, 1e-4}},
    {"medial_axis", "on the medial axis of fair parts", test::on_the_medial_axis,
     {"fair fin", "fair banana", "fair irregular", "fair open strip", "fair open fan"}, 500, kMillion,
     {1e-4, 5e-3, 1e-4, 2e-3, 1e-4}},
    {"centres", "at centres of curvature of fair parts", test::at_a_centre_of_curvature,
     {"fair fin", "fair banana", "fair irregular"}, 500, kMillion, {1e-9, 0, 1e-5, 2e-3, 1e-4}},
    {"surface", "exactly on the surface of fair parts", test::on_the_surface, test::kFairExtremes, 1000, kMillion,
     {1e-9, 0, 1e-5}},
    {"far", "1 to 10 sizes outside fair parts", test::far_outside<1>, test::kFairExtremes, 1000, kMillion,
     {1e-9, 0, 5e-6}}};
// clang-format on

INSTANTIATE_TEST_SUITE_P(Open, ExtremeNearest, ::testing::ValuesIn(kOpenKinds), test::kNameOf);
INSTANTIATE_TEST_SUITE_P(Fair, ExtremeNearest, ::testing::ValuesIn(kFairKinds), test::kNameOf);

}  // namespace
}  // namespace gliss
