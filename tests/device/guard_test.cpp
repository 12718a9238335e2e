// The guards over a fake clock: every transition at its boundary, every kind of bad input.
#include "gliss/device/guard.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <ostream>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "tests/support/numbers.h"

namespace gliss {

void PrintTo(GuardState state, std::ostream* out) { *out << guard_state_name(state); }
void PrintTo(GuardReason reason, std::ostream* out) { *out << guard_reason_name(reason); }

namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;
using enum GuardState;
using enum GuardReason;

using test::kNaN, test::kInfinity;

static_assert(noexcept(std::declval<Guard&>().step(std::declval<nanoseconds&>(),
                                                   std::declval<const GuardInput&>())));
static_assert(std::is_trivially_destructible_v<Guard>);  // owns nothing

Vec3 along_x(double force) { return {force, 0, 0}; }

// A guard and the clock that it is told.
struct Bench {
  explicit Bench(const GuardLimits& limits = {}) : guard(limits) {}

  GuardOutput step(nanoseconds dt, const Vec3& force, nanoseconds age = 0ns) {
    now += dt;
    return last = guard.step(now, {force, now - age});
  }
  // Steps of 1 ms with fresh inputs.
  GuardOutput steps(int count, const Vec3& force) {
    for (int i = 0; i < count; ++i) step(1ms, force);
    return last;
  }
  // Engaged, the engage ramp behind it, and `force` going out for a fresh input.
  static Bench running(const Vec3& force, const GuardLimits& limits = {}) {
    Bench bench(limits);
    bench.steps(700, Vec3::Zero());
    bench.steps(10, force);
    return bench;
  }
  static Bench safe() {
    Bench bench = running(along_x(2));
    bench.guard.trip(kStopRequested);
    bench.steps(12, along_x(2));
    return bench;
  }
  // Steps `ages` after an input that nothing follows.
  void starve(std::initializer_list<nanoseconds> ages) {
    const nanoseconds measured = now;
    for (const nanoseconds age : ages) {
      now = measured + age;
      last = guard.step(now, {along_x(3), measured});
    }
  }

  Guard guard;
  nanoseconds now = 1s;
  GuardOutput last;
};

void expect(const GuardOutput& got, double force, GuardState state, GuardReason reason) {
  EXPECT_NEAR(got.force.x(), force, 1e-12);
  EXPECT_EQ(got.force.y(), 0);
  EXPECT_EQ(got.force.z(), 0);
  EXPECT_EQ(got.state, state);
  EXPECT_EQ(got.reason, reason);
}

TEST(Guard, refuses_limits_that_are_no_limits) {
  struct Case {
    const char* named;
    void (*spoil)(GuardLimits&);
  };
  const Case cases[] = {
      {"max_force", [](GuardLimits& l) { l.max_force = kNaN; }},
      {"max_force", [](GuardLimits& l) { l.max_force = kInfinity; }},
      {"max_force", [](GuardLimits& l) { l.max_force = 0; }},
      {"max_rate", [](GuardLimits& l) { l.max_rate = kNaN; }},
      {"max_rate", [](GuardLimits& l) { l.max_rate = -1; }},
      {"max_rate", [](GuardLimits& l) { l.max_rate = 412; }},  // 3.3 N in 8 ms needs 412.5 N/s
      {"hold_after", [](GuardLimits& l) { l.hold_after = 0ns; }},
      {"ramp_from", [](GuardLimits& l) { l.ramp_from = l.hold_after - 1ns; }},
      {"ramp_to", [](GuardLimits& l) { l.ramp_to = l.ramp_from; }},
      {"ramp_to", [](GuardLimits& l) { l.ramp_to = 10ms + 1ns; }},
      {"engage_below", [](GuardLimits& l) { l.engage_below = kNaN; }},
      {"engage_below", [](GuardLimits& l) { l.engage_below = 0; }},
      {"engage_below", [](GuardLimits& l) { l.engage_below = 0.21; }},
      {"engage_ramp", [](GuardLimits& l) { l.engage_ramp = 499ms; }},
  };
  EXPECT_NO_THROW(Guard());
  for (const auto& [named, spoil] : cases) {
    GuardLimits limits;
    spoil(limits);
    EXPECT_THAT([&] { Guard guard(limits); },
                testing::ThrowsMessage<std::invalid_argument>(testing::StartsWith(named)));
  }
}

TEST(Limit, keeps_the_order_finite_force_change_finite) {
  const auto bare = [](const LimitedForce& limited) {
    return !limited.finite << 2 | limited.force_limited << 1 | int{limited.rate_limited};
  };
  struct Case {
    Vec3 wanted, from;
    double most, change;
    Vec3 force;
    int acted;
  };
  const double x = std::sqrt(1.0 / 3);
  const Case cases[] = {
      {{1, 0, 0}, {1, 0, 0}, 3, 1, {1, 0, 0}, 0},
      {{0, 3, 0}, {0, 2, 0}, 3, 1, {0, 3, 0}, 0},  // on both limits
      {{0, 0, 4}, {0, 0, 2.5}, 3, 1, {0, 0, 3}, 2},
      {{0, 0, 2}, {0, 0, 0}, 3, 1, {0, 0, 1}, 1},
      {{9, 0, 0}, {0, 0, 0}, 3, 1, {1, 0, 0}, 3},
      {{-9, 0, 0}, {3, 0, 0}, 3, 6, {-3, 0, 0}, 2},
      {{1e300, 1e300, 1e300}, {0, 0, 0}, 3, 9, {3 * x, 3 * x, 3 * x}, 2},
      {{5e-324, 0, 0}, {0, 0, 0}, 3, 1, {5e-324, 0, 0}, 0},
      {{1, 0, 0}, {0, 0, 0}, 0, 1, {0, 0, 0}, 2},
      {{1, 0, 0}, {2, 0, 0}, 3, 0, {2, 0, 0}, 1},
      {{kNaN, 0, 0}, {1, 0, 0}, 3, 1, {1, 0, 0}, 4},
      {{0, kInfinity, 0}, {1, 0, 0}, 3, 1, {1, 0, 0}, 4},
      {{0, 0, -kInfinity}, {1, 0, 0}, 3, 1, {1, 0, 0}, 4},
      // What no caller should send ends in zero, not in the device.
      {{1, 0, 0}, {kNaN, 0, 0}, 3, 1, {0, 0, 0}, 5},
      {{1, 0, 0}, {0, 0, 0}, kNaN, 1, {0, 0, 0}, 7},
      {{1, 0, 0}, {0, 0, 0}, 3, kNaN, {0, 0, 0}, 5},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(testing::Message() << c.wanted.transpose() << " from " << c.from.transpose()
                                    << ", " << c.most << ", " << c.change);
    const LimitedForce got = limit_force(c.wanted, c.from, c.most, c.change);
    EXPECT_LE((got.force - c.force).norm(), 1e-14);
    EXPECT_EQ(bare(got), c.acted);
    EXPECT_TRUE(!(got.force.norm() > c.most));  // most may be NaN
  }
}

TEST(Guard, lets_a_sound_force_through) {
  Bench bench = Bench::running(along_x(2));
  expect(bench.step(1ms, along_x(2.5)), 2.5, kRun, kNone);
  expect(bench.step(1ms, along_x(1.5)), 1.5, kRun, kNone);
  expect(bench.step(1ms, along_x(3.3)), 2.5, kRun, kRateLimit);
  expect(bench.step(1ms, along_x(3.3)), 3.3, kRun, kNone);
  expect(bench.step(1ms, along_x(1e300)), 3.3, kRun, kForceLimit);
  expect(bench.step(1ms, along_x(-1e300)), 2.3, kRun, kForceLimit);
  expect(bench.step(500us, along_x(0)), 1.8, kRun, kRateLimit);
  expect(bench.step(0ns, along_x(0)), 1.8, kRun, kRateLimit);
}

// Ages of the last input at which steps are made, and what the last of them does with 2 N.
TEST(Guard, holds_fades_and_latches_when_inputs_stop) {
  struct Case {
    std::initializer_list<nanoseconds> ages;
    double force;
    GuardState state;
    GuardReason reason;
  };
  // The wanted force is 3 N all the while: it must show in kRun only.
  const Case cases[] = {
      {{1ms}, 3, kRun, kNone},
      {{2ms}, 3, kRun, kNone},
      {{2ms + 1ns}, 2 * (8e6 - 1) / 8e6, kHold, kLateInput},
      {{3ms}, 1.75, kHold, kLateInput},
      {{9ms}, 0.25, kHold, kLateInput},
      {{10ms - 1ns}, 2 / 8e6, kHold, kLateInput},
      {{10ms}, 0, kSafe, kLateInput},
      {{1h}, 0, kSafe, kLateInput},
      {{2ms + 1ns, 2ms + 2ns}, 2 * (8e6 - 2) / 8e6, kRamp, kLateInput},
      {{3ms, 4ms}, 1.5, kRamp, kLateInput},
      {{3ms, 4ms, 6ms}, 1, kRamp, kLateInput},
      {{3ms, 9ms}, 0.25, kRamp, kLateInput},
      {{3ms, 10ms - 1ns}, 2 / 8e6, kRamp, kLateInput},
      {{3ms, 10ms}, 0, kSafe, kLateInput},
      {{3ms, 4ms, 5ms, 6ms, 7ms, 8ms, 9ms, 10ms}, 0, kSafe, kLateInput},
  };
  for (const Case& c : cases) {
    std::string ages;
    for (const nanoseconds age : c.ages) ages += std::to_string(age.count()) + " ns ";
    SCOPED_TRACE(ages);
    Bench bench = Bench::running(along_x(2));
    bench.starve(c.ages);
    expect(bench.last, c.force, c.state, c.reason);
  }
}

TEST(Guard, stays_safe_and_keeps_the_first_reason) {
  Bench bench = Bench::running(along_x(2));
  bench.starve({3ms, 10ms});
  for (int i = 0; i < 2000; ++i) expect(bench.step(1ms, along_x(1)), 0, kSafe, kLateInput);
  bench.guard.trip(kDeviceFault);
  expect(bench.step(1ms, along_x(1)), 0, kSafe, kLateInput);
  bench.now -= 1s;
  expect(bench.step(0ms, along_x(1)), 0, kSafe, kLateInput);
  EXPECT_EQ(bench.guard.count(kLateInput), 1u);
  EXPECT_EQ(bench.guard.count(kDeviceFault), 1u);
  EXPECT_EQ(bench.guard.count(kTimeBackwards), 1u);
}

TEST(Guard, takes_a_force_that_is_not_finite_for_a_missed_input) {
  for (const double bad : {kNaN, kInfinity, -kInfinity}) {
    for (int axis = 0; axis < 3; ++axis) {
      Vec3 force = along_x(2.5);
      force[axis] = bad;
      Bench bench = Bench::running(along_x(2));
      expect(bench.step(1ms, force), 2, kHold, kNotFinite);
      expect(bench.step(1ms, along_x(2.5)), 2.5, kRun, kNone);
      for (int age = 1; age < 3; ++age) expect(bench.step(1ms, force), 2.5, kHold, kNotFinite);
      for (int age = 3; age < 10; ++age) {
        expect(bench.step(1ms, force), 2.5 * (10 - age) / 8, kRamp, kNotFinite);
      }
      expect(bench.step(1ms, force), 0, kSafe, kNotFinite);
      expect(bench.step(1ms, along_x(0)), 0, kSafe, kNotFinite);
      EXPECT_EQ(bench.guard.count(kNotFinite), 2u);
      EXPECT_EQ(bench.guard.count(kLateInput), 0u);
    }
  }
}

TEST(Guard, comes_back_slowly_after_a_ramp) {
  Bench bench = Bench::running(along_x(3.2));
  bench.starve({3ms, 4ms, 5ms});
  EXPECT_EQ(bench.last.state, kRamp);
  // Half the ramp is gone: half the largest force is left, and 6.6 N/s are added.
  expect(bench.step(1ms, along_x(3.2)), 1.6566, kRun, kLateInput);
  expect(bench.step(1ms, along_x(3.2)), 1.6632, kRun, kForceLimit);
  expect(bench.steps(230, along_x(3.2)), 1.6632 + 230 * 0.0066, kRun, kForceLimit);
  expect(bench.steps(10, along_x(3.2)), 3.2, kRun, kNone);
}

TEST(Guard, fades_no_more_than_the_time_that_inputs_were_missing) {
  Bench bench = Bench::running(along_x(1));
  for (int i = 0; i < 200; ++i) {  // every second tick is NaN
    expect(bench.step(1ms, along_x(kNaN)), 1, kHold, kNotFinite);
    expect(bench.step(1ms, along_x(1)), 1, kRun, kNone);
  }
}

TEST(Guard, does_not_jump_after_the_loop_stood_still) {
  {  // one step of at most 2 ms, and below the part of the largest force that is left
    Bench bench = Bench::running(along_x(-1));
    expect(bench.step(4ms, along_x(2)), 1, kRun, kLateInput);
    bench = Bench::running(along_x(0));
    expect(bench.step(9ms, along_x(3)), 3.3 / 8 + 9 * 0.0066, kRun, kLateInput);
  }
  for (const nanoseconds gap : {nanoseconds{10ms}, nanoseconds{5s}}) {
    Bench bench = Bench::running(along_x(2));
    expect(bench.step(gap, along_x(2)), 0, kSafe, kLateInput);
  }
}

TEST(Guard, trips_when_time_runs_backwards) {
  Bench bench = Bench::running(along_x(2));
  bench.now -= 1s;
  // From here on a step counts 1 ms, whatever the clock says.
  expect(bench.step(0ns, along_x(2)), 2, kHold, kTimeBackwards);
  for (int i = 1; i < 8; ++i) {
    expect(bench.step(1us, along_x(2)), 2.0 * (8 - i) / 8, kRamp, kTimeBackwards);
  }
  expect(bench.step(1us, along_x(2)), 0, kSafe, kTimeBackwards);
  EXPECT_EQ(bench.guard.count(kTimeBackwards), 1u);

  bench = Bench::running(along_x(2));
  expect(bench.step(1ms, along_x(2), -2ms), 2, kRun, kNone);
  expect(bench.step(1ms, along_x(2), -2ms - 1ns), 2, kHold, kTimeBackwards);
}

TEST(Guard, trips_when_time_stands_still) {
  Bench bench = Bench::running(along_x(2));
  for (int i = 0; i < 2; ++i) expect(bench.step(0ns, along_x(2)), 2, kRun, kNone);
  expect(bench.step(1ms, along_x(2)), 2, kRun, kNone);
  for (int i = 0; i < 2; ++i) expect(bench.step(0ns, along_x(2)), 2, kRun, kNone);
  expect(bench.step(0ns, along_x(2)), 2, kHold, kTimeStalled);
  for (int i = 0; i < 8; ++i) bench.step(0ns, along_x(2));
  expect(bench.last, 0, kSafe, kTimeStalled);
  EXPECT_FALSE(bench.guard.engage());  // still standing
}

TEST(Guard, fades_when_tripped_whatever_the_input) {
  for (const GuardReason reason : {kDeviceFault, kStopRequested}) {
    Bench bench = Bench::running(along_x(2));
    bench.guard.trip(reason);
    expect(bench.step(1ms, along_x(3)), 2, kHold, reason);
    for (int i = 1; i < 8; ++i) {
      bench.guard.trip(reason == kDeviceFault ? kStopRequested : kDeviceFault);
      expect(bench.step(1ms, along_x(3)), 2.0 * (8 - i) / 8, kRamp, reason);
    }
    expect(bench.step(1ms, along_x(3)), 0, kSafe, reason);
    EXPECT_EQ(bench.guard.count(kDeviceFault), 1u);
    EXPECT_EQ(bench.guard.count(kStopRequested), 1u);
  }
  // In the midst of a ramp it goes on from there.
  Bench bench = Bench::running(along_x(2));
  bench.starve({3ms, 5ms});
  bench.guard.trip(kDeviceFault);
  expect(bench.step(1ms, along_x(3)), 1, kRamp, kDeviceFault);
  // With no force there is nothing to fade.
  bench = Bench::running(along_x(0));
  bench.guard.trip(kDeviceFault);
  expect(bench.step(1ms, along_x(3)), 0, kSafe, kDeviceFault);
}

TEST(Guard, engages_only_when_asked_and_below_the_threshold) {
  struct Case {
    const char* name;
    std::function<void(Bench&)> last_step;
    bool engages;
  };
  const Case cases[] = {
      {"free", [](Bench& b) { b.step(1ms, along_x(0)); }, true},
      {"just below", [](Bench& b) { b.step(1ms, along_x(-0.1999)); }, true},
      {"at the threshold", [](Bench& b) { b.step(1ms, along_x(0.2)); }, false},
      {"pressed", [](Bench& b) { b.step(1ms, along_x(2)); }, false},
      {"1e300",
       [](Bench& b) {
         b.step(1ms, {1e300, 1e300, 0});
       },
       false},
      {"NaN", [](Bench& b) { b.step(1ms, along_x(kNaN)); }, false},
      {"late", [](Bench& b) { b.step(1ms, along_x(0), 3ms); }, false},
      {"from the future", [](Bench& b) { b.step(1ms, along_x(0), -3ms); }, false},
      {"backwards", [](Bench& b) { b.step(-1ms, along_x(0)); }, false},
      {"fault", [](Bench& b) { b.guard.trip(kDeviceFault), b.step(1ms, along_x(0)); }, false},
      {"fault since", [](Bench& b) { b.step(1ms, along_x(0)), b.guard.trip(kDeviceFault); }, false},
  };
  for (const auto& [name, last_step, engages] : cases) {
    SCOPED_TRACE(name);
    Bench bench = Bench::safe();
    ASSERT_EQ(bench.last.state, kSafe);
    last_step(bench);
    EXPECT_EQ(bench.last.state, kSafe);
    EXPECT_EQ(bench.guard.engage(), engages);
    EXPECT_FALSE(bench.guard.engage());
    bench.step(1ms, along_x(0));
    EXPECT_EQ(bench.last.state, engages ? kRun : kSafe);
    EXPECT_EQ(bench.last.reason, engages ? kNone : kStopRequested);
  }
  for (const double force : {0.0, 1.0}) {
    Bench bench = Bench::running(along_x(force));
    EXPECT_FALSE(bench.guard.engage());
  }
}

TEST(Guard, ramps_over_half_a_second_once_engaged) {
  Bench bench = Bench::safe();
  bench.step(1ms, along_x(0.1));
  ASSERT_TRUE(bench.guard.engage());
  for (int i = 1; i <= 499; ++i) {
    expect(bench.step(1ms, along_x(3.3)), 3.3 * i / 500, kRun, kForceLimit);
  }
  expect(bench.steps(2, along_x(3.3)), 3.3, kRun, kNone);
}

TEST(Guard, does_not_kick_when_started_inside_a_solid) {
  const double stiffness = 500, depth = 5e-3;  // 2.5 N
  Bench bench;
  const auto pressed = [&](double at) { return along_x(stiffness * at); };
  for (int i = 0; i < 5000; ++i) {
    bench.step(1ms, pressed(depth));
    ASSERT_EQ(bench.last.state, kStart);
    ASSERT_LE(bench.last.force.norm(), 0.2);
  }
  expect(bench.last, 0.2, kStart, kForceLimit);
  // The hand is let out, slowly; 0.4 mm deep it engages.
  for (double at = depth; at > 0.4e-3; at -= 1e-5) {
    bench.step(1ms, pressed(at));
    ASSERT_EQ(bench.last.state, stiffness * at >= 0.2 ? kStart : kRun);
    ASSERT_LE(bench.last.force.norm(), 0.2);
  }
  expect(bench.step(1ms, pressed(0.399e-3)), 0.1995, kRun, kNone);
  // And back in: from what it was, over half a second.
  for (int i = 0; i < 600; ++i) {
    bench.step(1ms, pressed(depth));
    ASSERT_LE(bench.last.force.x(), 0.2001 + (i + 2) * 0.0066);
  }
  expect(bench.last, 2.5, kRun, kNone);
}

TEST(Guard, sends_nothing_before_a_first_input) {
  Bench bench;
  expect(bench.step(1ms, along_x(kNaN)), 0, kHold, kNotFinite);
  for (int i = 1; i < 10; ++i) {
    expect(bench.step(1ms, along_x(kNaN)), 0, i < 3 ? kHold : kRamp, kNotFinite);
  }
  expect(bench.step(1ms, along_x(kNaN)), 0, kSafe, kNotFinite);
  // Missed inputs do not engage.
  bench = Bench();
  bench.steps(100, along_x(2.5));
  bench.step(1ms, along_x(kNaN));
  expect(bench.step(1ms, along_x(2.5)), 0.2, kStart, kForceLimit);
}

TEST(Guard, bears_any_two_times) {
  constexpr nanoseconds kTimes[] = {
      nanoseconds::min(),       nanoseconds::min() + 1ns, -1ns, 0ns, 1ns,
      nanoseconds::max() - 1ns, nanoseconds::max()};
  for (const nanoseconds before : kTimes) {
    for (const nanoseconds now : kTimes) {
      for (const nanoseconds measured : kTimes) {
        Guard guard;
        guard.step(before, {along_x(0), before});
        const GuardOutput out = guard.step(now, {along_x(1), measured});
        EXPECT_LE(out.force.norm(), 2e-8);
        EXPECT_TRUE(!(now < before) || out.reason == kTimeBackwards);
      }
    }
  }
}

TEST(Guard, tells_failures_from_limits_and_what_it_comes_back_from) {
  for (const GuardReason reason :
       {kDeviceFault, kTimeBackwards, kTimeStalled, kNotFinite, kLateInput})
    EXPECT_TRUE(is_failure(reason)) << guard_reason_name(reason);
  for (const GuardReason reason : {kNone, kStopRequested, kForceLimit, kRateLimit})
    EXPECT_FALSE(is_failure(reason)) << guard_reason_name(reason);
  for (const GuardReason reason : {kNotFinite, kLateInput})
    EXPECT_TRUE(may_reengage(reason)) << guard_reason_name(reason);
  for (const GuardReason reason :
       {kNone, kDeviceFault, kStopRequested, kTimeBackwards, kTimeStalled, kForceLimit, kRateLimit})
    EXPECT_FALSE(may_reengage(reason)) << guard_reason_name(reason);
}

}  // namespace
}  // namespace gliss
