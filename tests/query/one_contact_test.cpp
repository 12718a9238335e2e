// One contact, one truth: whoever asks gets the same forces, and a contact ends where the HIP has
// crossed the surface and not before, on open meshes as on closed ones.
#include <array>
#include <cstring>

#include "gliss/contact/tracker.h"
#include "gliss/generate/generate.h"
#include "gliss/query/trace.h"
#include "gliss/surface/names.h"
#include "gliss/walk/walk.h"
#include "tests/oracle/union_oracle.h"
#include "tests/support/open_meshes.h"
#include "tests/support/random_meshes.h"
#include "tests/support/sharp_meshes.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using oracle::Rng, oracle::uniform, oracle::random_unit;

std::vector<Mesh> meshes() {
  return {test::sheet(),       test::sheet(1.5),   test::half_torus(),
          test::fan_of_five(), thin_plate().mesh,  fin().mesh,
          goldberg(2).mesh,    banana(13, 6).mesh, prism(5).mesh};
}

// Random triangles: solids whose normals see little of their faces, so that patches fold, sheets
// with borders, and solids that stand within each other.
Mesh random_mesh(Rng& rng) {
  const auto solid = [&] {
    const double tilt = uniform(rng, 0, 1.2);
    return rng() % 2 ? test::random_sphere(rng, 12 + static_cast<int>(rng() % 30), 10, tilt)
                     : test::random_torus(rng, 60, 12, 5, tilt);
  };
  const auto beside = [&] { return Vec3(uniform(rng, 2, 12) * random_unit(rng)); };
  switch (rng() % 4) {
    case 0:
      return test::random_sheet(rng, {.shake = 0.4, .wave = 1, .tilt = uniform(rng, 0, 0.8)});
    case 1:
      return solid();
    case 2:
      return test::joined({solid(), test::moved(solid(), beside())});
    default:
      return test::joined(
          {solid(), test::moved(solid(), beside()), test::moved(solid(), beside())});
  }
}

// A HIP that wanders in, out, round rims and through, and leaps now and then. Mesh's unit.
std::vector<Vec3> wild_path(const PatchCache& cache, std::size_t ticks, std::uint64_t seed) {
  Rng rng(seed);
  const Box box = cache.bounds();
  const Vec3 middle = 0.5 * (box.low + box.high), half = 0.5 * (box.high - box.low);
  const double size = half.norm();
  const auto anywhere = [&] {
    Vec3 x = middle + 0.1 * size * random_unit(rng);
    for (int i = 0; i < 3; ++i) x[i] += uniform(rng, -1.2, 1.2) * half[i];
    return x;
  };
  std::vector<Vec3> path{anywhere()};
  Vec3 aim = path[0];
  double pace = 0;
  while (path.size() < ticks) {
    if ((aim - path.back()).norm() <= pace || pace == 0) {
      aim = anywhere();
      pace = size * std::array{1e-4, 1e-3, 1e-3, 1e-2, 0.1}[rng() % 5];
    }
    path.push_back(rng() % 500 == 0 ? anywhere()
                                    : Vec3(path.back() + uniform(rng, 0, pace) *
                                                             (aim - path.back()).normalized()));
  }
  return path;
}

// An object of every method, as it stands in the world, and how it is traced.
struct Placed {
  std::shared_ptr<PatchCache> cache;
  Pose pose = Pose::Identity();
  TraceOptions options;

  Vec3 in_object(const Vec3& at) const { return pose.inverse() * at / cache->unit; }
  Vec3 in_world(const Vec3& x) const { return pose * (cache->unit * x); }
};

Placed placed(const Mesh& mesh, Precision precision) {
  Placed object;
  object.cache = std::make_shared<PatchCache>(test::cache_of(mesh, precision));
  object.options.settle = precision == Precision::kDouble ? 5e-3 : 0;
  return object;
}

// Contacts that HIPs had with objects, and those that needed no search.
struct Met {
  std::size_t touching = 0, left_out = 0;
};

// Tracker and trace() meet the same objects with one HIP or several, from the device's position.
Met expect_same_bytes(const std::vector<Placed>& scene, const std::vector<Vec3>& hips,
                      const std::vector<Vec3>& path, const std::string& name) {
  std::vector<SceneObject> objects;
  for (const Placed& object : scene) {
    for (const Method method : object.options.methods)
      objects.push_back({.cache = object.cache,
                         .stiffness = object.options.stiffness,
                         .method = method,
                         .pose = object.pose,
                         .settle = object.options.settle});
  }
  Tracker tracker(objects, hips);
  std::vector<Vec3> ran;  // forces, [tick][hip][object]
  Met met;
  std::size_t differ = 0;
  for (const Vec3& position : path) {
    tracker.step(position);
    for (const ObjectStep& step : tracker.objects()) {
      ran.push_back(step.force);
      met.left_out += !step.searched;
    }
  }
  const std::size_t row = tracker.objects().size();
  std::size_t column = 0;
  for (const Vec3& hip : hips) {
    for (const Placed& object : scene) {
      std::vector<Vec3> way;
      for (const Vec3& position : path) way.push_back(object.in_object(position + hip));
      trace(*object.cache, way, object.options,
            [&](std::size_t tick, std::span<const TraceStep> steps) {
              for (std::size_t m = 0; m < steps.size(); ++m) {
                const Vec3 force = Vec3::Zero() + object.pose.linear() * steps[m].force;  // no -0
                differ += std::memcmp(&force, &ran[row * tick + column + m], sizeof force) != 0;
                met.touching += steps[m].contact.touching;
              }
            });
      column += object.options.methods.size();
    }
  }
  EXPECT_EQ(differ, 0u) << name;
  return met;
}

TEST(OneContact, trace_and_run_give_the_same_bytes_on_any_mesh_and_path) {
  const std::size_t ticks = std::getenv("GLISS_LONG_TESTS") ? 200'000 : 4'000;
  Rng rng(31);
  for (const Mesh& mesh : meshes()) {
    for (const Precision precision : {Precision::kDouble, Precision::kFloat}) {
      Placed object = placed(mesh, precision);
      object.cache->unit = 1;  // so that metres are the mesh's unit, and nothing is rounded
      const std::vector<Vec3> path = wild_path(*object.cache, ticks, rng());
      object.options.stiffness = uniform(rng, 100, 1000);
      const Met met = expect_same_bytes({object}, {Vec3::Zero()}, path, mesh.source);
      EXPECT_GT(met.touching, ticks / 50) << mesh.source;
      EXPECT_GT(met.left_out, 0u) << mesh.source;
    }
  }
}

// Units, poses and a second HIP by chance as well.
TEST(OneContact, trace_and_run_give_the_same_bytes_in_any_scene) {
  const bool all = std::getenv("GLISS_LONG_TESTS") != nullptr;
  const int seeds = all ? 300 : 8;
  const std::size_t ticks = all ? 20'000 : 500;
  std::size_t touching = 0, left_out = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    Rng rng(static_cast<std::uint64_t>(seed));
    std::vector<Placed> scene;
    for (int i = 0; i < 2; ++i) {
      scene.push_back(placed(random_mesh(rng), i == 0 ? Precision::kDouble : Precision::kFloat));
      Placed& object = scene.back();
      object.options.stiffness = uniform(rng, 100, 1000);
      object.cache->unit = std::array{1e-3, 1.0, 0.0254}[rng() % 3];
      object.pose = Eigen::Translation3d(uniform(rng, 0, 0.1) * random_unit(rng)) *
                    Eigen::AngleAxisd(uniform(rng, 0, 3), random_unit(rng));
    }
    std::vector<Vec3> path = wild_path(*scene.front().cache, ticks, rng());
    for (Vec3& x : path) x = scene.front().in_world(x);
    // The second HIP wanders where the second object is.
    const auto middle = [](const Placed& object) {
      const Box box = object.cache->bounds();
      return object.in_world(0.5 * (box.low + box.high));
    };
    const Met met = expect_same_bytes(scene, {Vec3::Zero(), middle(scene[1]) - middle(scene[0])},
                                      path, fmt::format("seed {}", seed));
    touching += met.touching;
    left_out += met.left_out;
  }
  EXPECT_GT(touching, static_cast<std::size_t>(seeds) * ticks / 10);
  EXPECT_GT(left_out, static_cast<std::size_t>(seeds) * ticks / 10);
}

// The largest change of the push from tick to tick, over the HIP's own way.
struct BorderSlide {
  double largest_step = 0, last_push = 0;  // mesh's unit
  std::size_t touching = 0, changes = 0;
  Contact end;
};

template <class Path>
BorderSlide slide(ContactTracker& tracker, int ticks, Path path) {
  BorderSlide result;
  Contact last = tracker.tick(path(0));
  for (int i = 1; i <= ticks; ++i) {
    const Contact contact = tracker.tick(path(static_cast<double>(i) / ticks));
    result.largest_step = std::max(result.largest_step, (contact.push - last.push).norm());
    result.changes += contact.touching != last.touching;
    result.touching += contact.touching;
    if (contact.touching) result.last_push = contact.push.norm();
    last = contact;
  }
  result.end = last;
  return result;
}

BorderSlide slide(ContactTracker& tracker, const Vec3& from, const Vec3& to, int ticks) {
  return slide(tracker, ticks, [&](double s) { return Vec3(from + s * (to - from)); });
}

class Rim : public ::testing::TestWithParam<Method> {
 protected:
  QueryOptions query() const {
    QueryOptions options;
    options.method = GetParam();
    return options;
  }
};

TEST_P(Rim, lets_a_contact_go_gently_and_once) {
  for (const double wave : {0.0, 1.0}) {
    const PatchCache cache = test::cache_of(test::sheet(wave));
    for (const Vec3& way : {Vec3(9, 1, 0), Vec3(-9, 0.3, 0), Vec3(8, 8.5, 0), Vec3(0.1, -9, 0)}) {
      ContactTracker tracker(cache, query());
      const auto beneath = [&](double s) {
        const double x = (0.5 + s) * way.x(), y = (0.5 + s) * way.y();
        return Vec3(x, y, test::sheet_height(wave, x, y) - 0.5);
      };
      tracker.tick(beneath(0) + Vec3(0, 0, 3));
      constexpr int kTicks = 3000;
      const BorderSlide felt = slide(tracker, kTicks, beneath);
      EXPECT_GT(felt.touching, kTicks / 3u);
      EXPECT_EQ(felt.changes, 1u) << wave << ": " << way.transpose();
      EXPECT_FALSE(felt.end.touching);
      EXPECT_LT(felt.last_push, 0.02) << wave << ": " << way.transpose();
      // Flat polygons and force shading jump at the edges of a wave.
      if (GetParam() == Method::kGregory || wave == 0) {
        EXPECT_LT(felt.largest_step, 1.7 * way.norm() / kTicks) << wave << ": " << way.transpose();
      }
    }
  }
}

TEST_P(Rim, lets_a_hip_pass_behind_that_came_round_it) {
  const PatchCache cache = test::cache_of(test::sheet(1.5));
  ContactTracker tracker(cache, query());
  tracker.tick({16, 0, 3});
  EXPECT_EQ(slide(tracker, {16, 0, 3}, {16, 0, -3}, 100).touching, 0u);
  EXPECT_EQ(slide(tracker, {16, 0, -3}, {1, 2, -3}, 100).touching, 0u);
  // Out through the sheet, and in again.
  EXPECT_EQ(slide(tracker, {1, 2, -3}, {1, 2, 4}, 1000).touching, 0u);
  EXPECT_TRUE(slide(tracker, {1, 2, 4}, {1, 2, -2}, 1000).end.touching);
}

TEST_P(Rim, keeps_a_leaping_hip_on_the_side_that_it_came_from) {
  const PatchCache cache = test::cache_of(test::sheet(1.5));
  Rng rng(8);
  for (int i = 0; i < 300; ++i) {
    const auto beside = [&](double z) { return Vec3(uniform(rng, -6, 6), uniform(rng, -6, 6), z); };
    const Vec3 above = beside(uniform(rng, 2, 60)), below = beside(-uniform(rng, 2, 9));
    ContactTracker from_above(cache, query()), from_below(cache, query());
    from_above.tick(above);
    EXPECT_TRUE(from_above.tick(below).touching) << above.transpose();
    from_below.tick({40, 0, 5});
    from_below.tick({40, 0, -40});
    from_below.tick({0, 0, -40});
    ASSERT_FALSE(from_below.tick(below).touching);
    EXPECT_FALSE(from_below.tick(above).touching) << below.transpose();
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, Rim,
                         ::testing::Values(Method::kGregory, Method::kShaded, Method::kFlat),
                         [](const auto& info) { return std::string(method_name(info.param)); });

// A leap out of one solid through another is stopped there.
TEST(OneContact, of_a_hip_that_leaps_out_is_looked_for_along_its_way) {
  const Mesh one = thin_plate(6, 6, 30, 0.5).mesh;
  const PatchCache cache = test::cache_of(test::joined({one, test::moved(one, Vec3(0, 0, 20))}));
  const Vec3 middle = 0.5 * (cache.bounds().low + cache.bounds().high);
  Rng rng(12);
  for (int i = 0; i < 300; ++i) {
    ContactTracker tracker(cache, {});
    const Vec3 at(uniform(rng, -9, 9), uniform(rng, -9, 9), 0);
    const double below = middle.z() - 10;  // the lower plate's middle
    tracker.tick({at.x(), at.y(), below + 2});
    ASSERT_TRUE(tracker.tick({at.x(), at.y(), below + 0.1}).touching);
    const Vec3 beyond(uniform(rng, -9, 9), uniform(rng, -9, 9),
                      middle.z() + 10 + uniform(rng, 1, 200));
    Contact contact = tracker.tick(beyond);
    // What a tick may not spend, the next ones do.
    for (int late = 0; late < 10 && !contact.touching; ++late) contact = tracker.tick(beyond);
    ASSERT_TRUE(contact.touching) << i;
    EXPECT_LT(contact.normal.z(), -0.9);
    EXPECT_NEAR(contact.scp.z(), middle.z() + 10 - 0.25, 0.05);
  }
}

// A sheet beside it makes no ball a skin: where a HIP leaps into the ball from behind the sheet, it
// is inside.
TEST(OneContact, begins_with_a_solid_part_behind_an_open_one) {
  constexpr double kRadius = 4, kBelow = 8;
  const Mesh ball = test::moved(goldberg(3, kRadius).mesh, Vec3(0, 0, -kBelow));
  const PatchCache cache = test::cache_of(test::joined({test::sheet(), ball}));
  Rng rng(3);
  for (int i = 0; i < 300; ++i) {
    ContactTracker tracker(cache, {});
    for (const Vec3& round : {Vec3(40, 0, 5), Vec3(40, 0, -40), Vec3(0, 0, -40)})
      tracker.tick(round);
    const double angle = uniform(rng, 0, 2 * std::numbers::pi);
    const Vec3 behind(9 * std::cos(angle), 9 * std::sin(angle), -uniform(rng, 0.5, kBelow));
    const Vec3 inside = Vec3(0, 0, -kBelow) + uniform(rng, 0, 0.9) * kRadius * random_unit(rng);
    ASSERT_FALSE(tracker.tick(behind).touching) << behind.transpose();
    const Contact contact = tracker.tick(inside);
    ASSERT_TRUE(contact.touching) << behind.transpose() << " to " << inside.transpose();
    EXPECT_GT((contact.scp - inside).dot(contact.normal), 0);
  }
}

TEST(OneContact, survives_a_position_that_is_no_number) {
  const PatchCache cache = test::cache_of(goldberg(2).mesh);
  ContactTracker tracker(cache, {});
  tracker.tick({0, 0, 12});
  const Contact before = tracker.tick({0, 0, 9.5});
  ASSERT_TRUE(before.touching);
  const Contact lost = tracker.tick({0, std::nan(""), 9.5});
  EXPECT_FALSE(lost.touching);
  EXPECT_EQ(lost.push, Vec3::Zero());
  const Contact after = tracker.tick({0, 0, 9.5});
  EXPECT_TRUE(after.touching);
  EXPECT_LT((after.push - before.push).norm(), 1e-9);
}

// The cache is another one sixty times a second, as of a host that loads it again and again: the
// contact goes on with the bytes that it has, and on one of another level it moves no farther than
// the two surfaces are apart.
TEST(OneContact, goes_on_where_its_cache_is_swapped) {
  for (const Mesh& mesh :
       {test::with_normals(goldberg(4).mesh), test::with_normals(irregular(torus(24, 12), 3).mesh),
        test::with_creases(cube(3, 20).mesh)}) {
    const PatchCache one = test::cache_of(mesh), same = one;
    BuildOptions coarse;
    coarse.level = {Level::kTable, kTableCells};
    const PatchCache other = build_cache(mesh, coarse);
    WalkOptions walk{.depth = walk_depth(mesh), .walkers = 4, .ticks = 2000};
    for (const Walk& way : walk_paths(mesh, build_topology(mesh), walk)) {
      for (const Method method : {Method::kGregory, Method::kShaded, Method::kFlat}) {
        for (const double friction : {0.0, 0.5}) {
          QueryOptions query;
          query.method = method;
          query.friction = {friction, 0.6 * friction};
          ContactTracker still(one, query), swapped(one, query), changed(one, query);
          for (std::size_t i = 0; i < way.hips.size(); ++i) {
            const bool odd = i / 16 % 2 == 1;
            if (i % 16 == 0) swapped.move_to(odd ? same : one), changed.move_to(odd ? other : one);
            const Contact want = still.tick(way.hips[i]), got = swapped.tick(way.hips[i]),
                          near = changed.tick(way.hips[i]);
            ASSERT_EQ(got.push, want.push) << method_name(method) << " " << i;
            ASSERT_EQ(got.scp, want.scp);
            ASSERT_EQ(got.flags, want.flags);
            ASSERT_EQ(near.touching, want.touching) << method_name(method) << " " << i;
            ASSERT_LT((near.push - want.push).norm(), 0.05 * walk.depth);
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace gliss
