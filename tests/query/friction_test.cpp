// Friction: a contact point that stays within a cone, and else slips. It holds, breaks away and
// slips where Coulomb's law says, makes no energy, and steps no further than it must.
#include "gliss/query/friction.h"

#include <cstring>
#include <random>

#include "gliss/generate/generate.h"
#include "gliss/query/contact_tracker.h"
#include "gliss/query/trace.h"
#include "gliss/surface/names.h"
#include "gliss/walk/walk.h"
#include "tests/oracle/oracle.h"
#include "tests/oracle/union_oracle.h"
#include "tests/support/lazy_tracker.h"
#include "tests/support/open_meshes.h"
#include "tests/support/sharp_meshes.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using oracle::Rng, oracle::uniform;

constexpr Method kEveryMethod[] = {Method::kGregory, Method::kShaded, Method::kFlat};
constexpr double kStiff = 0.5;  // N/mm: forces of pushes in mm

QueryOptions with_friction(double at_rest, double slipping, double settle = 5e-3,
                           Method method = Method::kGregory) {
  QueryOptions options;
  options.method = method;
  options.settle = settle;
  options.friction = {at_rest, slipping};
  return options;
}

// The tangential part of a contact's force on the flat sheet, N.
Vec3 drag_of(const Contact& contact) {
  return kStiff * Vec3(contact.push.x(), contact.push.y(), 0);
}

// A sheet of 20 mm beneath which a HIP is pressed straight down to 2 mm, which is 1 N.
class FrictionOnSheet {
 public:
  explicit FrictionOnSheet(const QueryOptions& options)
      : cache_(test::cache_of(test::sheet())), tracker_(cache_, options) {}

  Contact press(const Vec3& at) {
    for (double z = 0.5625; z > -2; z -= 0.125) tracker_.tick({at.x(), at.y(), z});
    return tick(at.x(), at.y());
  }
  Contact tick(double x, double y = 0) { return tracker_.tick({x, y, -2}); }
  double cone_share() const { return tracker_.cone_share(); }
  bool change(const FrictionOptions& friction) { return tracker_.set_friction(friction); }

 private:
  PatchCache cache_;
  ContactTracker tracker_;
};

TEST(Friction, breaks_away_at_the_static_limit_and_slips_at_the_dynamic_one) {
  constexpr double kStep = 0.005;  // mm a tick, 5 mm/s
  const Vec3 way = Vec3(1, 0.3, 0).normalized();
  for (const Method method : kEveryMethod) {
    for (const double settle : {0.0, 5e-3}) {
      FrictionOnSheet sheet(with_friction(0.5, 0.3, settle, method));
      EXPECT_LT(drag_of(sheet.press({-7, -1, 0})).norm(), 1e-12);
      double most = 0;
      bool slips = false;
      for (int i = 1; i < 2000; ++i) {
        const Contact contact = sheet.tick(-7 + i * kStep * way.x(), -1 + i * kStep * way.y());
        const Vec3 drag = drag_of(contact);
        ASSERT_NEAR(contact.push.z(), 2, 1e-12);
        EXPECT_LT(oracle::angle<double>(drag, -way), 1e-6);
        slips = slips || is_slipping(contact.flags);
        EXPECT_EQ(is_slipping(contact.flags), slips);
        if (slips) {
          EXPECT_NEAR(drag.norm(), 0.3, 1e-9);
          EXPECT_NEAR(sheet.cone_share(), 0.6, 1e-9);
        } else {
          EXPECT_NEAR(drag.norm(), kStiff * i * kStep, 1e-9);
          EXPECT_NEAR(sheet.cone_share(), drag.norm() / 0.5, 1e-9);
          most = drag.norm();
        }
      }
      EXPECT_TRUE(slips);
      EXPECT_NEAR(most, 0.5, kStiff * kStep + 1e-12);
      EXPECT_LE(most, 0.5 + 1e-12);
    }
  }
}

TEST(Friction, takes_its_settling_time_from_the_static_to_the_dynamic_limit) {
  constexpr double kStep = 0.005, kTicks = 2;
  QueryOptions options = with_friction(0.5, 0.3);
  options.friction.settle = 1e-3 * kTicks;
  FrictionOnSheet sheet(options);
  sheet.press({-7, 0, 0});
  int slipped = 0;
  for (int i = 1; i < 1000; ++i) {
    const Contact contact = sheet.tick(-7 + i * kStep);
    if (!is_slipping(contact.flags)) continue;
    ++slipped;
    EXPECT_NEAR(drag_of(contact).norm(), 0.3 + 0.2 * std::exp(-slipped / kTicks), 1e-9);
  }
  EXPECT_GT(slipped, 500);
}

TEST(Friction, changes_in_contact_to_the_cone_that_it_is_given) {
  for (const double settle : {0.0, 5e-3}) {
    FrictionOnSheet sheet(with_friction(0.5, 0.3, settle));
    sheet.press({-7, 0, 0});
    const auto drag = [&] { return drag_of(sheet.tick(-6.2)).norm(); };
    EXPECT_NEAR(drag(), 0.4, 1e-9);  // at rest, 0.8 mm behind
    EXPECT_TRUE(sheet.change({0.6, 0.5}));
    EXPECT_NEAR(drag_of(sheet.tick(-5.9)).norm(), 0.55, 1e-9);  // it would have slipped
    EXPECT_NEAR(drag(), 0.4, 1e-9);
    EXPECT_TRUE(sheet.change({0.2, 0.1}));  // it slips, and rests within the new cone
    for (int i = 0; i < 50; ++i) drag();
    EXPECT_NEAR(drag(), 0.1, 1e-9);
    for (const FrictionOptions& none :
         {FrictionOptions{-1, -1}, FrictionOptions{0.1, 0.2}, FrictionOptions{6, 1}}) {
      EXPECT_FALSE(sheet.change(none));
      EXPECT_NEAR(drag(), 0.1, 1e-9);
    }
    EXPECT_TRUE(sheet.change({}));  // it slides to where it belongs
    for (int i = 0; i < 200; ++i) drag();
    EXPECT_NEAR(drag(), 0, 1e-9);
    EXPECT_FALSE(is_slipping(sheet.tick(-6.3).flags));
    EXPECT_TRUE(sheet.change({0.5, 0.3, 2e-3}));
    drag();  // from here on it has friction
    EXPECT_NEAR(drag_of(sheet.tick(-5.8)).norm(), 0.2, 1e-9);
    EXPECT_NEAR(drag_of(sheet.tick(-5.1)).norm(), 0.3 + 0.2 * std::exp(-0.5), 1e-9);
  }
}

TEST(Friction, holds_its_point_bit_for_bit_under_noise) {
  const Generated knot = torus_knot();
  const PatchCache cache = test::cache_of(knot.mesh);
  ContactTracker tracker(cache, with_friction(0.5, 0.3));
  const ExactSurface::Point above = knot.exact->nearest(knot.mesh.positions[300]);
  const Vec3 aside = above.normal.unitOrthogonal();
  Contact held;
  for (double height = 1; height > -2; height -= 0.05)
    held = tracker.tick(above.position + height * above.normal);
  const Vec3 rest = above.position - 2 * above.normal;
  for (double lag = 0; lag < 0.78 * 0.5 * 2; lag += 0.005) held = tracker.tick(rest + lag * aside);
  const Vec3 at = rest + 0.78 * 0.5 * 2 * aside;
  held = tracker.tick(at);
  EXPECT_NEAR(tracker.cone_share(), 0.78, 0.02);
  std::mt19937_64 rng(1);
  std::normal_distribution<double> noise(0, 0.005);
  const int ticks = 1'000'000;
  int moved = 0;
  for (int i = 0; i < ticks; ++i) {
    const Contact now = tracker.tick(at + Vec3(noise(rng), noise(rng), noise(rng)));
    moved += now.at.face != held.at.face || now.at.xi != held.at.xi || now.at.eta != held.at.eta ||
             now.scp != held.scp || is_slipping(now.flags);
  }
  EXPECT_EQ(moved, 0);
}

// The work that a round of going to and fro takes from the hand, J: the force of the trapezoid.
double work_of_round(FrictionOnSheet& sheet, double amplitude) {
  constexpr int kTicks = 4000;
  double work = 0, last_x = 0;
  Vec3 last = drag_of(sheet.tick(0));
  for (int round = 0; round < 3; ++round) {
    work = 0;
    for (int i = 1; i <= kTicks; ++i) {
      const double turn = 4.0 * i / kTicks;  // 0 to 1 to -1 to 0
      const double x = amplitude * (turn < 1 ? turn : turn < 3 ? 2 - turn : turn - 4);
      const Vec3 now = drag_of(sheet.tick(x));
      work -= 0.5 * (last + now).x() * (x - last_x) * 1e-3;
      last = now;
      last_x = x;
    }
  }
  return work;
}

TEST(Friction, takes_no_work_within_the_cone_and_coulombs_beyond_it) {
  for (const Method method : kEveryMethod) {
    constexpr double kForce = 1, kMu = 0.3, kStop = kMu * kForce / kStiff;  // N, mm
    FrictionOnSheet inside(with_friction(kMu, kMu, 5e-3, method));
    inside.press({0, 0, 0});
    EXPECT_LT(std::abs(work_of_round(inside, 0.1)), 1e-15);
    FrictionOnSheet beyond(with_friction(kMu, kMu, 5e-3, method));
    beyond.press({0, 0, 0});
    const double want = 4 * kMu * kForce * (2 - kStop) * 1e-3;
    EXPECT_NEAR(work_of_round(beyond, 2), want, 0.01 * want);
    // At each turn the spring goes on to the static limit.
    FrictionOnSheet sticky(with_friction(0.5, kMu, 5e-3, method));
    sticky.press({0, 0, 0});
    const double more = want + std::pow(0.2 * kForce, 2) / kStiff * 1e-3;
    EXPECT_NEAR(work_of_round(sticky, 2), more, 0.01 * more);
  }
}

// Random ways beneath a mesh, as walks go, with turns and pauses.
std::vector<Walk> ways_on(const Mesh& mesh, double depth, double step = 0.05) {
  WalkOptions options;
  options.depth = depth;
  options.step = step;
  options.walkers = 10;
  options.ticks = std::getenv("GLISS_LONG_TESTS") ? 100'000 : 1000;
  options.seed = 5;
  return walk_paths(mesh, build_topology(mesh), options);
}

// k |push|^2 / 2, and the potential of a rim; J.
double energy_of(const PatchCache& cache, const Contact& contact, const Vec3& hip) {
  if (!contact.touching) return 0;
  const bool on_rim = (contact.flags & kOnBorder) && !is_settling(contact.flags);
  const double twice = on_rim ? contact.push.dot(contact.scp - hip) : contact.push.squaredNorm();
  return 0.5 * 1e3 * kStiff * twice * cache.unit * cache.unit;
}

struct FrictionEnergy {
  double excess = 0;  // of W + E over where it began, the error of held forces taken out, J
  double given = 0;   // the most work that a hand got back beyond what it put in, J
  std::size_t slips = 0, ticks = 0;
};

// The force is held for a tick, of which k |dx|^2 / 2 is the error; 5 / 3 of that on a rim.
FrictionEnergy energy_on(const PatchCache& cache, const QueryOptions& options,
                         const std::vector<Walk>& ways) {
  FrictionEnergy found;
  const double k = 1e3 * kStiff * cache.unit * cache.unit;
  for (const Walk& way : ways) {
    ContactTracker tracker(cache, options);
    Contact last = tracker.tick(way.hips[0]);
    double sum = 0, least = 0, given = 0;
    for (std::size_t i = 1; i < way.hips.size(); ++i) {
      const Vec3 dx = way.hips[i] - way.hips[i - 1];
      const Contact now = tracker.tick(way.hips[i]);
      const bool on_rim = ((now.flags | last.flags) & kOnBorder) != 0;
      const double error = (on_rim ? 5.0 / 6 : 0.5) * k * dx.squaredNorm();
      const double made = k * last.push.dot(dx) + energy_of(cache, now, way.hips[i]) -
                          energy_of(cache, last, way.hips[i - 1]) - error;
      sum += made;
      given += k * last.push.dot(dx) - error;
      found.given = std::max(found.given, given);
      found.excess = std::max(found.excess, sum - least);
      least = std::min(least, sum);
      found.slips += is_slipping(now.flags);
      ++found.ticks;
      last = now;
    }
  }
  return found;
}

Mesh friction_plates() {
  const Mesh plate = test::with_normals(thin_plate(6, 6, 30, 3).mesh);
  return test::joined({plate, test::moved(plate, Vec3(11, 7, 1.1))});
}

// An L of cubes of 20 mm, whose concave edge is a crease.
Mesh friction_l() {
  Mesh mesh = test::l_solid();
  for (Vec3& p : mesh.positions) p *= 20;
  mesh.unit = 1e-3;
  return mesh;
}

struct FrictionMesh {
  const char* name;
  Mesh mesh;
};

std::vector<FrictionMesh> closed_meshes_to_rub() {
  std::vector<FrictionMesh> all;
  all.push_back({"knot", torus_knot(60, 8).mesh});
  all.push_back({"cube with creases", test::with_creases(test::with_normals(cube(2, 20).mesh))});
  all.push_back({"L with creases", test::with_creases(test::with_normals(friction_l()))});
  all.push_back({"irregular torus", test::with_normals(irregular(torus(), 7).mesh)});
  all.push_back({"fin", test::with_normals(fin().mesh)});
  all.push_back({"plates", friction_plates()});
  return all;
}

TEST(Friction, makes_no_energy) {
  for (const FrictionMesh& made : closed_meshes_to_rub()) {
    const PatchCache cache = test::cache_of(made.mesh);
    const std::vector<Walk> ways = ways_on(made.mesh, 4 * walk_depth(made.mesh));
    for (const Method method : {Method::kGregory, Method::kFlat}) {
      double excess = 0;
      for (const double settle : {5e-3, 0.0}) {
        for (const double mu : {0.3, 1.5}) {
          const FrictionEnergy found =
              energy_on(cache, with_friction(1.5 * mu, mu, settle, method), ways);
          EXPECT_LE(found.excess, 1e-12) << made.name << ", " << method_name(method);
          EXPECT_LT(100 * found.slips, 99 * found.ticks);
          EXPECT_GT(found.slips, 100u);
          excess = std::max(excess, found.excess);
        }
      }
      test::record(fmt::format("{}, {}", made.name, method_name(method)),
                   "{:.1e} J of energy from nothing", excess);
    }
  }
}

// Friction and a rim give a hand that has come from the open no more than it has put in. The
// potential of a rim is not exact where its border is curved.
TEST(Friction, gives_on_rims_what_the_hand_has_put_in) {
  for (const Mesh& mesh : {test::open_strip(), test::sheet(1.5), test::sheet(0)}) {
    const PatchCache cache = test::cache_of(mesh);
    const double depth = 4 * walk_depth(mesh);
    const std::vector<Walk> ways = ways_on(mesh, depth);
    for (const double settle : {5e-3, 0.0}) {
      for (const double mu : {0.3, 0.5, 1.5}) {
        const FrictionEnergy found = energy_on(cache, with_friction(1.5 * mu, mu, settle), ways);
        EXPECT_LE(found.given, 1e-12) << mesh.source << ", mu " << mu << ", settle " << settle;
        EXPECT_GT(found.slips, 100u);
      }
    }
  }
}

class SharedFriction : public test::SharedTest {};

TEST_F(SharedFriction, makes_no_energy) {
  for (const char* name : {"meshes/molar_ngon", "meshes/hand_webxr", "meshes/goathead"}) {
    const Mesh mesh = test::with_normals(test::load_shared(name));
    const PatchCache cache = test::cache_of(mesh);
    const std::vector<Walk> ways = ways_on(mesh, walk_depth(mesh));
    double excess = 0, spring = 0.5 * 1e3 * kStiff * std::pow(walk_depth(mesh) * cache.unit, 2);
    for (const double mu : {0.3, 1.5}) {
      const FrictionEnergy found = energy_on(cache, with_friction(1.5 * mu, mu), ways);
      excess = std::max(excess, found.excess);
      EXPECT_GT(found.slips, 100u) << name;
    }
    EXPECT_LE(excess, 1e-10 * spring) << name;
    test::record(name, "{:.1e} J of energy from nothing, of {:.1e} J", excess, spring);
  }
}

// The change of the push over the HIP's way, at most, on a rim with friction.
double rim_bend(double mu) { return 1 + 0.5 * std::pow(1 + std::min(mu, 0.5), 4); }

// How a step of the push compares with what the hand moves it by, |dx| (1 + mu) or as a rim does,
// and `drops` drops from the static to the dynamic limit, of the larger press of the two ticks.
struct FrictionSteps {
  double most = 0;  // of the bound
  std::size_t slips = 0, ends = 0;

  void add(const Contact& last, const Contact& now, double way, const FrictionOptions& friction,
           bool has_rim, double drops) {
    slips += is_slipping(now.flags);
    ends += last.touching && !now.touching;
    if (!last.touching || !now.touching) return;
    const auto press_of = [](const Contact& c) { return c.push.dot(c.normal); };
    const double press = std::max(press_of(last), press_of(now)),
                 rate = std::max(1 + friction.at_rest, has_rim ? rim_bend(friction.slipping) : 0),
                 bound = way * rate + drops * (friction.at_rest - friction.slipping) * press;
    most = std::max(most, (now.push - last.push).norm() / bound);
  }
};

template <class Tick>
FrictionSteps steps_along(const std::vector<Vec3>& way, const FrictionOptions& friction, Tick tick,
                          bool has_rim = false, double drops = 1) {
  FrictionSteps found;
  Contact last = tick(way[0]);
  for (std::size_t i = 1; i < way.size(); ++i) {
    const Contact now = tick(way[i]);
    found.add(last, now, (way[i] - way[i - 1]).norm(), friction, has_rim, drops);
    last = now;
  }
  return found;
}

std::vector<Vec3> lines_through(const std::vector<Vec3>& points) {
  constexpr double kStep = 0.02;  // mm
  std::vector<Vec3> way;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vec3 d = points[i] - points[i - 1];
    const int steps = static_cast<int>(std::ceil(d.norm() / kStep));
    for (int k = 0; k < steps; ++k) way.push_back(points[i - 1] + k * d / steps);
  }
  return way;
}

struct FrictionWay {
  const char* over;
  Mesh mesh;
  std::vector<Vec3> way;
  bool has_rim = false;
  double drops = 1;
};

std::vector<FrictionWay> ways_to_rub() {
  const Generated knot = torus_knot();
  const std::vector<Vec3> round = path_beneath(knot, 120, 12, 2, 0.05);
  const Mesh sheet = test::sheet();
  std::vector<FrictionWay> all;
  all.push_back({"edges", knot.mesh, {round.begin(), round.begin() + 5000}});
  all.push_back({"edges, to and fro", knot.mesh,
                 lines_through({1.1 * round[0], round[0], round[60], round[0], round[200],
                                round[100], round[300]})});
  all.push_back({"a concave crease", test::with_creases(test::with_normals(friction_l())),
                 lines_through({{30, 22, 8},
                                {30, 18, 8},
                                {22, 18, 8},
                                {18.5, 18.5, 9},
                                {18, 25, 9},
                                {18, 35, 9},
                                {18, 18.2, 9},
                                {28, 18, 9}})});
  all.push_back({"a border and back", sheet,
                 lines_through({{0, 1, 1.01}, {0, 1, -2}, {8, 1, -2}, {12.5, 2, -2}, {6, 1, -2}}),
                 true});
  // There the point cannot follow across the border, and lets go of more along it.
  all.push_back({"beyond a border, along it", sheet,
                 lines_through({{0, 1, 1.01},
                                {0, 1, -2},
                                {10.3, 1, -2},
                                {10.3, 6, -2},
                                {10.3, 1, -2},
                                {10.8, 6, -2},
                                {10.3, 1, -2},
                                {11.8, 6, -2},
                                {10.3, 1, -2},
                                {8, 1, -2}}),
                 true, 2});
  return all;
}

TEST(Friction, steps_by_no_more_than_the_hand_and_the_drop) {
  for (const FrictionWay& path : ways_to_rub()) {
    const PatchCache cache = test::cache_of(path.mesh);
    double most = 0;
    for (const double settle : {0.0, 5e-3}) {
      for (const double mu : {0.001, 0.1, 0.3, 0.5}) {
        const QueryOptions options = with_friction(mu, 0.6 * mu, settle);
        ContactTracker tracker(cache, options);
        const FrictionSteps found = steps_along(
            path.way, options.friction, [&](const Vec3& hip) { return tracker.tick(hip); },
            path.has_rim, path.drops);
        EXPECT_LE(found.most, 1 + 1e-9) << path.over << ", mu " << mu << ", settle " << settle;
        EXPECT_EQ(found.ends, 0u) << path.over;
        EXPECT_GT(found.slips, 300u);
        most = std::max(most, found.most);
      }
    }
    test::record(fmt::format("over {}", path.over), "{:.2f} of the bound", most);
  }
}

// The sheet ends at x = 10: 0.3 mm beyond, 2 mm deep, the border holds so much of the cone.
TEST(Friction, has_along_a_border_what_the_border_leaves_of_the_cone) {
  for (const Method method : kEveryMethod) {
    FrictionOnSheet sheet(with_friction(0.5, 0.3, 0, method));
    sheet.press({5, -8, 0});
    for (double x = 5; x < 10.3; x += 0.01) sheet.tick(x, -8);
    Contact contact;
    for (double y = -8; y < 3; y += 0.01) contact = sheet.tick(10.3, y);
    EXPECT_TRUE(is_slipping(contact.flags));
    EXPECT_NEAR(contact.push.x(), -0.3, 1e-9);
    EXPECT_NEAR(contact.push.y(), -std::sqrt(0.6 * 0.6 - 0.3 * 0.3), 1e-6);
  }
}

TEST(Friction, lets_go_past_a_border_without_a_force) {
  constexpr double kStep = 0.01, kDepth = 2;
  for (const double mu : {0.001, 0.1, 0.3, 0.5, 2.0}) {
    FrictionOnSheet sheet(with_friction(mu, mu, 0));
    Contact last = sheet.press({4, 1, 0});
    double x = 4;
    for (; last.touching && x < 20; x += kStep) {
      const Contact now = sheet.tick(x, 1);
      const double most = rim_bend(mu) * kStep + 1e-9, step = (now.push - last.push).norm();
      // A coefficient above 1/2 drops to that at the border.
      EXPECT_LE(mu <= 0.5 ? step : 0, most) << mu;
      EXPECT_LE(now.touching ? 0 : last.push.norm(), most) << mu;
      last = now;
    }
    EXPECT_NEAR(x - 10, (2 + std::min(mu, 0.5)) * kDepth, 3 * kStep) << mu;
  }
}

// A fast hand comes in through the sheet and is beyond its border in the same tick.
TEST(Friction, begins_where_a_contact_that_began_past_a_border_has_left_it) {
  constexpr double kStep = 0.01;
  const PatchCache cache = test::cache_of(test::sheet());
  ContactTracker tracker(cache, with_friction(0.5, 0.3, 0));
  Vec3 hip(9.5, 1, 0.3);
  tracker.tick(hip);
  Contact last = tracker.tick(hip = {10.6, 1, -2});
  EXPECT_TRUE(last.touching);
  EXPECT_GT(last.push.x(), 0.5);  // as a rim does
  const auto go = [&](double x) {
    double share = 0;
    for (; hip.x() > x; hip.x() -= kStep) {
      const Contact now = tracker.tick(hip);
      EXPECT_LE((now.push - last.push).norm(), (5.0 / 3 + 1e-6) * kStep) << hip.x();
      share = std::max(share, tracker.cone_share());
      last = now;
    }
    return share;
  };
  EXPECT_EQ(go(10.005), 0);
  EXPECT_NEAR(go(9.1), 0.9, 0.02);
}

TEST(Friction, of_lazy_patches_is_that_of_the_whole_mesh) {
  const Generated knot = torus_knot();
  const PatchCache cache = test::cache_of(knot.mesh);
  const QueryOptions options = with_friction(0.5, 0.3);
  ContactTracker whole(cache, options);
  test::LazyTracker lazy(knot.mesh, {}, options);
  std::vector<Vec3> way = path_beneath(knot, 120, 12, 2, 0.05);
  way.resize(4000);
  const Vec3 out = knot.exact->nearest(way[0]).normal;
  for (int i = 0; i < 60; ++i) way.insert(way.begin(), way[0] + 0.05 * out);
  test::Worst apart;
  std::size_t slips = 0;
  const FrictionSteps found = steps_along(way, options.friction, [&](const Vec3& hip) {
    const Contact want = whole.tick(hip), got = lazy.tick(hip);
    EXPECT_EQ(got.touching, want.touching);
    apart.add((got.push - want.push).norm());
    slips += is_slipping(got.flags);
    return got;
  });
  EXPECT_LE(found.most, 1);
  EXPECT_GT(lazy.built(), 200u);
  EXPECT_GT(slips, 3500u);
  EXPECT_LT(apart.value, 1e-3);
  test::record("lazy", "{:.1e} mm from the whole mesh's", apart.value);
}

TEST(Friction, of_nothing_changes_no_byte) {
  QueryOptions none;
  none.friction.settle = 3e-3;
  for (const Mesh& mesh : {torus_knot(60, 8).mesh, test::open_strip(), friction_plates()}) {
    const std::vector<Walk> ways = ways_on(mesh, 4 * walk_depth(mesh));
    for (const Precision precision : {Precision::kDouble, Precision::kFloat}) {
      const PatchCache cache = test::cache_of(mesh, precision);
      for (const Method method : kEveryMethod) {
        none.method = method;
        QueryOptions plain;
        plain.method = method;
        ContactTracker with(cache, none), without(cache, plain);
        for (const Vec3& hip : ways[0].hips) {
          const Contact a = with.tick(hip), b = without.tick(hip);
          ASSERT_EQ(std::memcmp(a.push.data(), b.push.data(), sizeof a.push), 0);
          ASSERT_EQ(a.scp, b.scp);
          ASSERT_EQ(a.flags, b.flags);
          ASSERT_EQ(a.iterations, b.iterations);
          ASSERT_EQ(with.cone_share(), 0);
        }
      }
    }
  }
}

// Any coefficients, depths from a nanometre to 20 mm, speeds to 2 m/s, and turns at any time.
TEST(Friction, stays_finite_and_within_a_ticks_budget_under_any_hand) {
  Rng rng(17);
  const int ticks = std::getenv("GLISS_LONG_TESTS") ? 1'000'000 : 1500;
  std::size_t slips = 0, sticks = 0;
  for (const Mesh& mesh :
       {goldberg(4).mesh, test::with_creases(test::with_normals(cube(2, 20).mesh)),
        test::sheet(1.5), friction_plates()}) {
    const PatchCache cache = test::cache_of(mesh);
    const Box box = cache.bounds();
    for (int round = 0; round < 24; ++round) {
      const double mu = uniform(rng, 0, 1) * (round % 2 == 0 ? 0.6 : 5);
      QueryOptions options = with_friction(mu, mu * uniform(rng, 0, 1), round % 4 == 3 ? 0 : 5e-3,
                                           kEveryMethod[round % 3]);
      options.friction.settle = round % 5 == 0 ? 2e-3 : 0;
      ContactTracker tracker(cache, options);
      const double depth = std::pow(10, uniform(rng, -6, 1.3)),
                   speed = std::pow(10, uniform(rng, -5, 0.3));
      Vec3 hip = box.high + Vec3(0, 0, 1), way = Vec3::UnitX();
      for (int i = 0; i < ticks; ++i) {
        if (i % 97 == 0) way = oracle::random_unit(rng);
        if (i % 31 == 0) way = -way;
        // Towards the box's middle, no deeper.
        const Vec3 aim = 0.5 * (box.low + box.high);
        const Contact near = tracker.tick(hip);
        ASSERT_TRUE(near.push.allFinite());
        ASSERT_LE(near.iterations, ContactTracker::kTickEvaluations);
        ASSERT_TRUE(std::isfinite(tracker.cone_share()));
        slips += is_slipping(near.flags);
        sticks += near.touching && !is_slipping(near.flags);
        hip += speed * way;
        if (near.push.norm() < depth)
          hip += 0.3 * std::max(speed, depth) * (aim - hip).normalized();
        if (near.push.norm() > 2 * depth) hip += 0.3 * near.push;
      }
    }
  }
  EXPECT_GT(slips, 5000u);
  EXPECT_GT(sticks, 5000u);
  test::record("hands", "{} ticks slip, {} stick", slips, sticks);
}

// A mass in the grip of a damped spring, 6 s, or 60 with GLISS_LONG_TESTS: the force is held for a
// tick, within which the mass moves on. Once the grip rests the energy of all falls, though held
// forces make some: what the damping takes is more, above k T / 2 = 0.25 N s/m.
struct HeldMass {
  static constexpr double kMass = 0.1, kGrip = 300, kDamping = 1, kTick = 1e-3;  // kg, N/m, N s/m
  static constexpr int kSteps = 10;                                              // in a tick
  Vec3 x, v = Vec3::Zero();                                                      // m

  void tick(const Vec3& grip, const Vec3& force) {
    for (int i = 0; i < kSteps; ++i) {
      const Vec3 pull = force + kGrip * (grip - x) - kDamping * v;
      v += kTick / kSteps / kMass * pull;
      x += kTick / kSteps * v;
    }
  }
  double energy(const Vec3& grip) const {
    return 0.5 * kMass * v.squaredNorm() + 0.5 * kGrip * (grip - x).squaredNorm();
  }
};

TEST(Friction, lets_a_mass_in_a_hand_come_to_rest) {
  const int ticks = std::getenv("GLISS_LONG_TESTS") ? 60'000 : 6000;
  const Mesh ball = goldberg(4).mesh;
  for (const Mesh& mesh : {ball, test::with_creases(test::with_normals(cube(2, 20).mesh))}) {
    const PatchCache cache = test::cache_of(mesh);
    for (const double mu : {0.0, 0.3, 5.0}) {
      for (const double force : {1e-6, 1.0, 10.0}) {  // N, of the grip on a rigid surface
        ContactTracker tracker(cache, with_friction(mu, 0.6 * mu));
        const double top = cache.bounds().high.z() * cache.unit;
        Vec3 grip(0.001, 0.002, top + 0.01);
        HeldMass mass{grip};
        double last = 0;
        for (int i = 0; i < ticks; ++i) {
          // Two seconds to and fro at 0 to 2 m/s, pressing; then rest.
          const double t = i * HeldMass::kTick;
          if (i < 2000) {
            const double speed = 2 * std::sin(3.0 * t) * (i / 50 % 2 == 0 ? 1 : -1);
            grip += HeldMass::kTick * speed * Vec3(1, 0.4, 0).normalized() * (i < 1000 ? 0.1 : 1);
            grip.z() = top - force / HeldMass::kGrip * std::min(1.0, t);
          }
          const Contact contact = tracker.tick(mass.x / cache.unit);
          const Vec3 felt = contact_force(cache, contact, 1e3 * kStiff);
          ASSERT_TRUE(felt.allFinite());
          if (i >= 3000 && i % 1000 == 0) {
            const double energy =
                mass.energy(grip) + energy_of(cache, contact, mass.x / cache.unit);
            if (i > 3000) {
              ASSERT_LE(energy, last * (1 + 1e-9) + 1e-12)
                  << mu << ", " << force << " N, " << t << " s";
            }
            last = energy;
          }
          mass.tick(grip, felt);
        }
        EXPECT_LT(mass.v.norm(), 1e-5) << mu << ", " << force << " N";
      }
    }
  }
}

}  // namespace
}  // namespace gliss
