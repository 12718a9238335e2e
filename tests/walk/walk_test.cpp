// Walks: what they are, and that a contact ends only where its HIP has crossed the surface.
#include "gliss/walk/walk.h"
#include "gliss/build/build_cache.h"
#include "gliss/files/mesh_file.h"

#include <array>
#include <map>
#include <numbers>

#include "gliss/compare/tessellate.h"
#include "gliss/engine/engine.h"
#include "gliss/generate/generate.h"
#include "gliss/query/contact_tracker.h"
#include "gliss/surface/names.h"
#include "gliss/validate/validate.h"
#include "tests/extremes/extremes.h"
#include "tests/oracle/crossing_oracle.h"
#include "tests/support/open_meshes.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using test::CrossingOracle;

WalkOptions options_of(const Mesh& mesh, std::size_t walkers, std::size_t ticks) {
  WalkOptions options;
  options.depth = walk_depth(mesh);
  options.walkers = walkers;
  options.ticks = ticks;
  return options;
}

std::vector<Walk> walks_on(const Mesh& mesh, const WalkOptions& options,
                           const ParallelFor& parallel = serial_for) {
  return walk_paths(mesh, build_topology(mesh), options, parallel);
}

TEST(Walk, enters_from_the_open_and_stays_at_its_depth_in_steps_of_one_size) {
  const Mesh mesh = test::with_normals(torus_knot().mesh);
  const PatchCache base = build_base(mesh, build_topology(mesh), Precision::kDouble);
  const WalkOptions options = options_of(mesh, 5, 400);
  const std::vector<Walk> walks = walks_on(mesh, options);
  ASSERT_EQ(walks.size(), 5u);
  test::Worst off, step;
  for (const Walk& walk : walks) {
    ASSERT_EQ(walk.hips.size(), Walk::kEntry + 400);
    const QueryOptions flat{{}, Method::kFlat};
    EXPECT_GT(nearest(base, walk.hips.front(), flat).distance, 0);
    for (std::size_t i = Walk::kEntry; i < walk.hips.size(); ++i) {
      off.add(std::abs(nearest(base, walk.hips[i], flat).distance + options.depth));
      step.add((walk.hips[i] - walk.hips[i - 1]).norm());
    }
  }
  EXPECT_LE(off.value, 0.25 * options.depth);  // it comes back slowly where polygons meet
  EXPECT_LE(step.value, 1.03 * options.step * options.depth);
  EXPECT_GE(step.value, options.step * options.depth);
}

TEST(Walk, is_the_same_on_any_number_of_threads_and_with_more_walkers) {
  const Mesh mesh = test::with_normals(banana().mesh);
  const auto engine = make_tbb_engine(3);
  const ParallelFor parallel = [&](std::size_t count, std::size_t grain, const auto& body) {
    engine->for_each(count, grain, body);
  };
  const std::vector<Walk> few = walks_on(mesh, options_of(mesh, 3, 300)),
                          many = walks_on(mesh, options_of(mesh, 6, 300), parallel);
  ASSERT_LT(few.size(), many.size());
  for (std::size_t i = 0; i < few.size(); ++i) EXPECT_EQ(few[i].hips, many[i].hips);
  WalkOptions other = options_of(mesh, 3, 300);
  other.seed = 2;
  EXPECT_NE(walks_on(mesh, other)[0].hips, few[0].hips);
  const PatchCache cache = test::cache_of(mesh);
  const double depth = walk_depth(mesh);
  const FeltWalks serial = feel_walks(cache, test::leaping(), many, depth),
                  shared = feel_walks(cache, test::leaping(), many, depth, parallel);
  EXPECT_EQ(serial.ticks, shared.ticks);
  EXPECT_EQ(serial.mean_step, shared.mean_step);
  EXPECT_EQ(serial.p99_step, shared.p99_step);
  EXPECT_EQ(serial.jumps(), shared.jumps());
}

TEST(Walk, starts_again_where_it_leaves_an_open_surface) {
  const Mesh mesh = test::with_normals(test::half_torus());
  const std::vector<Walk> walks = walks_on(mesh, options_of(mesh, 4, 20000));
  EXPECT_GT(walks.size(), 4u);
  std::size_t ticks = 0;
  for (const Walk& walk : walks) ticks += walk.hips.size() - Walk::kEntry;
  EXPECT_EQ(ticks, 4 * 20000u);
}

// There the guide is held by the side that the HIP came from, ever deeper.
TEST(Walk, ends_where_it_has_gone_through_a_thin_part) {
  const Mesh mesh = test::with_normals(thin_plate().mesh);
  const PatchCache base = build_base(mesh, build_topology(mesh), Precision::kDouble);
  WalkOptions options = options_of(mesh, 20, 2500);
  options.step = 0.1;
  const std::vector<Walk> walks = walks_on(mesh, options);
  std::size_t ended = 0;
  for (const Walk& walk : walks) {
    ContactTracker guide(base, test::leaping(Method::kShaded));
    double deepest = 0;
    for (std::size_t i = 0; i < walk.hips.size(); ++i) {
      EXPECT_LT(deepest, 3 * options.depth);
      deepest = -guide.tick(walk.hips[i]).distance;
    }
    ended += deepest >= 3 * options.depth;
  }
  test::record("through", "{} of {} walks", ended, walks.size());
  EXPECT_GT(ended, 0u);
}

TEST(Walk, tells_smooth_surfaces_from_those_that_jump) {
  const Mesh mesh = test::with_normals(torus_knot().mesh);
  const std::vector<Walk> walks = walks_on(mesh, options_of(mesh, 20, 2500));
  const PatchCache cache = test::cache_of(mesh);
  const auto felt = [&](Method method) {
    return feel_walks(cache, test::leaping(method), walks, walk_depth(mesh));
  };
  const ForceStatistics gregory = felt(Method::kGregory), flat = felt(Method::kFlat);
  EXPECT_EQ(gregory.jumps(), 0u);
  EXPECT_EQ(gregory.lost, 0u);
  EXPECT_EQ(gregory.ticks, 20 * 2501u);  // each begins with the last tick of pressing in
  EXPECT_GT(flat.jumps_per_100k(), 20);
}

TEST(Walk, tells_where_it_jumps) {
  const Mesh mesh = test::with_normals(prism(5).mesh);
  WalkOptions options = options_of(mesh, 40, 1000);
  const double depth = options.depth = 0.5;  // so deep that contacts are lost at its edges
  const std::vector<Walk> walks = walks_on(mesh, options);
  const PatchCache cache = test::cache_of(mesh);
  const auto engine = make_tbb_engine(3);
  const ParallelFor parallel = [&](std::size_t count, std::size_t grain, const auto& body) {
    engine->for_each(count, grain, body);
  };
  const QueryOptions flat = test::leaping(Method::kFlat);
  std::vector<WalkJump> jumps, shared;
  const FeltWalks felt = feel_walks(cache, flat, walks, depth, serial_for, &jumps);
  feel_walks(cache, flat, walks, depth, parallel, &shared);
  ASSERT_GT(jumps.size(), 5u);
  EXPECT_EQ(jumps.size(), felt.jumps());
  EXPECT_EQ(felt.jumps(), feel_walks(cache, flat, walks, depth).jumps());
  ASSERT_EQ(shared.size(), jumps.size());
  std::vector<Vec3> places;  // that contacts leave, or find
  std::uint64_t beyond = 0;
  double farthest = 0;
  for (const Walk& walk : walks) {
    ContactTracker tracker(cache, flat);
    Contact before;
    for (std::size_t tick = 0; tick < walk.hips.size(); ++tick) {
      const Contact contact = tracker.tick(walk.hips[tick]);
      if (tick >= Walk::kEntry && (contact.touching || before.touching)) {
        const double step = (contact.push - before.push).norm();
        const double excess = step - 2 * (walk.hips[tick] - walk.hips[tick - 1]).norm();
        beyond += excess > 0;
        farthest = std::max(farthest, excess);
        if (step > 0.2 * depth) places.push_back(before.touching ? before.scp : contact.scp);
      }
      before = contact;
    }
  }
  ASSERT_EQ(places.size(), jumps.size());
  EXPECT_EQ(felt.steps_beyond_2dx, beyond);
  EXPECT_EQ(felt.largest_beyond_2dx, farthest);
  std::size_t lost = 0;
  double largest = 0;
  for (std::size_t i = 0; i < jumps.size(); ++i) {
    EXPECT_EQ(jumps[i].scp, places[i]);
    EXPECT_GT(jumps[i].step, ForceStatistics::kJump);
    EXPECT_LE(std::abs(nearest(cache, jumps[i].scp, flat).distance), 1e-9);
    ASSERT_LT(jumps[i].face, mesh.face_count());
    EXPECT_EQ(shared[i].scp, jumps[i].scp);
    lost += jumps[i].lost;
    largest = std::max(largest, jumps[i].step);
  }
  EXPECT_EQ(lost, felt.lost);
  EXPECT_GT(lost, 0u);
  EXPECT_EQ(largest, felt.largest_step / depth);
}

TEST(CrossingOracle, counts_ways_in_and_out_of_a_ball) {
  const Mesh ball = test::with_normals(goldberg().mesh);
  const Mesh fine = tessellate(ball, test::cache_of(ball), 6);
  const CrossingOracle oracle(fine);
  oracle::Rng rng(3);
  const auto vector = [&](double size) {
    return Vec3(oracle::uniform(rng, -size, size), oracle::uniform(rng, -size, size),
                oracle::uniform(rng, -size, size));
  };
  const auto inside = [](const Vec3& p) { return p.norm() < 10 ? 1 : 0; };
  int crossed = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 a = vector(8), b = a + vector(2);
    if (std::abs(a.norm() - 10) < 0.1 || std::abs(b.norm() - 10) < 0.1) continue;
    EXPECT_EQ(oracle.crossings(a, b), inside(b) - inside(a));
    crossed += inside(b) != inside(a);
  }
  EXPECT_GT(crossed, 200);
}

// Counts what a mesh's surface does to a HIP that walks beneath it.
struct Held {
  ForceStatistics felt;
  // Contacts lost under more than 20 % of k d, no way out crossed.
  std::uint64_t lost_uncrossed = 0;
};

Held hold(const PatchCache& cache, const CrossingOracle& oracle, std::span<const Walk> walks,
          double depth) {
  Held all;
  for (const Walk& walk : walks) {
    ForceStatistics felt(depth);
    ContactTracker tracker(cache, test::leaping());
    int inside = 0;  // since the start, in the open
    for (std::size_t tick = 0; tick < walk.hips.size(); ++tick) {
      if (tick > 0) inside += oracle.crossings(walk.hips[tick - 1], walk.hips[tick]);
      const Contact contact = tracker.tick(walk.hips[tick]);
      if (tick + 1 < Walk::kEntry) continue;
      const std::uint64_t lost = felt.lost;
      felt.add(contact.touching, contact.push);
      all.lost_uncrossed += felt.lost > lost && inside > 0;
    }
    all.felt.merge(felt);
  }
  return all;
}

// Losses that are known, all 0.5 % deep: where a surface passes through itself, its normals call a
// HIP outside that has crossed one sheet of two.
std::uint64_t known_losses(const std::string& name, double deep, double step) {
  if (deep < 1) return 0;
  if (name == "fish_control") return step > 0.05 ? 11 : step > 0.015 ? 1 : 0;
  return (name == "gums_open" || name == "spot_control") && step > 0.05 ? 1 : 0;
}

// Walks at 0.5 % and 0.1 % of the size, with steps for loops of 1000, 500 and 100 Hz.
void expect_contacts_held(const std::string& name, const Mesh& raw, std::uint64_t few) {
  constexpr std::uint64_t kTicks = 500000, kTicksPerWalker = 2500;
  const Mesh mesh = test::with_normals(raw);
  const PatchCache cache = test::cache_of(mesh);
  constexpr std::uint64_t kTriangles = 400000;
  std::uint32_t cells = 1;
  while (cells < 12 && tessellated_count(mesh, cache, cells + 1) <= kTriangles) ++cells;
  const CrossingOracle oracle(tessellate(mesh, cache, cells));
  const Topology topology = build_topology(mesh);
  for (const double deep : {1.0, 0.2}) {
    for (const double step : {0.01, 0.02, 0.1}) {
      WalkOptions options = options_of(mesh, 0, kTicksPerWalker);
      options.depth *= deep;
      options.step = step;
      options.walkers = test::samples(few, kTicks) / kTicksPerWalker;
      const std::vector<Walk> walks = walk_paths(mesh, topology, options);
      const Held held = hold(cache, oracle, walks, options.depth);
      EXPECT_LE(held.lost_uncrossed, known_losses(name, deep, step))
          << name << ", " << 0.5 * deep << " %, step " << step;
      EXPECT_EQ(held.felt.unsound, 0u);
      test::record(fmt::format("{}, {} % deep, steps of {} %", name, 0.5 * deep, 100 * step),
                   "{} ticks in contact; per 100,000 jumps {:.1f}, lost {:.1f}; lost uncrossed {}; "
                   "largest step {:.2f} k d",
                   held.felt.touching, held.felt.jumps_per_100k(), held.felt.lost_per_100k(),
                   held.lost_uncrossed, held.felt.largest_step / options.depth);
    }
  }
}

TEST(Walk, loses_contact_only_where_the_surface_of_a_generated_mesh_was_crossed) {
  const std::pair<const char*, Mesh> meshes[] = {{"knot", torus_knot().mesh},
                                                 {"banana", banana().mesh},
                                                 {"goldberg", goldberg().mesh},
                                                 {"half torus", test::half_torus()},
                                                 {"plate", thin_plate().mesh}};
  for (const auto& [name, mesh] : meshes) expect_contacts_held(name, mesh, 10000);
}

// The energy of a contact over its stiffness: that of a spring, or of the rim that rounds off an
// open border (kernels/contact.h, past_border).
double energy_of(const Contact& contact, const Vec3& hip) {
  if (!contact.touching) return 0;
  const bool is_rim = (contact.flags & kOnBorder) != 0 && !is_settling(contact.flags);
  return 0.5 * (is_rim ? contact.push.dot(contact.scp - hip) : contact.push.squaredNorm());
}

// The most work that contacts of a walk have given the hand, and hold, beyond what it put in; over
// stiffness x depth^2. A force that is held for a tick may give |dx|^2 / 2 times the curvature of
// the energy: 1, and 5 / 3 on a rim.
double work_gained(const PatchCache& cache, const QueryOptions& options, const Walk& walk,
                   double depth) {
  ContactTracker tracker(cache, options);
  Vec3 push = Vec3::Zero();
  double given = 0, most = 0;
  for (std::size_t tick = 0; tick < walk.hips.size(); ++tick) {
    const Contact contact = tracker.tick(walk.hips[tick]);
    if (tick > 0) {
      const Vec3 way = walk.hips[tick] - walk.hips[tick - 1];
      const double error = contact.flags & kOnBorder ? 5.0 / 6 : 0.5;
      given += push.dot(way) - error * way.squaredNorm();
    }
    push = contact.touching ? contact.push : Vec3(Vec3::Zero());
    // A surface may bulge out of its polygons, over which the walk begins.
    if (tick == 0) given = -energy_of(contact, walk.hips[0]);
    most = std::max(most, given + energy_of(contact, walk.hips[tick]));
  }
  return most / (depth * depth);
}

// ... of walks on a mesh, by a method.
double most_gained(const PatchCache& cache, Method method, std::span<const Walk> walks,
                   double depth) {
  double most = 0;
  for (const Walk& walk : walks)
    most = std::max(most, work_gained(cache, {{}, method}, walk, depth));
  return most;
}

std::vector<Walk> walks_for_work(const Mesh& mesh, double depth, std::uint64_t few) {
  WalkOptions options = options_of(mesh, 0, 2500);
  options.depth = depth;
  options.walkers = test::samples(few, 1'000'000) / 2500;
  return walks_on(mesh, options);
}

// Patches of both constructions and flat polygons, 0.5 % and 0.1 % deep.
void expect_no_work(const std::string& name, const Mesh& raw, std::uint64_t few) {
  const Mesh mesh = test::with_normals(raw);
  for (const double deep : {1.0, 0.2}) {
    const double depth = deep * walk_depth(mesh);
    const std::vector<Walk> walks = walks_for_work(mesh, depth, few);
    const auto expect_none = [&](const PatchCache& cache, Method method) {
      const double most = most_gained(cache, method, walks, depth);
      const std::string which =
          fmt::format("{}, {}, {} % deep", name,
                      method == Method::kFlat ? "flat" : surface_name(cache.level), 0.5 * deep);
      EXPECT_LE(most, 1e-9) << which;
      test::record(which, "work gained {:.3g} k d^2", most);
    };
    for (const PatchCache& cache : {test::cache_of(mesh), test::paper_cache_of(mesh)})
      expect_none(cache, Method::kGregory);
    expect_none(build_base(mesh, build_topology(mesh), Precision::kDouble), Method::kFlat);
  }
}

TEST(Walk, that_settles_gives_no_work_but_what_it_took) {
  for (const Generated& made : {torus_knot(), banana(), goldberg(), fin(), prism(5)})
    expect_no_work(made.mesh.source, made.mesh, 5000);
  for (const Mesh& mesh : {test::sheet(1.5), test::half_torus()})
    expect_no_work(mesh.source, mesh, 5000);
  // Force shading has no potential.
  const Mesh mesh = test::with_normals(banana().mesh);
  const double depth = walk_depth(mesh);
  const PatchCache base = build_base(mesh, build_topology(mesh), Precision::kDouble);
  EXPECT_GT(most_gained(base, Method::kShaded, walks_for_work(mesh, depth, 10000), depth), 0.01);
}

class SharedWalk : public test::SharedTest {
 protected:
  // Calls visit(name, mesh) with each mesh that is not refused: of a few, or, in long tests, of
  // all.
  template <class Visit>
  static void for_each_mesh(Visit visit) {
    std::vector<std::string> names = {"hand_open_dual", "spot_control", "osd_pawn"};
    if (std::getenv("GLISS_LONG_TESTS") != nullptr) {
      names.clear();
      for (const auto& file : std::filesystem::directory_iterator(test::shared_path("meshes"))) {
        if (file.path().extension() == ".obj") names.push_back(file.path().stem());
      }
      std::sort(names.begin(), names.end());
    }
    for (const std::string& name : names) {
      Mesh mesh;
      try {
        mesh = load_mesh(test::shared_path("meshes/" + name + ".obj"), {.unit = 1e-3});
      } catch (const MeshError& error) {
        test::record(name, "refused: {}", error.what());
        continue;
      }
      visit(name, mesh);
    }
  }
};

TEST_F(SharedWalk, loses_contact_only_where_the_surface_was_crossed) {
  for_each_mesh(
      [](const std::string& name, const Mesh& mesh) { expect_contacts_held(name, mesh, 5000); });
}

TEST_F(SharedWalk, that_settles_gives_no_work_but_what_it_took) {
  for_each_mesh(
      [](const std::string& name, const Mesh& mesh) { expect_no_work(name, mesh, 5000); });
}

// One triangle in a hundred has a vertex on one of its sides, but for `height` of that side: a
// triangle as flat as that lies between them.
Mesh with_collinear_triangles(const Mesh& mesh, double height) {
  oracle::Rng rng(9);
  Mesh cut;
  cut.unit = mesh.unit;
  cut.source = mesh.source;
  cut.positions = mesh.positions;
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    cut.corner_vertex.insert(cut.corner_vertex.end(), {a, b, c});
    cut.face_begin.push_back(static_cast<std::uint32_t>(cut.corner_vertex.size()));
  };
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    const std::uint32_t* v = &mesh.corner_vertex[mesh.face_begin[face]];
    const auto k = static_cast<std::uint32_t>(rng() % 300);
    if (k >= 3 || height == 0) {
      add(v[0], v[1], v[2]);
      continue;
    }
    const std::uint32_t a = v[k], b = v[(k + 1) % 3], c = v[(k + 2) % 3];
    const auto middle = static_cast<std::uint32_t>(cut.positions.size());
    const Vec3 A = mesh.positions[a], side = mesh.positions[b] - A, to_c = mesh.positions[c] - A;
    const Vec3 in = (to_c - to_c.dot(side) / side.squaredNorm() * side).normalized();
    cut.positions.push_back(A + 0.5 * side + height * side.norm() * in);
    add(a, middle, c), add(middle, b, c), add(a, b, middle);
  }
  return cut;
}

// Such triangles are mended: a patch of one would turn its normal within no width.
TEST(Walk, feels_no_triangle_that_is_nearly_collinear) {
  const Mesh ball = with_collinear_triangles(irregular(goldberg(8), 4).mesh, 0);
  const std::vector<Walk> walks = walks_on(test::with_normals(ball), options_of(ball, 40, 2500));
  for (const double height : {1e-9, 1e-12}) {
    Mesh mesh = with_collinear_triangles(ball, height);
    const std::size_t faces = mesh.face_count();
    EXPECT_GT(faces, ball.face_count() + 20);
    std::vector<Finding> findings;
    validate(mesh, {}, &findings);
    ASSERT_EQ(findings.size(), 1u);
    EXPECT_EQ(findings[0].code, "zero-area-face");
    EXPECT_EQ(mesh.face_count(), faces);
    for (const Precision precision : {Precision::kDouble, Precision::kFloat}) {
      const PatchCache cache = test::cache_of(mesh, precision),
                       without = test::cache_of(test::with_normals(ball), precision);
      for (const Method method : {Method::kGregory, Method::kShaded, Method::kFlat}) {
        const FeltWalks felt = feel_walks(cache, test::leaping(method), walks, walk_depth(ball)),
                        want = feel_walks(without, test::leaping(method), walks, walk_depth(ball));
        EXPECT_EQ(felt.jumps(), want.jumps()) << method_name(method) << " " << height;
        EXPECT_EQ(felt.lost, 0u);
      }
    }
  }
}

}  // namespace
}  // namespace gliss
