// Tools that turn: HIPs fixed to a frame, whose forces make one force and one torque.
#include "gliss/base/wrench.h"

#include <cstring>
#include <random>

#include "gliss/contact/tracker.h"
#include "gliss/device/guard.h"
#include "gliss/device/replay_device.h"
#include "gliss/device/sim_device.h"
#include "gliss/generate/generate.h"
#include "gliss/loop/loop.h"
#include "gliss/scene/tool.h"
#include "tests/oracle/oracle.h"
#include "tests/support/allocations.h"
#include "tests/support/open_meshes.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using oracle::Rng, oracle::uniform;
using namespace std::chrono_literals;

constexpr double kPerMetre = 500;

SceneObject touched(const Mesh& mesh) {
  return {.cache = std::make_shared<const PatchCache>(test::cache_of(mesh)),
          .stiffness = kPerMetre};
}

Pose tool_at(const Vec3& place, const Vec3& axis = Vec3::UnitZ(), double angle = 0) {
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisd(angle, axis.normalized()).matrix();
  pose.translation() = place;
  return pose;
}

TEST(Wrench, of_a_tool_on_a_plane_is_the_exact_one) {
  const SceneObject sheet = touched(test::sheet());
  const std::vector<Vec3> hips{{2e-3, 0, 0}, {-1e-3, 2e-3, 1e-3}, {0, 0, -1e-3}, {0, 0, 5e-3}};
  Tracker tracker({&sheet, 1}, hips);
  for (int i = 0; i < 400; ++i) {
    const Pose tool = tool_at({1e-3, -1e-3, 5e-3 - 2e-5 * i}, {1, 2, 3}, 0.01 * i);
    const Wrench got = tracker.step(tool);
    Wrench want;
    for (const Vec3& hip : hips) {
      const Vec3 arm = tool.linear() * hip;
      const double depth = std::max(0.0, -(tool.translation() + arm).z());
      want.force += kPerMetre * depth * Vec3::UnitZ();
      want.torque += arm.cross(kPerMetre * depth * Vec3::UnitZ());
    }
    EXPECT_LT((got.force - want.force).norm(), 1e-10) << i;
    EXPECT_LT((got.torque - want.torque).norm(), 1e-12) << i;
  }
}

// A dumb-bell that presses on a ball from the side: the patches' sphere is exact to 2e-3.
TEST(Wrench, of_a_tool_on_a_sphere_is_nearly_the_exact_one) {
  const SceneObject ball = touched(test::with_normals(goldberg(4).mesh));
  const std::vector<Vec3> hips{{0, 0, 0}, {4e-3, 0, 0}, {-4e-3, 1e-3, 0}};
  Tracker tracker({&ball, 1}, hips);
  constexpr double kRadius = 10e-3;
  for (int i = 0; i < 200; ++i) {
    const Pose tool = tool_at({1e-3, 0, 12e-3 - 2.5e-5 * i}, {0, 1, 0}, 0.3 + 1e-3 * i);
    const Wrench got = tracker.step(tool);
    Wrench want;
    for (const Vec3& hip : hips) {
      const Vec3 arm = tool.linear() * hip, at = tool.translation() + arm;
      const Vec3 force = kPerMetre * std::max(0.0, kRadius - at.norm()) * at.normalized();
      want.force += force;
      want.torque += arm.cross(force);
    }
    const double error = kPerMetre * 3e-3 * kRadius * 3;
    EXPECT_LT((got.force - want.force).norm(), error) << i;
    EXPECT_LT((got.torque - want.torque).norm(), error * 4e-3) << i;
  }
}

// A crowd of HIPs leaps deep into a ball: no step spends more than it may, all are served in turn,
// and what is felt in the end is what a tracker of each HIP alone feels.
TEST(Wrench, of_a_crowd_of_hips_is_bounded_a_step_and_whole_soon) {
  const SceneObject ball = touched(goldberg(4).mesh);
  std::vector<Vec3> hips;
  Rng rng(7);
  for (int i = 0; i < 1500; ++i)
    hips.emplace_back(uniform(rng, -6e-3, 6e-3), uniform(rng, -6e-3, 6e-3), uniform(rng, 0, 6e-3));
  Tracker tracker({&ball, 1}, hips);
  std::vector<Tracker> alone;
  for (const Vec3& hip : hips) alone.emplace_back(std::span(&ball, 1), std::span(&hip, 1));
  Wrench crowd, sum;
  std::size_t most_waiting = 0;
  const auto step = [&](const Pose& tool) {
    std::vector<Contact> before;
    for (const ObjectStep& last : tracker.objects()) before.push_back(last.contact);
    crowd = tracker.step(tool);
    sum = {};
    std::size_t waiting = 0;
    int spent = 0;
    for (std::size_t i = 0; i < hips.size(); ++i) {
      const Wrench one = alone[i].step(tool);
      sum.force += one.force;
      sum.torque += one.torque;
      const ObjectStep& here = tracker.objects()[i];
      if (here.contact.scp != before[i].scp) spent += here.contact.iterations + 1;
      waiting += here.searched && here.contact.scp != alone[i].objects()[0].contact.scp;
    }
    EXPECT_LE(spent, Tracker::kStepEvaluations + ContactTracker::kTickEvaluations);
    most_waiting = std::max(most_waiting, waiting);
  };
  for (int i = 0; i < 30; ++i) step(tool_at({0, 0, 30e-3}));
  for (int i = 0; i < 30; ++i) step(tool_at({0, 0, 5e-3}));
  EXPECT_LT((crowd.force - sum.force).norm(), 1e-9 * sum.force.norm());
  step(tool_at({0, 0, 30e-3}));
  EXPECT_TRUE(crowd.force.isZero(0)) << "no plane is touched from outside";
  EXPECT_GT(most_waiting, 100u) << "they are too few to wait";
  const std::vector<Vec3> many(Tracker::kMostContacts + 1, Vec3::Zero());
  EXPECT_THROW(Tracker({&ball, 1}, many), std::invalid_argument);
}

TEST(Wrench, turns_with_all_and_without_a_turn_has_the_bytes_of_a_point) {
  const Mesh mesh = test::with_normals(goldberg(4).mesh);
  SceneObject object = touched(mesh);
  object.friction = {0.5, 0.3};
  const std::vector<Vec3> hips = {{1e-3, 0, 0}, {0, 2e-3, 0}, {0, 0, -1e-3}};
  const Pose all = tool_at({0.1, -0.2, 0.05}, {3, 1, -2}, 1.2);
  Tracker here({&object, 1}, hips), point({&object, 1}), turnless({&object, 1});
  SceneObject moved = object;
  moved.pose = all;
  Tracker there({&moved, 1}, hips);
  Rng rng(3);
  Vec3 hip(0, 0, 0.012);
  std::uint64_t allocations = 0;
  for (int i = 0; i < 2000; ++i) {
    hip += Vec3(uniform(rng, -1e-4, 1e-4), uniform(rng, -1e-4, 1e-4),
                hip.norm() > 0.009 ? -2e-5 : 2e-5);
    const Pose tool = tool_at(hip, {1, 1, 0}, 2e-3 * i);
    const std::uint64_t before = test::allocations();
    const Wrench want = here.step(tool), got = there.step(all * tool);
    allocations += test::allocations() - before;
    ASSERT_LT((all.linear() * want.force - got.force).norm(), 1e-6) << i;
    ASSERT_LT((all.linear() * want.torque - got.torque).norm(), 1e-8) << i;
    const Vec3 a = point.step(hip), b = turnless.step(tool_at(hip)).force;
    ASSERT_EQ(std::memcmp(a.data(), b.data(), sizeof a), 0);
  }
  EXPECT_EQ(allocations, 0u);
}

TEST(Wrench, goes_out_within_the_limits_of_its_torque) {
  const GuardLimits limits;
  Rng rng(5);
  Guard guard(limits);
  Nanoseconds now = 1s;
  Vec3 last = Vec3::Zero(), way = Vec3::UnitX();
  int limited = 0, zero = 0, ran = 0;
  for (int i = 0; i < 100'000; ++i) {
    now += 1ms;
    const double inf = std::numeric_limits<double>::infinity();
    if (i % 20 == 0) way = oracle::random_unit(rng);
    Vec3 torque = std::pow(10, uniform(rng, -3, i % 3000 < 1500 ? -1 : 3)) * way;
    if (i % 701 == 0) torque.y() = i % 2 == 0 ? std::nan("") : inf;
    if (i % 5000 < 100) torque.setZero();
    const bool late = i % 9000 > 8980;
    const GuardOutput out = guard.step(now, {Vec3(0, 0, 0.01), late ? now - 1s : now, torque});
    ASSERT_TRUE(out.torque.allFinite());
    ASSERT_LE(out.torque.norm(), limits.max_torque);
    ASSERT_LE((out.torque - last).norm(), limits.max_torque_rate * 1e-3 * (1 + 1e-9));
    if (out.state == GuardState::kSafe) {
      ASSERT_TRUE(out.torque.isZero(0));
      ++zero;
      guard.engage();
    }
    limited += out.torque.norm() > 0.99 * limits.max_torque;
    ran += out.state == GuardState::kRun;
    last = out.torque;
  }
  EXPECT_GT(limited, 1000);
  EXPECT_GT(zero, 10);
  EXPECT_GT(ran, 50'000);
  // A start with a torque does not kick either.
  Guard start(limits);
  start.step(1s, {});
  GuardLimits bad;
  bad.max_torque = 0;
  EXPECT_THROW(Guard{bad}, std::invalid_argument);
  bad = {};
  bad.max_torque_rate = 30;
  EXPECT_THROW(Guard{bad}, std::invalid_argument);
}

TEST(Wrench, lets_a_start_inside_give_no_more_than_a_share_of_its_torque) {
  const GuardLimits limits;
  Guard guard(limits);
  for (int i = 1; i < 1000; ++i) {
    const Nanoseconds now = i * 1ms;
    const GuardOutput out = guard.step(now, {Vec3(0, 0, 2), now, Vec3(1, 0, 0)});
    EXPECT_EQ(out.state, GuardState::kStart);
    EXPECT_LE(out.torque.norm(), limits.max_torque * 0.2 / 3.3);
  }
}

// The hand of the simulation turns the tool at its speed, and a torque holds it back by its angle.
TEST(Wrench, turns_the_simulated_tool_against_its_wrist) {
  SimOptions options;
  options.turning = Vec3(0, 0, 0.5);
  SimDevice device(HandPath::sampled(std::vector<Vec3>(5000, Vec3::Zero()), 1e-3), options);
  EXPECT_TRUE(device.info().has_orientation);
  const auto angle_after = [&](int from, int to, const Vec3& torque) {
    double angle = 0;
    for (int i = from; i < to; ++i) {
      const DeviceState state = device.read(1s + i * 1ms);
      EXPECT_NEAR(state.orientation.norm(), 1, 1e-12);
      angle = 2 * std::atan2(state.orientation.z(), state.orientation.w());
      EXPECT_TRUE(device.write_wrench({Vec3::Zero(), torque}, 1s + i * 1ms));
    }
    return angle;
  };
  EXPECT_NEAR(angle_after(0, 1001, Vec3::Zero()), 0.5 - 0.5 * 0.005 / 2, 2e-3);
  const double held = angle_after(1001, 2001, Vec3(0, 0, -0.2));
  EXPECT_NEAR(held, 1.0 - 0.2 / 2, 3e-3);
  EXPECT_FALSE(device.write_wrench({Vec3::Zero(), Vec3(0, std::nan(""), 0)}, 3s));
}

TEST(Wrench, comes_from_a_replay_with_orientations_through_the_loop) {
  const SceneObject sheet = touched(test::sheet());
  const std::vector<Vec3> hips{{2e-3, 0, 0}, {-2e-3, 0, 0}};
  std::vector<Vec3> path;
  std::vector<Rotation> turns;
  for (int i = 0; i < 1500; ++i) {
    path.push_back({0, 0, 2e-3 - 4e-6 * std::min(i, 800)});
    turns.emplace_back(Eigen::AngleAxisd(2e-4 * i, Vec3::UnitY()));
  }
  for (const bool has_turns : {true, false}) {
    ReplayDevice device(path, "replay", has_turns ? turns : std::vector<Rotation>{});
    Tracker tracker({&sheet, 1}, hips);
    HapticLoop loop(device, tracker, {.wait = false});
    double torque = 0, sent = 0;
    loop.run([&](const LoopTick& tick) {
      torque = std::max(torque, tick.rendered_torque.norm());
      sent = std::max(sent, tick.sent_torque.norm());
      return true;
    });
    EXPECT_EQ(torque > 1e-3, has_turns);
    EXPECT_EQ(sent > 1e-4, has_turns);
  }
  EXPECT_THROW(ReplayDevice(path, "replay", {Rotation::Identity()}), std::invalid_argument);
}

TEST(Wrench, of_a_tool_is_felt_at_points_that_are_spread_over_its_mesh) {
  const Mesh ball = goldberg(4).mesh;
  const std::vector<Vec3> points = spread_points(ball, 50);
  ASSERT_EQ(points.size(), 50u);
  double nearest = 1;
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(points[i].norm(), 10e-3, 1.3e-4);  // to the middle of a face
    for (std::size_t j = 0; j < i; ++j) nearest = std::min(nearest, (points[i] - points[j]).norm());
  }
  EXPECT_GT(nearest, 1.8e-3);  // 50 caps of the same size are 2.8 mm wide
  EXPECT_TRUE(spread_points(Mesh{}, 5).empty());
  Mesh bare = ball;
  bare.face_begin = {0};
  bare.corner_vertex.clear();
  bare.positions.insert(bare.positions.end(), ball.positions.begin(), ball.positions.end());
  EXPECT_EQ(spread_points(bare, 1000).size(), ball.positions.size());
}

// Long thin triangles have two long sides, and no more places for that.
TEST(Wrench, of_a_needle_is_spread_along_it) {
  const Mesh needle = cylinder(12, 1, 1e-3, 100).mesh;
  const std::vector<Vec3> points = spread_points(needle, 200);
  ASSERT_EQ(points.size(), 200u);
  for (int i = -49; i <= 49; ++i) {
    double nearest = 1;
    for (const Vec3& p : points) nearest = std::min(nearest, std::abs(p.z() - 1e-3 * i));
    EXPECT_LT(nearest, 0.6e-3) << i;
  }
}

// A cube of six faces has eight vertices: between them it would pass through a small ball.
TEST(Wrench, of_a_coarse_tool_is_felt_all_over_its_faces) {
  const std::vector<Vec3> points = spread_points(cube(1, 10).mesh, 200);
  ASSERT_EQ(points.size(), 200u);
  for (int i = 0; i < 600; ++i) {
    Vec3 at(i % 10 - 4.5, i / 10 % 10 - 4.5, i / 100 % 2 == 0 ? -5 : 5);
    std::rotate(at.data(), at.data() + i / 200, at.data() + 3);
    double nearest = 1;
    for (const Vec3& p : points) nearest = std::min(nearest, (p - 1e-3 * at).norm());
    EXPECT_LT(nearest, 1.3e-3) << at.transpose();
  }
}

}  // namespace
}  // namespace gliss
