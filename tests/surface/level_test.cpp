// The levels beside the exact one: the same boundary, the same normals along it, near to it within,
// and the same questions answered.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "gliss/build/build_cache.h"
#include "gliss/compare/tessellate.h"
#include "gliss/engine/engine.h"
#include "gliss/files/mesh_file.h"
#include "gliss/generate/generate.h"
#include "gliss/lazy/lazy_mesh.h"
#include "gliss/query/contact_tracker.h"
#include "gliss/surface/layout.h"
#include "gliss/surface/names.h"
#include "tests/support/gliss_process.h"
#include "tests/support/places.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using oracle::Rng;
using test::Worst;

PatchCache at_level(const Mesh& mesh, const std::string& level,
                    Precision precision = Precision::kDouble) {
  BuildOptions options;
  options.precision = precision;
  options.level = find_surface(level).value();
  return build_cache(mesh, options);
}

Mesh triangles() {
  const Mesh quads = torus_knot(40, 6).mesh;
  return tessellate(quads, build_cache(quads), 1);
}

std::vector<Mesh> meshes() {
  return {torus_knot().mesh, triangles(), goldberg().mesh, banana().mesh,
          test::with_normals(fin().mesh)};
}

constexpr const char* kJoined[] = {"ribbon", "bezier"};
constexpr const char* kAll[] = {"exact", "ribbon", "bezier", "table:2", "table"};

TEST(Level, names_are_read_back) {
  for (const std::string name : {"exact", "ribbon", "bezier", "table", "table:1", "table:64"})
    EXPECT_EQ(level_name(find_level(name).value()), name);
  EXPECT_EQ(level_name(find_level("table:4").value()), "table");
  for (const std::string name :
       {"", "Exact", "table:", "table:0", "table:65", "table:4x", "bezier:4", "flat", "fair"})
    EXPECT_FALSE(find_level(name)) << name;
  for (const std::string name : {"exact", "table:2", "fair", "fair-ribbon", "fair-table:64"})
    EXPECT_EQ(surface_name(find_surface(name).value()), name);
  for (const std::string name : {"paper", "paper-table:2", "fair", "fair-ribbon"})
    EXPECT_EQ(full_surface_name(find_surface(name).value()), name);
  EXPECT_EQ(find_surface("paper-ribbon"), find_surface("ribbon"));
  for (const std::string name : {"", "fair-", "fair-fair", "fairtable", "fair-table:0", "paper-"})
    EXPECT_FALSE(find_surface(name)) << name;
}

// Neighbours of any forms join with G1 continuity by this.
TEST(Level, ribbon_and_bezier_have_the_boundary_and_the_normals_of_the_exact_patches) {
  for (const Mesh& mesh : meshes()) {
    for (const Precision precision : {Precision::kDouble, Precision::kFloat}) {
      const bool is_float = precision == Precision::kFloat;
      const PatchCache exact = at_level(mesh, "exact");
      const double size = test::size_of(mesh);
      for (const char* level : kJoined) {
        const PatchCache cache = at_level(mesh, level, precision);
        Worst gap, turn;
        for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
          const int n = static_cast<int>(mesh.valence(face));
          for (int k = 0; k < n; ++k) {
            for (int i = 0; i < 16; ++i) {
              const auto X = oracle::on_side(n, k, i / 16.0);
              const SurfacePoint a = test::at(exact, face, X), b = test::at(cache, face, X);
              gap.add((a.position - b.position).norm() / size);
              turn.add(oracle::angle<double>(a.normal, b.normal));
            }
          }
        }
        EXPECT_LE(gap.value, is_float ? 1e-6 : 1e-14) << mesh.source << ' ' << level;
        EXPECT_LE(turn.value, is_float ? 2e-5 : 1e-10) << mesh.source << ' ' << level;
        test::record(mesh.source + " " + level + (is_float ? " float" : " double"),
                     "boundary off by {:.2g} of the size, normals along it by {:.2g} rad",
                     gap.value, turn.value);
      }
    }
  }
}

TEST(Level, is_near_the_exact_surface_and_coarser_ones_farther) {
  const struct {
    const char* level;
    double gap, turn;  // of size, rad: at most
  } levels[] = {{"table:8", 5e-6, 5e-4},
                {"table:2", 5e-4, 3e-3},
                {"ribbon", 3e-4, 2e-3},
                {"bezier", 3e-4, 0.02}};
  Rng rng(80);
  for (const Generated& made : {torus_knot(), goldberg(), torus()}) {
    const PatchCache exact = at_level(made.mesh, "exact");
    const double size = test::size_of(made.mesh);
    std::map<std::string, double> gaps;
    for (const auto& [level, most_gap, most_turn] : levels) {
      const PatchCache cache = at_level(made.mesh, level);
      Worst gap, turn;
      for (int i = 0; i < 4000; ++i) {
        const auto face = static_cast<std::uint32_t>(rng() % made.mesh.face_count());
        const int n = static_cast<int>(made.mesh.valence(face));
        const auto X = oracle::random_inside<double>(rng, n);
        const SurfacePoint a = test::at(exact, face, X), b = test::at(cache, face, X);
        gap.add((a.position - b.position).norm() / size);
        turn.add(oracle::angle<double>(a.normal, b.normal));
      }
      EXPECT_LE(gap.value, most_gap) << made.mesh.source << ' ' << level;
      EXPECT_LE(turn.value, most_turn) << made.mesh.source << ' ' << level;
      gaps[level] = gap.value;
      test::record(made.mesh.source + " " + level,
                   "off by {:.2g} of the size, normals by {:.2g} rad", gap.value, turn.value);
    }
    // A quarter of the cells a side; cross tangents of a lower degree.
    EXPECT_GT(gaps["table:2"], 4 * gaps["table:8"]) << made.mesh.source;
    EXPECT_GE(gaps["bezier"], 0.95 * gaps["ribbon"]) << made.mesh.source;
    EXPECT_GT(gaps["ribbon"], 0) << made.mesh.source;
  }
}

// Away from corners, next to which the exact patch's second derivatives depend on the direction.
TEST(Level, tables_come_near_with_their_cells) {
  Rng rng(81);
  const Mesh mesh = goldberg().mesh;
  const PatchCache exact = at_level(mesh, "exact");
  std::vector<double> worst;
  for (const char* level : {"table:1", "table:2", "table:4", "table:8"}) {
    const PatchCache cache = at_level(mesh, level);
    Worst gap;
    for (int i = 0; i < 4000; ++i) {
      const auto face = static_cast<std::uint32_t>(rng() % mesh.face_count());
      const int n = static_cast<int>(mesh.valence(face));
      const oracle::Vec2<double> X = 0.5 * oracle::random_inside<double>(rng, n);
      gap.add((test::at(exact, face, X).position - test::at(cache, face, X).position).norm());
    }
    worst.push_back(gap.value);
  }
  for (std::size_t i = 1; i < worst.size(); ++i) EXPECT_LE(worst[i], worst[i - 1] / 2) << i;
  EXPECT_LE(worst.back(), worst.front() / 100);
}

TEST(Level, derivatives_are_those_of_the_position) {
  Rng rng(82);
  const double step = 1e-5;
  for (const Mesh& mesh : meshes()) {
    for (const char* level : kAll) {
      const PatchCache cache = at_level(mesh, level);
      Worst off;
      for (int i = 0; i < 500; ++i) {
        const auto face = static_cast<std::uint32_t>(rng() % mesh.face_count());
        const int n = static_cast<int>(mesh.valence(face));
        const oracle::Vec2<double> X = 0.95 * oracle::random_inside<double>(rng, n);
        const SurfacePoint p = test::at(cache, face, X);
        const auto difference = [&](const oracle::Vec2<double>& way) {
          return Vec3((test::at(cache, face, X + step * way).position -
                       test::at(cache, face, X - step * way).position) /
                      (2 * step));
        };
        const double scale = p.d_xi.norm() + p.d_eta.norm();
        off.add((difference({1, 0}) - p.d_xi).norm() / scale);
        off.add((difference({0, 1}) - p.d_eta).norm() / scale);
      }
      // Tables are only once differentiable between cells.
      EXPECT_LE(off.value, std::string(level).starts_with("table") ? 1e-4 : 1e-7)
          << mesh.source << ' ' << level;
    }
  }
}

TEST(Level, a_hip_on_a_normal_is_projected_back_with_each_solver) {
  Rng rng(83);
  const Mesh mesh = torus_knot().mesh;
  for (const char* level : kAll) {
    for (const Precision precision : {Precision::kDouble, Precision::kFloat}) {
      const PatchCache cache = at_level(mesh, level, precision);
      for (const auto& [name, solver] : kSolverNames) {
        QueryOptions options;
        options.solver = solver;
        Worst miss;
        for (int i = 0; i < 300; ++i) {
          const auto face = static_cast<std::uint32_t>(rng() % mesh.face_count());
          const SurfacePoint p = test::at(cache, face, oracle::random_inside<double>(rng, 4));
          const Contact found = nearest(cache, p.position - 1.0 * p.normal, options);
          miss.add((found.scp - p.position).norm() / test::size_of(mesh));
        }
        // The last as printed stops at an angle.
        const double bound = solver == Solver::kPaper ? 1e-3 : 1e-9;
        EXPECT_LE(miss.value, std::max(bound, precision == Precision::kFloat ? 1e-5 : 0.0))
            << level << ' ' << name;
      }
    }
  }
}

// In contact a path over many patches and corners is smooth at every level that is.
TEST(Level, a_tick_follows_the_surface) {
  const Generated knot = torus_knot();
  const std::vector<Vec3> path = path_beneath(knot, 120, 12, 2, 0.3);
  for (const char* level : kAll) {
    const PatchCache cache = at_level(knot.mesh, level);
    ContactTracker tracker(cache, {});
    Vec3 before = Vec3::Zero();
    Worst step, off;
    int lost = 0;
    for (std::size_t i = 0; i < path.size(); ++i) {
      const Contact contact = tracker.tick(path[i]);
      lost += !contact.touching;
      const ExactSurface::Point truth = knot.exact->nearest(path[i]);
      off.add((contact.push + truth.distance * truth.normal).norm());
      if (i > 0) step.add((contact.push - before).norm());
      before = contact.push;
    }
    EXPECT_EQ(lost, 0) << level;
    EXPECT_LE(off.value, 0.06) << level;
    EXPECT_LE(step.value, 0.08) << level;
    test::record(level, "push off by {:.3g} mm of 2, largest step {:.3g} mm", off.value,
                 step.value);
  }
}

TEST(Level, every_engine_and_width_has_the_same_bytes) {
  for (const Mesh& mesh : {torus_knot().mesh, triangles(), goldberg().mesh}) {
    for (const char* level : kAll) {
      for (const Precision precision : {Precision::kDouble, Precision::kFloat}) {
        const PatchCache cache = at_level(mesh, level, precision);
        Rng rng(84);
        std::vector<DomainPoint> at;
        for (int i = 0; i < 1000; ++i) {
          const auto face = static_cast<std::uint32_t>(rng() % mesh.face_count());
          const auto X = oracle::random_inside<double>(rng, static_cast<int>(mesh.valence(face)));
          at.push_back({face, X.x(), X.y()});
        }
        std::vector<SurfacePoint> points(at.size());
        evaluate(cache, at, points);
        for (std::size_t i = 0; i < at.size(); ++i) {
          const SurfacePoint alone = evaluate(cache, at[i]);
          ASSERT_EQ(points[i].position, alone.position) << level;
          ASSERT_EQ(points[i].d_xi, alone.d_xi) << level;
          ASSERT_EQ(points[i].d_eta, alone.d_eta) << level;
        }
      }
    }
  }
}

TEST(Level, faster_levels_keep_less) {
  const Mesh mesh = torus_knot().mesh;
  const auto numbers = [&](const char* level) {
    return std::get<1>(at_level(mesh, level).surface).control.size() / mesh.face_count();
  };
  EXPECT_EQ(numbers("exact"), 4 * 51);
  EXPECT_EQ(numbers("ribbon"), 4 * 33);
  EXPECT_EQ(numbers("bezier"), 4 * 15);
  EXPECT_EQ(numbers("table:2"), 4 * 12 * 9);
}

// A patch that would fold at its level is kept in the exact form, beside the others.
TEST(Level, nothing_folds_that_does_not_fold_exactly) {
  for (const Mesh& mesh : meshes()) {
    const PatchCache exact = at_level(mesh, "exact");
    for (const char* level : kAll) {
      const PatchCache cache = at_level(mesh, level);
      std::visit(
          [&](const auto& s) {
            for (std::uint32_t p = 0; p < cache.patch_count(); ++p) {
              if (cache.kind[p] == PatchKind::kBent && !std::string(level).starts_with("table")) {
                EXPECT_EQ(s.form[p], kFormPaper);
              }
            }
          },
          cache.surface);
      Rng rng(85);
      for (int i = 0; i < 3000; ++i) {
        const auto face = static_cast<std::uint32_t>(rng() % mesh.face_count());
        const auto X = oracle::random_inside<double>(rng, static_cast<int>(mesh.valence(face)));
        const Vec3 a = test::at(exact, face, X).normal, b = test::at(cache, face, X).normal;
        EXPECT_GT(a.dot(b), 0) << mesh.source << ' ' << level;
      }
    }
  }
}

TEST(Level, regions_built_near_a_hip_have_the_patches_of_the_whole) {
  const Mesh mesh = torus_knot(24, 6).mesh;
  for (const char* level : {"ribbon", "bezier", "table:2"}) {
    LazyOptions options;
    options.rings = 2;
    options.level = find_surface(level).value();
    const LazyMesh lazy(mesh, options);
    const std::uint32_t middle = 70;
    const LazyRegion region = lazy.build({&middle, 1});
    const PatchCache all = at_level(mesh, level);
    int compared = 0;
    for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
      if (!region.covers(face)) continue;
      EXPECT_EQ(test::at(region.cache, face, {0.3, -0.2}).position,
                test::at(all, face, {0.3, -0.2}).position);
      ++compared;
    }
    EXPECT_GT(compared, 10);
  }
}

TEST(Level, commands_take_it_and_caches_keep_it) {
  const test::ScratchFolder folder;
  save_obj(torus(12, 8).mesh, folder / "torus.obj");
  folder.write("hips.csv", "x,y,z\n38,0,1\n0,25,9\n");
  const auto run = [&](const std::vector<std::string>& words) {
    return test::Process(folder / "", test::kProgram, words).wait();
  };
  for (const std::string level : {"exact", "ribbon", "bezier", "table:3"}) {
    ASSERT_EQ(run({"bake", "torus.obj", "--unit", "mm", "--level", level, "--construction", "paper",
                   "-o", "t.gliss"})
                  .code,
              0);
    const auto info = nlohmann::json::parse(run({"info", "t.gliss", "--json"}).out);
    EXPECT_EQ(info["level"], level);
    EXPECT_EQ(info["forms"][level.substr(0, level.find(':'))], 96);
    const auto baked = run({"project", "t.gliss", "--hip", "hips.csv", "--unit", "mm"}),
               built = run({"project", "torus.obj", "--hip", "hips.csv", "--unit", "mm", "--level",
                            level, "--construction", "paper"});
    EXPECT_EQ(baked.code, 0) << baked.err;
    EXPECT_EQ(baked.out, built.out) << level;
  }
  const auto other = run({"info", "t.gliss", "--level", "exact"});
  EXPECT_EQ(other.code, 3);
  EXPECT_THAT(other.err, ::testing::HasSubstr("a cache of level table:3; for --level exact bake"));
  const auto unknown = run({"info", "torus.obj", "--level", "best"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_THAT(unknown.err,
              ::testing::HasSubstr("--level: 'best' is not one of exact, ribbon, bezier"));
}

}  // namespace
}  // namespace gliss
