// Objects that move: by a list of poses, by a thread's, by hand. Contacts go along with them.
#include "gliss/contact/motion.h"

#include <atomic>
#include <random>
#include <thread>

#include "gliss/contact/tracker.h"
#include "gliss/generate/generate.h"
#include "gliss/walk/walk.h"
#include "tests/oracle/oracle.h"
#include "tests/support/open_meshes.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using oracle::Rng, oracle::uniform;
using namespace std::chrono_literals;

Pose pose_of(const Vec3& place, const Vec3& axis = Vec3::UnitZ(), double angle = 0) {
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisd(angle, axis.normalized()).matrix();
  pose.translation() = place;
  return pose;
}

SceneObject moving(const Mesh& mesh) {
  return {.cache = std::make_shared<const PatchCache>(test::cache_of(mesh))};
}

TEST(Motion, goes_evenly_from_pose_to_pose) {
  const Motion motion({1, 2, 4}, {pose_of({0, 0, 0}), pose_of({1, 0, 0}, {0, 0, 1}, 1),
                                  pose_of({1, 2, 0}, {0, 0, 1}, -1)});
  EXPECT_EQ(motion.duration(), 4);
  const auto expect_at = [&](double time, const Vec3& place, double angle) {
    EXPECT_LT((motion.at(time).matrix() - pose_of(place, {0, 0, 1}, angle).matrix()).norm(), 1e-12)
        << time;
  };
  expect_at(-1, {0, 0, 0}, 0);
  expect_at(1, {0, 0, 0}, 0);
  expect_at(1.25, {0.25, 0, 0}, 0.25);
  expect_at(2, {1, 0, 0}, 1);
  expect_at(3.5, {1, 1.5, 0}, -0.5);
  expect_at(4, {1, 2, 0}, -1);
  expect_at(1e9, {1, 2, 0}, -1);
  const Motion again({0, 2}, {pose_of({0, 0, 0}), pose_of({2, 0, 0})}, true);
  EXPECT_NEAR(again.at(101.5).translation().x(), 1.5, 1e-12);
}

TEST(Motion, refuses_what_is_none_and_names_the_pose) {
  const Pose rest = Pose::Identity();
  Pose mirror = rest, stretched = rest, nan = rest;
  mirror.linear()(0, 0) = -1;
  stretched.linear() *= 1.001;
  nan.translation().x() = std::nan("");
  const auto error = [](std::vector<double> times, std::vector<Pose> poses, bool repeats = false) {
    return test::message_of<std::invalid_argument>([&] { Motion(times, poses, repeats); });
  };
  EXPECT_EQ(error({}, {}), "motion: has no pose");
  EXPECT_EQ(error({0}, {rest, rest}), "motion: as many times as poses");
  EXPECT_EQ(error({0, 1, 1}, {rest, rest, rest}),
            "motion: pose 2 is not later than the one before it");
  EXPECT_EQ(error({0, 1, 0.5}, {rest, rest, rest}),
            "motion: pose 2 is not later than the one before it");
  EXPECT_EQ(error({-1}, {rest}), "motion: pose 0 is not at 0 s or later");
  EXPECT_EQ(error({0, std::nan("")}, {rest, rest}), "motion: pose 1 is not at 0 s or later");
  for (const Pose& bad : {mirror, stretched, nan}) {
    EXPECT_EQ(error({0, 1}, {rest, bad}), "motion: pose 1 is not a rotation and translation");
    EXPECT_FALSE(is_rigid(bad));
    PoseChannel channel;
    EXPECT_FALSE(channel.publish(bad));
    EXPECT_FALSE(channel.latest().has_value());
    SceneObject object = moving(test::sheet());
    Tracker tracker({&object, 1});
    EXPECT_FALSE(tracker.move(0, bad));
    object.pose = bad;
    EXPECT_THROW(Tracker({&object, 1}), std::invalid_argument);
  }
  EXPECT_EQ(error({0}, {rest}, true), "motion: repeats a single pose");
}

TEST(PoseChannel, never_tears_a_pose) {
  PoseChannel channel;
  std::atomic<bool> stop = false;
  // The angle goes with the place.
  std::thread writer([&] {
    for (int i = 0; !stop; ++i)
      channel.publish(pose_of(Vec3::Constant(i % 1000), {1, 2, 3}, i % 1000));
  });
  int seen = 0, torn = 0;
  const auto give_up = std::chrono::steady_clock::now() + 20s;
  while (seen < 20'000 && std::chrono::steady_clock::now() < give_up) {
    const auto pose = channel.latest();
    if (!pose) continue;
    ++seen;
    const Vec3 place = pose->translation();
    torn += place != Vec3::Constant(place.x()) ||
            pose->linear() != pose_of(place, {1, 2, 3}, place.x()).linear();
  }
  stop = true;
  writer.join();
  EXPECT_GT(seen, 1000);
  EXPECT_EQ(torn, 0);
}

// A hand and an object that go together feel what they would at rest, turned.
TEST(MovingObject, feels_alike_to_a_hand_that_goes_along) {
  const Mesh mesh = test::with_normals(goldberg(4).mesh);
  SceneObject object = moving(mesh);
  object.friction = {0.5, 0.3};
  object.effects.texture = {Relief::kNoise, 5e-5, 2e-3};
  object.effects.damping = 2;
  Tracker rest({&object, 1}), ride({&object, 1});
  Rng rng(3);
  Vec3 hip(0, 0, 0.012);
  std::size_t touching = 0;
  for (int i = 0; i < 3000; ++i) {
    hip += Vec3(uniform(rng, -1e-4, 1e-4), uniform(rng, -1e-4, 1e-4),
                hip.norm() > 0.009 ? -2e-5 : 2e-5);
    const Pose pose = pose_of(Vec3(1e-3 * i, -2e-4 * i, 0), {1, 2, 3}, 0.002 * i);
    ASSERT_TRUE(ride.move(0, pose));
    const Vec3 want = rest.step(hip), got = ride.step(pose * hip);
    ASSERT_LT((pose.linear() * want - got).norm(), 2e-6) << i;
    touching += rest.touching();
  }
  EXPECT_GT(touching, 1000u);
}

// A sheet that rises to a hand at rest, slow or fast, is met on its way.
TEST(MovingObject, meets_a_hand_at_any_speed) {
  for (const double speed : {0.01, 1.0, 100.0}) {  // m/s
    for (const double lag : {0.0, 0.3, 0.7}) {     // of a tick's way
      SceneObject object = moving(test::sheet());
      Tracker tracker({&object, 1});
      const double way = speed * 1e-3;
      double depth = 0;
      for (int i = 0; depth < 2e-3 || i < 10; ++i) {
        depth = way * (i - 5 + lag);
        ASSERT_TRUE(tracker.move(0, pose_of({0, 0, depth})));
        const Vec3 force = tracker.step({1e-3, 2e-3, 0});
        EXPECT_NEAR(force.z(), 500 * std::max(0.0, depth), 1e-9) << speed << " m/s, tick " << i;
      }
    }
  }
}

TEST(MovingObject, drags_a_hand_that_rests_on_it_by_friction_and_viscosity) {
  constexpr double kSpeed = 0.02;  // m/s, a conveyor's
  for (const bool viscous : {false, true}) {
    SceneObject object = moving(test::sheet());
    if (viscous) {
      object.effects.viscosity = 3;
    } else {
      object.friction = {0.5, 0.3};
    }
    Tracker tracker({&object, 1});
    const auto step = [&](double x, double z) {
      EXPECT_TRUE(tracker.move(0, pose_of({x, 0, z})));
      return tracker.step(Vec3::Zero());
    };
    for (int i = 0; i <= 100; ++i) step(0, 2e-5 * (i - 5));
    for (int i = 0; i < 50; ++i) step(0, 1.9e-3);
    Vec3 force;
    for (int i = 1; i <= 200; ++i) {
      force = step(kSpeed * 1e-3 * i, 1.9e-3);
      if (!viscous && i == 10) {
        EXPECT_NEAR(force.x(), 500 * kSpeed * 1e-3 * i, 1e-9);
      }
    }
    EXPECT_NEAR(force.z(), 500 * 1.9e-3, 1e-9);
    EXPECT_NEAR(force.x(), viscous ? 3 * kSpeed : 0.3 * force.z(), 1e-9);
  }
}

// A hand that goes along with a conveyor, and says so, is not resisted; one that rests beside it
// is.
TEST(MovingObject, is_taken_off_a_devices_own_velocity) {
  constexpr double kSpeed = 0.02;  // m/s
  SceneObject object = moving(test::sheet());
  object.effects.viscosity = 3;
  const Pose turned = pose_of({0, 0, 0}, {0, 0, 1}, 0.7);
  Tracker along({&object, 1}), beside({&object, 1});
  Vec3 rides, rests;
  for (int i = 0; i <= 200; ++i) {
    const Vec3 way(kSpeed * 1e-3 * i, 0, 0), at(0, 0, 1e-3 - 2e-5 * std::min(i, 100));
    const Pose pose = Eigen::Translation3d(way) * turned;
    ASSERT_TRUE(along.move(0, pose) && beside.move(0, pose));
    rides = along.step(at + way, i * 1ms, Vec3(kSpeed, 0, 0));
    rests = beside.step(at, i * 1ms, Vec3::Zero());
  }
  EXPECT_LT((rides - Vec3(0, 0, 500 * 1e-3)).norm(), 1e-9);
  EXPECT_LT((rests - Vec3(3 * kSpeed, 0, 500 * 1e-3)).norm(), 1e-9);
}

TEST(MovingObject, changes_the_force_by_no_more_than_both_have_moved) {
  const Mesh mesh = test::with_normals(goldberg(4).mesh);
  SceneObject object = moving(mesh);
  Tracker tracker({&object, 1});
  Rng rng(9);
  const double size = 0.01;
  Vec3 hip(0, 0, 0.0095), last = Vec3::Zero(), place = Vec3::Zero();
  double angle = 0, most = 0;
  tracker.step({0, 0, 0.02});
  for (int i = 0; i < 20'000; ++i) {
    const Vec3 hand = 2e-5 * oracle::random_unit(rng), drift = 2e-5 * oracle::random_unit(rng);
    const double turn = uniform(rng, 0, 2e-3);
    place += drift - 0.01 * place;
    angle += turn;
    hip += hand + 0.01 * (Vec3(0, 0, 0.0095) - hip);
    ASSERT_TRUE(tracker.move(0, pose_of(place, {1, 1, 0.3}, angle)));
    const Vec3 force = tracker.step(hip);
    const double ways = 2e-5 + 2e-5 + 0.01 * place.norm() + 1e-4 + turn * size * 1.2;
    if (i > 0) most = std::max(most, (force - last).norm() / (500 * 1.3 * ways));
    last = force;
  }
  EXPECT_LE(most, 1);
  EXPECT_GT(most, 0.1);
}

// A thread's poses and a list of them do what move() does; several HIPs see the same pose.
TEST(MovingObject, follows_its_channel_and_its_motion) {
  SceneObject by_motion = moving(test::sheet());
  SceneObject by_channel = by_motion;
  by_motion.pose = pose_of({0, 0, -1e-3});
  by_motion.motion = std::make_shared<const Motion>(
      std::vector<double>{0, 1}, std::vector<Pose>{pose_of({0, 0, 0}), pose_of({0, 0, 3e-3})});
  const auto channel = std::make_shared<PoseChannel>();
  by_channel.pose = by_motion.pose;
  by_channel.poses = channel;
  const std::vector<Vec3> hips{{0, 0, 0}, {1e-3, 0, 0}};
  Tracker a({&by_motion, 1}, hips), b({&by_channel, 1}, hips);
  for (int i = 0; i <= 1200; ++i) {
    const Nanoseconds time = i * 1ms;
    EXPECT_TRUE(channel->publish(by_motion.motion->at(std::chrono::duration<double>(time).count()) *
                                 by_motion.pose));
    const Vec3 want = a.step(Vec3::Zero(), time);
    EXPECT_EQ(want, b.step(Vec3::Zero()));
    EXPECT_NEAR(want.z(), 2 * 500 * std::max(0.0, 3e-3 * std::min(1.0, 1e-3 * i) - 1e-3), 1e-9);
  }
  by_motion.poses = channel;
  EXPECT_THROW(Tracker({&by_motion, 1}), std::invalid_argument);
}

}  // namespace
}  // namespace gliss
