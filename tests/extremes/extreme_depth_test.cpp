// HIPs whose contact is known: G - d n, where d is below a quarter of the least radius of
// curvature. Every one of them is found, in ten steps of Newton's method.
#include <mutex>

#include "gliss/engine/engine.h"
#include "tests/extremes/extreme_hips.h"

namespace gliss {
namespace {

using oracle::Rng, oracle::uniform;
using test::Extreme;

struct Found {
  double excess = 0, error = 0;  // of the distance; of the contact point, where no other is nearer
  std::uint64_t farther = 0, unfinished = 0, wrong_side = 0;
  std::string worst;  // of `excess`

  void add(const Found& other) {
    if (!(other.excess <= excess)) worst = other.worst;
    excess = std::max(excess, other.excess), error = std::max(error, other.error);
    farther += other.farther, unfinished += other.unfinished, wrong_side += other.wrong_side;
  }
};

void search(Rng& rng, const Extreme& e, const PatchCache& cache, double goal, Found& found) {
  const auto face = static_cast<std::uint32_t>(rng() % e.mesh.face_count());
  const auto n = static_cast<int>(e.mesh.valence(face));
  const SurfacePoint p = test::at(e.cache, face, oracle::random_inside<double>(rng, n));
  const double depth = uniform(rng, -0.25, 0.25) * std::min(e.rho_of(face), e.size);
  const Vec3 hip = p.position - depth * p.normal;
  QueryOptions options;
  options.max_iterations = 10;
  const Contact c = nearest(cache, hip, options);
  if (!(c.flags & kConverged)) {
    ++found.unfinished;
    return;
  }
  const double excess = (std::abs(c.distance) - std::abs(depth)) / e.size;
  found.farther += !(excess <= goal);
  if (!(excess <= found.excess)) {
    found.excess = excess;
    found.worst = fmt::format("{}: ({:.17g}, {:.17g}, {:.17g}), face {}, depth {:.3g}", e.name,
                              hip.x(), hip.y(), hip.z(), face, depth);
  }
  // Where the surface passes through itself, or is thin, another sheet may be nearer.
  if (excess < -0.01 * goal) return;
  found.error = std::max(found.error, (c.scp - p.position).norm() / e.size);
  found.wrong_side += std::abs(depth) > goal * e.size && c.touching != (depth > 0);
}

struct Parts {
  const char* name;
  std::vector<const char*> meshes;
  Precision precision;
  double goal;
  double unfinished = 0, farther = 0, error = goal;  // what is reached where that is more
};

const char* const kMissed = "a second minimum near a ridge was nearer";

void PrintTo(const Parts& parts, std::ostream* out) { *out << parts.name; }

class ExtremeDepth : public ::testing::TestWithParam<Parts> {};

TEST_P(ExtremeDepth, within_a_quarter_of_the_radius_every_point_is_found_in_ten_steps) {
  constexpr std::size_t kBlock = 250;
  const Parts& parts = GetParam();
  const std::uint64_t each = test::samples(4'000, 1'000'000) / parts.meshes.size();
  const auto engine = make_tbb_engine();
  Found all;
  for (const char* name : parts.meshes) {
    const Extreme& e = test::extreme(name);
    const PatchCache& cache = parts.precision == Precision::kDouble ? e.cache : e.narrow;
    Found of_mesh;
    std::mutex mutex;
    engine->for_each(each, kBlock, [&](std::size_t begin, std::size_t end) {
      Rng rng(3000 + begin);
      Found some;
      for (std::size_t i = begin; i < end; ++i) search(rng, e, cache, parts.goal, some);
      const std::lock_guard lock(mutex);
      of_mesh.add(some);
    });
    test::record(name, "{} farther, {} unfinished of {}, excess {:.2g}, error {:.2g}; worst at {}",
                 of_mesh.farther, of_mesh.unfinished, each, of_mesh.excess, of_mesh.error,
                 of_mesh.worst);
    all.add(of_mesh);
  }
  const std::uint64_t count = each * parts.meshes.size();
  const auto share = [&](std::uint64_t some) {
    return static_cast<double>(some) / static_cast<double>(count);
  };
  const std::string what = fmt::format("within 0.25 rho_min, {}: ", parts.name);
  EXPECT_EQ(all.wrong_side, 0u);
  test::hold({"Projection", what + "share that needs more than 10 Newton steps, and says so", 0,
              parts.unfinished, "flat minima, and those on sides and corners, need some more"},
             share(all.unfinished), count);
  test::hold({"Projection", what + "share of contacts that are not the nearest", 0, parts.farther,
              kMissed},
             share(all.farther), count);
  test::hold({"Projection", what + "the contact point's error, of size", parts.goal, parts.error,
              parts.farther > 0 ? kMissed : "the distance is flat to rounding about its minimum"},
             all.error, count);
}

const std::vector<const char*> kRound{"knot", "torus", "goldberg", "banana", "sphere"},
    kSharp{"plate", "fin", "fans"};

INSTANTIATE_TEST_SUITE_P(
    , ExtremeDepth,
    ::testing::Values(
        Parts{"round parts", kRound, Precision::kDouble, 1e-9, 2e-4},
        Parts{"sharp parts", kSharp, Precision::kDouble, 1e-9, 0.012, 0, 5e-9},
        Parts{"round parts, float", kRound, Precision::kFloat, 1e-6, 0, 0, 5e-5},
        Parts{"sharp parts, float", kSharp, Precision::kFloat, 1e-6, 5e-3, 1e-4, 5e-3},
        Parts{"open parts", test::kOpenExtremes, Precision::kDouble, 1e-9},
        Parts{"open parts, float", test::kOpenExtremes, Precision::kFloat, 1e-6, 0, 0, 5e-5},
        Parts{"fair parts", test::kFairExtremes, Precision::kDouble, 1e-9, 3e-4},
        Parts{"fair parts, float", test::kFairExtremes, Precision::kFloat, 1e-6, 0, 0, 5e-5}),
    test::kNameOf);

}  // namespace
}  // namespace gliss
