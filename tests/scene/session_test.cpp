// The loop in a thread of its own: all its ticks come out, and it ends as its owner wishes.
#include "gliss/scene/session.h"

#include <gmock/gmock.h>

#include "gliss/device/replay_device.h"
#include "gliss/generate/generate.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using namespace std::chrono_literals;

class Session : public testing::Test {
 protected:
  // Takes ticks until the loop has ended, and gives them all.
  static std::vector<LoopTick> ticks_of(LoopSession& session) {
    std::vector<LoopTick> all, some;
    for (bool more = true; more;) {
      more = !session.wait_for(1ms);
      session.take(some);
      all.insert(all.end(), some.begin(), some.end());
    }
    return all;
  }

  const SceneObject object{.cache = std::make_shared<PatchCache>(test::cache_of(goldberg().mesh)),
                           .stiffness = 500};
  Tracker tracker{{&object, 1}};
};

TEST_F(Session, loses_no_tick_without_a_clock) {
  ReplayDevice device(std::vector<Vec3>(1000, Vec3(0, 0, 0.02)));
  LoopOptions rules;
  rules.wait = false;
  LoopSession session(device, tracker, rules, {.ring = 16});
  const std::vector<LoopTick> ticks = ticks_of(session);
  session.join();
  EXPECT_EQ(session.end(), LoopEnd::kDeviceEnded);
  EXPECT_EQ(session.lost(), 0u);
  EXPECT_EQ(ticks.size(), session.loop().record().ticks());
  for (std::size_t i = 0; i < ticks.size(); ++i) ASSERT_EQ(ticks[i].number, i);
  EXPECT_EQ(session.grants()->priority, 0) << "a loop without a clock needs no real-time thread";
}

TEST_F(Session, calls_after_each_tick_what_may_change_the_tracker) {
  ReplayDevice device(std::vector<Vec3>(10, Vec3(0, 0, 0.009)));
  LoopOptions rules;
  rules.wait = false;
  int calls = 0;
  LoopSession session(device, tracker, rules, {.after_tick = [&](Tracker& changed) {
                        EXPECT_EQ(&changed, &tracker);
                        if (++calls == 5) changed.set_material(0, 1000, {});
                      }});
  const std::vector<LoopTick> ticks = ticks_of(session);
  session.join();
  ASSERT_GE(ticks.size(), 10u);
  EXPECT_EQ(calls, static_cast<int>(ticks.size()));
  EXPECT_GT(ticks[4].rendered.norm(), 0);
  EXPECT_DOUBLE_EQ(ticks[5].rendered.norm(), 2 * ticks[4].rendered.norm());
}

TEST_F(Session, ends_after_its_time_or_on_request) {
  for (const bool on_request : {false, true}) {
    ReplayDevice device(std::vector<Vec3>(100'000, Vec3(0, 0, 0.02)));
    LoopSession session(device, tracker, {}, {.seconds = on_request ? 0 : 0.05});
    if (on_request) session.request_stop();
    ASSERT_TRUE(session.wait_for(10s));
    session.join();
    EXPECT_EQ(session.end(), LoopEnd::kStopped);
    EXPECT_LT(session.loop().record().ticks(), 1000u);
  }
}

TEST_F(Session, that_is_dropped_ends_its_loop_also_where_nobody_takes_its_ticks) {
  ReplayDevice device(std::vector<Vec3>(100'000, Vec3(0, 0, 0.02)));
  LoopOptions rules;
  rules.wait = false;
  LoopSession(device, tracker, rules, {.ring = 16});
}

TEST_F(Session, throws_at_its_end_what_was_required_and_refused) {
  struct Refusing final : HapticDevice {
    const DeviceInfo& info() const noexcept override { return replay.info(); }
    DeviceState read(Nanoseconds now) noexcept override { return replay.read(now); }
    bool write(const Vec3&, Nanoseconds) noexcept override { return true; }
    std::vector<std::string> refusals() const override { return {"its thread may not"}; }
    ReplayDevice replay{std::vector<Vec3>(100'000, Vec3(0, 0, 0.02))};
  } device;
  SessionOptions options{.seconds = 0.01};
  LoopSession told(device, tracker, {}, options);
  told.join();
  EXPECT_THAT(told.grants()->refusals, testing::Contains("its thread may not"));
  options.scheduling.require = true;
  Tracker another({&object, 1});
  LoopSession ended(device, another, {}, options);
  EXPECT_THROW(ended.join(), LoopError);
  EXPECT_EQ(ended.grants(), std::nullopt);
}

}  // namespace
}  // namespace gliss
