// The functions for C: the results of the C++ library, and an error for each bad call.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <thread>

#include "gliss/c_api/gliss_c.h"
#include "gliss/contact/tracker.h"
#include "gliss/device/guard.h"
#include "gliss/files/cache_file.h"
#include "gliss/generate/generate.h"
#include "tests/support/allocations.h"
#include "tests/support/open_meshes.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using ::testing::HasSubstr;

// Drops the exact normals of a generated mesh: arrays have none.
Mesh without_normals(Mesh mesh) {
  mesh.normals.clear();
  mesh.corner_normal.clear();
  return mesh;
}

std::int32_t make_surface(const Mesh& mesh, const gliss_options* options, gliss_surface** out) {
  return gliss_surface_from_arrays(mesh.positions[0].data(), 0, mesh.positions.size(),
                                   mesh.face_begin.data(), mesh.corner_vertex.data(),
                                   mesh.face_count(), options, out);
}

// A ball of 10 mm, from arrays.
struct CBall {
  CBall() : mesh(without_normals(goldberg(3).mesh)) {
    gliss_options options = GLISS_OPTIONS_INIT;
    options.unit = mesh.unit;
    EXPECT_EQ(make(&options, &surface), 0) << gliss_last_error();
  }
  ~CBall() { gliss_surface_release(surface); }
  std::int32_t make(const gliss_options* options, gliss_surface** out) const {
    return make_surface(mesh, options, out);
  }
  gliss_object object() const {
    gliss_object object = gliss_object_init();
    object.surface = surface;
    return object;
  }
  const Mesh mesh;
  gliss_surface* surface = nullptr;
};

// True if the point (0, 0, z) is inside, by the nearest point.
bool is_inside(const Mesh& mesh, const gliss_options& options, double z) {
  gliss_surface* surface = nullptr;
  EXPECT_EQ(make_surface(mesh, &options, &surface), 0) << gliss_last_error();
  const double hip[3] = {0, 0, z};
  gliss_contact contact;
  EXPECT_EQ(gliss_surface_nearest(surface, GLISS_GREGORY, hip, 0, sizeof(double), 1, &contact), 0)
      << gliss_last_error();
  gliss_surface_release(surface);
  return contact.touching != 0;
}

TEST(CApi, orients_flips_and_creases_as_it_is_told) {
  Mesh room = without_normals(goldberg(3).mesh);
  for (std::uint32_t f = 0; f < room.face_count(); ++f)
    std::reverse(room.corner_vertex.begin() + room.face_begin[f],
                 room.corner_vertex.begin() + room.face_begin[f + 1]);
  gliss_options options = GLISS_OPTIONS_INIT;
  EXPECT_TRUE(is_inside(room, options, 5));
  options.orient = GLISS_AS_GIVEN;
  EXPECT_FALSE(is_inside(room, options, 5));
  const Mesh sheet = without_normals(test::sheet());
  EXPECT_TRUE(is_inside(sheet, options, -1));
  options.flip = 1;
  EXPECT_FALSE(is_inside(sheet, options, -1));

  const auto departure = [](const char* crease, std::uint32_t size) {
    const Mesh box = without_normals(cube(1, 20).mesh);
    gliss_options creased = GLISS_OPTIONS_INIT;
    creased.crease = crease;
    creased.size = size;
    gliss_surface* surface = nullptr;
    EXPECT_EQ(make_surface(box, &creased, &surface), 0) << gliss_last_error();
    double distance = -1, room = 0;
    std::uint32_t face = 0;
    EXPECT_EQ(gliss_surface_departure(surface, &distance, &room, &face), 0);
    gliss_surface_release(surface);
    return distance;
  };
  const test::ScratchFolder folder;
  const std::string listed = folder / "edges";
  {
    const Mesh box = cube(1, 20).mesh;
    std::ofstream out(listed);
    for (std::uint32_t f = 0; f < box.face_count(); ++f) {
      for (std::uint32_t k = 0; k < 4; ++k)
        out << box.corner_vertex[4 * f + k] << ' ' << box.corner_vertex[4 * f + (k + 1) % 4]
            << '\n';
    }
  }
  EXPECT_LT(departure(("edges:" + listed).c_str(), sizeof(gliss_options)), 1e-9);
  EXPECT_LT(departure(nullptr, sizeof(gliss_options)), 1e-9);
  EXPECT_GT(departure("none", sizeof(gliss_options)), 1);
  // What ABI 1.2 knew: the text behind it is not read.
  EXPECT_LT(departure("none", offsetof(gliss_options, crease)), 1e-9);
}

TEST(CApi, finds_what_the_library_finds) {
  const CBall ball;
  const PatchCache cache = build_cache(ball.mesh);
  EXPECT_EQ(gliss_abi_version() >> 16, GLISS_ABI >> 16);
  EXPECT_STREQ(gliss_version(), GLISS_VERSION);
  EXPECT_EQ(gliss_surface_unit(ball.surface), 1e-3);
  EXPECT_EQ(gliss_surface_faces(ball.surface), ball.mesh.face_count());
  double low[3], high[3];
  ASSERT_EQ(gliss_surface_bounds(ball.surface, low, high), 0);
  EXPECT_EQ(high[0], cache.bounds().high.x());
  double distance = 0, room = 0;
  std::uint32_t farthest = 0;
  ASSERT_EQ(gliss_surface_departure(ball.surface, &distance, &room, &farthest), 0);
  EXPECT_EQ((Departure{distance, room, farthest}), cache.tightest);
  std::vector<Vec3> points;
  std::vector<float> strided;  // x, y, z and one that is none of ours
  for (int i = 0; i < 200; ++i) {
    const Vec3 p(8 * std::sin(i), 8 * std::cos(1.3 * i), 9 * std::sin(0.7 * i));
    points.push_back(p.cast<float>().cast<double>());
    for (const double x : {p.x(), p.y(), p.z(), 99.0}) strided.push_back(static_cast<float>(x));
  }
  const struct {
    std::uint32_t number;
    Method method;
  } methods[] = {{GLISS_GREGORY, Method::kGregory},
                 {GLISS_SHADED, Method::kShaded},
                 {GLISS_FLAT, Method::kFlat}};
  for (const auto& [number, method] : methods) {
    std::vector<gliss_contact> of_doubles(200), of_floats(200);
    ASSERT_EQ(
        gliss_surface_nearest(ball.surface, number, points.data(), 0, 8, 200, of_doubles.data()),
        0);
    ASSERT_EQ(
        gliss_surface_nearest(ball.surface, number, strided.data(), 16, 4, 200, of_floats.data()),
        0);
    EXPECT_EQ(std::memcmp(of_doubles.data(), of_floats.data(), 200 * sizeof(gliss_contact)), 0);
    QueryOptions query;
    query.method = method;
    for (std::size_t i = 0; i < 200; ++i) {
      const Contact want = nearest(cache, points[i], query);
      const gliss_contact& got = of_doubles[i];
      EXPECT_EQ(got.touching, want.touching ? 1u : 0u);
      EXPECT_EQ(got.face, want.at.face);
      EXPECT_EQ(Vec3(got.scp[0], got.scp[1], got.scp[2]), want.scp);
      EXPECT_EQ(Vec3(got.push[0], got.push[1], got.push[2]), want.push);
      EXPECT_EQ(got.distance, want.distance);
    }
  }
  const std::uint32_t face = 7;
  const double xi = 0.1, eta = -0.2;
  double position[3], normal[3];
  ASSERT_EQ(gliss_surface_evaluate(ball.surface, &face, &xi, &eta, 1, position, normal), 0);
  const SurfacePoint want = evaluate(cache, {face, xi, eta});
  EXPECT_EQ(Vec3(position[0], position[1], position[2]), want.position);
  EXPECT_EQ(Vec3(normal[0], normal[1], normal[2]), want.normal);
}

TEST(CApi, loads_meshes_and_caches_and_says_why_not) {
  const test::ScratchFolder folder;
  const CBall ball;
  ASSERT_EQ(gliss_surface_save(ball.surface, (folder / "ball.gliss").c_str()), 0);
  gliss_surface* loaded = nullptr;
  ASSERT_EQ(gliss_surface_load((folder / "ball.gliss").c_str(), nullptr, &loaded), 0)
      << gliss_last_error();
  EXPECT_EQ(gliss_surface_unit(loaded), 1e-3);
  EXPECT_STREQ(gliss_last_error(), "");
  gliss_surface_release(loaded);
  gliss_surface* none = nullptr;
  EXPECT_EQ(gliss_surface_load((folder / "none.obj").c_str(), nullptr, &none), 2);
  EXPECT_THAT(gliss_last_error(), HasSubstr("none.obj"));
  folder.write("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
  EXPECT_EQ(gliss_surface_load((folder / "bad.obj").c_str(), nullptr, &none), 2);
  EXPECT_THAT(gliss_last_error(), HasSubstr("bad.obj:4"));
  folder.write("bad.gliss", "not a cache");
  EXPECT_EQ(gliss_surface_load((folder / "bad.gliss").c_str(), nullptr, &none), 3);
  EXPECT_EQ(none, nullptr);
  // A thread has errors of its own.
  std::thread([] { EXPECT_STREQ(gliss_last_error(), ""); }).join();
  EXPECT_THAT(gliss_last_error(), HasSubstr("bad.gliss"));
}

TEST(CApi, ticks_as_the_tracker_does_and_allocates_nothing) {
  const CBall ball;
  gliss_object object = ball.object();
  object.friction_static = 0.5;
  object.friction_dynamic = 0.3;
  object.damping = 2;
  object.texture = 2;
  object.texture_height = 5e-5;
  object.texture_period = 2e-3;
  const double tool[] = {0, 0, 0, 1e-3, 0, 0};
  gliss_hand* hand = nullptr;
  ASSERT_EQ(gliss_hand_create(&object, 1, tool, 2, &hand), 0) << gliss_last_error();
  SceneObject scene{.cache = std::make_shared<const PatchCache>(build_cache(ball.mesh))};
  scene.friction = {0.5, 0.3};
  scene.effects.damping = 2;
  scene.effects.texture = {Relief::kNoise, 5e-5, 2e-3};
  const std::vector<Vec3> hips{{0, 0, 0}, {1e-3, 0, 0}};
  Tracker tracker({&scene, 1}, hips);
  std::uint64_t allocations = 0;
  std::size_t touching = 0;
  for (int i = 0; i < 1500; ++i) {
    const double position[3] = {1e-6 * i, 2e-3 * std::sin(0.01 * i), 11e-3 - 2e-6 * i};
    const double angle = 1e-3 * i, rotation[4] = {std::cos(angle / 2), 0, 0, std::sin(angle / 2)};
    double force[3], torque[3];
    const std::uint64_t before = test::allocations();
    ASSERT_EQ(gliss_hand_tick_tool(hand, position, rotation, force, torque), 0);
    allocations += test::allocations() - before;
    Pose pose = Pose::Identity();
    pose.linear() = Rotation(rotation[0], 0, 0, rotation[3]).normalized().toRotationMatrix();
    pose.translation() = Vec3(position[0], position[1], position[2]);
    const Wrench want = tracker.step(pose);
    ASSERT_EQ(Vec3(force[0], force[1], force[2]), want.force);
    ASSERT_EQ(Vec3(torque[0], torque[1], torque[2]), want.torque);
    gliss_contact contact;
    ASSERT_EQ(gliss_hand_contact(hand, 1, 0, &contact), 0);
    EXPECT_EQ(contact.touching, tracker.objects()[1].contact.touching ? 1u : 0u);
    touching += contact.touching;
  }
  EXPECT_EQ(allocations, 0u);
  EXPECT_GT(touching, 500u);
  const double far[] = {1, 1, 1}, none[] = {1, 0, 0, 0};
  EXPECT_EQ(gliss_hand_move(hand, 0, none, far), 0);
  double force[3];
  EXPECT_EQ(gliss_hand_tick(hand, tool, force), 0);
  EXPECT_EQ(force[2], 0);
  gliss_hand_release(hand);
}

// By a time of its own or the object's, and by the velocity that it is told.
TEST(CApi, ticks_by_the_time_that_it_is_told) {
  const CBall ball;
  gliss_object object = ball.object();
  object.friction_static = 0.5;
  object.friction_dynamic = 0.3;
  object.friction_settle = 0.02;
  object.damping = 2;
  object.viscosity = 3;
  object.tick = 0.25e-3;
  SceneObject scene{.cache = std::make_shared<const PatchCache>(build_cache(ball.mesh))};
  scene.friction = {0.5, 0.3, 0.02};
  scene.effects.damping = 2;
  scene.effects.viscosity = 3;
  gliss_hand *told = nullptr, *steady = nullptr;
  ASSERT_EQ(gliss_hand_create(&object, 1, nullptr, 0, &told), 0) << gliss_last_error();
  ASSERT_EQ(gliss_hand_create(&object, 1, nullptr, 0, &steady), 0);
  Tracker by_time({&scene, 1}), by_tick({&scene, 1});
  std::int64_t time = 0;
  for (int i = 0; i < 2000; ++i) {
    time += i % 58 == 57 ? 8'250'000 : 250'000;
    const double position[3] = {2e-6 * i, 0, 11e-3 - 2e-6 * i}, velocity[3] = {0.008, 0, 1e-4 * i};
    const Vec3 at(position[0], position[1], position[2]);
    double force[3];
    ASSERT_EQ(gliss_hand_tick_at(told, time, position, velocity, nullptr, force, nullptr), 0);
    ASSERT_EQ(Vec3(force[0], force[1], force[2]),
              by_time.step(at, Nanoseconds(time), Vec3(velocity[0], 0, velocity[2])));
    ASSERT_EQ(gliss_hand_tick(steady, position, force), 0);
    ASSERT_EQ(Vec3(force[0], force[1], force[2]), by_tick.step(at, Nanoseconds(250'000 * i)));
  }
  EXPECT_TRUE(by_time.touching());
  double force[3];
  EXPECT_EQ(gliss_hand_tick_at(told, INT64_MAX, force, nullptr, nullptr, force, nullptr), 0);
  EXPECT_EQ(gliss_hand_tick(told, force, force), 0);
  gliss_hand_release(told);
  gliss_hand_release(steady);
}

TEST(CApi, tells_of_numbers_that_are_not_finite_and_keeps_the_contact) {
  const CBall ball;
  gliss_object object = ball.object();
  gliss_hand* hand = nullptr;
  ASSERT_EQ(gliss_hand_create(&object, 1, nullptr, 0, &hand), 0);
  const double nan = std::nan(""), outside[] = {0, 0, 12e-3}, inside[] = {0, 0, 9e-3},
               bad[] = {0, nan, 9e-3}, turn[] = {1, 0, 0, 0}, no_turn[] = {nan, 0, 0, 0};
  double force[3], pressed[3], torque[3];
  EXPECT_EQ(gliss_hand_tick(hand, outside, force), 0);
  EXPECT_EQ(gliss_hand_tick(hand, inside, pressed), 0);
  EXPECT_GT(pressed[2], 0.4);
  EXPECT_EQ(gliss_hand_tick(hand, bad, force), 0);
  EXPECT_TRUE(std::isnan(force[0]) && std::isnan(force[1]) && std::isnan(force[2]));
  EXPECT_EQ(gliss_hand_tick_tool(hand, bad, turn, force, torque), 0);
  EXPECT_TRUE(std::isnan(force[2]) && std::isnan(torque[2]));
  EXPECT_EQ(gliss_hand_tick_tool(hand, inside, no_turn, force, torque), 0);
  EXPECT_TRUE(std::isnan(force[2]) && std::isnan(torque[2]));
  gliss_contact contact;
  EXPECT_EQ(gliss_hand_contact(hand, 0, 0, &contact), 0);
  EXPECT_EQ(contact.touching, 1u);
  EXPECT_EQ(gliss_hand_tick(hand, inside, force), 0);
  EXPECT_EQ(force[2], pressed[2]);
  contact.distance = 7;
  EXPECT_EQ(gliss_surface_nearest(ball.surface, GLISS_GREGORY, bad, 0, 8, 1, &contact), 2);
  EXPECT_THAT(gliss_last_error(), HasSubstr("points: one is not finite"));
  EXPECT_EQ(contact.distance, 7);
  gliss_hand_release(hand);
  const auto refused = [&](const char* why) {
    EXPECT_EQ(gliss_hand_create(&object, 1, nullptr, 0, &hand), 2);
    EXPECT_THAT(gliss_last_error(), HasSubstr(why));
    object = ball.object();
  };
  object.stiffness = -500;
  refused("stiffness that is not from 0 to 1e6 N/m");
  object.settle = 5;  // a number of ticks
  refused("settle that is not from 0 to 1 s");
  object.friction_settle = -1;
  refused("settle of its friction that is not from 0 to 1 s");
  object.tick = 0;
  refused("tick: is not from 1e-6 to 1 s");
  gliss_object two[2] = {ball.object(), ball.object()};
  two[1].tick = 2e-3;
  EXPECT_EQ(gliss_hand_create(two, 2, nullptr, 0, &hand), 2);
  EXPECT_THAT(gliss_last_error(), HasSubstr("tick: is not the same in all objects"));
}

TEST(CApi, writes_no_byte_of_an_object_beyond_the_callers) {
  struct {
    gliss_object object;
    std::uint64_t behind = 0x0123456789abcdef;
  } caller;
  ASSERT_EQ(gliss_object_set_defaults(&caller.object, sizeof caller.object), 0);
  EXPECT_EQ(caller.object.size, sizeof caller.object);
  EXPECT_EQ(caller.object.rotation[0], 1);
  EXPECT_EQ(caller.behind, 0x0123456789abcdef);
  for (const std::size_t size : {sizeof(gliss_object) + 8, std::size_t{4}})
    EXPECT_EQ(gliss_object_set_defaults(&caller.object, size), 2) << size;
}

TEST(CApi, guards_a_torque_and_says_why) {
  gliss_guard* guard = nullptr;
  ASSERT_EQ(gliss_guard_create_tool(3.3, 1000, 0.01, 2, &guard), 0);
  EXPECT_STREQ(gliss_guard_reason(guard), "none");
  const double none[3] = {0, 0, 0}, wanted[3] = {0, 0, 5}, twist[3] = {0, 0.5, 0};
  double force[3], torque[3];
  std::uint32_t state = 9;
  for (std::int64_t tick = 1; tick <= 2000; ++tick) {
    const std::int64_t now = tick * 1'000'000;
    const bool is_free = tick <= 1000;
    ASSERT_EQ(gliss_guard_step_tool(guard, now, now, is_free ? none : wanted,
                                    is_free ? none : twist, force, torque, &state),
              0);
    EXPECT_LE(std::abs(torque[1]), 0.01 + 1e-15);
    EXPECT_LE(std::abs(force[2]), 3.3 + 1e-12);
  }
  EXPECT_EQ(state, GLISS_GUARD_RUN);
  EXPECT_NEAR(torque[1], 0.01, 1e-12);
  EXPECT_STREQ(gliss_guard_reason(guard), "force limit");
  ASSERT_EQ(gliss_guard_trip(guard, 1), 0);
  for (std::int64_t tick = 2001; tick <= 2030; ++tick)
    ASSERT_EQ(gliss_guard_step_tool(guard, tick * 1'000'000, tick * 1'000'000, wanted, twist, force,
                                    torque, &state),
              0);
  EXPECT_EQ(state, GLISS_GUARD_SAFE);
  EXPECT_EQ(force[2], 0);
  EXPECT_EQ(torque[1], 0);
  EXPECT_STREQ(gliss_guard_reason(guard), "device fault");
  gliss_guard_release(guard);
}

TEST(CApi, guards_a_force_as_the_guard_does) {
  gliss_guard* guard = nullptr;
  ASSERT_EQ(gliss_guard_create(3.3, 1000, &guard), 0);
  Guard want;
  for (int i = 1; i < 1000; ++i) {
    const std::int64_t now = 1'000'000 * i;
    const double wanted[3] = {0, i > 20 ? 5.0 : 0.0, i == 700 ? std::nan("") : 0.0};
    double force[3];
    std::uint32_t state = 99;
    ASSERT_EQ(gliss_guard_step(guard, now, now, wanted, force, &state), 0);
    const GuardOutput out =
        want.step(Nanoseconds(now), {Vec3(wanted[0], wanted[1], wanted[2]), Nanoseconds(now)});
    ASSERT_EQ(Vec3(force[0], force[1], force[2]), out.force);
    ASSERT_EQ(state, static_cast<std::uint32_t>(out.state));
  }
  EXPECT_EQ(gliss_guard_engage(guard), 2);
  EXPECT_THAT(gliss_last_error(), HasSubstr("does not permit"));
  gliss_guard_release(guard);
}

TEST(CApi, refuses_null_and_what_is_none) {
  const CBall ball;
  gliss_surface* surface = nullptr;
  gliss_hand* hand = nullptr;
  gliss_guard* guard = nullptr;
  double v[4] = {1, 0, 0, 0};
  gliss_contact contact;
  const std::uint32_t face = 0;
  const gliss_object object = ball.object();
  ASSERT_EQ(gliss_hand_create(&object, 1, nullptr, 0, &hand), 0);
  const auto refused = [](std::int32_t code, const char* why) {
    EXPECT_EQ(code, 2) << why;
    EXPECT_THAT(gliss_last_error(), HasSubstr(why));
  };
  refused(gliss_surface_load(nullptr, nullptr, &surface), "path: is NULL");
  refused(gliss_surface_load("a.obj", nullptr, nullptr), "out: is NULL");
  refused(gliss_surface_from_arrays(nullptr, 0, 3, &face, &face, 1, nullptr, &surface),
          "points: is NULL");
  refused(gliss_surface_save(nullptr, "a"), "surface: is NULL");
  refused(gliss_surface_save(ball.surface, nullptr), "path: is NULL");
  refused(gliss_surface_bounds(nullptr, v, v), "surface: is NULL");
  refused(gliss_surface_bounds(ball.surface, nullptr, v), "low: is NULL");
  refused(gliss_surface_departure(nullptr, v, v, &contact.face), "surface: is NULL");
  refused(gliss_surface_departure(ball.surface, v, nullptr, &contact.face), "room: is NULL");
  refused(gliss_surface_nearest(nullptr, 0, v, 0, 8, 1, &contact), "surface: is NULL");
  refused(gliss_surface_nearest(ball.surface, 0, nullptr, 0, 8, 1, &contact), "points: is NULL");
  refused(gliss_surface_nearest(ball.surface, 0, v, 0, 8, 1, nullptr), "out: is NULL");
  refused(gliss_surface_nearest(ball.surface, 3, v, 0, 8, 1, &contact), "method: is not one of");
  refused(gliss_surface_nearest(ball.surface, 0, v, 0, 2, 1, &contact), "bytes: of a number");
  refused(gliss_surface_evaluate(ball.surface, nullptr, v, v, 1, v, v), "face: is NULL");
  const std::uint32_t beyond = 1u << 30;
  refused(gliss_surface_evaluate(ball.surface, &beyond, v, v, 1, v, v), "domain of no face");
  const double outside = 5;
  refused(gliss_surface_evaluate(ball.surface, &face, &outside, v, 1, v, v), "domain of no face");
  refused(gliss_hand_create(nullptr, 1, nullptr, 0, &hand), "objects: is NULL");
  refused(gliss_hand_create(&object, 1, nullptr, 2, &hand), "points: is NULL");
  refused(gliss_hand_create(&object, 1, nullptr, 0, nullptr), "out: is NULL");
  refused(gliss_hand_tick(nullptr, v, v), "is NULL");
  refused(gliss_hand_tick(hand, nullptr, v), "is NULL");
  refused(gliss_hand_tick_tool(hand, v, nullptr, v, v), "is NULL");
  double zero[4] = {};
  refused(gliss_hand_tick_tool(hand, v, zero, v, v), "unit quaternion");
  refused(gliss_hand_contact(hand, 1, 0, &contact), "none of that index");
  refused(gliss_hand_contact(hand, 0, 1, &contact), "none of that index");
  refused(gliss_hand_contact(nullptr, 0, 0, &contact), "is NULL");
  refused(gliss_hand_move(hand, 1, v, v), "none of that index");
  refused(gliss_hand_move(hand, 0, zero, v), "unit quaternion");
  refused(gliss_guard_create(-1, 1000, &guard), "max_force");
  refused(gliss_guard_create(3, 1000, nullptr), "out: is NULL");
  refused(gliss_guard_step(nullptr, 0, 0, v, v, nullptr), "is NULL");
  refused(gliss_guard_engage(nullptr), "is NULL");
  gliss_options options = GLISS_OPTIONS_INIT;
  options.size = 8;
  refused(ball.make(&options, &surface), "GLISS_OPTIONS_INIT");
  options = GLISS_OPTIONS_INIT;
  options.unit = -1;
  refused(ball.make(&options, &surface), "unit: is not above 0");
  options = GLISS_OPTIONS_INIT;
  options.level = "smooth";
  refused(ball.make(&options, &surface), "smooth");
  options = GLISS_OPTIONS_INIT;
  options.crease = "sharp";
  refused(ball.make(&options, &surface), "creases: 'sharp' is not one of");
  options = GLISS_OPTIONS_INIT;
  options.orient = 2;
  refused(ball.make(&options, &surface), "orient: is neither");
  gliss_object bad = object;
  gliss_hand* none = nullptr;
  bad.surface = nullptr;
  refused(gliss_hand_create(&bad, 1, nullptr, 0, &none), "surface is NULL");
  bad = object;
  bad.friction_static = -1;
  refused(gliss_hand_create(&bad, 1, nullptr, 0, &none), "SceneObject 0 has a static friction");
  bad = object;
  bad.texture = 7;
  refused(gliss_hand_create(&bad, 1, nullptr, 0, &none), "texture: is not one of");
  const std::uint32_t begin[] = {0, 3}, corners[] = {0, 1, 99};
  const double points[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  EXPECT_EQ(gliss_surface_from_arrays(points, 0, 3, begin, corners, 1, nullptr, &surface), 2);
  const std::uint32_t falls[] = {0, 3, 1};
  refused(gliss_surface_from_arrays(points, 0, 3, falls, corners, 2, nullptr, &surface),
          "begin: decreases");
  EXPECT_EQ(surface, nullptr);
  gliss_surface_release(nullptr);
  gliss_surface_retain(nullptr);
  gliss_hand_release(nullptr);
  gliss_guard_release(nullptr);
  EXPECT_EQ(gliss_surface_unit(nullptr), 0);
  EXPECT_EQ(gliss_surface_faces(nullptr), 0u);
  gliss_hand_release(hand);
}

// A hand keeps its surface; the last one who releases it lets it go (under ASan a leak would be
// told).
TEST(CApi, counts_who_holds_a_surface) {
  gliss_hand* hand = nullptr;
  {
    const CBall ball;
    const gliss_object object = ball.object();
    gliss_surface_retain(ball.surface);
    ASSERT_EQ(gliss_hand_create(&object, 1, nullptr, 0, &hand), 0);
    gliss_surface_release(ball.surface);
  }
  const double in[3] = {0, 0, 9e-3}, out[3] = {0, 0, 12e-3};
  double force[3];
  EXPECT_EQ(gliss_hand_tick(hand, out, force), 0);
  EXPECT_EQ(gliss_hand_tick(hand, in, force), 0);
  EXPECT_GT(force[2], 0.4);
  gliss_hand_release(hand);
}

// The k-th allocation of a call fails, for each k that it has: an error each time, and then the
// call works. What does not fail asks for no memory.
TEST(CApi, tells_of_memory_that_it_does_not_get) {
  if (!test::allocations_are_counted()) GTEST_SKIP() << "skipped: a sanitizer has malloc";
  const CBall ball;
  gliss_options options = GLISS_OPTIONS_INIT;
  options.threads = 1;
  const auto failures_of = [&](const char* name, const auto& call) {
    int failures = 0;
    // glibc aborts where it cannot note what a thread keeps to its end: let it be noted.
    EXPECT_EQ(call(), 0) << name;
    for (std::uint64_t k = 1; k < 200'000; k += 1 + k / 20) {
      test::FailingAllocation failing(k, false);
      const std::int32_t code = call();
      failing.end();
      if (!failing.has_failed()) break;
      if (code == 0) continue;  // it went on without
      EXPECT_EQ(code, 1) << name << ", " << k << ": " << gliss_last_error();
      EXPECT_STRNE(gliss_last_error(), "");
      ++failures;
    }
    EXPECT_EQ(call(), 0) << name;
    return failures;
  };
  const auto fails_until_done = [&](const char* name, const auto& call) {
    EXPECT_GT(failures_of(name, call), 0) << name;
  };
  const auto never_fails = [&](const char* name, const auto& call) {
    EXPECT_EQ(failures_of(name, call), 0) << name;
  };
  fails_until_done("from_arrays", [&] {
    gliss_surface* surface = nullptr;
    const std::int32_t code = ball.make(&options, &surface);
    gliss_surface_release(surface);
    return code;
  });
  fails_until_done("hand_create", [&] {
    const gliss_object object = ball.object();
    gliss_hand* hand = nullptr;
    const std::int32_t code = gliss_hand_create(&object, 1, nullptr, 0, &hand);
    gliss_hand_release(hand);
    return code;
  });
  fails_until_done("guard_create", [&] {
    gliss_guard* guard = nullptr;
    const std::int32_t code = gliss_guard_create(3, 1000, &guard);
    gliss_guard_release(guard);
    return code;
  });
  fails_until_done("nearest", [&] {
    const double point[3] = {1, 2, 3};
    gliss_contact contact;
    return gliss_surface_nearest(ball.surface, GLISS_GREGORY, point, 0, 8, 1, &contact);
  });
  const test::ScratchFolder folder;
  const std::string saved = folder / "ball.gliss";
  fails_until_done("save", [&] { return gliss_surface_save(ball.surface, saved.c_str()); });
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder / ""), {}), 1);
  const std::string mesh = folder.write("triangle.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  for (const std::string& path : {saved, mesh}) {
    fails_until_done(path.c_str(), [&] {
      gliss_surface* surface = nullptr;
      const std::int32_t code = gliss_surface_load(path.c_str(), &options, &surface);
      gliss_surface_release(surface);
      return code;
    });
  }
  const std::uint32_t face = 7;
  const double xi = 0.1, eta = -0.2;
  double a[3] = {}, b[3] = {};
  fails_until_done("evaluate",
                   [&] { return gliss_surface_evaluate(ball.surface, &face, &xi, &eta, 1, a, b); });
  const gliss_object object = ball.object();
  gliss_hand* hand = nullptr;
  gliss_guard* guard = nullptr;
  ASSERT_EQ(gliss_hand_create(&object, 1, nullptr, 0, &hand), 0);
  ASSERT_EQ(gliss_guard_create(3, 1000, &guard), 0);
  const double none[4] = {1, 0, 0, 0}, in[3] = {0, 0, 9e-3};
  gliss_contact contact;
  never_fails("bounds", [&] { return gliss_surface_bounds(ball.surface, a, b); });
  never_fails("tick", [&] { return gliss_hand_tick(hand, in, a); });
  never_fails("tick_tool", [&] { return gliss_hand_tick_tool(hand, in, none, a, b); });
  never_fails("contact", [&] { return gliss_hand_contact(hand, 0, 0, &contact); });
  never_fails("move", [&] { return gliss_hand_move(hand, 0, none, a); });
  never_fails("guard_step", [&] { return gliss_guard_step(guard, 1, 1, a, b, nullptr); });
  gliss_hand_release(hand);
  gliss_guard_release(guard);
}

}  // namespace
}  // namespace gliss
