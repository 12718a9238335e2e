// The hand that a page pulls: it follows, and a silent page takes the force away.
#include "tools/view/pointer_hand.h"

#include <gmock/gmock.h>

#include "gliss/device/guard.h"

namespace gliss::tools {
namespace {

using namespace std::chrono_literals;

TEST(PointerHand, is_not_there_before_the_first_target) {
  PointerHand hand(Vec3(0.1, 0, 0));
  for (int i = 0; i < 50; ++i) EXPECT_EQ(hand.read(i * 1ms).sequence, 0u);
  hand.point(Vec3(0.1, 0, 0), 50ms);
  const DeviceState state = hand.read(51ms);
  EXPECT_EQ(state.sequence, 1u);
  EXPECT_LT((state.position - Vec3(0.1, 0, 0)).norm(), 1e-5);
}

TEST(PointerHand, goes_where_it_is_pointed_without_a_leap) {
  PointerHand hand(Vec3::Zero());
  Vec3 last = Vec3::Zero();
  for (int i = 0; i < 1000; ++i) {
    if (i % 16 == 0) hand.point(Vec3(0.02, 0, 0), i * 1ms);
    const Vec3 now = hand.read(i * 1ms).position;
    EXPECT_LT((now - last).norm(), 1.5e-4) << "0.1 m/s, and what it swings";
    last = now;
  }
  EXPECT_LT((last - Vec3(0.02, 0, 0)).norm(), 1e-4);
}

TEST(PointerHand, gives_way_to_the_force_as_a_spring_does) {
  PointerHand hand(Vec3::Zero());
  DeviceState state;
  for (int i = 0; i < 2000; ++i) {
    if (i % 16 == 0) hand.point(Vec3::Zero(), i * 1ms);
    state = hand.read(i * 1ms);
    hand.write(Vec3(0, 0, 3), i * 1ms);
  }
  EXPECT_NEAR(state.position.z(), 3.0 / SimOptions{}.hand_stiffness, 1e-4);
}

TEST(PointerHand, brings_nothing_new_once_its_page_is_silent) {
  PointerHand hand(Vec3::Zero());
  hand.point(Vec3(0.01, 0, 0), 0ms);
  std::uint64_t sequence = 0;
  for (int i = 0; i <= 100; ++i) {
    const auto next = hand.read(i * 1ms).sequence;
    EXPECT_GT(next, sequence);
    sequence = next;
  }
  const Vec3 where = hand.read(101ms).position;
  for (int i = 102; i < 300; ++i) {
    const DeviceState state = hand.read(i * 1ms);
    EXPECT_EQ(state.sequence, sequence);
    EXPECT_EQ(state.position, where);
    EXPECT_EQ(state.measured, 100ms);
  }
  hand.point(Vec3(0.01, 0, 0), 300ms);
  EXPECT_EQ(hand.read(301ms).sequence, sequence + 1);
  EXPECT_LT((hand.read(302ms).position - where).norm(), 1e-3) << "it goes on from there";
}

TEST(PointerHand, bears_targets_that_are_no_numbers) {
  PointerHand hand(Vec3::Zero());
  hand.point(Vec3::Constant(std::nan("")), 0ms);
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(hand.read(i * 1ms).position.allFinite());
  hand.point(Vec3(0.01, 0, 0), 10ms);
  DeviceState state;
  for (int i = 10; i < 100; ++i) state = hand.read(i * 1ms);
  EXPECT_GT(state.position.x(), 0.005);
}

}  // namespace
}  // namespace gliss::tools
