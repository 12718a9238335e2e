// Laws in seconds hold at any rate, and where ticks are left out.
#include "gliss/query/tick_time.h"

#include <cmath>

#include "gliss/generate/generate.h"
#include "gliss/query/effects.h"
#include "gliss/query/trace.h"
#include "tests/support/open_meshes.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

constexpr double kSpring = 500;  // N/m

// Times of ticks, ns: so many a second, and perhaps 8 of them left out after each 50.
std::vector<std::int64_t> ticks_at(int rate, bool has_gaps, double seconds) {
  std::vector<std::int64_t> times;
  for (std::int64_t i = 0; static_cast<double>(i) < rate * seconds; ++i)
    if (!has_gaps || i % 58 < 50) times.push_back(i * 1'000'000'000 / rate);
  return times;
}

struct Clockwork {
  int rate;
  bool has_gaps;
  std::string name() const { return fmt::format("{} Hz{}", rate, has_gaps ? " with gaps" : ""); }
};
constexpr Clockwork kClocks[] = {{1000, false},    {500, false}, {3000, false}, {4000, false},
                                 {100'000, false}, {1000, true}, {4000, true},  {500, true}};

// A HIP on a mesh, at times, with all that it is told.
class Timed {
 public:
  Timed(const Mesh& mesh, const EffectOptions& effects, const QueryOptions& query = {})
      : cache_(test::cache_of(mesh)), tracker_(cache_, query), effects_(effects, kSpring, 1e-3) {}

  // N. `own`: m/s
  Vec3 tick(std::int64_t time, const Vec3& hip, const Vec3& own = Vec3::Zero()) {
    const double dt = tick_time(std::chrono::nanoseconds(last_), std::chrono::nanoseconds(time));
    last_ = time;
    effects_.see(hip, dt, own);
    contact_ = tracker_.tick(hip, dt);
    return effects_.force(contact_, tracker_);
  }
  const Contact& contact() const { return contact_; }
  Vec3 velocity() const { return effects_.velocity(); }

 private:
  PatchCache cache_;
  ContactTracker tracker_;
  Effects effects_;
  Contact contact_;
  std::int64_t last_ = 0;
};

TEST(TickTime, resists_by_viscosity_and_damping_alike_at_any_rate) {
  constexpr double kViscosity = 5, kDamping = 4;
  for (const Clockwork& clock : kClocks) {
    Timed viscous(test::sheet(), {.viscosity = kViscosity}),
        damped(test::sheet(), {.damping = kDamping});
    const Vec3 v(0.05, -0.02, -0.01);  // m/s
    test::Worst of_viscosity, of_damping;
    for (const std::int64_t time : ticks_at(clock.rate, clock.has_gaps, 0.15)) {
      const Vec3 hip = Vec3(-4, 0, 0.5) + 1e3 * v * (1e-9 * static_cast<double>(time));
      const Vec3 resists = viscous.tick(time, hip), pushes = damped.tick(time, hip);
      const double spring = kSpring * 1e-3 * -hip.z();
      if (hip.z() > -0.11) continue;
      of_viscosity.add((resists - spring * Vec3::UnitZ() + kViscosity * v).norm() /
                       (kViscosity * v.norm()));
      of_damping.add(std::abs((pushes.z() - spring) / (spring * kDamping * -v.z()) - 1));
    }
    test::record(clock.name(), "viscosity off by {:.2g}, damping by {:.2g}", of_viscosity.value,
                 of_damping.value);
    EXPECT_LE(of_viscosity.value, 0.01) << clock.name();
    EXPECT_LE(of_damping.value, 0.01) << clock.name();
    EXPECT_GT(of_damping.value, 0) << clock.name();
  }
}

// The time over which friction goes from the one coefficient to the other.
TEST(TickTime, narrows_the_cone_of_friction_alike_at_any_rate) {
  constexpr double kTau = 0.02;
  QueryOptions query;
  query.friction = {0.5, 0.3, kTau};
  for (const Clockwork& clock : kClocks) {
    Timed sheet(test::sheet(), {}, query);
    sheet.tick(0, {-3, 0, 1});
    double slipped = 0;
    std::int64_t last = 0;
    std::size_t slips = 0;
    for (const std::int64_t time : ticks_at(clock.rate, clock.has_gaps, 0.15)) {
      const double x = 50e-9 * static_cast<double>(time);  // mm, at 50 mm/s
      const Vec3 force = sheet.tick(time, {-3 + x, 0, -1});
      const bool slip = is_slipping(sheet.contact().flags);
      if (slip) slipped += 1e-9 * static_cast<double>(time - last);
      slips += slip;
      last = time;
      if (!slip) continue;
      const double want = 0.3 + 0.2 * std::exp(-slipped / kTau);
      EXPECT_NEAR(-force.x() / force.z(), want, 0.01 * 0.2) << clock.name() << ", " << slipped;
    }
    EXPECT_GT(slips, 30u) << clock.name();
    EXPECT_GT(slipped, 5 * kTau) << clock.name();
  }
}

// Seconds in which the force of a hand that slides off over an edge goes from 90 to 10 %.
double fading_time(const Clockwork& clock) {
  QueryOptions query;
  query.settle = 0.05;
  const Mesh mesh = cube(4, 20).mesh;
  const Vec3 corner = test::cache_of(mesh).bounds().high;
  Timed hand(mesh, {}, query);
  hand.tick(0, corner + Vec3(-3, -9, 3));
  double most = 0, last_force = 0, last_time = 0, began = 0;
  for (const std::int64_t time : ticks_at(clock.rate, clock.has_gaps, 0.8)) {
    const double s = 1e-9 * static_cast<double>(time);
    const double force =
        hand.tick(time, corner + Vec3(2 * s - 0.3, -9, -0.5 * std::min(1.0, 20 * s))).norm();
    most = std::max(most, force);
    const auto falls_below = [&](double share) {
      return force < share * most && last_force >= share * most;
    };
    const auto when = [&](double share) {
      return last_time + (s - last_time) * (last_force - share * most) / (last_force - force);
    };
    if (falls_below(0.9)) began = when(0.9);
    if (falls_below(0.1)) return when(0.1) - began;
    last_force = force;
    last_time = s;
  }
  return 0;
}

TEST(TickTime, settles_alike_at_any_rate) {
  const double finest = fading_time({4000, false});
  EXPECT_GT(finest, 0.05);
  EXPECT_LT(finest, 0.25);
  for (const Clockwork& clock : kClocks) {
    const double found = fading_time(clock);
    test::record(clock.name(), "{:.6g} s", found);
    EXPECT_NEAR(found / finest, 1, 0.01) << clock.name();
  }
}

TEST(TickTime, measures_a_velocity_over_the_last_8_ms) {
  EffectOptions options{.viscosity = 1};
  for (const Clockwork& clock : kClocks) {
    Effects effects(options, kSpring, 1e-3);
    std::int64_t last = 0;
    const double a = 2;  // m/s^2
    for (const std::int64_t time : ticks_at(clock.rate, clock.has_gaps, 0.1)) {
      const double dt = tick_time(std::chrono::nanoseconds(last), std::chrono::nanoseconds(time));
      last = time;
      const double s = 1e-9 * static_cast<double>(time);
      effects.see(Vec3(1e3 * a * s * s / 2, 0, 0), dt);
      // A mean over so long is half as old.
      const double longest = std::max(8e-3, clock.has_gaps ? 9.0 / clock.rate : 0);
      if (s < 0.03) continue;
      EXPECT_LE(effects.velocity().x(), a * s);
      EXPECT_GE(effects.velocity().x(), a * (s - longest / 2) - 1e-9) << clock.name() << " " << s;
    }
  }
}

// It is no older than the tick, and what an object does is taken off.
TEST(TickTime, takes_a_devices_own_velocity_as_it_is_now) {
  EffectOptions options{.viscosity = 1};
  for (const Clockwork& clock : kClocks) {
    Effects effects(options, kSpring, 1e-3);
    std::int64_t last = 0;
    const double a = 2, drift = 0.03;  // m/s^2; m/s, of the object
    for (const std::int64_t time : ticks_at(clock.rate, clock.has_gaps, 0.1)) {
      const double dt = tick_time(std::chrono::nanoseconds(last), std::chrono::nanoseconds(time));
      last = time;
      const double s = 1e-9 * static_cast<double>(time);
      effects.see(Vec3(1e3 * a * s * s / 2, -1e3 * drift * s, 0), dt, Vec3(a * s, 0, 0));
      if (s < 0.02) continue;
      EXPECT_LT((effects.velocity() - Vec3(a * s, -drift, 0)).norm(), 1e-9) << clock.name();
    }
  }
  // What no hand does is a fault of the device, and the last velocity stands.
  Effects effects(options, kSpring, 1);
  for (int i = 0; i < 20; ++i) effects.see(Vec3(1e-5 * i, 0, 0), 1e-3, Vec3(0.01, 0, 0));
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  int i = 20;
  for (const double bad : {nan, inf, 1e300, -101.0}) {
    effects.see(Vec3(1e-5 * i++, 0, 0), 1e-3, Vec3(bad, 0, 0));
    EXPECT_NEAR(effects.velocity().x(), 0.01, 1e-12) << bad;
  }
}

TEST(TickTime, takes_one_that_is_invalid_for_a_millisecond) {
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  QueryOptions query;
  query.friction = {0.5, 0.3, 3e-3};
  const PatchCache cache = test::cache_of(goldberg().mesh);
  const auto path = [](int i) { return Vec3(0.03 * i - 2, 0, 10.3 - 0.01 * i); };
  for (const double bad : {0.0, -1.0, nan, inf, -inf, 1e300}) {
    ContactTracker right(cache, query), wrong(cache, query);
    const EffectOptions options{.damping = 2};
    Effects right_effects(options, kSpring, 1e-3), wrong_effects(options, kSpring, 1e-3);
    for (int i = 0; i < 200; ++i) {
      right_effects.see(path(i));
      wrong_effects.see(path(i), bad);
      const Contact a = right.tick(path(i)), b = wrong.tick(path(i), bad);
      EXPECT_EQ(a.push, b.push) << bad;
      EXPECT_EQ(right_effects.force(a, right), wrong_effects.force(b, wrong)) << bad;
    }
  }
}

TEST(TickTime, means_nothing_at_the_first_tick_and_bears_any_stall) {
  QueryOptions query;
  query.friction = {0.5, 0.3, 3e-3};
  const PatchCache cache = test::cache_of(goldberg().mesh);
  const EffectOptions options{.damping = 20, .viscosity = 20};
  Vec3 first;
  for (const double dt : {1e-3, 1e-9, 1.0, 1e9, 0.0}) {
    ContactTracker tracker(cache, query);
    Effects effects(options, kSpring, 1e-3);
    const Vec3 deep(0.5, 0, 8);
    effects.see(deep, dt);
    const Contact contact = tracker.tick(deep, dt);
    const Vec3 force = effects.force(contact, tracker);
    if (dt == 1e-3) first = force;
    EXPECT_EQ(force, first) << dt;
    const Vec3 beside(0.6, 0, 8);
    effects.see(beside, dt);
    const Contact next = tracker.tick(beside, dt);
    EXPECT_LT(next.push.norm(), 3) << dt;
    if (dt >= 1 || dt == 0) {
      EXPECT_LT(effects.force(next, tracker).norm(), 4) << dt;
    }
  }
  EXPECT_GT(first.norm(), 0.5);
}

// A list of times and velocities is felt as a loop feels them.
TEST(TickTime, of_a_trace_is_that_of_its_ticks) {
  const PatchCache cache = test::cache_of(goldberg().mesh);
  std::vector<Vec3> hips, own;
  std::vector<std::chrono::nanoseconds> times;
  const std::vector<std::int64_t> ticks = ticks_at(2000, true, 0.2);
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    const double s = 1e-9 * static_cast<double>(ticks[i]);
    times.emplace_back(ticks[i]);
    hips.push_back(Vec3(20 * s - 2, 1, 10.3 - 5 * s));
    own.push_back(Vec3(0.02, 0, -0.005 - 0.001 * std::sin(100 * s)));
    if (i % 50 == 30) hips.back().y() = std::nan("");
  }
  TraceOptions options;
  options.methods = {Method::kGregory};
  options.friction = {0.5, 0.3, 3e-3};
  options.effects = {.damping = 3, .viscosity = 2};
  options.times = times;
  options.velocities = own;
  QueryOptions query;
  query.friction = options.friction;
  Timed hand(goldberg().mesh, options.effects, query);
  std::size_t touching = 0, lost = 0;
  const auto statistics =
      trace(cache, hips, options, [&](std::size_t i, std::span<const TraceStep> steps) {
        if (!hips[i].allFinite()) {
          EXPECT_TRUE(steps[0].force.hasNaN()) << i;
          ++lost;
          return;
        }
        EXPECT_EQ(hand.tick(ticks[i], hips[i], own[i]), steps[0].force) << i;
        touching += steps[0].contact.touching;
      });
  EXPECT_GT(touching, 100u);
  EXPECT_GT(lost, 4u);
  EXPECT_GE(statistics[0].unsound, lost);
  const auto refusal = [&](const TraceOptions& bad) {
    return test::message_of<std::invalid_argument>([&] { trace(cache, hips, bad); });
  };
  TraceOptions bad = options;
  bad.times = std::span(times).first(3);
  EXPECT_EQ(refusal(bad), "TraceOptions has times that are not as many as HIPs");
  bad = options;
  bad.velocities = std::span(own).first(3);
  EXPECT_EQ(refusal(bad), "TraceOptions has velocities that are not as many as HIPs");
  bad = options;
  bad.stiffness = -1;
  EXPECT_EQ(refusal(bad), "TraceOptions has a stiffness that is not 0 or more");
  bad = options;
  bad.settle = 5;  // a number of ticks
  EXPECT_EQ(refusal(bad), "QueryOptions has a settle that is not from 0 to 1 s");
}

}  // namespace
}  // namespace gliss
