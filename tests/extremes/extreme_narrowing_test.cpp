// Narrowing to float rounds: g++ 12 may drop the rounding of (double)(float)x where its SLP
// vectoriser merges several, and the low part of a split is 0 then. What the product makes is
// compared with a rounding that no compiler sees through.
#include <bit>

#include "gliss/generate/generate.h"
#include "gliss/query/frames.h"
#include "gliss/surface/layout.h"
#include "tests/extremes/extreme_errors.h"

namespace gliss {
namespace {

using oracle::Rng;
using test::hold, test::Polygon, test::Vec2;

// Round to nearest, ties to even, from the bits; of normal numbers.
double rounded(double x) {
  if (x == 0) return x;
  constexpr std::uint64_t kDropped = (std::uint64_t{1} << 29) - 1, kHalf = std::uint64_t{1} << 28;
  auto bits = std::bit_cast<std::uint64_t>(x);
  const std::uint64_t odd = bits >> 29 & 1;
  bits += kHalf - 1 + odd;
  return std::bit_cast<double>(bits & ~kDropped);
}

bool is_float(double x) { return rounded(x) == x; }

// Six parts at once, as a vectoriser likes them.
TEST(ExtremeNarrowing, a_hip_is_split_into_what_float_holds_and_the_rest) {
  Rng rng(151);
  const PatchCache cache = test::cache_of(goldberg(1).mesh, Precision::kFloat);
  std::uint64_t wrong = 0, count = 0, rests = 0;
  for (std::uint64_t i = 0; i < test::samples(20'000, 1'000'000); ++i) {
    const Vec3 hip = oracle::uniform(rng, 0, 30) * oracle::random_unit(rng);
    const RawHip<float> raw = raw_hip<float>(cache, hip);
    for (int axis = 0; axis < 3; ++axis) {
      const double x = (hip[axis] - cache.origin[axis]) * cache.scale, high = rounded(x);
      wrong += static_cast<double>(raw.parts[axis]) != high;
      wrong += static_cast<double>(raw.parts[axis + 3]) != rounded(x - high);
      rests += raw.parts[axis + 3] != 0;
      count += 2;
    }
  }
  hold({"Numbers: rounding to float", "parts of HIPs that are not rounded to float", 0},
       static_cast<double>(wrong), count);
  EXPECT_GT(rests, count / 4) << "low parts are lost";
}

// A float cache has the double one's numbers, rounded. Origins of patches are floats in both, so
// that a HIP and an origin of either precision differ by the same.
TEST(ExtremeNarrowing, caches_hold_rounded_numbers) {
  Rng rng(152);
  std::uint64_t wrong = 0, count = 0;
  const auto compare = [&](const LargeArray<float>& got, const LargeArray<double>& from) {
    ASSERT_EQ(got.size(), from.size());
    for (std::size_t i = 0; i < got.size(); ++i) {
      const double want = rounded(from[i]);
      // Denormals of float are rounded elsewhere.
      const bool tiny = std::abs(from[i]) < 0x1p-125;
      wrong += tiny ? std::abs(static_cast<double>(got[i]) - from[i]) > 0x1p-149
                    : static_cast<double>(got[i]) != want;
      ++count;
    }
  };
  std::vector<Mesh> meshes{torus_knot(24, 6).mesh, goldberg(2).mesh, fin().mesh};
  for (const int n : {3, 4, 5, 17, 100}) {
    meshes.push_back(test::mesh_of(test::sound_polygon(rng, n)));
    for (Vec3& p : meshes.back().positions) p += Vec3(1e5, 3, -1e4);
  }
  for (const Mesh& mesh : meshes) {
    const PatchCache fine = test::cache_of(mesh, Precision::kDouble);
    const PatchCache coarse = test::cache_of(mesh, Precision::kFloat);
    const auto& from = std::get<Surface<double>>(fine.surface);
    const auto& got = std::get<Surface<float>>(coarse.surface);
    compare(got.control, from.control);
    compare(got.corner, from.corner);
    compare(got.patch, from.patch);
    for (std::uint32_t p = 0; p < from.patch_count(); ++p) {
      for (std::size_t i = 0; i < 3; ++i, ++count)
        wrong += !is_float(from.patch[p * kPatchReals + kPatchOrigin + i]);
    }
  }
  hold({"Numbers: rounding to float",
        "numbers of float caches that are not those of double ones, rounded", 0},
       static_cast<double>(wrong), count);
}

// A point of the domain means the same to a float cache before and after the caller rounds it.
TEST(ExtremeNarrowing, points_of_the_domain_are_rounded_once) {
  Rng rng(153);
  std::uint64_t wrong = 0, count = 0;
  for (const int n : {3, 5, 8, 33}) {
    const PatchCache cache =
        test::cache_of(test::mesh_of(test::sound_polygon(rng, n)), Precision::kFloat);
    std::vector<DomainPoint> given, held;
    for (int i = 0; i < 200; ++i) {
      const Vec2 X = oracle::random_inside<double>(rng, n);
      given.push_back({0, X.x(), X.y()});
      held.push_back({0, rounded(X.x()), rounded(X.y())});
    }
    std::vector<SurfacePoint> a(given.size()), b(given.size());
    evaluate(cache, given, a);
    evaluate(cache, held, b);
    for (std::size_t i = 0; i < a.size(); ++i, ++count) {
      wrong += a[i].position != b[i].position || a[i].d_xi != b[i].d_xi || a[i].d_eta != b[i].d_eta;
      const SurfacePoint one = evaluate(cache, given[i]);
      wrong += one.position != b[i].position || one.d_xi != b[i].d_xi || one.d_eta != b[i].d_eta;
    }
  }
  hold({"Numbers: rounding to float", "points of float caches that are not rounded to float", 0},
       static_cast<double>(wrong), count);
}

}  // namespace
}  // namespace gliss
