// Late positions and slow loops: the force is that of where the hand was, so that a stiff wall
// gives energy to the hand.
#include "gliss/device/sim_device.h"
#include "gliss/generate/generate.h"
#include "gliss/loop/loop.h"
#include "tests/support/sharp_meshes.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using namespace std::chrono_literals;

// A cube of 60 mm round the origin.
std::shared_ptr<const PatchCache> block() {
  static const auto cache =
      std::make_shared<const PatchCache>(test::cache_of(test::with_creases(cube(4, 60).mesh)));
  return cache;
}

struct Ride {
  double given = 0;    // J, the most that the device has given to the hand
  double swing = 0;    // m, of the hand across the wall over the last second
  double largest = 0;  // N, sent
  std::uint64_t rate_limits = 0, failures = 0;  // of the guard
};

// A hand that presses on the block's top and slides on it to and fro, or rests.
Ride ride(const SceneObject& object, const SimOptions& sim, Nanoseconds period, double speed) {
  constexpr double kTop = 0.030, kPressed = kTop - 0.004;  // m
  std::vector<double> times{0, 0.2};
  std::vector<Vec3> points{{-0.02, 0, kTop + 0.002}, {-0.02, 0, kPressed}};
  for (int i = 0; i < 4; ++i) {
    times.push_back(times.back() + (speed > 0 ? 0.04 / speed : 1));
    points.push_back({speed > 0 && i % 2 == 0 ? 0.02 : -0.02, 0, kPressed});
  }
  SimDevice device(HandPath(times, points), sim);
  Tracker tracker({&object, 1});
  LoopOptions options;
  options.wait = false;
  options.period = period;
  HapticLoop loop(device, tracker, options);
  Ride result;
  double work = 0, low = 1, high = -1;
  Vec3 at = device.position(), force = Vec3::Zero();
  loop.run([&](const LoopTick& tick) {
    const Vec3 now = device.position();
    work += force.dot(now - at);
    result.given = std::max(result.given, work);
    result.largest = std::max(result.largest, tick.sent.norm());
    at = now;
    force = tick.sent;
    if (in_seconds(tick.time) > times.back() - 1) {
      low = std::min(low, now.z());
      high = std::max(high, now.z());
    }
    return true;
  });
  result.swing = high - low;
  result.rate_limits = loop.guard().count(GuardReason::kRateLimit);
  for (int r = 1; r < kGuardReasons; ++r) {
    const auto reason = static_cast<GuardReason>(r);
    if (is_failure(reason)) result.failures += loop.guard().count(reason);
  }
  return result;
}

// The damping that the hand needs against the delay of the force: k (T / 2 + delay), T a tick
// (docs/scenes.md, "Stiff walls").
double asked_for(double stiffness, Nanoseconds period, Nanoseconds delay) {
  return stiffness * (in_seconds(period) / 2 + in_seconds(delay));
}

// Friction makes no difference. A guard limits force and rate, and these stay below: it does not
// speak.
TEST(Delay, of_positions_gives_energy_once_the_hand_damps_less_than_it_asks_for) {
  for (const double friction : {0.0, 0.5}) {
    for (const int delay : {0, 1, 2, 5, 7, 9, 15, 20}) {
      SceneObject object{.cache = block()};
      object.friction = {friction, 0.6 * friction};
      SimOptions sim;
      sim.delay = std::chrono::milliseconds(delay);
      const Ride r = ride(object, sim, 1ms, 0.05);
      const bool is_damped = asked_for(object.stiffness, 1ms, sim.delay) < sim.hand_damping;
      EXPECT_EQ(is_damped, delay < 10);
      EXPECT_EQ(r.given < 1e-3, is_damped) << delay;
      EXPECT_EQ(r.swing < 1e-4, is_damped) << delay;
      EXPECT_LE(r.largest, sim.max_force);
      EXPECT_EQ(r.rate_limits + r.failures, 0u);
      test::record(fmt::format("friction {}, {} ms", friction, delay),
                   "{:.2g} J given, {:.2g} mm of swing, {:.2g} N", r.given, 1e3 * r.swing,
                   r.largest);
    }
  }
}

TEST(Delay, makes_a_stiff_wall_swing_by_the_rate_of_its_loop) {
  for (const auto delay : {0ms, 2ms}) {
    for (const double damping : {0.8, 1.6, 5.0, 12.0}) {
      for (const int rate : {500, 1000, 2000, 4000}) {
        SceneObject object{.cache = block(), .stiffness = 2000};
        SimOptions sim;
        sim.hand_damping = damping;
        sim.delay = delay;
        const Nanoseconds period(1'000'000'000 / rate);
        const Ride r = ride(object, sim, period, 0);
        const double asked = asked_for(object.stiffness, period, delay);
        // Near the line the sensor's rounding decides.
        if (asked < 0.8 * damping) {
          EXPECT_LT(r.swing, 1.2e-4) << damping << ", " << rate << " Hz";
          EXPECT_LT(r.given, 1e-3) << damping << ", " << rate << " Hz";
        }
        if (asked > 1.15 * damping) {
          EXPECT_GT(r.swing, 1.5e-4) << damping << ", " << rate << " Hz";
        }
        test::record(fmt::format("{} ms, {} N s/m, {} Hz", delay.count(), damping, rate),
                     "{:.2g} N s/m asked for, {:.2g} mm of swing, {:.2g} J given, {:.2g} N, {} "
                     "times rate limited",
                     asked, 1e3 * r.swing, r.given, r.largest, r.rate_limits);
      }
    }
  }
}

}  // namespace
}  // namespace gliss
