// Many points and HIPs of many patches: packed into lanes or not, the bytes are those of one at a
// time.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "gliss/build/build_cache.h"
#include "gliss/generate/generate.h"
#include "gliss/query/contact_tracker.h"
#include "gliss/query/placed_points.h"
#include "gliss/surface/names.h"
#include "tests/oracle/oracle.h"
#include "tests/support/open_meshes.h"
#include "tests/support/places.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using oracle::Rng, oracle::uniform;

// Patches of high numbers cost no more room than others: it goes by the points alone.
TEST(PatchOrder, sorts_points_by_patch_whatever_the_numbers_of_patches) {
  const std::uint32_t many = 4'000'000'000;
  const std::vector<PatchRun> given = {{many, 0, 1}, {7, 1, 3}, {many, 3, 4}, {7, 4, 6}};
  PatchOrder order;
  ASSERT_EQ(order.judge(given, 2), PatchOrder::kInRuns);
  ASSERT_EQ(order.judge(given, 8), PatchOrder::kSparse);
  EXPECT_EQ(order.patch, (std::vector<std::uint32_t>{many, 7, 7, many, 7, 7}));
  std::vector<PatchRun> mixed;
  for (std::uint32_t i = 0; i < 16; ++i) mixed.push_back({i % 2 == 0 ? many : 7, i, i + 1});
  ASSERT_EQ(order.judge(mixed, 4), PatchOrder::kByPatch);
  order.sort();
  ASSERT_EQ(order.runs.size(), 2u);
  for (const PatchRun& run : order.runs) {
    EXPECT_EQ(run.end - run.begin, 8u);
    for (std::uint32_t at = run.begin; at < run.end; ++at) {
      EXPECT_EQ(order.order[at], 2 * (at - run.begin) + (run.patch == 7));
    }
  }
}

struct Asked {
  std::vector<DomainPoint> points;
  std::vector<Vec3> hips;
};

Asked asked(const Mesh& mesh, const PatchCache& cache, std::size_t count) {
  Rng rng(17);
  Asked a;
  for (std::size_t i = 0; i < count; ++i) {
    const auto face = static_cast<std::uint32_t>(rng() % mesh.face_count());
    const int n = static_cast<int>(mesh.valence(face));
    const int side = static_cast<int>(rng() % static_cast<std::uint64_t>(n));
    // Near sides too, which tracking crosses, and on them.
    const double inward = i % 7 == 0 ? 1 : i % 7 == 1 ? 0.999 : uniform(rng, 0, 1);
    const Eigen::Vector2d X = inward * oracle::on_side(n, side, uniform(rng, 0, 1));
    a.points.push_back({face, X.x(), X.y()});
    const SurfacePoint at = evaluate(cache, a.points.back());
    const double size = test::size_of(mesh);
    a.hips.push_back(at.position + size * uniform(rng, -0.03, 0.01) * at.normal +
                     (i % 5 == 0 ? 0.05 : 0.002) * size * oracle::random_unit(rng));
  }
  return a;
}

template <class T>
void expect_same(const T& one, const T& many, const std::string& what) {
  ASSERT_EQ(std::memcmp(&one, &many, sizeof one), 0) << what;
}

// Contacts have bytes between their members that nobody sets.
void expect_same(const Contact& one, const Contact& many, const std::string& what) {
  expect_same(one.scp, many.scp, what + ", SCP");
  expect_same(one.normal, many.normal, what + ", normal");
  expect_same(one.push, many.push, what + ", push");
  EXPECT_EQ(one.touching, many.touching) << what;
  EXPECT_EQ(one.at.face, many.at.face) << what;
  EXPECT_EQ(one.at.xi, many.at.xi) << what;
  EXPECT_EQ(one.at.eta, many.at.eta) << what;
  EXPECT_EQ(one.iterations, many.iterations) << what;
  EXPECT_EQ(one.crossings, many.crossings) << what;
  EXPECT_EQ(one.flags, many.flags) << what;
}

struct Case {
  const char* level;
  Precision precision;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.level << precision_name(c.precision); }

class Batch : public ::testing::TestWithParam<Case> {
 protected:
  static std::vector<Mesh> meshes() {
    return {torus_knot(40, 6).mesh, goldberg().mesh,
            banana().mesh,          irregular(torus(16, 8), 1).mesh,
            test::half_torus(),     test::fan_of_five(),
            test::open_strip()};
  }
  static PatchCache cache_of(const Mesh& mesh) {
    BuildOptions options;
    options.level = find_surface(GetParam().level).value();
    options.precision = GetParam().precision;
    return build_cache(mesh, options);
  }
};
INSTANTIATE_TEST_SUITE_P(
    , Batch,
    ::testing::Values(Case{"exact", Precision::kFloat}, Case{"exact", Precision::kDouble},
                      Case{"ribbon", Precision::kFloat}, Case{"bezier", Precision::kDouble},
                      Case{"table:2", Precision::kFloat}, Case{"fair", Precision::kFloat},
                      Case{"fair", Precision::kDouble}, Case{"fair-ribbon", Precision::kDouble}),
    [](const auto& info) {
      std::string name = info.param.level;
      std::erase(name, ':');
      std::erase(name, '-');
      return name + "_" + precision_name(info.param.precision);
    });

TEST_P(Batch, of_points_has_the_bytes_of_one_at_a_time) {
  for (const Mesh& mesh : meshes()) {
    const PatchCache cache = cache_of(mesh);
    const Asked a = asked(mesh, cache, 200);
    // Every remainder of every number of lanes, of one valence and of several.
    for (std::size_t count = 1; count <= a.points.size(); count += count < 40 ? 1 : 53) {
      std::vector<SurfacePoint> many(count);
      evaluate(cache, std::span(a.points).first(count), many);
      for (std::size_t i = 0; i < count; ++i)
        expect_same(evaluate(cache, a.points[i]), many[i], mesh.source + std::to_string(i));
    }
  }
}

TEST_P(Batch, of_hips_has_the_bytes_of_one_at_a_time) {
  constexpr Method kAsked[] = {Method::kFlat, Method::kGregory, Method::kShaded};
  for (const Mesh& mesh : meshes()) {
    const PatchCache cache = cache_of(mesh);
    const Asked a = asked(mesh, cache, 150);
    for (const Solver solver : {Solver::kNewton, Solver::kGaussNewton, Solver::kPaper}) {
      QueryOptions options;
      options.solver = solver;
      const std::size_t count = a.hips.size();
      std::vector<Contact> found(3 * count), tracked(count);
      nearest(cache, a.hips, kAsked, options, found);
      track(cache, a.hips, a.points, options, tracked);
      for (std::size_t i = 0; i < count; ++i) {
        const std::string what = mesh.source + ", HIP " + std::to_string(i);
        for (std::size_t m = 0; m < 3; ++m) {
          options.method = kAsked[m];
          expect_same(nearest(cache, a.hips[i], options), found[m * count + i], what);
        }
        options.method = Method::kGregory;
        ContactTracker tracker(cache, options);
        expect_same(tracker.track(a.hips[i], a.points[i]), tracked[i], what + " tracked");
      }
    }
  }
}

// HIPs as a sweep asks about them, one beside the other, which share a walk over the hierarchy:
// near the surface, where very many patches are as near, far outside, and with some among them that
// are no place.
std::vector<Vec3> hips_together(const Mesh& mesh, const PatchCache& cache) {
  constexpr std::size_t kTogether = 30;
  const double size = test::size_of(mesh);
  const Box box = cache.bounds();
  const Vec3 middle = 0.5 * (box.low + box.high);
  Rng rng(18);
  std::vector<Vec3> hips;
  const auto add = [&](const Vec3& at, double apart) {
    for (std::size_t i = 0; i < kTogether; ++i)
      hips.push_back(at + apart * size * oracle::random_unit(rng));
  };
  for (const Vec3& hip : asked(mesh, cache, 6).hips) {
    for (const double apart : {0.0, 1e-3, 0.02, 0.1}) add(hip, apart);
  }
  for (const double apart : {0.0, 1e-9, 1e-3, 0.1}) add(middle, apart);
  add(middle + Vec3(30 * size, 0, 0), 0.01);
  add(middle + Vec3(0, 1e12 * size, 0), 0.01);
  for (std::size_t i = 7; i < hips.size(); i += 50) hips[i].y() = std::nan("");
  for (std::size_t i = 19; i < hips.size(); i += 50) hips[i].z() = 1e200;
  return hips;
}

TEST_P(Batch, of_hips_that_lie_together_has_the_bytes_of_one_at_a_time) {
  constexpr Method kAsked[] = {Method::kGregory, Method::kFlat};
  std::vector<Mesh> all = meshes();
  all.push_back(goldberg(5).mesh);
  for (const Mesh& mesh : all) {
    const PatchCache cache = cache_of(mesh);
    const std::vector<Vec3> hips = hips_together(mesh, cache);
    QueryOptions options;
    for (const std::size_t methods : {1u, 2u}) {
      std::vector<Contact> found(methods * hips.size());
      nearest(cache, hips, std::span(kAsked).last(methods), options, found);
      for (std::size_t i = 0; i < found.size(); ++i) {
        options.method = std::span(kAsked).last(methods)[i / hips.size()];
        expect_same(nearest(cache, hips[i % hips.size()], options), found[i],
                    mesh.source + ", HIP " + std::to_string(i));
      }
    }
  }
}

// Lanes hold HIPs that a side, a saddle or too long a step stops: as many iterations as are allowed
// are spent in the same way.
TEST_P(Batch, stops_after_as_many_iterations) {
  const Mesh mesh = torus_knot(40, 6).mesh;
  const PatchCache cache = cache_of(mesh);
  const Asked a = asked(mesh, cache, 100);
  for (const int most : {0, 1, 2, 3, 5}) {
    QueryOptions options;
    options.max_iterations = most;
    std::vector<Contact> tracked(a.hips.size());
    track(cache, a.hips, a.points, options, tracked);
    for (std::size_t i = 0; i < a.hips.size(); ++i) {
      ContactTracker tracker(cache, options);
      expect_same(tracker.track(a.hips[i], a.points[i]), tracked[i],
                  std::to_string(most) + " iterations, HIP " + std::to_string(i));
      EXPECT_LE(tracked[i].iterations, most);
    }
  }
}

}  // namespace
}  // namespace gliss
