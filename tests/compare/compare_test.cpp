// gliss compare as outsiders script against it, and what it is made of: paths, dense meshes, gaps.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <set>

#include "gliss/compare/tessellate.h"
#include "gliss/engine/engine.h"
#include "gliss/files/mesh_file.h"
#include "gliss/generate/generate.h"
#include "gliss/query/contact_tracker.h"
#include "gliss/surface/names.h"
#include "gliss/walk/fidelity.h"
#include "tests/oracle/union_oracle.h"
#include "tests/support/gliss_process.h"
#include "tests/support/places.h"
#include "tests/support/poll_gap.h"
#include "tests/support/sharp_meshes.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using Json = nlohmann::json;
using ::testing::HasSubstr;

class Compare : public ::testing::Test {
 protected:
  Compare() { save_obj(torus(12, 8).mesh, folder_ / "torus.obj"); }

  test::Outcome run(std::vector<std::string> words) const {
    words.insert(words.begin(), {"compare", "torus.obj", "--unit", "mm", "--ticks", "300"});
    return test::Process(folder_ / "", test::kProgram, words).wait();
  }
  Json json_of(std::vector<std::string> words) const {
    words.insert(words.end(), {"--json", "--quiet"});
    const test::Outcome ran = run(words);
    EXPECT_EQ(ran.code, 0) << ran.err;
    return Json::parse(ran.out, nullptr, false);
  }

  test::ScratchFolder folder_;
};

TEST_F(Compare, rows_have_the_columns_that_were_promised) {
  const Json json = json_of({"--depth", "0.5mm", "--reference", "torus", "--dense-limit", "2000"});
  ASSERT_EQ(json["rows"].size(), 14);
  std::set<std::string> levels;
  for (const Json& row : json["rows"]) {
    for (const char* text : {"level", "precision", "solver", "backend"})
      EXPECT_TRUE(row[text].is_string()) << text;
    for (const char* number : {"bytes_per_patch",
                               "build_per_s",
                               "track_per_s",
                               "max_distance",
                               "p99_distance",
                               "max_normal_gap_deg",
                               "p99_normal_gap_deg",
                               "max_force_step",
                               "p99_force_step",
                               "jumps_per_100k",
                               "lost_per_100k",
                               "unsound",
                               "max_force_error",
                               "p99_force_error",
                               "tick_us",
                               "true_max_distance",
                               "steps_beyond_2dx_per_100k",
                               "max_step_beyond_2dx",
                               "held_outside",
                               "held_outside_of",
                               "held_outside_longest",
                               "held_outside_pulled"})
      EXPECT_TRUE(row[number].is_number()) << number;
    const bool patches = row["level"] != "shaded" && row["level"] != "flat";
    EXPECT_EQ(row["eval_per_s"].is_number(), patches);
    EXPECT_TRUE(row["pareto"].is_boolean());
    for (const char* of : {"distance", "normal_gap_deg", "force_step", "force_error"})
      EXPECT_GE(row[std::string("max_") + of], row[std::string("p99_") + of]);
    EXPECT_GE(row["jumps_per_100k"], row["lost_per_100k"]);
    EXPECT_EQ(row["unsound"], 0);
    levels.insert(row["level"].get<std::string>());
  }
  EXPECT_EQ(levels, (std::set<std::string>{"exact", "ribbon", "bezier", "table", "fair", "shaded",
                                           "flat"}));
  const auto find = [&](const char* level, const char* key) {
    for (const Json& row : json["rows"]) {
      if (row["level"] == level && row["precision"] == "double") return row[key].get<double>();
    }
    return -1.0;
  };
  // The torus is 80 mm wide; lengths are in metres.
  EXPECT_LE(find("exact", "max_distance"), 1e-11);
  EXPECT_GT(find("flat", "max_distance"), 1e-4);
  EXPECT_LT(find("flat", "max_distance"), 1e-2);
  EXPECT_LT(find("ribbon", "max_distance"), find("bezier", "max_distance"));
  EXPECT_LT(find("exact", "true_max_distance"), 0.2 * find("flat", "true_max_distance"));
  EXPECT_EQ(find("exact", "max_force_error"), 0);
  EXPECT_LE(find("ribbon", "max_force_error"), find("flat", "max_force_error"));
  EXPECT_LE(find("ribbon", "max_normal_gap_deg"), 1e-8);
  EXPECT_GT(find("flat", "max_normal_gap_deg"), 10);
  EXPECT_LT(find("bezier", "bytes_per_patch"), find("exact", "bytes_per_patch"));
}

TEST_F(Compare, walks_by_itself_over_the_mesh) {
  const std::vector<std::string> words = {"--dense-limit", "0",          "--precisions", "double",
                                          "--levels",      "exact,flat", "--depth",      "0.5mm"};
  const auto walked = [&](std::vector<std::string> more) {
    more.insert(more.end(), words.begin(), words.end());
    return json_of(more);
  };
  const Json json = walked({"--walks", "10", "--walk-depth", "0.4mm"});
  EXPECT_EQ(json["walks"]["walkers"], 10);
  EXPECT_EQ(json["walks"]["depth_m"], 0.4e-3);
  EXPECT_EQ(json["rows"][0]["jumps_per_100k"], 0);
  EXPECT_EQ(json["rows"][0]["lost_per_100k"], 0);
  EXPECT_GT(json["rows"][1]["jumps_per_100k"], 20);
  EXPECT_GT(json["rows"][1]["walk_max_force_step"], 0.2 * 0.2);  // 20 % of 0.2 N
  for (const Json& row : json["rows"]) {
    EXPECT_GT(row["walk_p99_force_step"], 0);
    EXPECT_LT(row["walk_p99_force_step"], row["walk_max_force_step"]);
  }
  EXPECT_LT(json["rows"][1]["walk_p99_force_step"], 0.1 * 0.2);  // most ticks are no jumps
  const Json again = walked({"--walks", "10", "--walk-depth", "0.4mm", "--threads", "3"});
  const Json other = walked({"--walks", "10", "--walk-depth", "0.4mm", "--seed", "7"});
  const auto step = [](const Json& of) { return of["rows"][1]["walk_max_force_step"]; };
  EXPECT_EQ(step(again), step(json));
  EXPECT_NE(step(other), step(json));
  const Json percent = walked({"--walks", "1", "--walk-depth", "0.1%"});
  // The mesh is 80 x 80 x 20 mm.
  EXPECT_NEAR(percent["walks"]["depth_m"], 0.1149e-3, 2e-6);
  const Json none = walked({"--walks", "0"});
  EXPECT_TRUE(none["walks"].is_null());
  EXPECT_TRUE(none["leaving"].is_null());
  for (const char* key : {"steps_beyond_2dx_per_100k", "held_outside", "held_outside_of"})
    EXPECT_TRUE(none["rows"][0][key].is_null()) << key;
  EXPECT_TRUE(none["rows"][0]["walk_max_force_step"].is_null());
  EXPECT_TRUE(none["rows"][0]["walk_p99_force_step"].is_null());
  EXPECT_TRUE(none["rows"][0]["jumps_per_100k"].is_number());
}

TEST_F(Compare, lets_hands_leave_and_tells_the_speed_of_its_walks) {
  const std::vector<std::string> words = {"--dense-limit", "0",         "--precisions", "double",
                                          "--levels",      "fair,flat", "--depth",      "0.5mm"};
  const auto left = [&](std::vector<std::string> more) {
    more.insert(more.end(), words.begin(), words.end());
    return json_of(more);
  };
  const Json json = left({"--walks", "4", "--settle", "20ms"});
  EXPECT_EQ(json["leaving"]["hands"], 20);
  EXPECT_EQ(json["leaving"]["rest_ticks"], 302);
  for (const Json& row : json["rows"]) {
    EXPECT_GE(row["held_outside_of"], 20);
    EXPECT_LE(row["held_outside"], row["held_outside_of"]);
    EXPECT_GE(row["steps_beyond_2dx_per_100k"], 0);
  }
  EXPECT_LT(json["rows"][1]["max_step_beyond_2dx"], json["rows"][1]["walk_max_force_step"]);
  const Json leaping = left({"--walks", "4", "--settle", "0"});
  EXPECT_GE(leaping["rows"][1]["steps_beyond_2dx_per_100k"], leaping["rows"][1]["jumps_per_100k"]);
  const Json hands = left({"--walks", "0", "--leaving", "15", "--threads", "3"});
  EXPECT_TRUE(hands["walks"].is_null());
  EXPECT_EQ(hands["leaving"]["hands"], 15);
  EXPECT_GE(hands["rows"][0]["held_outside_of"], 15);
  const Json again = left({"--walks", "0", "--leaving", "15"});
  EXPECT_EQ(hands["rows"][0]["held_outside_of"], again["rows"][0]["held_outside_of"]);
  const test::Outcome told = run({"--walks", "1", "--dense-limit", "0", "--levels", "flat",
                                  "--settle", "5ms", "--walk-depth", "0.5mm"});
  EXPECT_THAT(told.out, HasSubstr("0.5 mm deep"));
  EXPECT_THAT(told.out, HasSubstr("held: contacts of 5 hands"));
}

// The length of n 4-byte numbers in base64.
std::size_t packed_size(std::size_t n) { return (4 * n + 2) / 3 * 4; }

TEST_F(Compare, tells_what_a_picture_needs_if_it_is_asked_for) {
  const std::vector<std::string> words = {
      "--dense-limit",   "0",       "--precisions", "double",       "--levels",
      "fair,exact,flat", "--walks", "30",           "--walk-depth", "0.4mm"};
  const Json plain = json_of(words);
  EXPECT_FALSE(plain.contains("picture"));
  EXPECT_FALSE(plain["rows"][2].contains("jumps"));
  std::vector<std::string> more = words;
  more.emplace_back("--picture");
  const Json json = json_of(more);
  ASSERT_EQ(json["picture"].size(), 2);
  for (const std::size_t i : {0, 1}) {
    const Json& picture = json["picture"][i];
    EXPECT_EQ(picture["construction"], i == 0 ? "fair" : "paper");
    EXPECT_EQ(picture["construction"], json["rows"][i]["construction"]);
    const std::size_t points = picture["points"];
    EXPECT_GT(points, 10000u);
    EXPECT_LE(points, 16000u);
    EXPECT_EQ(picture["face"]["u32"].get<std::string>().size(), packed_size(points));
    for (const auto& [name, numbers] :
         {std::pair("position", 3), {"normal", 3}, {"spot", 1}, {"curvature", 1}}) {
      EXPECT_EQ(picture[name]["f32"].get<std::string>().size(),
                packed_size(points * static_cast<std::size_t>(numbers)));
    }
    EXPECT_LE(picture["p99_curvature"], picture["max_curvature"]);
  }
  // The tube's radius is 10 mm; patches as coarse as these bend more, and the paper's most.
  EXPECT_GT(json["picture"][0]["p50_curvature"], 80);  // 1/m
  EXPECT_LT(json["picture"][0]["p50_curvature"], 200);
  EXPECT_GT(json["picture"][1]["p50_curvature"], json["picture"][0]["p50_curvature"]);
  EXPECT_TRUE(json["rows"][2]["construction"].is_null());
  const Json& flat = json["rows"][2];
  const std::size_t jumps = flat["jumps"].size();
  ASSERT_GT(jumps, 5);
  EXPECT_NEAR(flat["jumps_per_100k"].get<double>(), static_cast<double>(jumps) * 1e5 / 75000,
              0.01 * flat["jumps_per_100k"].get<double>());
  for (std::size_t i = 0; i < jumps; ++i) {
    const Json& jump = flat["jumps"][i];
    EXPECT_GT(jump["step"], 0.2);
    EXPECT_LE(jump["step"], flat["jumps"][0]["step"]);
    EXPECT_LT(jump["face"], 96);
    const Vec3 at(jump["position"][0], jump["position"][1], jump["position"][2]);
    // On polygons within the tube of radius 10 mm round a ring of 30 mm.
    EXPECT_NEAR(std::hypot(std::hypot(at.x(), at.y()) - 30, at.z()), 9, 1.5);
  }
  std::vector<std::string> still = more;
  *std::find(still.begin(), still.end(), "30") = "0";
  const Json walkless = json_of(still);
  EXPECT_FALSE(walkless["rows"][2].contains("jumps"));
  EXPECT_EQ(walkless["picture"], json["picture"]);
  const test::Outcome without = run({"--picture"});
  EXPECT_EQ(without.code, 2);
  EXPECT_THAT(without.err, HasSubstr("--picture: needs --json"));
}

TEST_F(Compare, a_row_is_marked_where_no_other_is_better_in_all) {
  const Json rows = json_of({"--dense-limit", "0", "--precisions", "float"})["rows"];
  for (const Json& row : rows) {
    bool beaten = false;
    for (const Json& other : rows) {
      bool no_worse = true, better = false;
      for (const char* key : {"max_force_error", "tick_us", "bytes_per_patch"}) {
        no_worse = no_worse && other[key] <= row[key];
        better = better || other[key] < row[key];
      }
      beaten = beaten || (no_worse && better);
    }
    EXPECT_EQ(row["pareto"].get<bool>(), !beaten) << row;
  }
}

// Not how far it is to the surface of the union, within which a part of each lies.
TEST_F(Compare, measures_distances_where_parts_overlap) {
  const Mesh one = torus(12, 8).mesh;
  save_obj(test::joined({one, test::moved(one, Vec3(30, 1, 2))}), folder_ / "torus.obj");
  const Json rows = json_of({"--levels", "exact,ribbon", "--precisions", "double", "--walks", "0",
                             "--dense-limit", "0"})["rows"];
  ASSERT_EQ(rows.size(), 2);
  EXPECT_LE(rows[0]["max_distance"], 1e-11);
  EXPECT_GT(rows[1]["max_distance"], 0);
  EXPECT_LT(rows[1]["max_distance"], 1e-5);
}

// A hand that leaves a cube by another side loses its contact: with another --settle the reference
// would feel otherwise.
TEST_F(Compare, the_reference_has_no_error_from_itself) {
  Mesh cube = test::cube();
  for (Vec3& p : cube.positions) p *= 20;
  save_obj(cube, folder_ / "torus.obj");
  std::string path = "x_mm,y_mm,z_mm\n";
  for (int i = 0; i < 150; ++i) path += fmt::format("{},10,17\n", 10 + 0.1 * i);
  folder_.write("path.csv", path);
  for (const char* settle : {"0", "20ms"}) {
    const Json row =
        json_of({"--settle", settle, "--path", "path.csv", "--depth", "3mm", "--levels", "fair",
                 "--precisions", "double", "--walks", "0", "--dense-limit", "0"})["rows"][0];
    EXPECT_EQ(row["max_force_error"], 0) << settle;
    EXPECT_EQ(row["max_force_step"] > 1, settle == std::string("0"));
  }
}

// The meshes of anybody, by a script.
TEST_F(Compare, is_what_foreign_sh_counts_by) {
  const std::string line =
      fmt::format("GLISS='{}' bash '{}/../bench/foreign.sh' '{}' --ticks 2500 > '{}'",
                  test::kProgram, test::kTests, folder_ / "torus.obj", folder_ / "table");
  ASSERT_EQ(std::system(line.c_str()), 0);
  EXPECT_THAT(folder_.read("table"), HasSubstr("| 0.1% | fast | 5 ms |"));
}

TEST_F(Compare, recommends_what_the_budget_allows) {
  const std::vector<std::string> words = {"--dense-limit", "0",        "--precisions",
                                          "double",        "--levels", "exact,fair,shaded,flat"};
  const auto recommended = [&](std::vector<std::string> budget) {
    budget.insert(budget.end(), words.begin(), words.end());
    return json_of(budget)["recommended"];
  };
  EXPECT_EQ(recommended({})["level"], "fair");
  EXPECT_TRUE(recommended({"--max-memory", "1KiB"}).is_null());
  EXPECT_TRUE(recommended({"--max-tick", "1ns"}).is_null());
  // Only the base polygons are so small: they jump more than patches, or make energy.
  EXPECT_TRUE(recommended({"--max-memory", "80KiB"}).is_null());
  const std::string near = recommended({"--max-force-error", "0.1%"})["level"];
  EXPECT_TRUE(near == "fair" || near == "exact") << near;
}

TEST_F(Compare, dense_triangles_get_as_smooth_or_it_says_that_they_did_not) {
  const Json dense = json_of({"--levels", "bezier,shaded,flat", "--precisions", "double",
                              "--dense-limit", "20000"})["dense"];
  ASSERT_EQ(dense.size(), 2);
  for (const Json& row : dense) {
    EXPECT_EQ(row["target_level"], "bezier");
    EXPECT_GT(row["triangles"], 1000);
    EXPECT_LE(row["triangles"], 20000);
    EXPECT_GT(row["memory_ratio"], 1);
    EXPECT_EQ(row["reached"].get<bool>(), row["max_force_step"] <= row["target_force_step"]);
    if (row["needed_triangles"].is_number()) {
      EXPECT_GE(row["needed_triangles"], row["triangles"]);
    }
  }
}

TEST_F(Compare, writes_tables_and_names_what_is_wrong) {
  for (const char* name : {"rows.csv", "rows.h5"}) {
    const test::Outcome ran =
        run({"--dense-limit", "0", "--levels", "flat", "-o", name, "--quiet"});
    EXPECT_EQ(ran.code, 0) << ran.err;
    EXPECT_GT(folder_.read(name).size(), 100);
  }
  EXPECT_THAT(folder_.read("rows.csv"),
              HasSubstr("level,precision,solver,backend,bytes_per_patch"));
  const std::pair<std::vector<std::string>, const char*> wrong[] = {
      {{"--levels", "exact,best"}, "--levels: 'best' is not one of fair, paper"},
      {{"--levels", "flat,flat"}, "'flat' is there twice"},
      {{"--backends", "cuda"}, "--backends: 'cuda' is not one of"},
      {{"--max-force-error", "little"}, "--max-force-error: 'little' is not a number"},
      {{"--depth", "0"}, "--depth: '0' is not positive"},
      {{"--walks", "many"}, "--walks: 'many' is not"},
      {{"--walk-depth", "0%"}, "--walk-depth: '0%' is not positive"},
      {{"--walk-step", "200%"}, "--walk-step: '200%' is not above 0"},
      {{"--path", "none.csv"}, "none.csv"}};
  for (const auto& [words, message] : wrong) {
    const test::Outcome ran = run(words);
    EXPECT_NE(ran.code, 0) << message;
    EXPECT_THAT(ran.err, HasSubstr(message));
  }
}

TEST(Fidelity, its_path_stays_at_its_depth_and_goes_in_small_steps) {
  for (const Generated& made : {torus_knot(), goldberg(), banana()}) {
    const PatchCache cache = test::cache_of(made.mesh);
    const std::vector<Vec3> path =
        path_over(made.mesh, build_topology(made.mesh), cache, 0.5, 0.1, 3000);
    ASSERT_EQ(path.size(), 3000);
    std::set<std::uint32_t> faces;
    for (std::size_t i = 0; i < path.size(); ++i) {
      const Contact contact = nearest(cache, path[i]);
      EXPECT_NEAR(contact.distance, -0.5, 1e-6);
      faces.insert(contact.at.face);
      if (i > 0) {
        EXPECT_LE((path[i] - path[i - 1]).norm(), 0.2);
      }
    }
    EXPECT_GT(faces.size(), 20);
  }
}

// Ridges, creases, parts that overlap, and a plate that is thinner than the path is deep.
TEST(Fidelity, its_path_lets_no_hand_go_deeper) {
  Mesh box = test::with_creases(test::cube());
  Mesh balls = test::joined({goldberg(4, 10).mesh, goldberg(4, 6).mesh});
  for (std::size_t v = goldberg(4, 10).mesh.positions.size(); v < balls.positions.size(); ++v)
    balls.positions[v].x() += 9;
  const std::pair<Mesh, double> all[] = {{test::with_normals(fin().mesh), 0.3},
                                         {box, 0.05},
                                         {test::with_normals(balls), 0.2},
                                         {thin_plate().mesh, 0.7}};
  for (const auto& [mesh, depth] : all) {
    const PatchCache cache = test::cache_of(mesh);
    const double step = 1e-3 * (cache.bounds().high - cache.bounds().low).norm();
    ContactTracker hand(cache, test::leaping());
    int touching = 0;
    double deepest = 0;
    const auto path = path_over(mesh, build_topology(mesh), cache, depth, step, 4000);
    ASSERT_EQ(path.size(), 4000);
    for (const Vec3& hip : path) {
      const Contact contact = hand.tick(hip);
      touching += contact.touching;
      deepest = std::max(deepest, -contact.distance);
    }
    EXPECT_LE(deepest, 1.1 * depth) << mesh.source;
    EXPECT_GE(deepest, 0.9 * depth) << mesh.source;
    EXPECT_GT(touching, 2000) << mesh.source;
  }
}

// A patch that gives no numbers, on a path over it and along its edges.
TEST(Fidelity, never_takes_what_is_not_finite_for_a_small_step) {
  const double infinity = std::numeric_limits<double>::infinity(), nan = std::nan("");
  EXPECT_EQ(distances_of({1, nan, 2}).largest, infinity);
  EXPECT_EQ(distances_of({1, -infinity, 2}).largest, infinity);
  EXPECT_EQ(distances_of({nan, nan, 2}).p99, infinity);
  EXPECT_EQ(distances_of({1, 3, 2}).largest, 3);

  const Mesh mesh = goldberg(3).mesh;
  const Topology topology = build_topology(mesh);
  const PatchCache sound = test::cache_of(mesh);
  PatchCache broken = sound;
  test::break_patch(broken, 0);
  // The polygon's normal stands in for the patch's.
  EXPECT_GT(normal_gaps(mesh, topology, broken, Method::kGregory).largest, 0.1);
  EXPECT_LT(normal_gaps(mesh, topology, sound, Method::kGregory).largest, 1e-10);
  // Bent patches give up their neighbours' normals, and say so.
  const Mesh folding = test::with_normals(fin().mesh);
  EXPECT_LT(normal_gaps(folding, build_topology(folding), test::cache_of(folding), Method::kGregory)
                .largest,
            1e-6);
  const Vec3 to = test::at(sound, 0, {0, 0}).position,
             from = 0.9 * test::at(sound, 1, {0, 0}).position;
  std::vector<Vec3> path;
  for (int i = 0; i <= 400; ++i) path.push_back(from + (0.9 * to - from) * i / 400.0);
  const FeltPath smooth = feel_path(sound, {}, path, 1, {});
  EXPECT_EQ(smooth.force.unsound, 0u);
  const FeltPath felt = feel_path(broken, {}, path, 1, smooth.push);
  EXPECT_GT(felt.force.unsound, 0u);
  EXPECT_EQ(felt.force.largest_step, infinity);
  EXPECT_EQ(felt.error.largest, infinity);
  EXPECT_GE(felt.force.jumps(), felt.force.unsound);
}

TEST(Fidelity, a_tessellation_lies_on_the_surface_and_is_closed) {
  for (const Generated& made : {torus_knot(24, 6), goldberg()}) {
    const PatchCache cache = test::cache_of(made.mesh);
    for (const std::uint32_t cells : {1, 2, 5}) {
      const Mesh dense = tessellate(made.mesh, cache, cells);
      EXPECT_EQ(dense.positions,
                tessellate(made.mesh, cache, cells, make_tbb_engine()->build_backend().parallel)
                    .positions);
      EXPECT_EQ(dense.face_count(), tessellated_count(made.mesh, cache, cells));
      const Topology topology = build_topology(dense);
      EXPECT_EQ(topology.border_side_count, 0);
      EXPECT_EQ(topology.part_count, build_topology(made.mesh).part_count);
      test::Worst off;
      for (std::size_t v = 0; v < dense.positions.size(); v += 7) {
        const Contact contact = nearest(cache, dense.positions[v]);
        off.add(std::abs(contact.distance));
        off.add(oracle::angle<double>(contact.normal, dense.normals[v]));
      }
      EXPECT_LE(off.value, 1e-6);
      for (std::size_t f = 0; f < dense.face_count(); ++f) {
        const Vec3 normal = newell_normal(dense, f);
        EXPECT_GT(normal.dot(dense.normals[dense.corner_normal[3 * f]]), 0);
      }
    }
  }
}

TEST(Tessellate, asks_whether_it_is_to_stop) {
  struct Stop {};
  const Mesh mesh = goldberg().mesh;
  const PatchCache cache = build_cache(mesh);
  test::PollGap gap;
  int calls = 0;
  const auto made = [&](int most) {
    calls = 0;
    return tessellate(mesh, cache, 60, serial_for, [&] {
      gap.poll();
      if (++calls == most) throw Stop();
    });
  };
  EXPECT_EQ(made(0).face_count(), tessellated_count(mesh, cache, 60));
  gap.expect_promised();
  EXPECT_GT(calls, static_cast<int>(mesh.corner_vertex.size()));
  EXPECT_THROW(made(calls / 2), Stop);
}

// A face that is not convex is covered once, by what it is cut into.
TEST(Fidelity, a_comb_is_flat_and_its_tessellation_covers_it_once) {
  oracle::Rng rng(8);
  for (const std::uint32_t teeth : {3u, 5u}) {
    const Mesh mesh = test::with_creases(test::comb(rng, teeth, 0.5));
    const PatchCache cache = build_cache(mesh);
    EXPECT_LE(cache.departure.distance, 1e-6);
    double area = 0;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) area += newell_normal(mesh, f).norm();
    const Mesh dense = tessellate(mesh, cache, 3);
    EXPECT_EQ(dense.face_count(), tessellated_count(mesh, cache, 3));
    EXPECT_EQ(build_topology(dense).border_side_count, 0);
    double covered = 0;
    for (std::size_t f = 0; f < dense.face_count(); ++f) covered += newell_normal(dense, f).norm();
    EXPECT_NEAR(covered, area, 1e-6 * area);
  }
}

}  // namespace
}  // namespace gliss
