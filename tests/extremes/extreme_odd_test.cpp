// HIPs that are no places: NaN, infinities, the largest and the smallest numbers. Every question
// is answered, no force that is not finite leaves the guards, and the next sound HIP is felt.
#include "gliss/contact/tracker.h"
#include "gliss/device/guard.h"
#include "gliss/query/contact_tracker.h"
#include "gliss/query/trace.h"
#include "tests/device/guard_fuzz.h"
#include "tests/extremes/extreme_hips.h"

namespace gliss {
namespace {

using oracle::Rng, oracle::uniform;
using test::Extreme;

const std::vector<const char*> kMeshes{"torus",  "goldberg", "fin",      "plate",
                                       "sphere", "crumpled", "fair fin", "fair irregular"};

Vec3 odd_hip(Rng& rng, const Extreme& e) {
  Vec3 hip = e.middle() + e.size * uniform(rng, 0, 1) * oracle::random_unit(rng);
  const auto all = rng() % 3 == 0;
  const auto one = static_cast<int>(rng() % 3);
  for (int axis = 0; axis < 3; ++axis) {
    if (all || axis == one) hip[axis] = test::odd_number(rng);
  }
  return hip;
}

bool is_place(const Vec3& hip) { return (hip.array().abs() <= 1e100).all(); }  // false for NaN

bool answers(const Extreme& e, const Contact& c) {
  return in_domain(e.cache, c.at) && c.scp.allFinite() && c.normal.allFinite() &&
         c.push.allFinite() && std::isfinite(c.distance);
}

std::string text(const Vec3& hip) { return fmt::format("({}, {}, {})", hip.x(), hip.y(), hip.z()); }

TEST(ExtremeOdd, hips_get_an_answer_from_searches) {
  Rng rng(61);
  const std::uint64_t each = test::samples(3'000, 100'000) / kMeshes.size();
  std::uint64_t unanswered = 0, count = 0, unfaced = 0, claimed = 0, asked = 0;
  std::string first;
  for (const char* name : kMeshes) {
    const Extreme& e = test::extreme(name);
    for (std::uint64_t i = 0; i < each; ++i, ++count) {
      const Vec3 hip = odd_hip(rng, e);
      for (const PatchCache* cache : {&e.cache, &e.narrow}) {
        for (const Method method : {Method::kGregory, Method::kShaded, Method::kFlat}) {
          QueryOptions options;
          options.method = method;
          const Contact c = nearest(*cache, hip, options);
          const double most = cache == &e.cache ? 1e100 : 1e15;
          const bool place = (hip.array().abs() <= most).all();
          unfaced += c.at.face >= e.mesh.face_count();
          asked += !hip.allFinite();
          claimed += !hip.allFinite() && (c.flags & kConverged);
          if (place && !answers(e, c) && unanswered++ == 0)
            first = fmt::format("{} {} {}", name, static_cast<int>(method), text(hip));
        }
      }
    }
  }
  EXPECT_EQ(unfaced, 0u);
  test::hold({"Projection", "HIPs that are not finite: share of contacts that say they converged",
              0, 1, "where no comparison holds the start counts as the minimum"},
             static_cast<double>(claimed) / static_cast<double>(asked), count);
  test::hold({"Projection", "HIPs up to 1e100 (float: 1e15): contacts that are not finite", 0},
             static_cast<double>(unanswered), count);
  test::record("first", "{}", first);
}

// Ticks without a place are as if they had not been.
TEST(ExtremeOdd, hips_leave_trackers_sound) {
  Rng rng(62);
  const std::uint64_t each = test::samples(1'500, 100'000) / kMeshes.size();
  std::uint64_t not_finite = 0, count = 0;
  double worst_wide = 0, worst_narrow = 0;
  std::string first, worst_at;
  for (const char* name : kMeshes) {
    const Extreme& e = test::extreme(name);
    for (std::uint64_t i = 0; i < each; ++i, ++count) {
      const SurfacePoint p = test::random_site(rng, e);
      const double depth = 0.2 * e.rho;
      for (const PatchCache* cache : {&e.cache, &e.narrow}) {
        ContactTracker disturbed(*cache, {}), calm(*cache, {}), wild(*cache, {});
        for (const double height : {-1.0, 0.5, 1.0, 0.2, -0.1, 0.7}) {
          const Vec3 hip = p.position - height * depth * p.normal, odd = odd_hip(rng, e);
          const Contact got = disturbed.tick(hip), want = calm.tick(hip);
          const double error = got.touching == want.touching
                                   ? (got.push - want.push).norm() / e.size
                                   : std::numeric_limits<double>::infinity();
          double& worst = cache == &e.cache ? worst_wide : worst_narrow;
          if (!(error <= worst)) {
            worst = error;
            worst_at = fmt::format("{} {}", name, text(hip));
          }
          if (!odd.allFinite()) disturbed.tick(odd);
          for (const Vec3& any : {odd, hip}) {
            const Contact c = wild.tick(any);
            EXPECT_LT(c.at.face, e.mesh.face_count());
            if (is_place(any) && !c.push.allFinite() && not_finite++ == 0)
              first = fmt::format("{} {}", name, text(any));
          }
        }
      }
    }
  }
  test::record("first", "{}; {}", first, worst_at);
  test::hold({"Tracking", "HIPs up to 1e100, after any: pushes that are not finite", 0},
             static_cast<double>(not_finite), count);
  const std::string after = "after HIPs that are not finite";
  test::hold({"Tracking", after + ": push from an undisturbed one's, of size", 1e-9}, worst_wide,
             count);
  test::hold({"Tracking", after + ", float: push from an undisturbed one's, of size", 1e-6},
             worst_narrow, count);
}

TEST(ExtremeOdd, hips_in_a_trace_and_a_scene_give_no_force_that_is_not_finite) {
  Rng rng(63);
  const std::uint64_t each = test::samples(3'000, 100'000) / kMeshes.size();
  std::uint64_t not_finite = 0, count = 0;
  for (const char* name : kMeshes) {
    const Extreme& e = test::extreme(name);
    std::vector<Vec3> hips;
    for (std::uint64_t i = 0; i < each; ++i) {
      const SurfacePoint p = test::random_site(rng, e);
      hips.push_back(rng() % 4 == 0 ? odd_hip(rng, e)
                                    : Vec3(p.position - uniform(rng, -1, 1) * e.rho * p.normal));
    }
    count += each;
    trace(e.cache, hips, {}, [&](std::size_t i, std::span<const TraceStep> steps) {
      for (const TraceStep& step : steps)
        not_finite += is_place(hips[i]) && !step.force.allFinite();
    });
    const SceneObject object{.cache = std::make_shared<PatchCache>(e.narrow)};
    Tracker tracker({&object, 1});
    Guard guard;
    std::chrono::nanoseconds now{0};
    for (const Vec3& hip : hips) {
      now += std::chrono::milliseconds(1);
      const Vec3 force = tracker.step(e.mesh.unit * hip);
      not_finite += !guard.step(now, {force, now}).force.allFinite();
      if (guard.engage()) now += std::chrono::milliseconds(1);
    }
  }
  test::hold(
      {"Tracking",
       "odd HIPs in traces, and through the guards in a scene: forces that are not finite", 0},
      static_cast<double>(not_finite), count);
}

}  // namespace
}  // namespace gliss
