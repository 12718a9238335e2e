// The simulated device and its hand: physics, sensor, script, and the same bytes again.
#include "gliss/device/sim_device.h"

#include <gmock/gmock.h>

#include <cstring>

#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

SimOptions exact_sensor() {
  SimOptions options;
  options.resolution = 0;
  return options;
}

TEST(HandPath, runs_along_its_waypoints_at_its_speed) {
  HandPath path = HandPath::along({Vec3(0, 0, 0), Vec3(0.1, 0, 0), Vec3(0.1, 0.2, 0)}, 0.05);
  EXPECT_DOUBLE_EQ(path.duration(), 6);
  EXPECT_EQ(path.at(-1), Vec3(0, 0, 0));
  EXPECT_LT((path.at(1) - Vec3(0.05, 0, 0)).norm(), 1e-15);
  EXPECT_LT((path.at(4) - Vec3(0.1, 0.1, 0)).norm(), 1e-15);
  EXPECT_EQ(path.at(60), Vec3(0.1, 0.2, 0));
  EXPECT_LT((path.at(1) - Vec3(0.05, 0, 0)).norm(), 1e-15);  // back again
}

// Rounds as if the points were there so often, with the memory of one.
TEST(HandPath, goes_round) {
  const Vec3 a(0, 0, 0), b(0.1, 0, 0), c(0.1, 0.2, 0);
  const std::vector<Vec3> once{a, b, c}, thrice{a, b, c, a, b, c, a, b, c};
  const auto expect_same = [](HandPath round, HandPath whole) {
    EXPECT_NEAR(round.duration(), whole.duration(), 1e-12);
    for (double t = -1; t < whole.duration() + 1; t += 0.0137)
      EXPECT_LT((round.at(t) - whole.at(t)).norm(), 1e-12) << t;
    EXPECT_LT((round.at(0.3) - whole.at(0.3)).norm(), 1e-12);  // back again
  };
  expect_same(HandPath::along(once, 0.05, 3), HandPath::along(thrice, 0.05));
  expect_same(HandPath::along({a, b, a}, 0.05, 2), HandPath::along({a, b, a, a, b, a}, 0.05));
  expect_same(HandPath::sampled(once, 0.25, 3), HandPath::sampled(thrice, 0.25));
  EXPECT_EQ(HandPath::along({b}, 0.05, 3).at(1), b);
  HandPath long_path = HandPath::sampled(std::vector<Vec3>(100'000, a), 1e-3, 1'000'000);
  EXPECT_NEAR(long_path.duration(), 1e8 - 1e-3, 1e-6);
  EXPECT_EQ(long_path.at(9e7), a);
}

TEST(HandPath, refuses_what_is_no_path) {
  EXPECT_THROW(HandPath({0, 1}, {Vec3::Zero()}), std::invalid_argument);
  EXPECT_THROW(HandPath({1, 0}, {Vec3::Zero(), Vec3::Zero()}), std::invalid_argument);
  EXPECT_THROW(HandPath({0}, {Vec3(0, std::nan(""), 0)}), std::invalid_argument);
  EXPECT_THROW(HandPath::along({Vec3::Zero()}, 0), std::invalid_argument);
  EXPECT_THROW(HandPath::along({Vec3::Zero()}, 1, 0), std::invalid_argument);
}

TEST(SimDevice, oscillates_as_a_mass_on_a_spring) {
  SimOptions options = exact_sensor();
  options.mass = 0.2;
  options.hand_stiffness = 500;
  options.hand_damping = 0;
  // Pulled away for the first step, then let go.
  SimDevice device(
      HandPath({0, 0.0001, 0.0002}, {Vec3(1e-3, 0, 0), Vec3(1e-3, 0, 0), Vec3(0, 0, 0)}), options);
  const double period = 2 * std::numbers::pi * std::sqrt(options.mass / options.hand_stiffness);
  Nanoseconds now = 1s;
  double last = 1, crossings = 0, first = 0, latest = 0;
  for (int i = 0; i < 2000; ++i, now += 1ms) {
    const double x = device.read(now).position.x();
    if (last < 0 && x >= 0) {
      latest = i - x / (x - last);
      if (crossings++ == 0) first = latest;
    }
    last = x;
  }
  ASSERT_GT(crossings, 5);
  EXPECT_NEAR((latest - first) / (crossings - 1) * 1e-3, period, 0.003 * period);
}

TEST(SimDevice, rests_where_the_force_balances_the_grip) {
  SimDevice device(HandPath({0}, {Vec3(0.01, 0.02, 0.03)}), exact_sensor());
  const Vec3 force(1, -2, 0.5);
  DeviceState state;
  for (Nanoseconds now = 1s; now < 4s; now += 1ms) {
    state = device.read(now);
    ASSERT_TRUE(device.write(force, now));
  }
  EXPECT_LT((state.position - Vec3(0.01, 0.02, 0.03) - force / 300).norm(), 1e-9);
  EXPECT_LT(state.velocity.norm(), 1e-9);
}

TEST(SimDevice, gives_no_more_force_than_it_has) {
  SimDevice device(HandPath(), exact_sensor());
  for (Nanoseconds now = 1s; now < 4s; now += 1ms) {
    device.read(now);
    device.write(Vec3(100, 0, 0), now);
  }
  EXPECT_NEAR(device.position().x(), 3.3 / 300, 1e-9);
  // What nobody means is no force at all.
  Nanoseconds now = 4s;
  for (const Vec3& absurd : {Vec3(std::nan(""), 0, 0), Vec3(0, 1e200, 0)}) {
    EXPECT_FALSE(device.write(absurd, now));
    for (int i = 0; i < 3000; ++i) device.read(now += 1ms);
    EXPECT_NEAR(device.position().norm(), 0, 1e-9);
    EXPECT_TRUE(device.write(Vec3(1, 0, 0), now));
    device.read(now += 1s);
    EXPECT_GT(device.position().norm(), 1e-3);
  }
}

TEST(SimDevice, reports_late_and_rounded_positions) {
  const HandPath path = HandPath::along({Vec3(0, 0, 0), Vec3(0.1, 0, 0)}, 0.1);
  SimOptions late = exact_sensor();
  late.delay = 5ms;
  SimDevice now_device(path, exact_sensor()), late_device(path, late);
  SimOptions coarse;
  coarse.resolution = 1e-4;
  SimDevice coarse_device(path, coarse);
  std::vector<Vec3> seen;
  for (int i = 0; i < 500; ++i) {
    const Nanoseconds now = 1s + i * 1ms;
    seen.push_back(now_device.read(now).position);
    const DeviceState state = late_device.read(now);
    EXPECT_EQ(state.position, seen[static_cast<std::size_t>(std::max(0, i - 5))]);
    EXPECT_EQ(state.measured, now);
    const double ticks = coarse_device.read(now).position.x() / 1e-4;
    EXPECT_NEAR(ticks, std::round(ticks), 1e-9);
    EXPECT_LE(std::abs(ticks * 1e-4 - seen.back().x()), 0.5001e-4);
  }
}

TEST(SimDevice, ends_after_its_path_and_stops_at_its_workspace) {
  SimOptions options = exact_sensor();
  options.workspace = {Vec3(-1, -1, -1), Vec3(0.02, 1, 1)};
  SimDevice device(HandPath::along({Vec3::Zero(), Vec3(0.05, 0.01, 0)}, 0.1), options);
  bool ended = false;
  double reach = 0;
  Nanoseconds now = 1s;
  for (; !ended && now < 5s; now += 1ms) {
    const DeviceState state = device.read(now);
    ended = state.ended;
    reach = std::max(reach, state.position.x());
  }
  EXPECT_NEAR((now - 1s).count() * 1e-9, 0.51, 0.02);
  EXPECT_EQ(reach, 0.02);
}

TEST(SimDevice, goes_to_the_target_that_it_is_given_and_has_no_end) {
  SimDevice device(HandPath::along({Vec3::Zero(), Vec3(0.01, 0, 0)}, 0.1), {});
  EXPECT_FALSE(device.draw_to(Vec3(0, std::numeric_limits<double>::quiet_NaN(), 0)));
  EXPECT_TRUE(device.draw_to(Vec3(0, 0.02, 0)));
  DeviceState state;
  for (int i = 0; i <= 2000; ++i) state = device.read(std::chrono::milliseconds(i));
  EXPECT_FALSE(state.ended);
  EXPECT_LT((state.position - Vec3(0, 0.02, 0)).norm(), 1e-5);
}

TEST(SimDevice, repeats_itself_by_its_seed) {
  SimOptions options;
  options.noise = 1e-5;
  options.resolution = 0;
  const HandPath path = HandPath::along({Vec3(0, 0, 0), Vec3(0.1, 0, 0)}, 0.1);
  SimDevice a(path, options), b(path, options);
  options.seed = 2;
  SimDevice c(path, options);
  int same = 0;
  for (Nanoseconds now = 1s; now < 2s; now += 1ms) {
    const DeviceState x = a.read(now), y = b.read(now + 5s);
    EXPECT_EQ(x.position, y.position);
    same += c.read(now).position == x.position;
  }
  EXPECT_EQ(same, 0);
}

// A reader that was away finds the hand on its way, after work that is bounded.
TEST(SimDevice, bears_any_time) {
  SimDevice device(HandPath::along({Vec3(0, 0, 0), Vec3(0.1, 0, 0)}, 0.1));
  device.read(1s);
  for (const Nanoseconds now : {2s, 3600s, 3600s, 10s}) {
    EXPECT_TRUE(device.read(now).position.allFinite());
  }
}

TEST(SimDevice, refuses_what_cannot_be_simulated) {
  const auto refusal = [](auto change) -> std::string {
    SimOptions options;
    change(options);
    try {
      SimDevice{HandPath(), options};
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refusal([](SimOptions& o) { o.mass = 0; }), HasSubstr("mass: must be"));
  EXPECT_THAT(refusal([](SimOptions& o) { o.mass = 1e-6; }), HasSubstr("mass: too small"));
  EXPECT_THAT(refusal([](SimOptions& o) { o.noise = std::nan(""); }), HasSubstr("noise"));
  EXPECT_THAT(refusal([](SimOptions& o) { o.delay = 1s; }), HasSubstr("delay"));
  EXPECT_EQ(refusal([](SimOptions&) {}), "");
}

}  // namespace
}  // namespace gliss
