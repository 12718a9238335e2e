// A HIP that moves far between two ticks: contact begins where its way enters, on the side it came
// from, and stays there however deep it goes.
#include "gliss/generate/generate.h"
#include "gliss/query/contact_tracker.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using oracle::Rng, oracle::uniform;

// The contact after some ticks from one place to another, and a few there: what one tick may not
// spend, the next ones do.
Contact at_end(const PatchCache& cache, Method method, const Vec3& from, const Vec3& to,
               int ticks) {
  ContactTracker tracker(cache, test::leaping(method));
  Contact contact = tracker.tick(from);
  for (int i = 1; i <= ticks; ++i) contact = tracker.tick(from + (to - from) * i / ticks);
  for (int late = 0; late < 50 && !contact.touching; ++late) contact = tracker.tick(to);
  return contact;
}

class Crossing : public ::testing::TestWithParam<Method> {};

TEST_P(Crossing, of_a_thin_plate_keeps_the_side_it_came_from) {
  const PatchCache cache = test::cache_of(thin_plate(12, 12, 30, 0.5).mesh);
  const Vec3 middle = 0.5 * (cache.bounds().low + cache.bounds().high);
  for (const double side : {1.0, -1.0}) {
    for (const double depth : {0.1, 0.4, 1.0, 4.0}) {
      const Vec3 over = middle + Vec3(1, 2, side * 3), under = middle + Vec3(1.5, 2, -side * depth);
      const Contact contact = at_end(cache, GetParam(), over, under, 1);
      ASSERT_TRUE(contact.touching) << depth;
      EXPECT_GT(side * contact.normal.z(), 0.9);
      EXPECT_NEAR(contact.scp.z(), middle.z() + side * 0.25, 0.05);
      EXPECT_GT(side * contact.push.z(), depth);
    }
  }
}

// Aslant and far in one tick, no step on the way may be longer than the plate is thick.
TEST_P(Crossing, of_a_thin_plate_aslant_is_felt_at_any_speed) {
  const PatchCache cache = test::cache_of(thin_plate().mesh);
  Rng rng(6);
  for (int i = 0; i < 500; ++i) {
    const double side = rng() % 2 ? 1 : -1;
    const auto place = [&](double z) {
      return Vec3(uniform(rng, -10, 10), uniform(rng, -10, 10), side * z);
    };
    const Vec3 from = place(0.25 + uniform(rng, 0, 50)), to = place(0.25 - uniform(rng, 0, 5));
    const Contact contact = at_end(cache, GetParam(), from, to, 1);
    ASSERT_TRUE(contact.touching) << from.transpose() << " to " << to.transpose();
    EXPECT_GT(side * contact.normal.z(), 0.9) << from.transpose() << " to " << to.transpose();
  }
}

TEST_P(Crossing, past_a_plate_without_entering_it_is_none) {
  const PatchCache cache = test::cache_of(thin_plate(12, 12, 30, 0.5).mesh);
  const Vec3 middle = 0.5 * (cache.bounds().low + cache.bounds().high);
  for (const double height : {0.26, 0.3, 1.0}) {
    const Contact contact =
        at_end(cache, GetParam(), middle + Vec3(-20, 0, height), middle + Vec3(20, 0.3, height), 1);
    EXPECT_FALSE(contact.touching) << height;
    EXPECT_EQ(contact.push, Vec3::Zero());
  }
}

// One tick ends where three hundred short ones do, but where a contact slides far on its way: along
// a fin's ridge on smooth patches, two of three.
TEST_P(Crossing, at_any_speed_ends_in_contact_and_mostly_in_the_same) {
  const bool is_smooth = GetParam() == Method::kGregory;
  const struct {
    const char* name;
    Mesh mesh;
    double same;  // share of ways, at least
  } cases[] = {{"plate", thin_plate().mesh, 1},
               {"fin", fin().mesh, is_smooth ? 0.65 : 0.97},
               {"goldberg", goldberg(3).mesh, is_smooth ? 0.99 : 0.97}};
  for (const auto& [name, mesh, least_same] : cases) {
    const PatchCache cache = test::cache_of(mesh);
    const Box box = cache.bounds();
    const Vec3 middle = 0.5 * (box.low + box.high), half = 0.5 * (box.high - box.low);
    Rng rng(5);
    int touching = 0, same = 0, both = 0;
    constexpr int kWays = 200;
    for (int i = 0; i < kWays; ++i) {
      Vec3 from, to;
      for (int axis = 0; axis < 3; ++axis) {
        from[axis] = middle[axis] + half[axis] * uniform(rng, -1, 1);
        to[axis] = middle[axis] + 0.8 * half[axis] * uniform(rng, -1, 1);
      }
      const int out = static_cast<int>(rng() % 3);
      from[out] = middle[out] + (half[out] + 0.1 * half.norm()) * (rng() % 2 ? 1 : -1);
      const Contact fast = at_end(cache, GetParam(), from, to, 1),
                    slow = at_end(cache, GetParam(), from, to, 300);
      touching += slow.touching;
      both += fast.touching && slow.touching;
      same += fast.touching == slow.touching &&
              (!slow.touching || (fast.scp - slow.scp).norm() < 1e-3 * half.norm());
    }
    test::record(name, "{} of {} ways end in contact, {} when fast too; {} alike", touching, kWays,
                 both, same);
    EXPECT_GT(touching, kWays / 4) << name;
    // Where a way grazes a rim, or leads to a ridge, both may be right.
    EXPECT_GE(both, touching * 97 / 100) << name;
    EXPECT_GE(same, least_same * kWays) << name;
  }
}

// What one tick may not spend, the next ones do: the contact comes later.
TEST(Crossing, that_costs_too_much_for_a_tick_goes_on_in_the_next) {
  const PatchCache cache = test::paper_cache_of(fin().mesh);
  const Vec3 middle = 0.5 * (cache.bounds().low + cache.bounds().high);
  QueryOptions options;
  options.solver = Solver::kPaper;
  Rng rng(9);
  int longest = 0;
  for (int i = 0; i < 100; ++i) {
    const Vec3 to = middle + 0.1 * oracle::random_unit(rng),
               from = to + 800 * oracle::random_unit(rng);
    ContactTracker tracker(cache, options);
    tracker.tick(from);
    int ticks = 0;
    Contact contact;
    for (; ticks < 40 && !contact.touching; ++ticks) {
      contact = tracker.tick(to);
      if (contact.touching) break;
      EXPECT_LE(contact.iterations, ContactTracker::kTickEvaluations);
      EXPECT_EQ(contact.push, Vec3::Zero());
    }
    ASSERT_TRUE(contact.touching) << i;
    longest = std::max(longest, ticks);
  }
  EXPECT_GT(longest, 0);
  test::record("costly ways", "up to {} ticks late", longest);
}

INSTANTIATE_TEST_SUITE_P(Methods, Crossing,
                         ::testing::Values(Method::kGregory, Method::kShaded, Method::kFlat),
                         [](const auto& info) {
                           return std::string(info.param == Method::kGregory  ? "gregory"
                                              : info.param == Method::kShaded ? "shaded"
                                                                              : "flat");
                         });

}  // namespace
}  // namespace gliss
