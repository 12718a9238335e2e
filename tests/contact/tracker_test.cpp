// One HIP among the objects of a scene.
#include "gliss/contact/tracker.h"

#include <cstring>

#include "gliss/device/replay_device.h"
#include "gliss/engine/engine.h"
#include "gliss/generate/generate.h"
#include "gliss/loop/loop.h"
#include "gliss/query/tick_time.h"
#include "gliss/query/trace.h"
#include "tests/support/allocations.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using namespace std::chrono_literals;
using oracle::Rng, oracle::uniform;

std::shared_ptr<const PatchCache> ball(Precision precision = Precision::kDouble) {
  return std::make_shared<PatchCache>(test::cache_of(goldberg().mesh, precision));
}

// A hand that wanders about and through balls of 10 mm, 0 to 2 mm a tick.
std::vector<Vec3> wandering(std::size_t ticks, double reach) {
  Rng rng(3);
  std::vector<Vec3> path{Vec3(0, 0, 0.02)};
  Vec3 aim = path[0];
  while (path.size() < ticks) {
    if ((aim - path.back()).norm() < 0.002)
      aim = reach * Vec3(uniform(rng, -1, 1), uniform(rng, -1, 1), uniform(rng, -1, 1));
    path.push_back(path.back() + uniform(rng, 0, 0.002) * (aim - path.back()).normalized());
  }
  return path;
}

TEST(Tracker, gives_the_forces_of_a_contact_tracker) {
  for (const Precision precision : {Precision::kFloat, Precision::kDouble}) {
    const auto cache = ball(precision);
    const SceneObject object{.cache = cache, .stiffness = 700};
    Tracker tracker({&object, 1});
    ContactTracker contact(*cache, {});
    std::size_t touching = 0, searched = 0;
    const std::vector<Vec3> path = wandering(5000, 0.03);
    for (const Vec3& hip : path) {
      const Vec3 got = tracker.step(hip),
                 want = contact_force(*cache, contact.tick(hip / cache->unit), 700);
      ASSERT_EQ(std::memcmp(&got, &want, sizeof got), 0) << got << "\n" << want;
      touching += tracker.touching();
      searched += tracker.objects()[0].searched;
    }
    EXPECT_GT(touching, path.size() / 20);
    // Most ticks in the open are too far away to matter.
    EXPECT_LT(searched, touching + (path.size() - touching) / 2);
    test::record("searches", "{} of {} ticks, {} in contact", searched, path.size(), touching);
  }
}

TEST(Tracker, turns_forces_with_the_object) {
  SceneObject object{.cache = ball()};
  Tracker still({&object, 1});
  object.pose =
      Eigen::Translation3d(0.1, -0.2, 0.3) * Eigen::AngleAxisd(1.1, Vec3(1, 2, -1).normalized());
  Tracker moved({&object, 1});
  for (const Vec3& hip : wandering(2000, 0.02)) {
    const Vec3 want = object.pose.linear() * still.step(hip);
    EXPECT_LT((moved.step(object.pose * hip) - want).norm(), 1e-7);
  }
}

TEST(Tracker, adds_the_forces_of_objects_that_touch) {
  const auto cache = ball();
  SceneObject objects[2] = {{.cache = cache}, {.cache = cache, .stiffness = 300}};
  objects[1].pose = Eigen::Translation3d(0.015, 0, 0) * Eigen::Isometry3d::Identity();
  Tracker both(objects), first({&objects[0], 1}), second({&objects[1], 1});
  std::size_t together = 0;
  for (const Vec3& hip : wandering(5000, 0.02)) {
    const Vec3 a = first.step(hip), b = second.step(hip);
    EXPECT_EQ(both.step(hip), a + b);
    together += a.norm() > 0 && b.norm() > 0;
  }
  EXPECT_GT(together, 50u);
}

// A type that keeps a reference takes nothing that dies at once.
static_assert(std::is_constructible_v<ContactTracker, const PatchCache&, QueryOptions>);
static_assert(!std::is_constructible_v<ContactTracker, PatchCache, QueryOptions>);
static_assert(!std::is_constructible_v<ContactTracker, const PatchCache, QueryOptions>);
static_assert(std::is_constructible_v<HapticLoop, HapticDevice&, Tracker&>);
static_assert(!std::is_constructible_v<HapticLoop, HapticDevice&, Tracker>);
static_assert(!std::is_constructible_v<HapticLoop, ReplayDevice, Tracker&>);
template <class Cache>
concept Residing = requires(const Engine& engine, Cache&& cache) {
  engine.reside(std::forward<Cache>(cache));
};
static_assert(Residing<const PatchCache&> && !Residing<PatchCache>);

TEST(Tracker, feels_nothing_of_an_empty_scene) {
  Tracker tracker({});
  EXPECT_EQ(tracker.step(Vec3(1, 2, 3)), Vec3::Zero());
  EXPECT_FALSE(tracker.touching());
}

// The message for three objects whose second one is this.
std::string refusal(SceneObject object) {
  const std::vector<SceneObject> objects{{.cache = ball()}, std::move(object), {.cache = ball()}};
  try {
    Tracker tracker(objects);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "none";
}

TEST(Tracker, refuses_an_object_without_a_surface_and_names_it) {
  EXPECT_EQ(refusal({}),
            "SceneObject 1 has no surface: set its cache, or lazy to build patches near the HIP");
  EXPECT_EQ(refusal({.cache = std::make_shared<const PatchCache>()}),
            "SceneObject 1 has a cache without patches");
  SceneObject lazy;
  lazy.method = Method::kShaded;
  lazy.lazy = std::make_shared<const LazyMesh>(goldberg().mesh);
  EXPECT_EQ(refusal(lazy), "SceneObject 1 is lazy, which is for the method gregory alone");
  lazy.method = Method::kGregory;
  EXPECT_EQ(refusal(lazy), "none");
  EXPECT_EQ(refusal({.cache = ball()}), "none");
  const SceneObject alone{};
  EXPECT_THROW(Tracker({&alone, 1}), std::invalid_argument);
}

TEST(Tracker, refuses_friction_that_is_none_and_names_it) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto told = [&](const FrictionOptions& friction) {
    const std::string refused = refusal({.cache = ball(), .friction = friction});
    QueryOptions query;
    query.friction = friction;
    if (refused == "none") {
      EXPECT_NO_THROW(ContactTracker(*ball(), query));
    } else {
      EXPECT_THROW(ContactTracker(*ball(), query), std::invalid_argument);
    }
    return refused;
  };
  const std::string at_rest = "SceneObject 1 has a static friction that is not from 0 to 5",
                    slipping = "SceneObject 1 has a dynamic friction that is not from 0 to 5";
  EXPECT_EQ(told({-0.1, 0}), at_rest);
  EXPECT_EQ(told({nan, 0}), at_rest);
  EXPECT_EQ(told({1e300, 0}), at_rest);
  EXPECT_EQ(told({0.5, -0.1}), slipping);
  EXPECT_EQ(told({0.5, nan}), slipping);
  EXPECT_EQ(told({0.3, 0.4}), "SceneObject 1 has a dynamic friction above the static one");
  EXPECT_EQ(told({0.3, 0.3, -1}),
            "SceneObject 1 has a settle of its friction that is not from 0 to 1 s");
  EXPECT_EQ(told({0.3, 0.3, 1 / 0.0}),
            "SceneObject 1 has a settle of its friction that is not from 0 to 1 s");
  EXPECT_EQ(told({0.3, 0, 2e-3}), "none");
  EXPECT_EQ(told({5, 5}), "none");
}

TEST(Tracker, rubs_as_a_contact_tracker_does_and_allocates_nothing) {
  const auto cache = ball();
  const FrictionOptions friction{0.5, 0.3, 2e-3};
  const SceneObject object{.cache = cache, .friction = friction};
  Tracker tracker({&object, 1});
  QueryOptions query;
  query.friction = friction;
  ContactTracker contact(*cache, query);
  std::size_t slips = 0, sticks = 0;
  std::uint64_t allocations = 0;
  for (const Vec3& hip : wandering(5000, 0.012)) {
    const std::uint64_t before = test::allocations();
    const Vec3 got = tracker.step(hip);
    allocations += test::allocations() - before;
    const Contact felt = contact.tick(hip / cache->unit);
    const Vec3 want = contact_force(*cache, felt, 500);
    ASSERT_EQ(std::memcmp(&got, &want, sizeof got), 0) << got << "\n" << want;
    slips += is_slipping(felt.flags);
    sticks += felt.touching && !is_slipping(felt.flags);
  }
  EXPECT_EQ(allocations, 0u);
  EXPECT_GT(slips, 100u);
  EXPECT_GT(sticks, 10u);
}

TEST(Tracker, refuses_effects_that_are_none_and_names_them) {
  EXPECT_EQ(refusal({.cache = ball(), .effects = {.damping = -1}}),
            "SceneObject 1 has a damping that is not from 0 to 20 s/m");
  SceneObject lazy;
  lazy.effects.magnet = {1, 1e-3};
  lazy.lazy = std::make_shared<const LazyMesh>(goldberg().mesh);
  EXPECT_EQ(refusal(lazy), "SceneObject 1 is lazy and has a magnet, which needs a cache");
}

TEST(Tracker, has_the_effects_of_a_trace_and_allocates_nothing) {
  const auto cache = ball();
  TraceOptions options;
  options.methods = {Method::kGregory};
  options.friction = {0.5, 0.3};
  options.effects = {
      .damping = 2, .viscosity = 1, .magnet = {0.3, 2e-3}, .texture = {Relief::kNoise, 5e-5, 2e-3}};
  const SceneObject object{
      .cache = cache, .friction = options.friction, .effects = options.effects};
  Tracker tracker({&object, 1});
  const std::vector<Vec3> path = wandering(5000, 0.012);
  std::vector<Vec3> hips;
  for (const Vec3& hip : path) hips.push_back(hip / cache->unit);
  std::uint64_t allocations = 0;
  std::size_t pulls = 0, pushes = 0;
  trace(*cache, hips, options, [&](std::size_t tick, std::span<const TraceStep> steps) {
    const std::uint64_t before = test::allocations();
    const Vec3 got = tracker.step(path[tick]);
    allocations += test::allocations() - before;
    EXPECT_EQ(got, steps[0].force) << tick;
    pulls += !steps[0].contact.touching && !got.isZero(0);
    pushes += steps[0].contact.touching;
  });
  EXPECT_EQ(allocations, 0u);
  EXPECT_GT(pulls, 100u);
  EXPECT_GT(pushes, 100u);
}

TEST(Tracker, goes_on_with_the_method_that_it_is_given) {
  const auto cache = ball();
  SceneObject object{.cache = cache, .method = Method::kFlat};
  Tracker changed({&object, 1});
  object.method = Method::kGregory;
  object.settle = 0.01;
  Tracker same({&object, 1});
  for (double z = 0.012; z > 0.009; z -= 1e-5) changed.step(Vec3(0, 0, z));
  ASSERT_TRUE(changed.touching());
  EXPECT_TRUE(changed.set_contact(0, Method::kGregory, 0.01));
  for (int i = 0; i < 100; ++i) {
    const Vec3 hip(1e-5 * i, 0, 0.009);
    EXPECT_EQ(changed.step(hip), same.step(hip)) << "as from a first step on";
    EXPECT_TRUE(changed.touching());
  }
  EXPECT_FALSE(changed.set_contact(0, Method::kFlat, -1));
  EXPECT_EQ(changed.step(Vec3(0, 0, 0.009)), same.step(Vec3(0, 0, 0.009)));
  SceneObject lazy;
  lazy.lazy = std::make_shared<const LazyMesh>(goldberg().mesh);
  EXPECT_FALSE(Tracker({&lazy, 1}).set_contact(0, Method::kFlat, 0)) << "it has no cache";
}

TEST(Tracker, goes_on_with_the_texture_that_it_is_given) {
  const auto cache = ball();
  const TextureOptions grating{Relief::kGrating, 5e-5, 2e-3};
  SceneObject object{.cache = cache};
  Tracker changed({&object, 1});
  object.effects.texture = grating;
  Tracker same({&object, 1});
  const auto slide = [&](auto compare) {
    for (int i = 0; i < 100; ++i) {
      const Vec3 hip(3e-5 * i, 0, 0.009);
      compare(changed.step(hip), same.step(hip));
    }
  };
  int differ = 0;
  slide([&](const Vec3& one, const Vec3& other) { differ += one != other; });
  EXPECT_GT(differ, 50);
  EXPECT_TRUE(changed.set_texture(0, grating));
  slide([](const Vec3& one, const Vec3& other) { EXPECT_EQ(one, other); });
  EXPECT_FALSE(changed.set_texture(0, {Relief::kGrating, 1, 1e-3})) << "it is too steep";
  slide([](const Vec3& one, const Vec3& other) { EXPECT_EQ(one, other); });
  EXPECT_TRUE(changed.set_texture(0, {}));
  EXPECT_TRUE(same.set_texture(0, {}));
  slide([](const Vec3& one, const Vec3& other) { EXPECT_EQ(one, other); });
}

TEST(Tracker, goes_on_with_the_material_that_it_is_given) {
  const auto cache = ball();
  SceneObject object{.cache = cache, .friction = {0.5, 0.3}};
  object.effects.damping = 1;
  Tracker changed({&object, 1});
  object.stiffness = 800;
  Tracker same({&object, 1});  // but for its stiffness as before
  std::size_t touching = 0;
  for (const Vec3& hip : wandering(5000, 0.012)) {
    const Vec3 felt = changed.step(hip);
    EXPECT_LT((1.6 * felt - same.step(hip)).norm(), 1e-12);
    touching += same.touching();
  }
  EXPECT_GT(touching, 500u);
  EXPECT_TRUE(changed.set_material(0, 800, object.friction));
  for (const Vec3& hip : wandering(500, 0.012)) EXPECT_EQ(changed.step(hip), same.step(hip));

  EXPECT_FALSE(changed.set_material(0, std::numeric_limits<double>::infinity(), {}));
  EXPECT_FALSE(changed.set_material(0, 500, {0.1, 0.2}));
  for (const Vec3& hip : wandering(500, 0.012)) EXPECT_EQ(changed.step(hip), same.step(hip));

  // An object whose patches are built near the hand has materials too.
  SceneObject lazy;
  lazy.lazy = std::make_shared<const LazyMesh>(goldberg().mesh);
  lazy.method = Method::kGregory;
  Tracker built_later({&lazy, 1});
  EXPECT_TRUE(built_later.set_material(0, 250, {0.5, 0.3}));
  const auto press = [](Tracker& tracker) {
    Vec3 force;
    for (double z = 0.012; z > 0.008; z -= 1e-5) force = tracker.step(Vec3(0, 0, z));
    return force;
  };
  EXPECT_NEAR(press(built_later).norm(), 250 * 0.002, 0.1);
  built_later.step(Vec3(0, 2e-4, 0.008));
  EXPECT_NEAR(built_later.step(Vec3(0, 2e-4, 0.008)).y(), -250 * 2e-4, 0.02);
}

// A ball of 10 mm that a hand presses by 2 mm and strokes, m.
Vec3 stroking(double s) {
  return Vec3(0.003 * std::sin(9 * s), 0, std::max(0.008, 0.0105 - 0.05 * s));
}

TEST(Tracker, feels_by_the_time_of_its_steps) {
  const auto cache = ball();
  SceneObject object{.cache = cache, .friction = {0.5, 0.3, 0.02}};
  object.effects = {.damping = 2, .viscosity = 3};
  for (const int period : {250, 1000, 2000}) {  // us
    for (const bool has_gaps : {false, true}) {
      Tracker tracker({&object, 1});
      QueryOptions query;
      query.friction = object.friction;
      ContactTracker contact(*cache, query);
      Effects effects(object.effects, object.stiffness, cache->unit);
      Nanoseconds last{};
      double felt = 0;
      for (int i = 0; i < 1000; ++i) {
        if (has_gaps && i % 58 >= 50) continue;
        const Nanoseconds time = 7s + std::chrono::microseconds(i * period);
        const Vec3 own(i % 2 == 0 ? 0.01 : 0.012, 0, 0), at = stroking(1e-6 * i * period);
        const Vec3 got = tracker.step(at, time, own), hip = at / cache->unit;
        const double dt = i == 0 ? ContactTracker::kTick : tick_time(last, time);
        last = time;
        effects.see(hip, dt, own);
        const Vec3 want = effects.force(contact.tick(hip, dt), contact);
        ASSERT_LE((got - want).norm(), 1e-12) << period << " us, " << i;
        felt = std::max(felt, got.norm());
      }
      EXPECT_GT(felt, 0.5);
    }
  }
}

TEST(Tracker, counts_a_step_without_a_time_as_a_millisecond) {
  SceneObject object{.cache = ball(), .friction = {0.5, 0.3, 3e-3}};
  object.effects = {.damping = 2};
  Tracker without({&object, 1}), with({&object, 1}), stands({&object, 1}), back({&object, 1});
  for (int i = 0; i < 300; ++i) {
    const Vec3 hip = stroking(1e-3 * i), want = with.step(hip, i * 1ms);
    EXPECT_EQ(without.step(hip), want);
    EXPECT_EQ(stands.step(hip, Nanoseconds::max()), want);
    EXPECT_EQ(back.step(hip, -i * 1h), want);
  }
  EXPECT_TRUE(with.touching());
  // Also where times would overflow.
  EXPECT_TRUE(stands.step(stroking(0.3)).allFinite());
  EXPECT_TRUE(back.step(stroking(0.3), Nanoseconds::min()).allFinite());
  EXPECT_TRUE(back.step(stroking(0.3), Nanoseconds::max()).allFinite());
}

TEST(Tracker, tells_of_a_position_that_is_not_finite_and_keeps_the_contact) {
  SceneObject object{.cache = ball(), .friction = {0.5, 0.3}};
  object.effects = {.viscosity = 2};
  Tracker tracker({&object, 1}), whole({&object, 1});
  Guard guard;
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  const Vec3 bad[] = {{nan, 0, 0.008}, {0, inf, 0.008}, {0, 0, -inf}};
  double sent = 0, lost = 0;
  for (int i = 1; i < 2000; ++i) {
    const Nanoseconds now = i * 1ms;
    const Vec3 hip = stroking(1e-3 * std::min(i, 1000));
    const bool is_lost = i > 1000 && i % 50 == 0;
    const Vec3 want = whole.step(hip, now);
    const Vec3 force = tracker.step(is_lost ? bad[i / 50 % 3] : hip, now);
    const GuardOutput out = guard.step(now, {force, now});
    if (is_lost) {
      EXPECT_TRUE(force.array().isNaN().all());
      EXPECT_EQ(out.state, GuardState::kHold);
      EXPECT_NEAR(out.force.norm(), sent, 1e-9);
      EXPECT_TRUE(tracker.touching());
      ++lost;
    } else {
      EXPECT_LT((force - want).norm(), 1e-9) << i;
    }
    sent = out.force.norm();
  }
  EXPECT_GT(sent, 0.9);
  EXPECT_EQ(lost, 19);
  Pose tool = Pose::Identity();
  tool.linear()(1, 1) = nan;
  const Wrench wrench = tracker.step(tool);
  EXPECT_TRUE(wrench.force.array().isNaN().all() && wrench.torque.array().isNaN().all());
}

TEST(Tracker, refuses_a_spring_that_pulls_and_times_that_are_ticks) {
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  for (const double bad : {-1e-9, -500.0, 1.1e6, 1e300, nan, inf}) {
    EXPECT_EQ(refusal({.cache = ball(), .stiffness = bad}),
              "SceneObject 1 has a stiffness that is not from 0 to 1e6 N/m");
  }
  for (const double bad : {-1e-9, 5.0, nan, inf}) {
    EXPECT_EQ(refusal({.cache = ball(), .settle = bad}),
              "SceneObject 1 has a settle that is not from 0 to 1 s");
    EXPECT_EQ(refusal({.cache = ball(), .friction = {0.5, 0.3, bad}}),
              "SceneObject 1 has a settle of its friction that is not from 0 to 1 s");
  }
  EXPECT_EQ(
      refusal({.cache = ball(), .effects = {.magnet = {1e9, 1e-3}}}),
      "SceneObject 1 has a magnet whose stiffness, 3.08 force / range, is not from 0 to 1e6 N/m");
  EXPECT_EQ(refusal({.cache = ball(), .stiffness = 0, .settle = 1}), "none");
  const SceneObject object{.cache = ball()};
  Tracker tracker({&object, 1});
  for (const double bad : {-1e-9, 1.1e6, nan, inf}) EXPECT_FALSE(tracker.set_material(0, bad, {}));
  EXPECT_TRUE(tracker.set_material(0, 0, {}));
}

}  // namespace
}  // namespace gliss
