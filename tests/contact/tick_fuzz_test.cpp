// Holds after any tick, wherever the hand is said to be and whenever: the tracker's force is finite
// for every position that is, its work bounded, and the guards keep their promises. 4e5 ticks, 1e8
// with GLISS_LONG_TESTS.
#include <cstdlib>

#include "gliss/contact/tracker.h"
#include "gliss/generate/generate.h"
#include "tests/device/guard_fuzz.h"
#include "tests/oracle/union_oracle.h"
#include "tests/support/allocations.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using oracle::Rng, oracle::uniform, oracle::random_unit;

// A hand that wanders about parts of 20 mm round the origin, in and out and through them; at times
// it is elsewhere at once, or nowhere.
class HandFuzz {
 public:
  explicit HandFuzz(std::uint64_t seed) : rng_(seed) {}

  Vec3 next() {
    if (left_-- == 0) {
      left_ = static_cast<int>(rng_() % 500);
      pace_ = std::array{1e-9, 1e-6, 1e-5, 1e-4, 1e-4, 5e-4}[rng_() % 6];
      aim_ = anywhere(0.02);
    }
    const Vec3 way = aim_ - at_;
    if (way.norm() > pace_) at_ += uniform(rng_, 0, pace_) * way.normalized();
    at_ += 0.1 * uniform(rng_, 0, pace_) * random_unit(rng_);
    // Few: those that cross a part cost a thousand others.
    const auto dice = rng_() % 4096;
    if (dice < 6) at_ = anywhere(0.03);
    if (dice == 6) at_ = anywhere(10);
    if (dice == 7) at_ = Vec3::Zero();
    if (dice == 8) return anywhere(1e100);
    if (dice == 9) return anywhere(5e-324);
    if (dice >= 16) return at_;
    Vec3 odd = at_;
    for (int axis = 0; axis < 3; ++axis) {
      if (dice == 10 || rng_() % 2 == 0) odd[axis] = test::odd_number(rng_);
    }
    return odd;
  }

 private:
  Vec3 anywhere(double reach) {
    return {uniform(rng_, -reach, reach), uniform(rng_, -reach, reach),
            uniform(rng_, -reach, reach)};
  }

  Rng rng_;
  int left_ = 0;
  double pace_ = 0;
  Vec3 at_ = Vec3::Zero(), aim_ = Vec3::Zero();
};

std::vector<std::vector<SceneObject>> scenes() {
  const auto part = [](const Mesh& mesh, Precision precision) {
    return std::make_shared<const PatchCache>(test::cache_of(mesh, precision));
  };
  SceneObject plate{.cache = part(thin_plate().mesh, Precision::kDouble)};
  SceneObject fin{.cache = part(gliss::fin().mesh, Precision::kFloat), .stiffness = 2000};
  SceneObject ball{.cache = part(goldberg().mesh, Precision::kDouble),
                   .solver = Solver::kGaussNewton,
                   .friction = {0.5, 0.3, 5e-3},
                   .effects = {.damping = 20, .viscosity = 20}};
  plate.pose =
      Eigen::Translation3d(0.002, 0, -0.004) * Eigen::AngleAxisd(0.3, Vec3(1, 2, 3).normalized());
  fin.pose = Eigen::Translation3d(0, 0.003, 0) * Eigen::AngleAxisd(2, Vec3(-1, 0, 1).normalized());
  ball.pose = Eigen::Translation3d(-0.006, 0.004, 0.01) * Eigen::Isometry3d::Identity();
  const Mesh sphere = goldberg(3, 10).mesh;
  const Mesh cluster = test::joined({sphere, test::moved(sphere, Vec3(15, 0.4, 0.3)),
                                     test::moved(sphere, Vec3(7.3, 13.2, 1)),
                                     test::moved(torus().mesh, Vec3(2, 3, 4))});
  SceneObject unioned{.cache = part(cluster, Precision::kDouble)};
  unioned.pose = Eigen::Translation3d(-0.005, -0.004, 0) * Eigen::Isometry3d::Identity();
  SceneObject flat = fin, shaded = plate;
  flat.method = Method::kFlat;
  shaded.method = Method::kShaded;
  SceneObject printed[2] = {plate, fin};
  for (SceneObject& object : printed) object.solver = Solver::kPaper;
  return {{plate, ball}, {fin, plate},   {ball, fin},
          {unioned},     {flat, shaded}, {printed[0], printed[1]}};
}

TEST(TickFuzz, keeps_the_promises_of_tracker_and_guard_wherever_the_hand_is) {
  const std::uint64_t ticks = std::getenv("GLISS_LONG_TESTS") ? 100'000'000 : 400'000;
  const std::vector<std::vector<SceneObject>> all = scenes();
  const Vec3 hips[2] = {Vec3::Zero(), Vec3(0.004, -0.001, 0.002)};
  std::vector<Tracker> trackers;
  for (const auto& objects : all) trackers.emplace_back(objects, hips);
  const GuardLimits limits{.max_force = 3, .max_rate = 400};
  Guard guard(limits);
  test::GuardJudge judge(limits);
  test::GuardFuzz clock(7);
  HandFuzz hand(11);
  std::array<std::uint64_t, 5> seen{};
  std::uint64_t violations = 0, touching = 0, unusable = 0, allocated = 0;
  int iterations = 0, crossings = 0;
  // The solver as printed, the last, costs a hundred times the others.
  const auto tracker_of = [&](std::uint64_t turn) {
    return turn % 64 == 63 ? trackers.size() - 1 : turn % (trackers.size() - 1);
  };
  const auto violated = [&](std::uint64_t tick, const char* what, const Vec3& at) {
    if (++violations <= 5)
      ADD_FAILURE() << "tick " << tick << ", " << what << ": " << at.transpose();
  };
  for (std::uint64_t i = 1; i <= ticks; ++i) {
    Tracker& tracker = trackers[tracker_of(i / 2'000)];
    clock.next();
    const Vec3 at = hand.next();
    const std::uint64_t before = test::allocations();
    // Of the device's velocity some are a fault.
    clock.force = tracker.step(at, clock.now, i % 5 == 0 ? Vec3(1e3 * at) : Vec3(0.1 * at));
    if (clock.trip != GuardReason::kNone) guard.trip(clock.trip);
    const GuardOutput out = guard.step(clock.now, {clock.force, clock.measured});
    allocated += test::allocations() - before;
    ++seen[static_cast<std::size_t>(out.state)];
    if (!judge.sound(clock, out)) violated(i, guard_state_name(out.state), at);
    // Beyond, squares overflow, and the guards have what is not finite.
    if ((at.array().abs() <= 1e100).all() && !clock.force.allFinite()) violated(i, "no force", at);
    if (!at.allFinite() && !clock.force.array().isNaN().all()) violated(i, "a free hand", at);
    unusable += !at.allFinite();
    touching += tracker.touching();
    for (const ObjectStep& step : tracker.objects()) {
      iterations = std::max(iterations, step.contact.iterations);
      crossings = std::max(crossings, step.contact.crossings);
    }
    if (i % 8 == 0 && guard.engage()) judge.engaged();
    if (i % 2'000 == 0) {  // a new start
      guard = Guard(limits);
      judge = test::GuardJudge(limits);
    }
  }
  EXPECT_EQ(violations, 0u);
  EXPECT_EQ(allocated, 0u);
  EXPECT_LE(iterations, ContactTracker::kTickEvaluations);
  EXPECT_GT(iterations, ContactTracker::kTickEvaluations / 2);
  EXPECT_LE(crossings, 64);
  EXPECT_GT(touching, ticks / 20);
  EXPECT_GT(unusable, ticks / 4000);
  for (std::size_t i = 0; i < seen.size(); ++i)
    EXPECT_GE(seen[i], ticks / 1000) << guard_state_name(static_cast<GuardState>(i));
  test::record("fuzz", "{} ticks, {} in contact, at most {} iterations and {} crossings", ticks,
               touching, iterations, crossings);
}

}  // namespace
}  // namespace gliss
