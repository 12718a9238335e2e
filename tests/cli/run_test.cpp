// gliss run as outsiders script against it: its JSON, and forces that are those of gliss trace,
// byte for byte.
#include "gliss/files/mesh_file.h"
#include "tests/support/run_files.h"

namespace gliss {
namespace {

using test::Outcome, test::TextTable;

class Run : public test::RunTest {
 protected:
  static constexpr int kTicks = 1500;

  // From the open to 4 mm beneath a knot and on along it, twice out and in again.
  Run() {
    const Generated knot = torus_knot(24, 6);
    save_obj(knot.mesh, folder_ / "knot.obj");
    folder_.write("knot.toml", "[[object]]\nmesh = 'knot.obj'\nunit = 'mm'\n");
    std::string mm = "x_mm,y_mm,z_mm\n", metres = "step,x,y,z\n";
    for (int i = 0; i < kTicks; ++i) {
      const auto p = knot.exact->nearest(knot.mesh.positions[0] + Vec3(0, 0.02 * i, 0));
      const double depth = 4 * std::sin(0.01 * i - 0.5);
      const Vec3 hip = p.position - depth * p.normal, hip_m = hip / 1000;
      mm += fmt::format("{},{},{}\n", hip.x(), hip.y(), hip.z());
      metres += fmt::format("{},{},{},{}\n", i, hip_m.x(), hip_m.y(), hip_m.z());
    }
    folder_.write("mm.csv", mm);
    folder_.write("m.csv", metres);
  }

  void gliss(const std::string& command, const std::string& words) const {
    const Outcome outcome = start(command, words)->wait();
    ASSERT_EQ(outcome.code, 0) << words << ": " << outcome.err;
  }
  // Expects the forces of the knot with these keys, as gliss trace has them with these options.
  void expect_forces_of_trace(const std::string& keys, const std::string& options) const {
    folder_.write("other.toml", "[[object]]\nmesh = 'knot.obj'\nunit = 'mm'\n" + keys);
    const TextTable felt = recorded("other.toml --device replay:mm.csv --no-wait");
    gliss("trace", "knot.obj --unit mm --path mm.csv -o trace.csv " + options);
    const TextTable trace(folder_.read("trace.csv"));
    for (const char* column : {"fx", "fy", "fz"}) EXPECT_EQ(felt[column], trace[column]) << options;
  }
  // Byte for byte but for how long it took.
  static void expect_same(const TextTable& a, const TextTable& b) {
    EXPECT_EQ(a.names, b.names);
    for (const std::string& name : a.names) {
      if (name == "compute") continue;
      EXPECT_EQ(a[name], b[name]) << name;
    }
  }
};

TEST_F(Run, prints_the_figures_of_its_contract) {
  const auto json = json_of_run("knot.toml --device replay:mm.csv --no-wait");
  EXPECT_EQ(json.at("ticks"), kTicks);
  EXPECT_EQ(json.at("missed"), 0);
  EXPECT_EQ(json.at("guard_trips"), 0);
  const double p50 = json.at("p50_us"), p99 = json.at("p99_us");
  EXPECT_GT(p50, 0.1);
  EXPECT_GE(p99, p50);
  EXPECT_LT(p99, 1e6);
  EXPECT_EQ(json.at("success_rate"), 1);
  EXPECT_EQ(json.at("device"), "replay:mm.csv");
  EXPECT_EQ(json.at("end"), "the device has ended");
  EXPECT_EQ(json.at("ticks_not_recorded"), 0);
  gliss("trace", "knot.obj --unit mm --path mm.csv --method gregory -o trace.csv");
  const Outcome traced =
      start("trace", "knot.obj --unit mm --path mm.csv --method gregory --json -o trace.csv")
          ->wait();
  const auto trace = nlohmann::json::parse(traced.out).at("methods").at(0);
  EXPECT_EQ(json.at("largest_force_step"), trace.at("largest_step_N"));
  for (const char* key : {"jumps_per_100k", "lost_per_100k", "unsound"})
    EXPECT_EQ(json.at(key), trace.at(key)) << key;
  EXPECT_EQ(json.at("jumps_per_100k"), 0);
  EXPECT_EQ(json.at("mean_force_step"), trace.at("mean_step_N"));
  EXPECT_EQ(json.at("largest_force"), trace.at("largest_force_N"));
  EXPECT_EQ(json.at("in_contact"), trace.at("in_contact"));
  EXPECT_EQ(json.at("entries"), trace.at("entries"));
  EXPECT_GT(json.at("in_contact"), kTicks / 3);
  EXPECT_GE(json.at("entries"), 2);
  EXPECT_GT(json.at("largest_force_step"), 0.001);
}

// The same in words, and nothing at all.
TEST_F(Run, says_that_a_crowd_may_be_late) {
  std::string hips;
  for (int i = 0; i < 1100; ++i) hips += fmt::format("[0, 0, {}e-6], ", i);
  folder_.write("crowd.toml", folder_.read("knot.toml") + "[device]\nhips = [" + hips + "]\n");
  const std::string words = "crowd.toml --device replay:mm.csv --seconds 0.05";
  EXPECT_THAT(start("run", words)->wait().err, HasSubstr("gliss: 1100 contacts of objects"));
  EXPECT_THAT(start("run", words + " --no-wait")->wait().err,
              Not(HasSubstr("contacts of objects")));
}

TEST_F(Run, speaks_as_it_is_asked_to) {
  const Outcome words = run("knot.toml --device replay:mm.csv --no-wait");
  EXPECT_EQ(words.code, 0);
  EXPECT_THAT(words.out, ::testing::AllOf(::testing::HasSubstr("1500 ticks, 0 missed"),
                                          ::testing::HasSubstr("end: the device has ended")));
  const Outcome quiet = run("knot.toml --device replay:mm.csv --no-wait --quiet");
  EXPECT_EQ(quiet.code, 0);
  EXPECT_EQ(quiet.out + quiet.err, "");
}

TEST_F(Run, renders_the_forces_of_a_trace_byte_for_byte) {
  gliss("bake", "knot.obj --unit mm -o knot.gliss");
  for (const char* path : {"mm.csv", "m.csv"}) {
    const TextTable felt = recorded(fmt::format("knot.toml --device replay:{} --no-wait", path));
    // A cache leaves the unit of the path to the file: metres.
    gliss("trace", fmt::format("knot.gliss --path {} --method gregory -o trace.csv", path));
    const TextTable trace(folder_.read("trace.csv"));
    ASSERT_EQ(felt.rows(), static_cast<std::size_t>(kTicks));
    EXPECT_EQ(felt["tick"], trace["step"]) << path;
    EXPECT_EQ(felt["state"], trace["state"]) << path;
    for (const char* column : {"x", "y", "z", "fx", "fy", "fz"})
      EXPECT_EQ(felt[column], trace[column]) << path << ' ' << column;
    for (std::size_t i = 0; i < felt.rows(); ++i) {
      if (felt["state"][i] == "free") continue;
      EXPECT_EQ(felt["face"][i], trace["face"][i]) << i;
    }
  }
}

TEST_F(Run, renders_with_the_method_and_the_stiffness_of_the_scene) {
  for (const char* method : {"shaded", "flat"}) {
    expect_forces_of_trace(fmt::format("method = '{}'\nstiffness = '0.8N/mm'\n", method),
                           fmt::format("--method {} --stiffness 0.8N/mm", method));
  }
}

TEST_F(Run, renders_at_the_level_and_with_the_solver_of_the_scene) {
  for (const char* level : {"ribbon", "bezier", "table:2"}) {
    expect_forces_of_trace(
        fmt::format("level = '{}'\nsolver = 'gauss-newton'\ntolerance = 1e-4\niterations = 3\n",
                    level),
        fmt::format("--method gregory --level {} --solver gauss-newton --tolerance 1e-4 "
                    "--iterations 3",
                    level));
  }
}

TEST_F(Run, replays_its_recordings_to_the_same_bytes) {
  const TextTable first = recorded("knot.toml --device replay:mm.csv --no-wait");
  gliss("run", "knot.toml --device replay:mm.csv --no-wait --quiet -o first.h5");
  folder_.write("first.csv", folder_.read("recorded.csv"));
  for (const char* name : {"first.csv", "first.h5"}) {
    SCOPED_TRACE(name);
    expect_same(recorded(fmt::format("knot.toml --device replay:{} --no-wait", name)), first);
  }
  gliss("run", "knot.toml --device replay:first.h5 --no-wait --quiet -o second.h5");
  expect_same(recorded("knot.toml --device replay:second.h5 --no-wait"), first);
}

// At any rate, with the velocities of the device; a replay of it has the same, at the same rate.
TEST_F(Run, is_traced_by_the_times_and_velocities_of_its_recording) {
  const std::string object =
      "[[object]]\nmesh = 'knot.obj'\nunit = 'mm'\nfriction = {static = 0.5, dynamic = 0.3, settle "
      "= '20ms'}\ndamping = 2\nviscosity = 1\n";
  const std::string hand =
      "[sim]\nwaypoints = [[0.067, 0, 0], [0.060, 0, 0], [0.060, 0.01, 0]]\nspeed = 0.05\n";
  gliss("bake", "knot.obj --unit mm -o knot.gliss");
  for (const int rate : {1000, 2000}) {
    folder_.write("timed.toml", object + fmt::format("[loop]\nrate = {}\n", rate) + hand);
    const TextTable felt = recorded("timed.toml --device sim --no-wait");
    gliss("run", "timed.toml --device sim --no-wait --quiet -o timed.h5");
    folder_.write("timed.csv", folder_.read("recorded.csv"));
    ASSERT_GT(felt.rows(), 100u);
    std::size_t touching = 0;
    for (const char* name : {"timed.csv", "timed.h5"}) {
      SCOPED_TRACE(fmt::format("{} Hz, {}", rate, name));
      gliss("trace", fmt::format("knot.gliss --path {} -o trace.csv --method gregory --friction "
                                 "0.5,0.3 --friction-settle 20ms --damping 2 --viscosity 1",
                                 name));
      const TextTable trace(folder_.read("trace.csv"));
      const TextTable again =
          recorded(fmt::format("timed.toml --device replay:{} --no-wait", name));
      for (const char* column : {"fx", "fy", "fz", "state"}) {
        EXPECT_EQ(trace[column], felt[column]) << column;
        ASSERT_GE(again.rows(), felt.rows());
        for (std::size_t i = 0; i < felt.rows(); ++i)
          ASSERT_EQ(again[column][i], felt[column][i]) << column << " " << i;
      }
      touching = std::count(felt["state"].begin(), felt["state"].end(), "contact");
    }
    EXPECT_GT(touching, 100u);
  }
}

// Whatever the machine does meanwhile, for a replay's positions are counted in ticks.
TEST_F(Run, renders_the_same_in_real_time) {
  const TextTable fast = recorded("knot.toml --device replay:mm.csv --no-wait");
  const TextTable real = recorded("knot.toml --device replay:mm.csv");
  for (const char* column : {"tick", "x", "y", "z", "fx", "fy", "fz", "state", "patch"})
    EXPECT_EQ(real[column], fast[column]) << column;
}

TEST_F(Run, does_not_kick_a_hand_that_starts_inside) {
  std::string path = "x_mm,y_mm,z_mm\n";
  for (int i = 0; i < 1000; ++i) path += "0,0,5\n";
  folder_.write("deep.csv", path);
  for (const char* pace : {" --no-wait", ""}) {
    const TextTable felt = recorded(std::string("scene.toml --device replay:deep.csv") + pace);
    ASSERT_EQ(felt.rows(), 1000u);
    double most = 0;
    for (std::size_t i = 0; i < felt.rows(); ++i) {
      EXPECT_NEAR(felt.vector("fx", "fy", "fz", i).norm(), 2.5, 0.1);
      most = std::max(most, felt.sent(i).norm());
    }
    EXPECT_LE(most, 0.2);
    EXPECT_GT(most, 0.19);
  }
}

TEST_F(Run, ends_after_so_many_seconds) {
  const auto json = json_of_run("scene.toml --device sim --no-wait --seconds 0.4");
  EXPECT_EQ(json.at("end"), "stopped");
  EXPECT_GE(json.at("ticks"), 400);
  EXPECT_LE(json.at("ticks"), 412);
  EXPECT_EQ(json.at("guard_trips"), 0);
  EXPECT_GT(json.at("in_contact"), 100);
  const auto real = json_of_run("scene.toml --device sim --seconds 0.4");
  EXPECT_EQ(real.at("end"), "stopped");
  EXPECT_GE(real.at("ticks").get<int>() + real.at("missed").get<int>(), 400);
}

// A device that takes little gets no more, whatever the scene's guards say.
TEST_F(Run, keeps_to_the_largest_force_of_the_scenes_device) {
  write_scene("", "[device]\nmax_force = 0.25");
  std::string path = "x_mm,y_mm,z_mm\n";
  for (int i = 0; i < 500; ++i) path += fmt::format("0,0,{}\n", std::max(8.0, 11 - 0.01 * i));
  folder_.write("in.csv", path);
  for (const char* device : {"sim --seconds 1", "replay:in.csv"}) {
    const auto json = json_of_run(fmt::format("scene.toml --no-wait --device {}", device));
    EXPECT_LE(json.at("largest_sent_force"), 0.25) << device;
    EXPECT_GT(json.at("largest_sent_force"), 0.24) << device;
    EXPECT_GT(json.at("largest_force"), 0.3) << device;
  }
}

// The loop has a private copy: what becomes of the file is nothing to it.
TEST_F(Run, outlives_the_cache_it_was_read_from) {
  folder_.write("cached.toml", "[[object]]\ncache = 'knot.gliss'\n");
  gliss("bake", "knot.obj --unit mm -o knot.gliss");
  const std::string cache = folder_.read("knot.gliss");
  const TextTable whole = recorded("cached.toml --device replay:mm.csv --no-wait");
  folder_.write("long.csv", folder_.read("mm.csv"));
  for (const char* fate : {"truncated", "deleted", "overwritten"}) {
    folder_.write("knot.gliss", cache);
    const auto loop = start_recording("cached.toml --device replay:long.csv", "run.csv");
    const std::string path = folder_ / "knot.gliss";
    if (*fate == 't') std::filesystem::resize_file(path, 0);
    if (*fate == 'd') std::filesystem::remove(path);
    if (*fate == 'o') std::ofstream(path) << std::string(cache.size(), '\xFF');
    EXPECT_FALSE(loop->over());
    const Outcome outcome = loop->wait();
    EXPECT_EQ(outcome.code, 0) << fate << outcome.err;
    const TextTable felt(folder_.read("run.csv"));
    for (const char* column : {"fx", "fy", "fz", "patch"})
      EXPECT_EQ(felt[column], whole[column]) << fate;
  }
}

}  // namespace
}  // namespace gliss
