// The loop between a device and a scene: what goes out, when, and how it ends. In a time of its
// own, so that every tick comes out the same.
#include "gliss/loop/loop.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cstring>
#include <thread>

#include "gliss/device/replay_device.h"
#include "gliss/device/sim_device.h"
#include "gliss/generate/generate.h"
#include "gliss/query/trace.h"
#include "tests/support/allocations.h"
#include "tests/support/surfaces.h"
#include "tests/thread/locked_memory.h"

namespace gliss {
namespace {

using namespace std::chrono_literals;

// A ball of 10 mm round the origin, and ways into it.
std::shared_ptr<const PatchCache> ball() {
  static const auto cache = std::make_shared<PatchCache>(test::cache_of(goldberg().mesh));
  return cache;
}
Vec3 at_depth(double depth) { return Vec3(0, 0, 0.010 - depth); }  // m
std::vector<Vec3> still(std::size_t ticks, double depth) { return {ticks, at_depth(depth)}; }
// At so many m/s from 5 mm above to `depth`.
std::vector<Vec3> entering(double speed, double depth, std::size_t ticks) {
  std::vector<Vec3> path;
  for (std::size_t i = 0; i < ticks; ++i)
    path.push_back(at_depth(std::min(depth, -0.005 + speed * 1e-3 * static_cast<double>(i))));
  return path;
}

// A replay that can go wrong, and keeps what was written.
class Probe final : public HapticDevice {
 public:
  explicit Probe(std::vector<Vec3> path) : replay_(std::move(path)) { written.reserve(100000); }
  const DeviceInfo& info() const noexcept override { return replay_.info(); }
  DeviceState read(Nanoseconds now) noexcept override {
    ++ticks;
    if (ticks > silent_from && ticks <= silent_to) {
      if (restamps) last_.measured = now;
      return last_;
    }
    last_ = replay_.read(now);
    last_.measured += ahead;
    last_.fault = ticks == fault_at;
    if (ticks == nan_at) last_.position.y() = std::nan("");
    return last_;
  }
  bool write(const Vec3& force, Nanoseconds) noexcept override {
    written.push_back(force);
    return ticks < broken_from;
  }

  static constexpr int kNever = std::numeric_limits<int>::max();
  int ticks = 0, silent_from = kNever, silent_to = kNever, fault_at = -1, nan_at = -1,
      broken_from = kNever;
  bool restamps = false;  // what it has told before, as if it were new
  Nanoseconds ahead{0};   // of its clock
  std::vector<Vec3> written;

 private:
  ReplayDevice replay_;
  DeviceState last_;
};

struct Felt {
  LoopEnd end;
  std::vector<LoopTick> ticks;
  std::uint64_t faults = 0;  // that the guard counted
};

Felt run(HapticDevice& device, LoopOptions options = {}, std::size_t stop_after = ~std::size_t{0},
         std::span<const SceneObject> objects = {}) {
  const SceneObject one{.cache = ball()};
  Tracker tracker(objects.empty() ? std::span(&one, 1) : objects);
  options.wait = false;
  HapticLoop loop(device, tracker, options);
  Felt result;
  result.end = loop.run([&](const LoopTick& tick) {
    result.ticks.push_back(tick);
    return result.ticks.size() < stop_after;
  });
  EXPECT_EQ(loop.record().ticks(), result.ticks.size());
  result.faults = loop.guard().count(GuardReason::kDeviceFault);
  return result;
}

double largest_step(const Felt& felt) {  // of what was sent
  double most = 0;
  Vec3 last = Vec3::Zero();
  for (const LoopTick& tick : felt.ticks) {
    most = std::max(most, (tick.sent - last).norm());
    last = tick.sent;
  }
  return most;
}

TEST(Loop, renders_the_bytes_of_a_trace) {
  const Generated knot = torus_knot(180, 8);
  const auto cache = std::make_shared<PatchCache>(test::cache_of(knot.mesh));
  std::vector<Vec3> path;
  for (int i = 0; i < 3000; ++i) {
    const auto p = knot.exact->nearest(knot.mesh.positions[0] + Vec3(0, 0.01 * i, 0));
    path.push_back((p.position - 2 * std::sin(0.01 * i) * p.normal) / 1000);
  }
  const SceneObject object{.cache = cache};
  ReplayDevice device(path);
  const Felt felt = run(device, {}, ~std::size_t{0}, {&object, 1});
  ASSERT_EQ(felt.ticks.size(), path.size());
  std::vector<Vec3> hips = path;
  for (Vec3& hip : hips) hip /= cache->unit;
  std::size_t touching = 0;
  TraceOptions options;
  options.methods = {Method::kGregory};
  trace(*cache, hips, options, [&](std::size_t i, std::span<const TraceStep> steps) {
    EXPECT_EQ(std::memcmp(&felt.ticks[i].rendered, &steps[0].force, sizeof(Vec3)), 0) << i;
    EXPECT_EQ(felt.ticks[i].touching, steps[0].contact.touching);
    touching += steps[0].contact.touching;
  });
  EXPECT_GT(touching, 1000u);
}

TEST(Loop, ends_with_a_device_and_writes_zero_last) {
  Probe device(entering(0.1, 0.002, 1000));
  const Felt felt = run(device);
  EXPECT_EQ(felt.end, LoopEnd::kDeviceEnded);
  EXPECT_EQ(felt.ticks.size(), 1000u);
  EXPECT_GT(felt.ticks.back().sent.norm(), 0.5);
  EXPECT_EQ(device.written.back(), Vec3::Zero());
}

TEST(Loop, fades_to_zero_when_told_to_stop) {
  Probe device(entering(0.1, 0.002, 10000));
  const Felt felt = run(device, {}, 2000);
  EXPECT_EQ(felt.end, LoopEnd::kStopped);
  EXPECT_NEAR(felt.ticks[1999].sent.norm(), 1, 0.05);
  EXPECT_LE(felt.ticks.size(), 2012u);
  EXPECT_EQ(felt.ticks.back().state, GuardState::kSafe);
  EXPECT_EQ(felt.ticks.back().reason, GuardReason::kStopRequested);
  EXPECT_EQ(device.written.back(), Vec3::Zero());
  EXPECT_LE(largest_step(felt), 0.3);
}

TEST(Loop, writes_zero_when_its_callback_throws) {
  Probe device(entering(0.1, 0.002, 10000));
  const SceneObject object{.cache = ball()};
  Tracker tracker({&object, 1});
  HapticLoop loop(device, tracker, {.wait = false});
  EXPECT_THROW(loop.run([](const LoopTick& tick) {
    if (tick.number == 1000) throw std::runtime_error("full disk");
    return true;
  }),
               std::runtime_error);
  EXPECT_GT(device.written[1000].norm(), 0.5);
  EXPECT_EQ(device.written.back(), Vec3::Zero());
}

TEST(Loop, does_not_kick_when_it_starts_inside) {
  std::vector<Vec3> path = still(1000, 0.005);
  Probe device(path);
  const Felt inside = run(device);
  for (const LoopTick& tick : inside.ticks) {
    EXPECT_NEAR(tick.rendered.norm(), 2.5, 0.1);
    EXPECT_LE(tick.sent.norm(), 0.2);
    EXPECT_EQ(tick.state, GuardState::kStart);
  }
  // Once it has been outside it may push, and does so gently.
  const std::vector<Vec3> again = still(2000, 0.005), out = still(10, -0.001);
  path.insert(path.end(), out.begin(), out.end());
  path.insert(path.end(), again.begin(), again.end());
  Probe later(path);
  const Felt felt = run(later);
  EXPECT_NEAR(felt.ticks.back().sent.norm(), 2.5, 0.1);
  EXPECT_LE(largest_step(felt), 0.2 + 3.3 * 11 / 500);  // the ramp's beginning
}

TEST(Loop, renders_all_at_any_rate_that_it_takes) {
  for (const double rate : {224.0, 250.0, 500.0, 600.0, 1000.0, 4000.0}) {
    LoopOptions options;
    options.period = Nanoseconds(std::llround(1e9 / rate));
    std::vector<Vec3> path = still(static_cast<std::size_t>(rate), -0.005);  // engaged long before
    for (int i = 0; i <= rate; ++i) path.push_back(at_depth(-0.005 + 0.007 * i / rate));
    Probe device(path);
    const Felt felt = run(device, options, path.size() - 1);
    EXPECT_NEAR(felt.ticks.back().sent.norm(), 1, 0.05) << rate;  // 2 mm deep
    for (const LoopTick& tick : felt.ticks) EXPECT_FALSE(is_failure(tick.reason)) << rate;
  }
  for (const double rate : {1.0, 50.0, 100.0, 223.0}) {
    LoopOptions options;
    options.period = Nanoseconds(std::llround(1e9 / rate));
    EXPECT_THAT([&] { guard_limits(options); }, ::testing::ThrowsMessage<std::invalid_argument>(
                                                    ::testing::StartsWith("rate: at ")));
    const SceneObject object{.cache = ball()};
    Tracker tracker({&object, 1});
    Probe device(still(1, 0));
    EXPECT_THROW(HapticLoop(device, tracker, options), std::invalid_argument);
  }
  LoopOptions tight;  // whose ramp has no time to spare
  tight.period = Nanoseconds(1'600'000);
  tight.guard.max_rate = 413;
  EXPECT_EQ(guard_limits(tight).hold_after, tight.guard.hold_after);
  LoopOptions impatient;
  impatient.guard.hold_after = 500us;  // shorter than a period
  EXPECT_THROW(guard_limits(impatient), std::invalid_argument);
}

TEST(Loop, enters_at_half_a_metre_a_second_without_a_kick) {
  std::vector<Vec3> path = still(1000, -0.005);  // engaged long before
  const std::vector<Vec3> in = entering(0.5, 0.002, 500);
  path.insert(path.end(), in.begin(), in.end());
  Probe device(path);
  const Felt felt = run(device);
  const double step = 0.5e-3 * 500;  // N a tick, of the way that a tick goes
  for (const LoopTick& tick : felt.ticks) {
    if (!tick.touching) continue;
    EXPECT_NEAR((tick.sent - tick.rendered).norm(), 0, 1e-12) << tick.number;
  }
  EXPECT_LE(largest_step(felt), 1.05 * step);
  test::record("entry at 0.5 m/s", "largest step {:.4f} N, of the way {:.4f} N", largest_step(felt),
               step);
}

TEST(Loop, holds_fades_and_stays_safe_when_the_device_falls_silent) {
  Probe device(entering(0.1, 0.002, 10000));
  device.silent_from = 2000;
  const Felt felt = run(device, {}, 2500);
  // The input missed first was due at tick 2000; within 10 ms of it the force is zero.
  EXPECT_EQ(felt.ticks[2001].state, GuardState::kRun);
  EXPECT_EQ(felt.ticks[2002].state, GuardState::kHold);
  for (std::size_t i = 2000; i < 2010; ++i)
    EXPECT_LE(felt.ticks[i].sent.norm(), felt.ticks[i - 1].sent.norm() + 1e-12);
  for (std::size_t i = 2010; i < 2500; ++i) {
    EXPECT_EQ(felt.ticks[i].sent, Vec3::Zero());
    EXPECT_EQ(felt.ticks[i].state, GuardState::kSafe);
    EXPECT_EQ(felt.ticks[i].reason, GuardReason::kLateInput);
  }
}

// Whatever it stamps: what brings nothing new grows old.
TEST(Loop, fades_when_a_device_says_the_same_again_and_calls_it_new) {
  for (const Nanoseconds ahead : {Nanoseconds(0ns), Nanoseconds(1s)}) {
    for (const bool restamps : {false, true}) {
      Probe device(entering(0.1, 0.002, 10000));
      device.silent_from = 2000;
      device.restamps = restamps;
      device.ahead = ahead;
      const Felt felt = run(device, {}, 2100);
      EXPECT_NEAR(felt.ticks[1999].sent.norm(), 1, 0.05);
      for (std::size_t i = 2010; i < 2100; ++i) EXPECT_EQ(felt.ticks[i].sent, Vec3::Zero()) << i;
    }
  }
}

// A hand that enters and stays, is outside for 100 ticks, and inside again for so many.
std::vector<Vec3> leaving_for_a_while(std::size_t ticks) {
  std::vector<Vec3> path = entering(0.1, 0.002, 3000);
  const std::vector<Vec3> out = still(100, -0.002), in = still(ticks, 0.002);
  path.insert(path.end(), out.begin(), out.end());
  path.insert(path.end(), in.begin(), in.end());
  return path;
}

TEST(Loop, engages_again_only_where_it_may_and_only_in_the_open) {
  for (const bool reengage : {false, true}) {
    Probe device(leaving_for_a_while(1000));
    device.silent_from = 2000;
    device.silent_to = 2100;
    const Felt felt = run(device, {.reengage = reengage});
    for (std::size_t i = 2010; i < 3100; ++i) EXPECT_EQ(felt.ticks[i].sent, Vec3::Zero()) << i;
    EXPECT_EQ(felt.ticks.back().state, reengage ? GuardState::kRun : GuardState::kSafe);
    EXPECT_NEAR(felt.ticks.back().sent.norm(), reengage ? 1 : 0, 0.05);
    EXPECT_LE(largest_step(felt), 3.3 * 101 / 500);  // jumps in after 0.1 s of the ramp
  }
}

// Inside, a wish waits for the hand to come out; the force then rises as slowly as at the
// beginning.
TEST(Loop, engages_again_and_ends_as_its_owner_wishes) {
  Probe device(leaving_for_a_while(3000));
  device.silent_from = 2000;
  device.silent_to = 2100;
  const SceneObject one{.cache = ball()};
  Tracker tracker(std::span(&one, 1));
  HapticLoop loop(device, tracker, {.wait = false});
  std::vector<LoopTick> ticks;
  const LoopEnd end = loop.run([&](const LoopTick& tick) {
    if (tick.number == 2500) loop.request_engage();
    if (tick.number == 5000) std::thread([&] { loop.request_stop(); }).join();
    ticks.push_back(tick);
    return true;
  });
  EXPECT_EQ(end, LoopEnd::kStopped);
  for (std::size_t i = 2010; i < 3100; ++i) EXPECT_EQ(ticks[i].sent, Vec3::Zero()) << i;
  EXPECT_EQ(ticks[3150].state, GuardState::kRun);  // silence kept the hand inside for longer
  EXPECT_NEAR(ticks[4500].sent.norm(), 1, 0.05);
  EXPECT_LE(ticks.size(), 5015u);
  EXPECT_EQ(ticks.back().sent, Vec3::Zero());
  EXPECT_EQ(ticks.back().reason, GuardReason::kStopRequested);
}

TEST(Loop, ends_safe_where_the_device_fails) {
  for (const bool by_write : {false, true}) {
    Probe device(entering(0.1, 0.002, 10000));
    (by_write ? device.broken_from : device.fault_at) = 2000;
    const Felt felt = run(device, {.reengage = true});
    EXPECT_EQ(felt.end, LoopEnd::kDeviceFault);
    EXPECT_LE(felt.ticks.size(), 2012u);
    EXPECT_EQ(felt.ticks.back().sent, Vec3::Zero());
    EXPECT_EQ(felt.ticks.back().reason, GuardReason::kDeviceFault);
    if (!by_write) {  // in the very tick
      EXPECT_EQ(felt.ticks[1999].reason, GuardReason::kDeviceFault);
    }
    EXPECT_EQ(device.written.back(), Vec3::Zero());
    EXPECT_LE(largest_step(felt), 0.3);
  }
}

TEST(Loop, counts_a_fault_that_finds_it_safe) {
  for (const bool by_write : {false, true}) {
    Probe device(entering(0.1, 0.002, 10000));
    device.silent_from = 2000;
    device.silent_to = 2100;
    (by_write ? device.broken_from : device.fault_at) = 3000;
    const Felt felt = run(device);
    EXPECT_EQ(felt.end, LoopEnd::kDeviceFault);
    EXPECT_EQ(felt.faults, 1u);
    EXPECT_LE(felt.ticks.size(), 3003u);
    EXPECT_EQ(felt.ticks.back().reason, GuardReason::kLateInput);  // the first trip's
  }
}

TEST(Loop, bears_a_position_that_is_none) {
  Probe device(entering(0.1, 0.002, 3000));
  device.nan_at = 2000;
  const Felt felt = run(device);
  EXPECT_EQ(felt.ticks[1999].reason, GuardReason::kNotFinite);
  EXPECT_LE(felt.ticks[1999].sent.norm(), felt.ticks[1998].sent.norm());
  EXPECT_GT(felt.ticks[1999].sent.norm(), 0.9);  // held
  EXPECT_EQ(felt.ticks[2001].state, GuardState::kRun);
  EXPECT_EQ(felt.end, LoopEnd::kDeviceEnded);
}

TEST(Loop, keeps_to_the_smaller_one_of_the_largest_forces) {
  SimDevice device(HandPath::along({at_depth(-0.002), at_depth(0.009)}, 0.1, 10),
                   {.max_force = 1.5});
  const Felt felt = run(device);
  double most = 0;
  for (const LoopTick& tick : felt.ticks) most = std::max(most, tick.sent.norm());
  EXPECT_LE(most, 1.5);
  EXPECT_GT(most, 0.5);
}

// The object that is pressed is told, with its distance in metres.
TEST(Loop, tells_what_is_touched) {
  SceneObject objects[2] = {{.cache = ball()}, {.cache = ball(), .stiffness = 900}};
  objects[1].pose = Eigen::Translation3d(0.03, 0, 0) * Eigen::Isometry3d::Identity();
  Probe device({at_depth(0.001), Vec3(0.03, 0, 0.008), Vec3(0.015, 0, 0.02)});
  const Felt felt = run(device, {}, ~std::size_t{0}, objects);
  EXPECT_TRUE(felt.ticks[0].touching);
  EXPECT_EQ(felt.ticks[0].object, 0u);
  EXPECT_NEAR(felt.ticks[0].distance, -0.001, 1e-4);
  EXPECT_EQ(felt.ticks[1].object, 1u);
  EXPECT_NEAR(felt.ticks[1].distance, -0.002, 1e-4);
  EXPECT_NEAR(felt.ticks[1].rendered.norm(), 1.8, 0.1);
  EXPECT_FALSE(felt.ticks[2].touching);
  EXPECT_GT(felt.ticks[2].iterations, 0);
}

TEST(Loop, tells_of_the_object_that_pushes_hardest) {
  for (const std::uint32_t hardest : {0u, 1u, 2u}) {
    std::vector<SceneObject> objects(3, SceneObject{.cache = ball(), .stiffness = 100});
    objects[hardest].stiffness = 200;
    Probe device(still(20, 0.001));
    for (const LoopTick& tick : run(device, {}, ~std::size_t{0}, objects).ticks)
      EXPECT_EQ(tick.object, hardest);
  }
}

TEST(Loop, a_million_ticks_allocate_nothing_and_fault_nothing_in) {
  if (!test::allocations_are_counted()) GTEST_SKIP() << "a sanitizer has malloc";
  const std::uint64_t most = std::getenv("GLISS_LONG_TESTS") ? 10'000'000 : 1'000'000;
  SimOptions options;
  options.noise = 2e-6;
  SimDevice device(HandPath::along({at_depth(-0.002), at_depth(0.004), Vec3(0.006, 0.002, 0.004),
                                    Vec3(-0.02, 0.001, 0.001)},
                                   0.05, 1000000),
                   options);
  const SceneObject object{.cache = ball()};
  Tracker tracker({&object, 1});
  HapticLoop loop(device, tracker, {.wait = false});
  const test::LockedMemory locked;
  std::uint64_t allocations = 0, touching = 0;
  test::PageFaults before;
  loop.run([&](const LoopTick& tick) {
    if (tick.number == 1000) {  // all was touched once
      allocations = test::allocations();
      before = test::PageFaults::now();
    }
    touching += tick.touching;
    return tick.number < most;
  });
  allocations = test::allocations() - allocations;
  const test::PageFaults faults = test::PageFaults::now() - before;
  EXPECT_EQ(allocations, 0u);
  EXPECT_EQ(faults.major, 0);
  if (locked.is_granted()) {
    EXPECT_EQ(faults.minor, 0);
  }
  EXPECT_GT(touching, most / 20);
  test::record("loop", "{} ticks: {} allocations, {} minor and {} major faults", most, allocations,
               faults.minor, faults.major);
}

}  // namespace
}  // namespace gliss
