// A program that embeds the library and slips: too little room, caches that were moved from, a
// thread that rounds otherwise. It gets an exception, or the same bytes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cfenv>

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

#include "gliss/build/build_cache.h"
#include "gliss/compare/tessellate.h"
#include "gliss/contact/tracker.h"
#include "gliss/device/guard.h"
#include "gliss/device/replay_device.h"
#include "gliss/engine/engine.h"
#include "gliss/files/cache_file.h"
#include "gliss/files/mesh_file.h"
#include "gliss/generate/generate.h"
#include "gliss/lazy/lazy_mesh.h"
#include "gliss/loop/loop.h"
#include "gliss/query/contact_tracker.h"
#include "gliss/query/trace.h"
#include "gliss/sweep/sweep.h"
#include "tests/support/gliss_process.h"
#include "tests/support/places.h"

namespace gliss {
namespace {

using ::testing::HasSubstr;

template <class Call>
std::string refused(const Call& call) {
  return test::message_of<std::invalid_argument>(call);
}

PatchCache ball() { return build_cache(goldberg(3, 10).mesh); }

TEST(HostMisuse, meshes_without_faces_are_refused) {
  const auto why = [](const auto& call) { return test::message_of<MeshError>(call); };
  const Mesh empty;
  const auto nothing = HasSubstr("no faces to build");
  EXPECT_THAT(why([&] { build_base(empty, Topology(), Precision::kDouble); }), nothing);
  EXPECT_THAT(why([&] { build_cache(empty); }), nothing);
  EXPECT_THAT(why([&] { LazyMesh(empty, {}); }), nothing);
}

TEST(HostMisuse, lists_of_faces_are_ascending_and_in_range) {
  const Mesh mesh = goldberg(1).mesh;
  const Topology topology = build_topology(mesh);
  for (const std::vector<std::uint32_t>& faces :
       {std::vector<std::uint32_t>{1, 1}, {3, 2}, {0, 12}}) {
    BuildOptions options;
    options.faces = faces;
    EXPECT_THROW(build_cache(mesh, topology, options), MeshError);
  }
}

TEST(HostMisuse, results_with_too_little_room_are_refused_before_anything_is_written) {
  const PatchCache cache = ball();
  const std::vector<Vec3> hips(300, Vec3(0, 0, 9));
  const std::vector<DomainPoint> points(300, {cache.patch_face[0], 0, 0});
  constexpr Method kTwo[] = {Method::kGregory, Method::kFlat};
  constexpr Method kFour[] = {Method::kGregory, Method::kFlat, Method::kShaded, Method::kFlat};
  std::vector<Contact> contacts(599);
  std::vector<SurfacePoint> surface(299);
  const std::span<Contact> few(contacts.data(), 299);
  const auto short_of = HasSubstr("has room or starts for");
  for (const auto& engine : {make_serial_engine(), make_tbb_engine(2)}) {
    const auto resident = engine->reside(cache);
    EXPECT_THAT(refused([&] { resident->evaluate(points, surface); }), short_of);
    EXPECT_THAT(refused([&] { resident->project(hips, {}, few); }), short_of);
    EXPECT_THAT(refused([&] { resident->nearest(hips, kTwo, {}, contacts); }), short_of);
    EXPECT_THAT(refused([&] { resident->nearest(hips, kFour, {}, contacts); }), short_of);
    EXPECT_THAT(refused([&] { resident->track(hips, points, {}, few); }), short_of);
    EXPECT_THAT(refused([&] { resident->track(hips, std::span(points).first(299), {}, contacts); }),
                short_of);
    EXPECT_EQ(refused([&] { resident->project(hips, {}, contacts); }), "");
  }
  EXPECT_THAT(refused([&] { evaluate(cache, points, surface); }), short_of);
  EXPECT_THAT(refused([&] { track(cache, hips, points, {}, few); }), short_of);
  EXPECT_THAT(refused([&] { nearest(cache, hips, kTwo, {}, contacts); }), short_of);
  EXPECT_THAT(refused([&] { nearest(cache, hips[0], kTwo, {}, few.first(1)); }), short_of);
  EXPECT_THAT(refused([&] { nearest(cache, hips[0], kFour, {}, contacts); }), short_of);
}

TEST(HostMisuse, a_cache_that_was_moved_from_is_empty_and_says_so) {
  const test::ScratchFolder folder;
  for (const Precision precision : {Precision::kFloat, Precision::kDouble}) {
    PatchCache cache = build_cache(goldberg().mesh, {.precision = precision});
    const DomainPoint at{cache.patch_face[0], 0, 0};
    ContactTracker early(cache, {});
    const PatchCache taken = std::move(cache);
    ASSERT_EQ(cache.patch_count(), 0u);
    const auto empty = HasSubstr("the cache has no patches");
    std::vector<Contact> contacts(1);
    std::vector<SurfacePoint> surface(1);
    const std::vector<Vec3> hips(1, Vec3::Zero());
    const std::vector<DomainPoint> points(1, at);
    constexpr Method kMethod[] = {Method::kGregory};
    EXPECT_THAT(refused([&] { nearest(cache, Vec3::Zero()); }), empty);
    EXPECT_THAT(refused([&] { nearest(cache, hips, kMethod, {}, contacts); }), empty);
    EXPECT_THAT(refused([&] { track(cache, hips, points, {}, contacts); }), empty);
    EXPECT_THAT(refused([&] { evaluate(cache, at); }), empty);
    EXPECT_THAT(refused([&] { evaluate(cache, points, surface); }), empty);
    EXPECT_THAT(refused([&] { ContactTracker(cache, {}); }), empty);
    EXPECT_THAT(refused([&] { make_tbb_engine(1)->reside(cache); }), empty);
    EXPECT_THAT(refused([&] { save_cache(cache, folder / "a"); }), empty);
    EXPECT_THAT(refused([&] { trace(cache, hips, {}, {}); }), empty);
    EXPECT_THAT(refused([&] { sweep(cache, *make_serial_engine(), {}, {}, {}, nullptr); }), empty);
    EXPECT_THAT(refused([&] { cache.bounds(); }), empty);
    EXPECT_THAT(refused([&] { cache.smallest_rho(); }), empty);
    EXPECT_FALSE(in_domain(cache, at));
    EXPECT_TRUE(early.tick(Vec3::Zero()).push.hasNaN());
    EXPECT_TRUE(early.track(Vec3::Zero(), at).push.hasNaN());
    EXPECT_EQ(folder.file_count(), 0u);
    EXPECT_GT(nearest(taken, Vec3::Zero()).iterations, 0);
  }
}

// Questions of a host, made before its thread rounds otherwise.
struct Questions {
  Mesh mesh = torus(12, 8).mesh;
  std::vector<Vec3> hips, in_metres;
  std::vector<DomainPoint> points;

  Questions() {
    const PatchCache cache = build_cache(mesh);
    const Box box = cache.bounds();
    for (std::uint32_t i = 0; i < 600; ++i) {
      const Vec3 mix(0.5 + 0.45 * std::sin(0.01 * i), 0.5 + 0.4 * std::cos(0.01 * i), 0.5);
      hips.push_back(box.low + mix.cwiseProduct(box.high - box.low));
      in_metres.push_back(hips.back() * mesh.unit);
      points.push_back({i % static_cast<std::uint32_t>(mesh.face_count()), 0.1, 0.2});
    }
  }
};

// All answers, and the cache as a file.
std::vector<double> answers(const Questions& asked, const std::string& file) {
  std::vector<double> all;
  const auto add = [&](const Vec3& v) { all.insert(all.end(), v.data(), v.data() + 3); };
  const auto add_contact = [&](const Contact& c) {
    add(c.scp), add(c.normal), add(c.push);
    all.insert(all.end(), {c.distance, c.at.xi, c.at.eta, static_cast<double>(c.iterations)});
  };
  const auto engine = make_tbb_engine(2);
  const auto cache = std::make_shared<const PatchCache>(engine->build(asked.mesh));
  save_cache(*cache, file);
  const auto resident = engine->reside(*cache);
  std::vector<Contact> contacts(asked.hips.size());
  for (const Method method : {Method::kGregory, Method::kShaded, Method::kFlat}) {
    resident->project(asked.hips, {{}, method}, contacts);
    for (const Contact& c : contacts) add_contact(c);
    resident->track(asked.hips, asked.points, {{}, method}, contacts);
    for (const Contact& c : contacts) add_contact(c);
    ContactTracker tracker(*cache, {{}, method});
    for (const Vec3& hip : asked.hips) add_contact(tracker.tick(hip));
    const SceneObject object{.cache = cache, .method = method};
    Tracker hand({&object, 1});
    for (const Vec3& hip : asked.in_metres) add(hand.step(hip));
  }
  std::vector<SurfacePoint> surface(asked.points.size());
  resident->evaluate(asked.points, surface);
  for (const SurfacePoint& p : surface) add(p.position), add(p.normal);
  add(cache->bounds().high);
  return all;
}

TEST(HostMisuse, a_thread_that_rounds_otherwise_gets_the_same_bytes_and_keeps_its_way) {
  const test::ScratchFolder folder;
  const Questions asked;
  const std::vector<double> expected = answers(asked, folder / "expected");
  const auto check = [&](const char* what) {
    const std::vector<double> found = answers(asked, folder / "found");
    ASSERT_EQ(found.size(), expected.size());
    EXPECT_EQ(std::memcmp(found.data(), expected.data(), found.size() * sizeof(double)), 0) << what;
    EXPECT_TRUE(folder.read("found") == folder.read("expected")) << what;
  };
  for (const int rounding : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
    ASSERT_EQ(std::fesetround(rounding), 0);
    check("rounding");
    const int after = std::fegetround();
    std::fesetround(FE_TONEAREST);
    EXPECT_EQ(after, rounding);
  }
#if defined(__x86_64__)
  constexpr unsigned kFlushes = 0x8040;
  const unsigned before = _mm_getcsr();
  _mm_setcsr(before | kFlushes);
  check("flush to zero");
  const unsigned after = _mm_getcsr();
  _mm_setcsr(before);
  EXPECT_EQ(after & kFlushes, kFlushes);
#endif
}

TEST(HostMisuse, an_instruction_set_of_no_known_name_is_an_error) {
  const test::ScratchFolder folder;
  save_obj(torus(6, 4).mesh, folder / "a.obj");
  const auto with = [&](const char* isa) {
    return test::Process(folder.path(), test::kProgram,
                         {"bake", "a.obj", "-o", "a.gliss", "--quiet"},
                         [&] { return setenv("GLISS_ISA", isa, 1) == 0; })
        .wait();
  };
  for (const char* isa : {"bogus", "V3", "v3 ", "v33"}) {
    const test::Outcome outcome = with(isa);
    EXPECT_EQ(outcome.code, 2) << isa;
    EXPECT_EQ(outcome.err,
              "gliss: GLISS_ISA: '" + std::string(isa) + "' is not one of baseline, v3, v4\n");
    EXPECT_FALSE(std::filesystem::exists(folder / "a.gliss"));
  }
  for (const char* isa : {"baseline", "v3", "v4", ""}) EXPECT_EQ(with(isa).code, 0) << isa;
}

#if defined(__GLIBC__)
// Calls all that computes, in a process whose faulty operations end it (SIGFPE).
[[noreturn]] void compute_where_faults_are_fatal(const Mesh& mesh, const PatchCache& made) {
  feenableexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto cache = std::make_shared<const PatchCache>(build_cache(mesh));
  bool fine = nearest(*cache, Vec3(3, 4, 8)).distance == nearest(made, Vec3(3, 4, 8)).distance;
  nearest(*cache, Vec3(3, 4, 0));
  nearest(*cache, Vec3(1e300, 0, nan));
  ContactTracker contact(*cache, {});
  TraceOptions options;
  options.friction = {0.5, 0.3, 2e-3};
  options.effects = {.damping = 2, .viscosity = 1, .texture = {Relief::kNoise, 5e-5, 2e-3}};
  std::vector<Vec3> path;
  for (int i = 0; i < 300; ++i) path.push_back(Vec3(3, 4, 10 - 0.05 * i));
  path[150].x() = nan;
  for (const Vec3& hip : path) contact.tick(hip);
  trace(*cache, path, options);
  SceneObject object{.cache = cache, .friction = options.friction, .effects = options.effects};
  Tracker hand({&object, 1});
  Guard guard;
  for (int i = 0; i < 300; ++i) {
    const Vec3 force =
        hand.step(1e-3 * path[static_cast<std::size_t>(i)], Nanoseconds(1'000'000 * i));
    const GuardOutput out =
        guard.step(Nanoseconds(1'000'000 * i), {force, Nanoseconds(1'000'000 * i)});
    fine = fine && motor_force(out.force, 3).has_value();
  }
  fine = fine && !motor_force(Vec3::Constant(nan), 3);
  SweepOptions swept;
  swept.depths = {1e-3};
  swept.rings = 2;
  sweep(*cache, *make_serial_engine(), swept, {}, {}, nullptr);
  tessellate(mesh, *cache, 2);
  ReplayDevice device({{0, 0, 0.02}, {0, 0, 0.009}, {0, 0, nan}, {0, 0, 0.009}});
  Tracker felt({&object, 1});
  HapticLoop(device, felt, {.wait = false}).run([](const LoopTick&) { return true; });
  // They are fatal again.
  fine = fine && fegetexcept() == (FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW);
  std::_Exit(fine ? 0 : 1);
}

TEST(HostMisuse, survives_floating_point_exceptions_that_are_fatal) {
  const Mesh mesh = goldberg(2, 10).mesh;
  const PatchCache made = build_cache(mesh);
  EXPECT_EXIT(compute_where_faults_are_fatal(mesh, made), ::testing::ExitedWithCode(0), "");
}
#endif

}  // namespace
}  // namespace gliss
