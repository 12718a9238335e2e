// Numbers that are finite and absurd, under checksums that are right: in caches and scenes. They
// are refused by name, or what comes of them is finite, or a failure that the guard sees.
#include <gmock/gmock.h>

#include "gliss/build/build_cache.h"
#include "gliss/contact/tracker.h"
#include "gliss/device/guard.h"
#include "gliss/engine/engine.h"
#include "gliss/files/cache_check.h"
#include "gliss/files/cache_file.h"
#include "gliss/files/cache_format.h"
#include "gliss/query/contact_tracker.h"
#include "gliss/query/trace.h"
#include "gliss/surface/layout.h"
#include "gliss/sweep/sweep.h"
#include "gliss/validate/validate.h"
#include "tests/oracle/union_oracle.h"
#include "tests/support/scene_files.h"
#include "tests/support/scratch_folder.h"

namespace gliss {
namespace {

using ::testing::HasSubstr;

PatchCache forged(const PatchCache& cache, const std::function<void(PatchCache&)>& forge) {
  PatchCache copy = cache;
  forge(copy);
  return copy;
}

std::string refusal(const PatchCache& cache) {
  return test::message_of<CacheError>([&] { check_cache(cache, "forged"); });
}

// Another number in place of one of a section's; through a file, whose checksums are then right.
class Forger {
 public:
  Forger() {
    const Mesh two = test::joined({goldberg().mesh, test::moved(goldberg().mesh, Vec3(6, 0, 0))});
    for (const Precision precision : {Precision::kFloat, Precision::kDouble}) {
      for (const Mesh& mesh : {torus(6, 4).mesh, fin().mesh, two})
        sound_.push_back(build_cache(mesh, {.precision = precision}));
      sound_.push_back(
          build_cache(torus(6, 4).mesh, {.precision = precision, .level = {Level::kBezier}}));
      sound_.push_back(
          build_cache(torus(6, 4).mesh, {.precision = precision, .level = {Level::kTable, 2}}));
    }
  }

  const std::vector<PatchCache>& sound() const { return sound_; }

  PatchCache forge(std::uint64_t seed) const {
    oracle::Rng rng(seed);
    PatchCache cache = sound_[seed % sound_.size()];
    const auto count = std::array{1, 1, 2, 4, 30}[rng() % 5];
    for (int i = 0; i < count; ++i) mutate(cache, rng);
    return cache;
  }

 private:
  static double odd(oracle::Rng& rng) {
    constexpr double kOdd[] = {0.0,  -0.0,  1e308, -1e308, 5e-324, 1e-300,  1e150, -1e150,
                               1e60, 1e200, 1.0,   -1.0,   1e30,   3e38,    1e18,  1e9,
                               -1e9, 1e5,   100,   0x1p30, 1e-9,   0x1p-540};
    return kOdd[rng() % std::size(kOdd)];
  }

  static void mutate(PatchCache& cache, oracle::Rng& rng) {
    const std::uint64_t chosen = rng() % (cache_format::kSections + 3);
    if (chosen == cache_format::kSections) cache.unit = odd(rng);
    if (chosen == cache_format::kSections + 1) cache.origin[static_cast<int>(rng() % 3)] = odd(rng);
    if (chosen == cache_format::kSections + 2)
      cache.scale = std::ldexp(1, 1 + static_cast<int>(rng() % 2000) - 1000);
    std::uint64_t section = 0;
    cache_format::for_each_section(cache, [&](const char*, auto& values) {
      if (section++ != chosen || values.empty()) return;
      mutate(values, rng);
    });
  }

  template <class T, class A>
  static void mutate(std::vector<T, A>& values, oracle::Rng& rng) {
    T& value = values[rng() % values.size()];
    if constexpr (std::is_floating_point_v<T>) {
      const double most = static_cast<double>(std::numeric_limits<T>::max());
      const auto other = [&](T x) {
        const double wanted = rng() % 2 == 0
                                  ? odd(rng)
                                  : static_cast<double>(x) *
                                        std::array{-1.0, 1e10, 1e-10, 0.0, 1.5, 1e150}[rng() % 6];
        return static_cast<T>(std::clamp(wanted, -most, most));
      };
      if (rng() % 8 == 0) {
        const T all = other(value);
        std::fill(values.begin(), values.end(), all);
      } else {
        value = other(value);
      }
    } else {
      T& second = values[rng() % values.size()];
      if (rng() % 2 == 0) {
        std::swap(value, second);
      } else {
        value = static_cast<T>(
            std::array<std::uint64_t, 6>{0, 1, 2, kNone, 0x80000000, rng() % 1000}[rng() % 6]);
      }
    }
  }

  std::vector<PatchCache> sound_;
};

bool is_finite(const Contact& c) {
  return c.scp.allFinite() && c.normal.allFinite() && std::isfinite(c.distance) &&
         c.push.allFinite();
}
// True if the contact of a HIP that is near is finite, or says that the surface is at fault.
bool is_sound(const Contact& c) {
  return c.touching ? is_finite(c) : is_finite(c) || !c.push.allFinite();
}

struct Found {
  std::uint64_t unsound = 0, failed = 0, contacts = 0;
  int iterations = 0;
  void add(const Contact& c) {
    ++contacts;
    unsound += !is_sound(c);
    failed += !c.push.allFinite();
    iterations = std::max(iterations, c.iterations);
  }
};

// Asks a cache what the program asks.
Found ask(const PatchCache& cache) {
  Found found;
  const Box box = cache.bounds();
  std::vector<Vec3> hips;
  for (int i = 0; i < 40; ++i) {
    const Vec3 mix(0.025 * i, 0.5 + 0.4 * std::sin(i), 0.5 + 0.6 * std::cos(2 * i));
    hips.push_back(box.low + mix.cwiseProduct(box.high - box.low));
  }
  constexpr Method kAll[] = {Method::kGregory, Method::kShaded, Method::kFlat};
  std::vector<Contact> contacts(hips.size() * kMethods);
  nearest(cache, hips, kAll, {{}, Method::kGregory, 2000}, contacts);
  for (const Contact& c : contacts) found.add(c);
  std::vector<DomainPoint> starts(hips.size());
  for (std::size_t i = 0; i < starts.size(); ++i)
    starts[i] = {cache.patch_face[i % cache.patch_count()], 0, 0};
  contacts.resize(hips.size());
  track(cache, hips, starts, {}, contacts);
  for (const Contact& c : contacts) found.add(c);
  ContactTracker tracker(cache, {});
  for (const Vec3& hip : hips) {
    const Contact c = tracker.tick(hip);
    found.add(c);
    EXPECT_LE(c.iterations, ContactTracker::kTickEvaluations);
  }
  return found;
}

std::uint64_t seeds(std::uint64_t few) { return std::getenv("GLISS_LONG_TESTS") ? 100 * few : few; }

TEST(HostileNumbers, of_a_cache_are_refused_or_no_query_takes_their_answer_for_none) {
  const Forger forger;
  for (const PatchCache& cache : forger.sound()) {
    EXPECT_EQ(refusal(cache), "");
    EXPECT_EQ(ask(cache).failed, 0u);
  }
  std::uint64_t accepted = 0, failed = 0;
  const std::uint64_t count = seeds(400);
  for (std::uint64_t seed = 0; seed < count; ++seed) {
    const PatchCache cache = forger.forge(seed);
    const std::string refused = refusal(cache);
    if (!refused.empty()) {
      EXPECT_THAT(refused, HasSubstr("forged: section '"));
      continue;
    }
    ++accepted;
    const Found found = ask(cache);
    EXPECT_EQ(found.unsound, 0u) << "seed " << seed;
    failed += found.failed > 0;
  }
  EXPECT_GT(accepted, count / 20);
  EXPECT_LT(accepted, count);
  EXPECT_LE(failed, accepted / 20);
  test::record("forged", "{} of {} accepted, {} of them fail aloud", accepted, count, failed);
}

TEST(HostileNumbers, of_a_cache_file_are_named_with_section_and_entry) {
  const test::ScratchFolder folder;
  const PatchCache sound = build_cache(torus(6, 4).mesh);
  const auto of = [&](const std::function<void(PatchCache&, Surface<double>&)>& forge) {
    save_cache(forged(sound, [&](PatchCache& c) { forge(c, std::get<1>(c.surface)); }),
               folder / "a.gliss");
    return test::message_of<CacheError>([&] { load_cache(folder / "a.gliss"); });
  };
  EXPECT_EQ(of([](auto&, auto&) {}), "");
  for (const double huge : {1e308, -1e308, 1e30}) {
    EXPECT_THAT(of([&](auto&, auto& s) { s.control[7] = huge; }),
                HasSubstr("'control': entry 7: "));
    EXPECT_THAT(of([&](auto&, auto& s) { s.corner[6] = huge; }), HasSubstr("'corner': entry 6: "));
    EXPECT_THAT(of([&](auto&, auto& s) { s.patch[kPatchOrigin] = huge; }),
                HasSubstr("'patch': entry 0: "));
    EXPECT_THAT(of([&](auto&, auto& s) { s.patch[kPatchSag] = huge; }),
                HasSubstr("'patch': entry "));
    EXPECT_THAT(of([&](auto&, auto& s) { s.node[3] = huge; }), HasSubstr("'node': entry 3: "));
    EXPECT_THAT(of([&](auto&, auto& s) { s.domain[9] = huge; }), HasSubstr("'domain': entry 9: "));
    EXPECT_THAT(of([&](auto& c, auto&) { c.unit = huge; }), HasSubstr("'header': the unit"));
  }
  for (const double origin : {1e61, -1e308}) {
    EXPECT_THAT(of([&](auto& c, auto&) { c.origin.y() = origin; }),
                HasSubstr("'header': the origin"));
  }
  for (const double scale : {0x1p-1074, 0x1p-500, 0x1p600}) {
    EXPECT_THAT(of([&](auto& c, auto&) { c.scale = scale; }), HasSubstr("'header': the scale"));
  }
  EXPECT_THAT(of([](auto& c, auto&) { c.unit = 1e-300; }), HasSubstr("'header': the unit"));
  // Numbers of a usual size, of no surface: a corner out of the mesh, boxes beside what they hold.
  EXPECT_THAT(of([](auto&, auto& s) { s.corner[0] = 100; }), HasSubstr("'corner': entry 0: "));
  EXPECT_THAT(of([](auto&, auto& s) { s.corner[3] = 100; }), HasSubstr("'corner': entry 3: "));
  EXPECT_THAT(of([](auto&, auto& s) { s.patch[kPatchNormal + 2] = 9; }),
              HasSubstr("'patch': entry 0: "));
  EXPECT_THAT(of([](auto&, auto& s) { s.patch[kPatchHigh] = s.patch[kPatchLow]; }),
              HasSubstr("'patch': entry 0: "));
  EXPECT_THAT(of([](auto&, auto& s) { std::fill_n(&s.node[0], 6, 0.5); }),
              HasSubstr("'node': entry "));
  EXPECT_THAT(of([](auto&, auto& s) { s.domain[9] += 0.01; }), HasSubstr("'domain': entry 9: "));
}

TEST(HostileNumbers, of_a_mesh_are_named) {
  const auto refused = [](double unit) {
    Mesh mesh = goldberg().mesh;
    mesh.source = "a";
    mesh.unit = unit;
    return test::message_of<MeshError>([&] { validate(mesh); });
  };
  EXPECT_EQ(refused(1e-3), "");
  for (const double unit : {0.0, -1.0, 1e-300, 1e300, std::nan("")})
    EXPECT_THAT(refused(unit), HasSubstr("a: the unit must be a length from 1e-15 to "));
}

// A surface that no check has seen, with a patch that is no number anywhere.
std::shared_ptr<const PatchCache> broken_ball() {
  PatchCache cache = build_cache(goldberg(3, 10).mesh);
  auto& control = std::get<1>(cache.surface).control;
  std::fill(control.begin(), control.end(), std::nan(""));
  return std::make_shared<const PatchCache>(std::move(cache));
}

TEST(HostileNumbers, of_a_surface_at_fault_make_no_free_contact) {
  const auto ball = broken_ball();
  const Contact inside = nearest(*ball, Vec3(0, 0, 9));
  EXPECT_FALSE(inside.touching);
  EXPECT_TRUE(inside.push.hasNaN());
  ContactTracker tracker(*ball, {});
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(tracker.tick(Vec3(0, 0.01 * i, 9)).push.hasNaN());
  // What is not the surface's fault makes none, as ever.
  const PatchCache sound = build_cache(goldberg(3, 10).mesh);
  for (const Vec3& hip : {Vec3(std::nan(""), 0, 0), Vec3(0, 0, 1e300), Vec3(1e5, 0, 0)}) {
    EXPECT_EQ(nearest(sound, hip).push, Vec3::Zero().eval());
    EXPECT_EQ(nearest(*ball, hip).push, Vec3::Zero().eval());
  }
}

TEST(HostileNumbers, of_a_surface_at_fault_count_in_traces_and_sweeps) {
  const auto ball = broken_ball();
  TraceOptions options;
  options.stiffness = 500;
  options.methods = {Method::kGregory};
  const std::vector<Vec3> hips(20, Vec3(0, 0, 9));
  const auto traced = trace(*ball, hips, options, {});
  EXPECT_EQ(traced.at(0).unsound, hips.size());
  EXPECT_EQ(traced.at(0).largest_step, std::numeric_limits<double>::infinity());
  SweepOptions sweeping;
  sweeping.depths = {1e-3};
  sweeping.methods = {Method::kGregory};
  sweeping.rings = 1;
  const auto engine = make_serial_engine();
  const PatchCache sound = build_cache(goldberg(3, 10).mesh);
  EXPECT_EQ(sweep(sound, *engine, sweeping, {}, {}, nullptr).statistics.at(0).error.unsound(), 0u);
  EXPECT_GT(sweep(*ball, *engine, sweeping, {}, {}, nullptr).statistics.at(0).error.unsound(), 0u);
}

TEST(HostileNumbers, of_a_surface_at_fault_end_a_loop_within_10_ms) {
  using namespace std::chrono_literals;
  const SceneObject object{.cache = broken_ball()};
  Tracker tracker({&object, 1});
  Guard guard;
  GuardOutput out;
  std::chrono::nanoseconds now{1};
  for (int tick = 0; tick < 15; ++tick, now += 1ms) {
    const Vec3 force = tracker.step(Vec3(0, 0, 9 * object.unit()));
    EXPECT_TRUE(force.hasNaN());
    out = guard.step(now, {force, now});
    EXPECT_TRUE(out.force.allFinite());
  }
  EXPECT_EQ(out.state, GuardState::kSafe);
  EXPECT_EQ(out.reason, GuardReason::kNotFinite);
}

TEST(HostileNumbers, of_a_scene_object_are_refused) {
  const auto cache = std::make_shared<const PatchCache>(build_cache(goldberg().mesh));
  const auto refused = [](const SceneObject& object, std::vector<Vec3> hips = {}) {
    return test::message_of<std::invalid_argument>([&] { Tracker({&object, 1}, hips); });
  };
  SceneObject object{.cache = cache};
  EXPECT_EQ(refused(object), "");
  object.stiffness = std::numeric_limits<double>::infinity();
  EXPECT_EQ(refused(object), "SceneObject 0 has a stiffness that is not from 0 to 1e6 N/m");
  object.stiffness = 500;
  EXPECT_EQ(refused(object, {Vec3(0, std::nan(""), 0)}), "hips: one is not finite");
  object.pose.translation().x() = std::nan("");
  EXPECT_EQ(refused(object), "SceneObject 0 has a pose that is not finite");
}

TEST(HostileNumbers, of_a_scene_are_bounded) {
  const test::SceneFiles files;
  const auto refused = [&](const std::string& line) {
    return test::message_of<SceneError>([&] {
      files.read("[[object]]\nmesh = 'ball.obj'\n" + line + "\n[sim]\nwaypoints = [[0, 0, 0]]\n");
    });
  };
  EXPECT_EQ(refused("stiffness = 1e60"), "");
  for (const std::string line : {"stiffness = 1e61", "position = [0, 1e300, 0]",
                                 "rotation = {axis = [0, 0, 1e300], degrees = 120}",
                                 "rotation = {axis = [0, 0, 1], degrees = -1e308}"})
    EXPECT_THAT(refused(line), HasSubstr("is beyond 1e+60")) << line;
}

TEST(HostileNumbers, of_a_rotation_axis_turn_as_those_of_length_1_do) {
  const test::SceneFiles files;
  const auto turned = [&](const std::string& axis) {
    return files
        .read("[[object]]\nmesh = 'ball.obj'\nrotation = {axis = [0, 0, " + axis +
              "], degrees = 120}\n")
        .objects.at(0)
        .pose.linear()
        .eval();
  };
  for (const std::string axis : {"1e60", "1e-165", "1e-300", "5e-324"})
    EXPECT_EQ(turned(axis), turned("1")) << axis;
  EXPECT_EQ(turned("-1e-300"), turned("-1"));
}

}  // namespace
}  // namespace gliss
