// Effects of a contact: they follow their laws, step nowhere, and make no energy.
#include "gliss/query/effects.h"

#include <cstring>
#include <numbers>
#include <random>

#include "gliss/generate/generate.h"
#include "gliss/query/trace.h"
#include "gliss/walk/walk.h"
#include "tests/oracle/oracle.h"
#include "tests/support/open_meshes.h"
#include "tests/support/sharp_meshes.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using oracle::Rng, oracle::uniform;

constexpr double kPerMetre = 500;  // N/m

TextureOptions grating(double height, double period, const Vec3& along = Vec3::UnitX()) {
  return {Relief::kGrating, height, period, along};
}
TextureOptions noise(double height, double period) { return {Relief::kNoise, height, period}; }

// Presses a HIP on a mesh and feels what a tracker and effects make of it.
class Touched {
 public:
  Touched(const Mesh& mesh, const EffectOptions& effects, const QueryOptions& query = {})
      : cache_(test::cache_of(mesh)),
        tracker_(cache_, query),
        effects_(effects, kPerMetre, cache_.unit) {}

  Vec3 tick(const Vec3& hip) {
    effects_.see(hip);
    contact_ = tracker_.tick(hip);
    return effects_.force(contact_, tracker_);
  }
  const Contact& contact() const { return contact_; }
  const ContactTracker& tracker() const { return tracker_; }
  const PatchCache& cache() const { return cache_; }
  // k (D + h)^2 / 2 of the last tick, J.
  double energy(const Vec3& hip, const Texture& texture) const {
    if (!contact_.touching) return 0;
    const ContactFoot foot = tracker_.foot(hip, contact_);
    const double depth = cache_.unit * foot.depth + texture.at(cache_.unit * foot.point).height;
    return 0.5 * kPerMetre * std::pow(std::max(0.0, depth), 2);
  }

 private:
  PatchCache cache_;
  ContactTracker tracker_;
  Effects effects_;
  Contact contact_;
};

Mesh effects_ball() { return test::with_normals(goldberg(4).mesh); }  // of 10 mm

TEST(Texture, has_the_slope_of_its_height_and_keeps_its_bounds) {
  Rng rng(1);
  for (const TextureOptions& options : {grating(2e-4, 2e-3, Vec3(1, 2, 0.5)), noise(2e-4, 2e-3)}) {
    ASSERT_EQ(fault_of(options), nullptr);
    const Texture texture(options);
    double slope = 0, low = 0, high = -1;
    for (int i = 0; i < 20'000; ++i) {
      const Vec3 at = 0.05 * oracle::random_unit(rng) * uniform(rng, 0, 1);
      const Texture::Place here = texture.at(at);
      const Vec3 way = oracle::random_unit(rng);
      const double step = 1e-7;
      const Texture::Place ahead = texture.at(at + step * way),
                           behind = texture.at(at - step * way);
      ASSERT_NEAR((ahead.height - behind.height) / (2 * step), here.slope.dot(way), 1e-6);
      slope = std::max(slope, here.slope.norm());
      low = std::min(low, here.height);
      high = std::max(high, here.height);
    }
    EXPECT_GE(low, -2e-4);
    EXPECT_LE(high, 0);
    EXPECT_LT(low, -1.5e-4);  // they are used
    EXPECT_GT(high, -0.5e-4);
    EXPECT_LE(slope, texture.steepest() * (1 + 1e-9));
    EXPECT_GT(slope, 0.4 * texture.steepest());
  }
}

TEST(Texture, is_the_same_noise_everywhere_and_flat_far_away) {
  const Texture texture(noise(1, 1));
  EXPECT_EQ(texture.at({3, -5, 7}).height, -0.5);  // a corner of cells
  for (const double far : {1e20, 1e300, -1e300})
    EXPECT_TRUE(texture.at({far, 0, 0}).slope.isZero(0));
}

TEST(Effects, refuse_what_is_none) {
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  for (const double bad : {-1.0, 21.0, nan, inf}) {
    EXPECT_NE(fault_of(EffectOptions{.damping = bad}), nullptr);
    EXPECT_NE(fault_of(EffectOptions{.viscosity = bad}), nullptr);
  }
  for (const double bad : {-1.0, nan, inf}) {
    EXPECT_NE(fault_of(EffectOptions{.magnet = {bad, 1}}), nullptr);
    EXPECT_NE(fault_of(EffectOptions{.magnet = {1, bad}}), nullptr);
    EXPECT_NE(fault_of(EffectOptions{.texture = noise(bad, 1)}), nullptr);
    EXPECT_NE(fault_of(EffectOptions{.texture = noise(1e-5, bad)}), nullptr);
  }
  EXPECT_NE(fault_of(EffectOptions{.magnet = {1, 0}}), nullptr);
  EXPECT_NE(fault_of(grating(1e-3, 1e-3)), nullptr);  // too steep
  EXPECT_NE(fault_of(grating(1e-5, 1e-3, Vec3::Zero())), nullptr);
  EXPECT_EQ(fault_of(grating(3e-4, 1e-3)), nullptr);
  EXPECT_EQ(fault_of(EffectOptions{}), nullptr);
  EXPECT_FALSE(EffectOptions{}.any());
  const PatchCache cache = test::cache_of(effects_ball());
  TraceOptions options;
  options.effects.damping = -1;
  EXPECT_THROW(trace(cache, {}, options), std::invalid_argument);
}

// A sheet of 20 mm, z = 0, from above: k d (1 + damping v) with v measured over the window.
TEST(Effects, damp_by_hunt_and_crossleys_law) {
  constexpr double kDamping = 2, kStep = 0.02;  // mm a tick: 20 mm/s
  Touched sheet(test::sheet(), {.damping = kDamping});
  double last = 0;
  const auto feel = [&](double z, double v) {  // m/s, inwards
    const Vec3 force = sheet.tick({0, 0, z});
    const double depth = std::max(0.0, -z) * 1e-3;
    EXPECT_NEAR(force.z(), kPerMetre * depth * (1 + kDamping * v), 1e-9);
    EXPECT_GE(force.z(), 0);
    // A step of the spring's own, and of what a change of velocity makes of it.
    EXPECT_LE(std::abs(force.z() - last), kPerMetre * kStep * 1e-3 * 1.1 + 0.02 * last + 1e-9);
    last = force.z();
  };
  double z = 0.3;
  for (int i = 0; i < 9; ++i) sheet.tick({0, 0, z -= kStep});
  while (z > -1) feel(z -= kStep, 0.02);
  for (int i = 0; i < 8; ++i) feel(z += kStep, 0.02 * (6 - 2 * i) / 8);
  while (z < 0.1) feel(z += kStep, -0.02);
}

TEST(Effects, never_pull_nor_push_more_than_twice_the_spring_by_damping) {
  Touched sheet(test::sheet(), {.damping = EffectOptions::kMostDamping});
  Rng rng(3);
  double z = 1;
  int zero = 0, twice = 0;
  for (int i = 0; i < 5000; ++i) {
    const Vec3 force = sheet.tick({0, 0, z});
    const double spring = kPerMetre * 1e-3 * std::max(0.0, -z);
    EXPECT_GE(force.z(), 0);
    EXPECT_LE(force.z(), 2 * spring + 1e-12);
    zero += z < 0 && force.z() == 0;
    twice += z < 0 && force.z() >= 2 * spring - 1e-12;
    z = std::clamp(z + uniform(rng, -1, 1), -2.0, 1.0);
  }
  EXPECT_GT(zero, 100);
  EXPECT_GT(twice, 100);
}

TEST(Effects, resist_inside_alone_by_viscosity) {
  constexpr double kViscosity = 3;
  Touched sheet(test::sheet(), {.viscosity = kViscosity});
  Vec3 hip(-5, 0, 0.5);
  const Vec3 way(0.01, 0.005, -0.005);  // mm a tick
  for (int i = 0; i < 10; ++i) sheet.tick(hip += way);
  for (int i = 0; i < 200; ++i) {
    const Vec3 force = sheet.tick(hip += way);
    const double depth = std::max(0.0, -hip.z()) * 1e-3, share = std::min(1.0, depth / 1e-4);
    const Vec3 want = kPerMetre * depth * Vec3::UnitZ() - share * kViscosity * way;  // mm/ms = m/s
    EXPECT_LT((force - want).norm(), 1e-9) << hip.z();
  }
  EXPECT_LT(hip.z(), -0.2);
}

TEST(Effects, pull_by_a_magnet_from_outside_alone) {
  const EffectOptions options{.magnet = {0.5, 2e-3}};
  Touched sheet(test::sheet(), options);
  Vec3 last = Vec3::Zero();
  double most = 0;
  for (double z = 3; z > -0.5; z -= 0.01) {
    const Vec3 force = sheet.tick({1, 2, z});
    const double u = z / 2;
    const double want = z <= 0  ? -kPerMetre * 1e-3 * z
                        : u < 1 ? -0.5 * std::pow(4 * u * (1 - u), 2)
                                : 0;
    EXPECT_NEAR(force.z(), want, 1e-9) << z;
    EXPECT_LT(std::hypot(force.x(), force.y()), 1e-9);
    if (z < 2.99) {
      EXPECT_LE((force - last).norm(), std::max(kPerMetre, options.magnet.stiffness()) * 1.001e-5);
    }
    most = std::max(most, -force.z());
    last = force;
  }
  EXPECT_NEAR(most, 0.5, 1e-3);
}

// The gain of a closed path about a ball of 10 mm.
double gain_round(const TraceOptions& options, double radius, int ticks) {
  static const PatchCache cache = test::cache_of(effects_ball());
  const Eigen::AngleAxisd tilt(1, Vec3(3, 2, 1).normalized());
  std::vector<Vec3> hips;
  for (int i = 0; i <= ticks + 20; ++i) {
    const double turn = 2 * std::numbers::pi * i / ticks;
    hips.push_back(Vec3(0.4, 0.3, 0.2) + tilt * (radius * Vec3(std::cos(turn), std::sin(turn), 0)));
  }
  return std::abs(trace(cache, hips, options)[0].loop_gain.gain);
}

TEST(Effects, of_textures_and_magnets_make_no_energy) {
  TraceOptions options;
  options.stiffness = kPerMetre;
  options.methods = {Method::kGregory};
  for (const TextureOptions& texture :
       {grating(5e-5, 2e-3, Vec3(1, 0.5, 0.2)), noise(1e-4, 1e-3)}) {
    options.effects = {.texture = texture};
    const double fine = gain_round(options, 8, 200'000);
    EXPECT_LT(fine, 1e-6);
    test::record(name_of(kReliefNames, texture.relief),
                 "{:.1e} of the force times the way of a loop", fine);
  }
  options.effects = {.magnet = {0.5, 3e-3}};
  EXPECT_LT(gain_round(options, 11.5, 200'000), 1e-6);
}

// Central differences of the energy, at HIPs at any depth beneath several meshes.
TEST(Effects, of_textures_are_the_gradient_of_their_energy) {
  Rng rng(5);
  for (const Mesh& mesh :
       {effects_ball(), torus_knot(60, 8).mesh, test::with_normals(irregular(torus(), 7).mesh)}) {
    const double depth = 2 * walk_depth(mesh), per = mesh.unit;
    const TextureOptions options = noise(0.2 * depth * per, depth * per);
    const Texture texture(options);
    Touched touched(mesh, {.texture = options});
    WalkOptions walk;
    walk.depth = depth;
    walk.walkers = 5;
    walk.ticks = 100;
    walk.step = 0.5;
    std::vector<double> errors;
    for (const Walk& way : walk_paths(mesh, build_topology(mesh), walk)) {
      for (std::size_t i = 0; i < way.hips.size(); ++i) {
        const Vec3 hip = way.hips[i];
        const Vec3 force = touched.tick(hip);
        if (!touched.contact().touching || is_settling(touched.contact().flags)) continue;
        const double step = 1e-4 * depth;
        Vec3 falls;
        for (int axis = 0; axis < 3; ++axis) {
          const Vec3 aside = step * Vec3::Unit(axis);
          falls[axis] =
              (touched.energy(hip - aside, texture) - touched.energy(hip + aside, texture)) /
              (2 * step * per);
        }
        errors.push_back((force - falls).norm() / (kPerMetre * per * depth));
      }
    }
    ASSERT_GT(errors.size(), 300u);
    std::sort(errors.begin(), errors.end());
    EXPECT_LT(errors[errors.size() * 9 / 10], 1e-6) << mesh.source;  // others cross an edge
    EXPECT_LT(errors.back(), 0.05) << mesh.source;
  }
}

// Force and relief of the hand's path from tick to tick: no leap where patches join.
TEST(Effects, leave_textures_without_steps_where_patches_join) {
  const Mesh mesh = effects_ball();
  const double depth = 2 * walk_depth(mesh), per = mesh.unit;
  const TextureOptions options = grating(0.2 * depth * per, 2 * depth * per);
  const Texture texture(options);
  // The most that the slope of a grating changes by, 1/m.
  const double wave = 2 * std::numbers::pi / options.period,
               sharpest = options.height / 2 * wave * wave;
  Touched touched(mesh, {.texture = options});
  WalkOptions walk;
  walk.depth = depth;
  walk.walkers = 4;
  walk.ticks = 2000;
  for (const Walk& way : walk_paths(mesh, build_topology(mesh), walk)) {
    Vec3 last = Vec3::Zero(), last_hip = way.hips[0];
    for (const Vec3& hip : way.hips) {
      const Vec3 force = touched.tick(hip);
      // The spring, the grooves' slope on it, and how that slope changes.
      const double stiff = kPerMetre * (1 + 2 * texture.steepest() + sharpest * depth * per);
      EXPECT_LE((force - last).norm(), 1.3 * stiff * per * (hip - last_hip).norm() + 1e-3);
      last = force;
      last_hip = hip;
    }
    touched.tick(mesh.positions[0] * 3);
  }
}

TEST(Effects, that_are_off_leave_the_bytes) {
  const Mesh mesh = torus_knot(60, 8).mesh;
  const PatchCache cache = test::cache_of(mesh);
  WalkOptions walk;
  walk.depth = walk_depth(mesh);
  walk.walkers = 2;
  walk.ticks = 300;
  const std::vector<Walk> ways = walk_paths(mesh, build_topology(mesh), walk);
  std::vector<Vec3> plain, none;
  TraceOptions options;
  const auto keep = [](std::vector<Vec3>& all) {
    return [&all](std::size_t, std::span<const TraceStep> steps) {
      for (const TraceStep& step : steps) all.push_back(step.force);
    };
  };
  trace(cache, ways[0].hips, options, keep(plain));
  options.effects = {.magnet = {0, 1}, .texture = noise(0, 1)};
  trace(cache, ways[0].hips, options, keep(none));
  ASSERT_EQ(plain.size(), none.size());
  EXPECT_EQ(std::memcmp(plain.data(), none.data(), sizeof(Vec3) * plain.size()), 0);
}

// With friction beside it the texture's force is that without: of a potential of the HIP alone.
TEST(Effects, add_texture_to_friction) {
  QueryOptions query;
  query.friction = {0.5, 0.3};
  const EffectOptions options{.texture = grating(5e-5, 2e-3)};
  const Mesh mesh = effects_ball();
  Touched rubbed(mesh, options, query), smooth(mesh, options), dry(mesh, {}, query), bare(mesh, {});
  const auto far = Vec3(0, 0, 12);
  for (Touched* each : {&rubbed, &smooth, &dry, &bare}) each->tick(far);
  int slips = 0;
  for (int i = 0; i < 600; ++i) {
    const double aside = std::max(0, i - 200) * 0.01;
    const Vec3 hip(aside, 0.3 * aside, 12 - 0.02 * std::min(i, 200));
    const Vec3 both = rubbed.tick(hip);
    slips += is_slipping(rubbed.contact().flags);
    EXPECT_LT((both - (smooth.tick(hip) + dry.tick(hip) - bare.tick(hip))).norm(), 1e-6) << i;
  }
  EXPECT_GT(slips, 100);
}

// A mass in the grip of a damped spring, 6 s, or 60 with GLISS_LONG_TESTS: once the grip rests, so
// does it, whatever the effects.
TEST(Effects, let_a_mass_in_a_hand_come_to_rest) {
  const int ticks = std::getenv("GLISS_LONG_TESTS") ? 60'000 : 6000;
  constexpr double kMass = 0.1, kGrip = 300, kDamping = 1.5, kTick = 1e-3;
  const EffectOptions all[] = {
      {.damping = 20},
      {.viscosity = 20},
      {.magnet = {0.3, 3e-3}},
      {.texture = noise(5e-5, 2e-3)},
      {.damping = 2, .viscosity = 1, .magnet = {0.2, 2e-3}, .texture = grating(5e-5, 2e-3)}};
  for (const EffectOptions& options : all) {
    for (const double press : {-1e-3, 2e-3}) {  // of the grip, m
      QueryOptions query;
      query.friction = {0.4, 0.3};
      Touched touched(effects_ball(), options, query);
      const double unit = touched.cache().unit, top = 10e-3;
      Vec3 grip(0, 0, top + 10e-3), x = grip, v = Vec3::Zero();
      for (int i = 0; i < ticks; ++i) {
        const double t = i * kTick;
        if (i < 2000) {
          grip = Vec3(2e-3 * std::sin(5 * t), 1e-3 * std::sin(7 * t),
                      top - press + 8e-3 * std::max(0.0, 1 - t) * std::cos(20 * t));
        }
        const Vec3 felt = touched.tick(x / unit);
        ASSERT_TRUE(felt.allFinite());
        for (int part = 0; part < 10; ++part) {
          v += kTick / 10 / kMass * (felt + kGrip * (grip - x) - kDamping * v);
          x += kTick / 10 * v;
        }
      }
      EXPECT_LT(v.norm(), 1e-4) << &options - all << ", " << press;
    }
  }
}

// HIPs that are none, jumps, and the middle of a ball, from where its surface is as far everywhere.
TEST(Effects, are_finite_whatever_the_hand_does) {
  Rng rng(7);
  const EffectOptions options{
      .damping = 5, .viscosity = 5, .magnet = {1, 5e-3}, .texture = noise(1e-4, 1e-3)};
  for (const Mesh& mesh : {effects_ball(), test::sheet(1.5), test::with_normals(fin().mesh),
                           test::with_creases(test::with_normals(cube(2, 20).mesh))}) {
    Touched touched(mesh, options);
    const Box box = touched.cache().bounds();
    const double size = (box.high - box.low).norm();
    Vec3 hip = box.high;
    for (int i = 0; i < 3000; ++i) {
      const double nan = std::numeric_limits<double>::quiet_NaN();
      if (i % 501 == 500) hip = 0.5 * (box.low + box.high);
      const bool is_none = i % 97 == 96;
      const Vec3 force = touched.tick(is_none ? Vec3(hip.x(), nan, 0) : hip);
      ASSERT_TRUE(force.allFinite()) << i;
      if (is_none) {
        EXPECT_TRUE(force.isZero(0));
      }
      hip += size * std::pow(10, uniform(rng, -6, -1)) * oracle::random_unit(rng) +
             0.02 * (0.5 * (box.low + box.high) - hip);
    }
  }
}

// Depth exactly 0, or as near to it as a number comes: no way leads from the HIP to its nearest
// point. It comes from the open or begins there, rests, slides on beneath, and comes back.
TEST(Effects, of_a_hand_that_rests_on_the_surface_are_numbers) {
  EffectOptions effects{.damping = 5, .viscosity = 2, .magnet = {0.5, 2e-3}};
  for (const Mesh& mesh : {effects_ball(), test::with_creases(cube(2, 20).mesh), test::sheet()}) {
    for (const Method method : {Method::kGregory, Method::kShaded, Method::kFlat}) {
      for (const TextureOptions& texture : {grating(5e-5, 1e-3), noise(5e-5, 1e-3)}) {
        effects.texture = texture;
        QueryOptions query;
        query.method = method;
        query.friction = {0.5, 0.3};
        const PatchCache cache = test::cache_of(mesh);
        std::vector<Vec3> places(
            mesh.positions.begin(),
            mesh.positions.begin() + std::min<std::size_t>(8, mesh.positions.size()));
        for (std::uint32_t face = 0; face < std::min<std::size_t>(8, mesh.face_count()); ++face) {
          for (const double t : {0.0, 0.5, 1.0}) {
            const DomainPoint side = on_side(face, mesh.valence(face), 0, 0.5);
            const Vec3 x = evaluate(cache, {face, t * side.xi, t * side.eta}).position;
            places.push_back(nearest(cache, x, query).scp);
          }
        }
        for (const Vec3& on : places) {
          const Vec3 out = nearest(cache, on, query).normal, way = out.unitOrthogonal();
          for (const bool begins_there : {true, false}) {
            Touched touched(mesh, effects, query);
            const auto feel = [&](const Vec3& hip) {
              const Vec3 force = touched.tick(hip);
              const Contact& c = touched.contact();
              EXPECT_TRUE(force.allFinite() && c.push.allFinite() && c.scp.allFinite() &&
                          std::isfinite(c.residual_angle))
                  << method_name(method) << " at " << on.transpose();
              EXPECT_NEAR(c.normal.norm(), 1, 1e-6);
              EXPECT_TRUE(std::isfinite(touched.tracker().cone_share()));
              EXPECT_TRUE(touched.tracker().foot(hip, c).moves.allFinite());
              return force.norm();
            };
            if (!begins_there) {
              for (int i = 10; i > 0; --i) feel(on + 0.01 * i * out);
            }
            for (int i = 0; i < 10; ++i) EXPECT_LT(feel(on), 1e-9);
            for (int i = 1; i <= 10; ++i) feel(on - 0.01 * i * out + 0.01 * i * way);
            for (int i = 9; i >= 0; --i) feel(on - 0.01 * i * out + 0.01 * i * way);
            for (int i = 0; i < 10; ++i) feel(on);
            EXPECT_LT(feel(on), 1e-9);
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace gliss
