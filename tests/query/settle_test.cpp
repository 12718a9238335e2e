// Contacts that slide to where a leap ends: no force leaps, no energy comes of it, and it ends.
#include <cstring>

#include "gliss/generate/generate.h"
#include "gliss/query/contact_tracker.h"
#include "gliss/query/force_statistics.h"
#include "gliss/surface/names.h"
#include "gliss/walk/fidelity.h"
#include "gliss/walk/walk.h"
#include "tests/oracle/oracle.h"
#include "tests/support/open_meshes.h"
#include "tests/support/sharp_meshes.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

QueryOptions with_settle(double settle, Method method = Method::kGregory) {
  QueryOptions options;
  options.method = method;
  options.settle = settle;
  return options;
}

std::vector<Walk> walks_on(const Mesh& mesh, double depth) {
  WalkOptions options;
  options.depth = depth;
  options.walkers = 10;
  options.ticks = std::getenv("GLISS_LONG_TESTS") ? 100'000 : 1000;
  options.seed = 3;
  return walk_paths(mesh, build_topology(mesh), options);
}

// Closed meshes on which contacts leap: thin parts, edges, corners, irregular triangles.
std::vector<Mesh> leaping_meshes() {
  std::vector<Mesh> meshes;
  for (const Generated& made : {fin(), prism(5), banana(13, 6), irregular(torus(), 7)})
    meshes.push_back(test::with_normals(made.mesh));
  return meshes;
}

PatchCache fair_cache_of(const Mesh& mesh) {
  BuildOptions options;
  options.level.construction = Construction::kFair;
  return test::unlimited_cache(mesh, options);
}

TEST(Settle, changes_no_byte_where_nothing_leaps) {
  const Generated knot = torus_knot();
  for (const Precision precision : {Precision::kDouble, Precision::kFloat}) {
    const PatchCache cache = test::cache_of(knot.mesh, precision);
    for (const double depth : {2.0, 4.0}) {
      ContactTracker plain(cache, test::leaping()), settling(cache, {});
      std::size_t touching = 0;
      for (const Vec3& hip : path_beneath(knot, 120, 12, depth, 0.05)) {
        const Contact a = plain.tick(hip), b = settling.tick(hip);
        ASSERT_EQ(a.scp, b.scp);
        ASSERT_EQ(a.push, b.push);
        ASSERT_EQ(a.flags, b.flags);
        ASSERT_EQ(a.iterations, b.iterations);
        touching += b.touching;
      }
      EXPECT_GT(touching, 1000u);
    }
  }
}

// A hand that finds itself deep inside has paid for nothing: its push begins at zero, grows as it
// presses on and falls as it goes back, and is never more than that way. Outside it is free again.
TEST(Settle, lets_a_contact_that_begins_deep_push_as_far_as_the_hand_has_pressed) {
  constexpr double kDeep = 4, kStep = 0.01;  // mm
  const Generated ball = goldberg(4, 10);
  const PatchCache cache = fair_cache_of(test::with_normals(ball.mesh));
  const Vec3 out = Vec3(0.3, 0.5, 0.8).normalized();
  for (const Method method : {Method::kGregory, Method::kFlat}) {
    ContactTracker tracker(cache, with_settle(5e-3, method));
    double depth = kDeep;
    tracker.release((10 - depth) * out, 0);
    const auto go = [&](double to) {
      Contact contact;
      const int ticks = static_cast<int>(std::lround(std::abs(to - depth) / kStep));
      for (int i = 0; i < ticks; ++i) {
        depth += to > depth ? kStep : -kStep;
        const Contact next = tracker.tick((10 - depth) * out);
        EXPECT_LE(next.push.norm(), std::max(0.0, depth - kDeep) + 2 * kStep);
        contact = next;
      }
      depth = to;
      return contact;
    };
    Contact contact = tracker.tick((10 - depth) * out);
    EXPECT_TRUE(contact.touching);
    EXPECT_TRUE(is_settling(contact.flags));
    EXPECT_LE(contact.push.norm(), 1e-9);
    contact = go(kDeep + 1);
    EXPECT_NEAR(contact.push.norm(), 1, 0.02);
    EXPECT_GT(contact.push.dot(out), 0.99 * contact.push.norm());
    EXPECT_LE(go(kDeep + 0.02).push.norm(), 0.05);
    EXPECT_LE(go(1).push.norm(), 2 * kStep);
    contact = go(-0.5);
    EXPECT_FALSE(contact.touching);
    for (int i = 0; i < 150; ++i) contact = tracker.tick((10.5 - 0.01 * i) * out);
    EXPECT_FALSE(is_settling(contact.flags));
    EXPECT_NEAR(contact.push.norm(), 1, 0.2);
  }
}

// Jumps and losses by the force held lately: a surface may lie farther from its polygons, whose
// depth a walk keeps, than the walk is deep.
ForceStatistics feel(const PatchCache& cache, const QueryOptions& options,
                     const std::vector<Walk>& walks) {
  ForceStatistics all;
  for (const Walk& walk : walks) {
    ContactTracker tracker(cache, options);
    ForceStatistics felt;
    for (const Vec3& hip : walk.hips) {
      const Contact contact = tracker.tick(hip);
      felt.add(contact.touching, contact.push, is_settling(contact.flags));
    }
    all.merge(felt);
  }
  return all;
}

TEST(Settle, lets_no_force_leap_with_any_method) {
  for (const Method method : {Method::kGregory, Method::kShaded, Method::kFlat}) {
    std::size_t leaps = 0;
    for (const Mesh& mesh : leaping_meshes()) {
      const PatchCache cache = fair_cache_of(mesh);
      const std::vector<Walk> walks = walks_on(mesh, 4 * walk_depth(mesh));
      const ForceStatistics leaping = feel(cache, with_settle(0, method), walks);
      const ForceStatistics settling = feel(cache, with_settle(5e-3, method), walks);
      leaps += leaping.jumps();
      EXPECT_EQ(leaping.settling, 0u);
      EXPECT_EQ(settling.jumps(), 0u) << mesh.source;
      EXPECT_EQ(settling.lost, 0u) << mesh.source;
      if (method == Method::kGregory) {
        EXPECT_LT(settling.settling_share(), 0.05) << mesh.source;
      }
    }
    EXPECT_GT(leaps, 0u);
  }
}

// With the contact point held while the HIP moves, the work of the hand is the change of k q^2 / 2
// but for k |dx|^2 / 2 of a force that is held for a tick. Then the point may only come nearer.
TEST(Settle, takes_energy_and_gives_none) {
  for (const Method method : {Method::kGregory, Method::kFlat}) {
    std::size_t settling = 0;
    for (const Mesh& mesh : leaping_meshes()) {
      const PatchCache cache = test::cache_of(mesh, Precision::kDouble);
      const double depth = 4 * walk_depth(mesh);
      for (const Walk& walk : walks_on(mesh, depth)) {
        ContactTracker tracker(cache, with_settle(5e-3, method));
        Contact last = tracker.tick(walk.hips[0]);
        for (std::size_t i = 1; i < walk.hips.size(); ++i) {
          const Contact now = tracker.tick(walk.hips[i]);
          if (last.touching && is_settling(now.flags)) {
            const Vec3 held = last.push - (walk.hips[i] - walk.hips[i - 1]);
            EXPECT_LE(now.push.norm(), held.norm() + 1e-9 * depth) << mesh.source;
            ++settling;
          }
          last = now;
        }
      }
    }
    EXPECT_GT(settling, 100u);
  }
}

// ... or where the push is as long as the hand has paid for, short of a nearest point.
TEST(Settle, ends_at_a_nearest_point_once_the_hand_rests) {
  std::size_t slides = 0, short_ones = 0;
  for (const Mesh& mesh : leaping_meshes()) {
    const PatchCache cache = test::cache_of(mesh, Precision::kDouble);
    const double depth = 4 * walk_depth(mesh);
    for (const Walk& walk : walks_on(mesh, depth)) {
      ContactTracker tracker(cache, with_settle(5e-3));
      bool was_settling = false;
      for (const Vec3& hip : walk.hips) {
        const bool settles = is_settling(tracker.tick(hip).flags);
        if (settles && !was_settling) {
          ContactTracker resting = tracker;
          int ticks = 0;
          Contact contact = resting.tick(hip);
          for (; is_settling(contact.flags) && ticks < 20000; ++ticks) contact = resting.tick(hip);
          // What is left of the way may take more iterations than a tick has.
          for (int i = 0; i < 40; ++i) contact = resting.tick(hip);
          const bool is_short = contact.push.norm() < (1 - 1e-6) * std::abs(contact.distance);
          EXPECT_EQ(is_settling(contact.flags), is_short);
          EXPECT_TRUE(contact.flags & kConverged);
          EXPECT_LT((resting.tick(hip).push - contact.push).norm(), 1e-9 * depth);
          short_ones += is_short;
          ++slides;
        }
        was_settling = settles;
      }
    }
  }
  EXPECT_GE(slides, 10 * short_ones);
  EXPECT_GT(slides, 0u);
}

TEST(Settle, fades_a_force_whose_contact_ends_and_keeps_the_budget_of_a_tick) {
  oracle::Rng rng(9);
  for (const Mesh& mesh : {test::sheet(1.5), fin().mesh, thin_plate().mesh, goldberg(2).mesh}) {
    const PatchCache cache = test::cache_of(test::with_normals(mesh), Precision::kFloat);
    const Box box = cache.bounds();
    const Vec3 middle = 0.5 * (box.low + box.high);
    const double size = (box.high - box.low).norm();
    ContactTracker tracker(cache, with_settle(5e-3));
    Vec3 hip = middle, last = Vec3::Zero();
    std::size_t fading = 0;
    for (int i = 0; i < 3000; ++i) {
      const Vec3 next = i % 40 == 0 ? Vec3(middle + 0.6 * size * oracle::random_unit(rng))
                                    : Vec3(hip + 1e-3 * size * oracle::random_unit(rng));
      const Contact contact = tracker.tick(next);
      EXPECT_LE(contact.iterations, ContactTracker::kTickEvaluations);
      EXPECT_EQ(contact.touching, tracker.touching());
      if (i > 0) {
        EXPECT_LE((contact.push - last).norm(),
                  2 * (next - hip).norm() +
                      0.04 * std::max({last.norm(), contact.push.norm(),
                                       0.5 * std::abs(contact.distance)}) +
                      1e-6 * size);
      }
      fading += contact.touching && contact.distance > 0;
      last = contact.push;
      hip = next;
    }
    RecordProperty("fading", static_cast<int>(fading));
  }
}

// A finger that slides off over an edge: its force grows no more, turns nowhere, and is gone in
// time, however fast it goes on.
TEST(Settle, lets_go_of_a_hand_that_leaves_over_an_edge) {
  constexpr double kDepth = 0.5, kBegin = 9;  // mm
  for (const Mesh& mesh :
       {test::with_creases(cube(1, 20).mesh), test::with_normals(cube(1, 20).mesh)}) {
    const PatchCache cache = fair_cache_of(mesh);
    const Box box = cache.bounds();
    const double top = box.high.z() - kDepth;
    for (const Method method : {Method::kGregory, Method::kShaded, Method::kFlat}) {
      for (const double settle : {5e-3, 20e-3}) {
        for (const double pace : {0.005, 0.05, 0.2}) {  // mm a tick
          ContactTracker tracker(cache, with_settle(settle, method));
          tracker.tick({kBegin, 1, top + 5});
          Contact last = tracker.tick({kBegin, 1, top});
          for (int i = 0; i < 1000; ++i) last = tracker.tick({kBegin, 1, top});
          ASSERT_TRUE(last.touching);
          ASSERT_FALSE(is_settling(last.flags));
          int outside = 0;
          double x = kBegin, largest = last.push.norm();
          for (; x < box.high.x() + 20; x += pace) {
            const Contact now = tracker.tick({x, 1, top});
            EXPECT_LT((now.push - last.push).norm(), 2 * pace + 0.2 * largest);
            if (x > box.high.x()) {
              EXPECT_LE(now.push.norm(), last.push.norm() * (1 + 1e-9));
              outside += now.touching;
            } else {
              largest = std::max(largest, now.push.norm());
            }
            last = now;
          }
          EXPECT_LE(outside, 5e3 * settle + 1) << method_name(method) << " " << pace;
          EXPECT_FALSE(last.touching);
        }
      }
    }
  }
}

// A hand that is pushed through a ball, centrally or not, and rests behind it, is free at once
// without settle, and 5 x settle after it has come out with it.
TEST(Settle, lets_go_of_a_hand_that_goes_through_a_ball) {
  const PatchCache cache = fair_cache_of(test::with_normals(goldberg(4, 10).mesh));
  for (const double settle : {0.0, 5e-3, 20e-3}) {
    const int bound = static_cast<int>(std::lround(5e3 * settle)) + 1;
    for (const double friction : {0.0, 0.5}) {
      for (const double aside : {0.0, 0.2, 3.0}) {
        for (const double pace : {0.05, 0.5, 4.0}) {  // mm a tick
          QueryOptions options = with_settle(settle);
          options.friction = {friction, 0.6 * friction};
          ContactTracker tracker(cache, options);
          int outside = 0;
          Contact contact;
          for (double x = 15; outside <= bound; x = std::max(-60.0, x - pace)) {
            const Vec3 hip(x, aside, 0);
            contact = tracker.tick(hip);
            outside += x < 0 && hip.norm() > 10.05;
          }
          EXPECT_FALSE(contact.touching)
              << settle << " s, friction " << friction << ", " << aside << ", " << pace;
          EXPECT_EQ(contact.push, Vec3::Zero());
        }
      }
    }
  }
}

// A hand that goes to and fro through a ball and the open, up to half of its size a tick: a contact
// that fades asks for nothing, and may have no energy left.
TEST(Settle, keeps_pushes_finite_wherever_a_hand_goes) {
  const PatchCache cache = test::cache_of(goldberg().mesh);
  oracle::Rng rng(1);
  for (const Method method : {Method::kGregory, Method::kShaded, Method::kFlat}) {
    ContactTracker tracker(cache, with_settle(5e-3, method));
    Vec3 hip(20, 0, 0);
    for (int i = 0; i < 100'000; ++i) {
      hip += oracle::uniform(rng, 0, 8) * oracle::random_unit(rng);
      if (hip.norm() > 25) hip *= 0.9;
      ASSERT_TRUE(tracker.tick(hip).push.allFinite()) << method_name(method) << " " << i;
    }
  }
}

TEST(Settle, leaves_a_hip_without_number_alone) {
  const Mesh mesh = test::with_normals(prism(5).mesh);
  const PatchCache cache = test::cache_of(mesh, Precision::kDouble);
  ContactTracker tracker(cache, with_settle(5e-3));
  const Vec3 inside = 0.5 * (cache.bounds().low + cache.bounds().high);
  const Contact before = tracker.tick(inside);
  ASSERT_TRUE(before.touching);
  EXPECT_FALSE(tracker.tick(Vec3::Constant(std::nan(""))).touching);
  EXPECT_LT((tracker.tick(inside).push - before.push).norm(), 1e-9);
}

}  // namespace
}  // namespace gliss
