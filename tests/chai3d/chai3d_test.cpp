// A Gliss surface among CHAI3D's objects, with a stub of their interface (tests/chai3d_stub): the
// forces, members and events that CHAI3D's call order gives.
#include "gliss/chai3d.h"

#include <limits>

#include "gliss/generate/generate.h"
#include "tests/oracle/oracle.h"
#include "tests/support/allocations.h"
#include "tests/support/open_meshes.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using chai3d::cInteractionRecorder;
using chai3d::cMatrix3d;
using chai3d::cVector3d;
using namespace std::chrono_literals;
using oracle::Rng, oracle::uniform;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double kSame = 1e-12;  // N
constexpr double kInfinity = std::numeric_limits<double>::infinity(),
                 kNaN = std::numeric_limits<double>::quiet_NaN();

SceneObject ball() {
  static const auto cache = std::make_shared<const PatchCache>(test::cache_of(goldberg().mesh));
  return {.cache = cache, .stiffness = 700};
}

Vec3 vec(const cVector3d& v) { return {v(0), v(1), v(2)}; }
cVector3d vec(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

// A hand that slides about and through a ball of 10 mm, up to 0.3 mm a tick, m.
std::vector<Vec3> sliding(std::size_t ticks, unsigned seed = 3) {
  Rng rng(seed);
  std::vector<Vec3> path{Vec3(0, 0, 0.012)};
  Vec3 aim = path[0];
  while (path.size() < ticks) {
    if ((aim - path.back()).norm() < 3e-4) {
      const Vec3 way(uniform(rng, -1, 1), uniform(rng, -1, 1), uniform(rng, -1, 1));
      aim = uniform(rng, 0.007, 0.012) * way.normalized();
    }
    path.push_back(path.back() + uniform(rng, 0, 3e-4) * (aim - path.back()).normalized());
  }
  return path;
}

// Pulls to the object's point from anywhere, as CHAI3D's magnet does.
struct Pull final : chai3d::cGenericEffect {
  using cGenericEffect::cGenericEffect;
  bool computeForce(const cVector3d& position, const cVector3d&, const unsigned int&,
                    cVector3d& force) override {
    force = cSub(m_parent->m_interactionPoint, position);
    return true;
  }
};

// One with a clock of the test's.
struct Ticking : cGlissObject {
  using cGlissObject::cGlissObject;
  Nanoseconds now() override { return time; }
  Nanoseconds time{1h};
};

// A world of one object: what a tool's point feels there, m and N.
class World {
 public:
  explicit World(Ticking& object, Nanoseconds tick = 1ms) : object_(object), tick_(tick) {
    recorder.m_interactions.reserve(8);
  }
  Vec3 force(const Vec3& hip, unsigned int id = 0, const Vec3& velocity = Vec3::Zero()) {
    object_.time += tick_;
    recorder.m_interactions.clear();
    return vec(object_.computeInteractions(vec(hip), vec(velocity), id, recorder));
  }
  cInteractionRecorder recorder;

 private:
  Ticking& object_;
  Nanoseconds tick_;
};

// What an object says on the standard error when the next frame is drawn.
std::string said_by(cGlissObject& object) {
  chai3d::cRenderOptions options;
  ::testing::internal::CaptureStderr();
  object.renderSceneGraph(options);
  return ::testing::internal::GetCapturedStderr();
}

// The path's forces are those of `want`, and some are not zero.
template <class Want>
void expect_forces(World& world, const std::vector<Vec3>& path, Want want, unsigned int id = 0) {
  test::Worst worst;
  std::size_t touching = 0;
  for (const Vec3& hip : path) {
    const Vec3 got = world.force(hip, id);
    worst.add((got - want(hip)).norm());
    touching += !got.isZero(0);
  }
  EXPECT_LE(worst.value, kSame);
  EXPECT_GT(touching, path.size() / 5);
}

TEST(Chai3d, gives_the_forces_of_a_contact_tracker) {
  const SceneObject surface = ball();
  Ticking object(surface);
  World world(object);
  ContactTracker alone(*surface.cache, {});
  expect_forces(world, sliding(4000), [&](const Vec3& hip) {
    return contact_force(*surface.cache, alone.tick(hip / surface.unit()), 700);
  });
  EXPECT_EQ(object.fault(), nullptr);
}

TEST(Chai3d, gives_the_forces_of_a_tracker_with_friction_and_effects) {
  SceneObject surface = ball();
  surface.friction = {0.6, 0.4, 3e-3};
  surface.effects = {.damping = 2, .viscosity = 1, .magnet = {0.2, 0.001}};
  Tracker alone({&surface, 1});
  Ticking object(surface);
  World world(object);
  expect_forces(world, sliding(4000), [&](const Vec3& hip) { return alone.step(hip); });

  surface.effects = {.texture = {.relief = Relief::kGrating, .height = 1e-4, .period = 1e-3}};
  object.setEffects(surface.effects);
  alone = Tracker({&surface, 1});
  expect_forces(world, sliding(1000), [&](const Vec3& hip) { return alone.step(hip); });
}

TEST(Chai3d, gives_each_point_of_the_tools_its_own_contact) {
  const SceneObject surface = ball();
  Ticking object(surface);
  World world(object);
  constexpr unsigned int ids[] = {7, 3, 4000000000};
  std::vector<std::vector<Vec3>> paths;
  std::vector<Tracker> alone;
  for (unsigned int i = 0; i < 3; ++i) {
    paths.push_back(sliding(1000, i));
    alone.emplace_back(std::span(&surface, 1));
  }
  for (std::size_t tick = 0; tick < 1000; ++tick) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3& hip = paths[i][tick];
      EXPECT_LE((world.force(hip, ids[i]) - alone[i].step(hip, object.time)).norm(), kSame);
    }
  }
}

// As CHAI3D's matrices do, to the last bit.
Vec3 turn_back(const Eigen::Matrix3d& turn, const Vec3& v) {
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) sum[i] += turn(j, i) * v[j];
  }
  return sum;
}

TEST(Chai3d, is_moved_by_chai3d) {
  SceneObject surface = ball();
  surface.friction = {0.6, 0.4};
  Ticking object(surface);
  World world(object);
  Tracker alone({&surface, 1}), still({&surface, 1});
  double turned = 0;
  test::Worst worst, worst_of_still;
  for (const Vec3& hip : sliding(3000)) {
    turned += 1e-3;
    const Pose pose = Eigen::Translation3d(0.2, 1e-3 * std::sin(turned), -0.1) *
                      Eigen::AngleAxisd(turned, Vec3(1, 2, -1).normalized());
    cMatrix3d turn;
    turn.setCol(vec(Vec3(pose.linear().col(0))), vec(Vec3(pose.linear().col(1))),
                vec(Vec3(pose.linear().col(2))));
    object.setLocalPos(vec(Vec3(pose.translation())));
    object.setLocalRot(turn);
    alone.move(0, pose);
    const Vec3 there = Vec3(0.2, 0, -0.1) + hip;
    const Vec3 force = world.force(there),
               local = turn_back(pose.linear(), there - pose.translation());
    worst.add((force - alone.step(there)).norm());
    worst_of_still.add((force - pose.linear() * still.step(local)).norm());
  }
  EXPECT_LE(worst.value, 1e-7);  // the HIP in the object's frame differs in its last bits
  EXPECT_LE(worst_of_still.value, kSame);
}

TEST(Chai3d, takes_stiffness_and_friction_of_the_material_in_each_tick) {
  SceneObject surface = ball();
  surface.friction = {0.5, 0.4};
  Ticking object(surface);
  EXPECT_EQ(object.m_material->getStiffness(), 700);
  EXPECT_EQ(object.m_material->getStaticFriction(), 0.5);
  EXPECT_EQ(object.m_material->getDynamicFriction(), 0.4);
  World world(object);
  Tracker alone({&surface, 1});
  std::size_t tick = 0;
  expect_forces(world, sliding(3000), [&](const Vec3& hip) {
    const Vec3 force = alone.step(hip);
    ++tick;  // the next tick's
    const double stiffness = 500 + 10 * static_cast<double>(tick % 40);
    const double at_rest = tick / 100 % 3 == 0 ? 0 : 0.2 + 0.1 * static_cast<double>(tick % 3);
    object.m_material->setStiffness(stiffness);
    object.m_material->setStaticFriction(at_rest);
    EXPECT_TRUE(alone.set_material(0, stiffness, {at_rest, std::min(at_rest, 0.4)}));
    return force;
  });
  EXPECT_EQ(object.fault(), nullptr);
}

TEST(Chai3d, keeps_the_material_before_one_that_is_none) {
  Ticking object(ball());
  World world(object);
  world.force({0, 0, 0.012});
  const Vec3 force = world.force({0, 0, 0.008});
  object.m_material->setStaticFriction(7);
  EXPECT_LE((world.force({0, 0, 0.008}) - force).norm(), kSame);
  EXPECT_LE((world.force({0, 0, 0.008}) - force).norm(), kSame);
  EXPECT_EQ(
      said_by(object),
      "cGlissObject : its material has a stiffness that is not from 0 to 1e6 N/m, or a friction "
      "above 5: it keeps the one before\n");
  EXPECT_EQ(said_by(object), "");
  EXPECT_THAT(object.fault(), HasSubstr("friction above 5"));
}

TEST(Chai3d, keeps_the_scale_before_one_that_is_none) {
  Ticking object(ball());
  World world(object);
  world.force({0, 0, 0.012});
  const Vec3 force = world.force({0, 0, 0.008});
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  for (const double factor : {0.0, -1.0, 1e300, 1e-300, nan, inf}) {
    object.scale(factor);
    EXPECT_LE((world.force({0, 0, 0.008}) - force).norm(), kSame) << factor;
  }
  EXPECT_THAT(object.fault(), HasSubstr("keeps the one before"));
}

TEST(Chai3d, speaks_in_the_worlds_units) {
  const SceneObject surface = ball();
  Ticking object(surface, 0.1);  // a unit of the world: 0.1 m
  EXPECT_DOUBLE_EQ(object.m_material->getStiffness(), 70);
  World world(object);
  Tracker alone({&surface, 1});
  for (const Vec3& hip : sliding(1000))
    ASSERT_LE((world.force(hip / 0.1) - alone.step(hip)).norm(), kSame);

  object.computeBoundaryBox();
  const Box box = surface.cache->bounds();
  EXPECT_LE((vec(object.getBoundaryMin()) - 0.01 * box.low).norm(), 1e-15);
  EXPECT_LE((vec(object.getBoundaryMax()) - 0.01 * box.high).norm(), 1e-15);

  // Twice as large, and as stiff a unit of the world's length.
  const Vec3 before = world.force({0, 0, 0.09});
  object.scale(2);
  world.force({0, 0, 0.21});
  EXPECT_LE((world.force({0, 0, 0.18}) - 2 * before).norm(), 1e-9);
  EXPECT_LE((vec(object.getBoundaryMax()) - 0.02 * box.high).norm(), 1e-15);
}

TEST(Chai3d, tells_chai3d_where_the_contact_is) {
  const SceneObject surface = ball();
  Ticking object(surface);
  World world(object);
  ContactTracker alone(*surface.cache, {});
  for (const Vec3& hip : sliding(1000)) {
    const Vec3 force = world.force(hip);
    const Contact contact = alone.tick(hip / surface.unit());
    EXPECT_EQ(object.m_interactionInside, contact.touching);
    EXPECT_EQ(world.recorder.m_interactions.size(), contact.touching ? 1u : 0u);
    if (!contact.touching) continue;
    const Vec3 point = surface.unit() * contact.scp;
    EXPECT_EQ(vec(object.m_interactionPoint), point);
    EXPECT_EQ(vec(object.m_interactionNormal), contact.normal);
    const chai3d::cInteractionEvent& event = world.recorder.m_interactions[0];
    EXPECT_EQ(event.m_object, &object);
    EXPECT_TRUE(event.m_isInside);
    EXPECT_EQ(vec(event.m_localPos), hip);
    EXPECT_EQ(vec(event.m_localForce), force);
    EXPECT_EQ(vec(event.m_localSurfacePos), vec(object.m_interactionPoint));
    EXPECT_EQ(vec(event.m_localNormal), vec(object.m_interactionNormal));
  }
}

TEST(Chai3d, shows_effects_of_chai3d_the_nearest_point_from_afar_too) {
  const SceneObject surface = ball();
  Ticking object(surface, 1, 1, ForceBy::kChai3d);
  object.addEffect(new Pull(&object));
  World world(object);
  for (const Vec3& hip :
       {Vec3(0, 0, 0.3), Vec3(0, 0.1, 0.3), Vec3(0.1, 0.1, 0.2), Vec3(0.02, 0, 0)}) {
    const Vec3 way = surface.unit() * nearest(*surface.cache, hip / surface.unit()).scp - hip;
    EXPECT_LE((world.force(hip) - way).norm(), 1e-9);
    EXPECT_FALSE(object.m_interactionInside);
  }
}

TEST(Chai3d, leaves_the_spring_to_chai3d_where_it_is_told_to) {
  SceneObject surface = ball();
  surface.friction = {0.6, 0.4};
  Ticking object(surface, 1, 1, ForceBy::kChai3d);
  object.createEffectSurface();
  World world(object);
  Tracker alone({&surface, 1});
  expect_forces(world, sliding(3000), [&](const Vec3& hip) { return alone.step(hip); });
}

TEST(Chai3d, leaves_the_spring_to_chai3d_at_an_open_border_too) {
  SceneObject surface{.cache = std::make_shared<PatchCache>(test::cache_of(test::sheet()))};
  surface.friction = {0.6, 0.4};
  Ticking object(surface, 1, 1, ForceBy::kChai3d);
  object.createEffectSurface();
  World world(object);
  Tracker alone({&surface, 1});
  std::vector<Vec3> over_the_rim;
  for (double x = 0; x < 0.017; x += 1e-5)
    over_the_rim.push_back({x, 0.001, std::max(-0.002, 5e-4 - x)});
  expect_forces(world, over_the_rim, [&](const Vec3& hip) { return alone.step(hip); });
  // From there beneath it, where nothing is felt.
  for (double x = 0.017; x > 0; x -= 1e-5) {
    ASSERT_TRUE(world.force({x, 0.001, -0.002}).isZero(0)) << x;
    ASSERT_FALSE(object.m_interactionInside) << x;
  }
}

TEST(Chai3d, lets_no_spring_act_twice) {
  Ticking object(ball());
  object.m_name = "ball";
  World world(object);
  world.force({0, 0, 0.012});
  const Vec3 force = world.force({0, 0, 0.008});
  object.createEffectSurface();
  EXPECT_LE((world.force({0, 0, 0.008}) - force).norm(), kSame);
  EXPECT_LE((world.force({0, 0, 0.008}) - force).norm(), kSame);
  const std::string told = said_by(object);
  EXPECT_EQ(told, "cGlissObject ball: " + std::string(object.fault()) + "\n");
  EXPECT_THAT(told, HasSubstr("second spring"));
  object.deleteEffectSurface();
  EXPECT_LE((world.force({0, 0, 0.008}) - force).norm(), kSame);
}

TEST(Chai3d, has_no_force_for_points_that_it_was_not_made_for_and_says_so_once) {
  Ticking object(ball(), 1, 2);
  object.addEffect(new Pull(&object));
  World world(object);
  const auto press = [&](unsigned int id) {
    world.force({0, 0, 0.012}, id);
    return world.force({0, 0, 0.008}, id).norm();
  };
  EXPECT_GT(press(5), 1);
  EXPECT_GT(press(6), 1);
  EXPECT_EQ(press(7), 0);
  EXPECT_FALSE(object.m_interactionInside);
  EXPECT_EQ(press(8), 0);
  EXPECT_EQ(said_by(object),
            "cGlissObject : more interaction points than it was made for: no force on those that "
            "came last\n");
  EXPECT_GT(press(5), 1);
  object.forgetPoints();
  EXPECT_GT(press(7), 1);
}

TEST(Chai3d, has_no_force_where_the_surface_is_at_fault) {
  auto broken = std::make_shared<PatchCache>(test::cache_of(goldberg().mesh));
  for (std::uint32_t face = 0; face < broken->mesh_face_count; ++face)
    test::break_patch(*broken, face);
  Ticking object({.cache = broken});
  World world(object);
  for (double z = 0.012; z > 0.005; z -= 1e-3) EXPECT_TRUE(world.force({0, 0, z}).isZero(0));
  EXPECT_THAT(said_by(object), HasSubstr("the surface is at fault"));
}

TEST(Chai3d, has_no_force_for_a_first_position_that_is_not_finite) {
  Ticking object(ball());
  World world(object);
  EXPECT_TRUE(world.force({kNaN, 0, 0}).isZero(0));
  EXPECT_FALSE(object.m_interactionInside);
}

// The force stays for a bad position or two; then it goes, and comes back gently.
TEST(Chai3d, holds_and_takes_away_the_force_where_positions_are_not_finite) {
  for (const ForceBy by : {ForceBy::kGliss, ForceBy::kChai3d}) {
    Ticking object(ball(), 1, 1, by);
    if (by == ForceBy::kChai3d) object.createEffectSurface();
    World world(object);
    world.force({0, 0, 0.012});
    for (int i = 0; i < 600; ++i) world.force({0, 0, 0.008});
    const Vec3 pressed(0, 0, 0.008), force = world.force(pressed);
    ASSERT_GT(force.norm(), 1);
    EXPECT_EQ(object.fault(), nullptr);
    const Vec3 bad[] = {{kNaN, 0, 0.008}, {0, kInfinity, 0}, {0, 0, -kInfinity}};
    for (const Vec3& hip : bad) {
      EXPECT_LE((world.force(hip) - force).norm(), kSame);
      EXPECT_FALSE(object.m_interactionInside);
      EXPECT_LE((world.force(pressed) - force).norm(), kSame);
    }
    Vec3 last = force;
    for (int i = 1; i <= 12; ++i) {
      const Vec3 held = world.force(bad[i % 3]);
      EXPECT_LE((held - std::clamp((10.0 - i) / 8, 0.0, 1.0) * force).norm(), kSame) << i;
    }
    last.setZero();
    for (int i = 1; i <= 510; ++i) {
      const Vec3 back = world.force(pressed);
      EXPECT_LE((back - last).norm(), force.norm() / 490) << i;
      last = back;
    }
    EXPECT_LE((last - force).norm(), kSame);
    EXPECT_EQ(said_by(object),
              "cGlissObject : a position is not finite: the force is held and taken away\n");
  }
}

// Haptic threads run as fast as they may, and some ticks come late.
TEST(Chai3d, has_the_same_laws_at_any_rate) {
  constexpr double kSpeed = 0.03, kViscosity = 4, kTau = 0.2;  // m/s, N s/m, s
  constexpr double kBreaks = 0.5e-3 / kSpeed;                  // s, when the point lets go
  for (const int rate : {500, 1000, 3000, 8000}) {
    SceneObject surface{.cache = std::make_shared<PatchCache>(test::cache_of(test::sheet()))};
    surface.friction = {0.5, 0.3, kTau};
    surface.effects = {.viscosity = kViscosity};
    Ticking object(surface);
    World world(object, Nanoseconds(0));
    world.force({-3e-3, 0, 1e-3});
    const Nanoseconds start = object.time;
    std::size_t felt = 0;
    for (int i = 1; i < rate / 5; ++i) {
      if (i % 100 > 91) continue;
      const double s = static_cast<double>(i) / rate;
      object.time = start + Nanoseconds(1'000'000'000ll * i / rate);
      const Vec3 told(rate == 3000 ? kSpeed : 0, 0, 0);
      const Vec3 force = world.force({-3e-3 + kSpeed * s, 0, -1e-3}, 0, told);
      if (s < 0.03) continue;
      const double rubs = 0.3 + 0.2 * std::exp(-(s - kBreaks) / kTau);
      EXPECT_NEAR(force.z(), 0.5, 1e-9);
      EXPECT_NEAR(-force.x(), 0.5 * rubs + kViscosity * kSpeed, 0.01 * 0.2) << rate << " " << s;
      ++felt;
    }
    EXPECT_GT(felt, 50u);
  }
}

TEST(Chai3d, allocates_nothing_in_a_tick) {
  if (!test::allocations_are_counted()) GTEST_SKIP() << "skipped: a sanitizer has malloc";
  SceneObject surface = ball();
  surface.friction = {0.6, 0.4};
  surface.effects = {.damping = 2, .magnet = {0.2, 0.001}};
  Ticking object(surface, 1, 3);
  object.addEffect(new Pull(&object));
  World world(object);
  const std::vector<Vec3> path = sliding(2000);
  const std::uint64_t before = test::allocations();
  for (std::size_t tick = 0; tick < path.size(); ++tick) {
    for (unsigned int id = 0; id < 3; ++id) world.force(path[(tick + 100 * id) % path.size()], id);
    object.m_material->setStiffness(500 + static_cast<double>(tick % 100));
  }
  EXPECT_EQ(test::allocations(), before);
}

TEST(Chai3d, still_asks_its_children_and_heeds_what_is_switched_off) {
  struct Child final : chai3d::cGenericObject {
    cVector3d computeInteractions(const cVector3d&, const cVector3d&, unsigned int,
                                  cInteractionRecorder&) override {
      return {0, 0, 40};
    }
  };
  Ticking object(ball());
  object.addChild(new Child);
  World world(object);
  EXPECT_EQ(world.force({0, 0, 0.012}), Vec3(0, 0, 40));
  EXPECT_GT(world.force({0, 0, 0.008}).z(), 41);
  object.setHapticEnabled(false);
  EXPECT_EQ(world.force({0, 0, 0.008}), Vec3(0, 0, 40));
  EXPECT_TRUE(world.recorder.m_interactions.empty());
  object.setEnabled(false);
  EXPECT_EQ(world.force({0, 0, 0.008}), Vec3(0, 0, 40));
}

TEST(Chai3d, draws_its_surface_by_a_child) {
  const Mesh mesh = goldberg().mesh;
  const SceneObject surface = ball();
  Ticking object(surface, 0.1);
  object.createDrawing(mesh, 1);
  const chai3d::cMesh* drawing = object.createDrawing(mesh, 2);
  ASSERT_EQ(object.getNumChildren(), 1u);
  EXPECT_EQ(object.getChild(0), drawing);
  EXPECT_FALSE(drawing->getHapticEnabled());
  EXPECT_EQ(drawing->m_material, object.m_material);
  EXPECT_EQ(drawing->corners.size(), 3 * tessellated_count(mesh, *surface.cache, 2));
  test::Worst off;
  for (std::size_t i = 0; i < drawing->positions.size(); ++i) {
    const Vec3 at = 0.1 * vec(drawing->positions[i]) / surface.unit();
    const Contact contact = nearest(*surface.cache, at);
    off.add(std::abs(contact.distance));
    EXPECT_GT(contact.normal.dot(vec(drawing->normals[i])), 1 - 1e-6);
  }
  EXPECT_LT(off.value, 1e-9);
}

TEST(Chai3d, refuses_what_it_cannot_be) {
  const auto refusal = [](const char* words) {
    return ThrowsMessage<std::invalid_argument>(HasSubstr(words));
  };
  const SceneObject good = ball();
  EXPECT_THAT([] { cGlissObject object({}); }, refusal("has no surface"));
  EXPECT_THAT([&] { cGlissObject object(good, 0); }, refusal("metres"));
  EXPECT_THAT([&] { cGlissObject object(good, kNaN); }, refusal("metres"));
  EXPECT_THAT([&] { cGlissObject object(good, 1, 0); }, refusal("points are 1 or more"));
  SceneObject placed = good;
  placed.pose.translation().x() = 1;
  EXPECT_THAT([&] { cGlissObject object(placed); }, refusal("setLocalPos"));
  SceneObject damped = good;
  damped.effects.damping = 1;
  EXPECT_THAT([&] { cGlissObject object(damped, 1, 1, ForceBy::kChai3d); },
              refusal("without Gliss's effects"));
  cGlissObject object(good);
  EXPECT_THAT([&] { object.setEffects({.damping = 21}); }, refusal("damping"));
  SceneObject lazy = good;
  lazy.cache = nullptr;
  lazy.lazy = std::make_shared<LazyMesh>(goldberg().mesh);
  cGlissObject built_later(lazy, 1, 1);
  EXPECT_THAT([&] { built_later.createDrawing(goldberg().mesh); }, refusal("needs a cache"));
}

}  // namespace
}  // namespace gliss
