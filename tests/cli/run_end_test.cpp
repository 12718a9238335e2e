// gliss run ends: by a signal, by what it may not do, by what is wrong before it begins or
// while it runs.
#include <sys/resource.h>

#include <regex>

#include "tests/support/run_files.h"
#include "tests/support/unprivileged.h"
#include "tools/cli/terminal/progress_text.h"

namespace gliss {
namespace {

using test::Outcome, test::TextTable;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using tools::count_text;

class RunEnd : public test::RunTest {
 protected:
  // A device loop that was told to stop. True where there was a force to take away.
  bool stop_by(int signal) {
    const Outcome outcome = stop_recording("scene.toml --device sim --json", "run.csv", signal);
    EXPECT_EQ(outcome.code, 130);
    EXPECT_THAT(outcome.err, EndsWith("gliss: interrupted\n"));
    const auto json = json_of(outcome);
    EXPECT_EQ(json.at("end"), "stopped");
    EXPECT_EQ(json.at("ticks_not_recorded"), 0);
    const TextTable felt(folder_.read("run.csv"));
    const std::size_t ticks = felt.rows();
    EXPECT_EQ(json.at("ticks"), ticks);
    EXPECT_EQ(felt.sent(ticks - 1), Vec3::Zero());
    EXPECT_EQ(felt["guard"].back(), "safe");
    // At most ten milliseconds, in which the force never grows.
    std::size_t last = ticks;
    while (last > 0 && felt["reason"][last - 1] == "stop requested") --last;
    EXPECT_LE(felt.number("time", ticks - 1) - felt.number("time", last - 1) -
                  1e-3 * felt.number("missed", ticks - 1),
              0.0125);
    for (std::size_t i = last; i < ticks; ++i)
      EXPECT_LE(felt.sent(i).norm(), felt.sent(i - 1).norm());
    return felt.sent(last - 1).norm() > 0.2;
  }
};

TEST_F(RunEnd, lets_the_hand_go_when_interrupted) {
  for (const int signal : {SIGINT, SIGTERM}) {
    // A machine that stood still is safe, and without a force, until the hand was out again.
    bool pressed = false;
    for (int tries = 0; tries < 10 && !pressed; ++tries) pressed = stop_by(signal);
    EXPECT_TRUE(pressed) << signal;
  }
}

TEST_F(RunEnd, is_interrupted_where_there_is_no_clock_to_wait_for) {
  const Outcome outcome = stop_recording("scene.toml --device sim --no-wait", "run.h5", SIGINT);
  EXPECT_EQ(outcome.code, 130);
  EXPECT_THAT(outcome.out, HasSubstr("end: stopped"));
  // Whole: it can be read again.
  EXPECT_EQ(run("scene.toml --device replay:run.h5 --no-wait --quiet").code, 0);
}

TEST_F(RunEnd, goes_on_without_what_is_refused_unless_that_is_required) {
  const auto unprivileged = [] { return test::limit_realtime(); };
  const Outcome soft = run("scene.toml --device sim --seconds 0.3 --json", unprivileged);
  if (soft.code == test::kNotStarted) GTEST_SKIP() << "capabilities cannot be dropped here";
  ASSERT_EQ(soft.code, 0) << soft.err;
  const auto json = json_of(soft);
  EXPECT_EQ(json.at("scheduling"), "SCHED_OTHER");
  EXPECT_GE(json.at("ticks").get<int>() + json.at("missed").get<int>(), 300);
  ASSERT_GE(json.at("refusals").size(), 1u);
  for (const std::string line : json.at("refusals"))
    EXPECT_THAT(soft.err, HasSubstr("gliss: " + line + "\n"));
  EXPECT_THAT(soft.err, HasSubstr("RLIMIT_RTPRIO"));
  expect_error(run("scene.toml --device sim --require-rt -o run.csv", unprivileged), 4,
               "CAP_SYS_NICE");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run.csv"));
}

TEST_F(RunEnd, names_what_is_wrong_before_anything_runs) {
  const std::size_t files = folder_.file_count();
  expect_error(run("scene.toml --device phantom"), 2, "'phantom' is not one of sim, replay:FILE");
  expect_error(run("scene.toml --device replay"), 2, "'replay' is not one of");
  expect_error(run("scene.toml --device replay:none.csv"), 2, "none.csv");
  expect_error(run("scene.toml --device udp:70000"), 2, "70000");
  expect_error(run("scene.toml --device udp:0"), 2, "port");
  expect_error(run("none.toml --device sim"), 2, "none.toml");
  expect_error(run("scene.toml --device sim -o run.txt"), 2, "run.txt");
  expect_error(run("scene.toml --device sim --seconds 0"), 2, "--seconds");
  expect_error(run("scene.toml --device sim -o none/run.csv"), 1, "none/run.csv");
  expect_error(run("scene.toml --device sim -o none/run.h5"), 1, "none/run.h5");
  expect_error(run("scene.toml --device sim --summary none/run.json"), 1, "none/run.json");
  folder_.write("nan.csv", "x,y,z\n0,0,nan\n");
  expect_error(run("scene.toml --device replay:nan.csv"), 2, "nan.csv:2: column 'z'");
  folder_.write("none.h5", "");
  expect_error(run("scene.toml --device replay:none.h5"), 2, "none.h5");
  folder_.write("bare.toml", "[[object]]\nmesh = 'ball.obj'\nunit = 'mm'\n");
  expect_error(run("bare.toml"), 2, "[sim]");
  folder_.write("wrong.toml", "[[object]]\nmesh = 'ball.obj'\nstifness = 3\n");
  expect_error(run("wrong.toml"), 2, "wrong.toml:3: object.stifness: ");
  folder_.write("mesh.toml", "[[object]]\nmesh = 'nan.csv'\n");
  expect_error(run("mesh.toml --device replay:hand.csv"), 2, "nan.csv");
  folder_.write("cache.toml", "[[object]]\ncache = 'ball.gliss'\n");
  folder_.write("ball.gliss", "GLISS");
  expect_error(run("cache.toml --device replay:hand.csv"), 3, "ball.gliss");
  folder_.write("none.toml", "[[object]]\ncache = 'ball.obj'\n");
  expect_error(run("none.toml --device replay:hand.csv"), 3, "ball.obj");
  EXPECT_EQ(folder_.file_count(), files + 8);  // those above
}

TEST_F(RunEnd, refuses_to_render_what_is_too_stiff_for_the_device) {
  write_scene("stiffness = 3000");
  expect_error(run("scene.toml --device sim"), 2,
               ": object.stiffness of 'ball' is 3000 N/m, and sim renders at most 2000");
  write_scene("magnet = {force = 2, range = '1mm'}");
  expect_error(run("scene.toml --device sim"), 2,
               "object.magnet of 'ball': its stiffness, 3.08 force / range,");
  write_scene("stiffness = 300", "[device]\nmax_stiffness = 200");
  expect_error(run("scene.toml --device replay:hand.csv"), 2,
               "scene.toml:5: object.stiffness of 'ball'");
}

TEST_F(RunEnd, ends_with_a_disk_that_is_full) {
  // A limit on the size of files fails the same calls.
  const auto full_at = [](rlim_t bytes) {
    return [bytes] {
      const rlimit limit{bytes, bytes};
      return signal(SIGXFSZ, SIG_IGN) != SIG_ERR && setrlimit(RLIMIT_FSIZE, &limit) == 0;
    };
  };
  // Ticks come faster than they can be written where nothing is to be felt.
  folder_.write("empty.toml",
                "[sim]\nwaypoints = [[0, 0, 0], [1, 0, 0]]\nspeed = 1e-3\nresolution = 0\n");
  struct Case {
    const char *name, *words;
    rlim_t bytes;
  };
  for (const auto& [name, words, bytes] : {Case{"run.csv", "scene.toml --no-wait", 100'000},
                                           Case{"run.csv", "empty.toml --no-wait", 10'000'000},
                                           Case{"run.h5", "scene.toml --no-wait", 100'000}}) {
    folder_.write(name, "old");
    const std::size_t files = folder_.file_count();
    const Outcome outcome = run(fmt::format("{} --quiet -o {}", words, name), full_at(bytes));
    expect_error(outcome, 1, name);
    EXPECT_THAT(outcome.err, HasSubstr("File too large"));
    EXPECT_EQ(folder_.read(name), "old");
    EXPECT_EQ(folder_.file_count(), files);
  }
}

// A hand is on the device: the loop is no worse for a recording that is lost.
TEST_F(RunEnd, goes_on_where_the_disk_is_full) {
  const auto full = [] {
    const rlimit limit{20'000, 20'000};
    return signal(SIGXFSZ, SIG_IGN) != SIG_ERR && setrlimit(RLIMIT_FSIZE, &limit) == 0;
  };
  folder_.write("fast.toml", folder_.read("scene.toml") + "[loop]\nrate = 8000\n");
  for (const std::string name : {"run.csv", "run.h5"}) {
    folder_.write(name, "old");
    const std::size_t files = folder_.file_count();
    const Outcome outcome = run("fast.toml --seconds 1.5 --json -o " + name, full);
    EXPECT_EQ(outcome.code, 1);
    EXPECT_THAT(outcome.err, HasSubstr("run." + name.substr(4) + "'"));
    EXPECT_THAT(outcome.err, HasSubstr("File too large; the loop goes on\n"));
    EXPECT_THAT(outcome.err, EndsWith("File too large\n"));
    const auto json = json_of(outcome);
    EXPECT_GE(json.at("ticks").get<int>() + json.at("missed").get<int>(), 12'000);
    EXPECT_EQ(json.at("ticks_not_recorded"), json.at("ticks"));
    EXPECT_EQ(json.at("end"), "stopped");
    EXPECT_EQ(folder_.read(name), "old");
    EXPECT_EQ(folder_.file_count(), files);
  }
}

TEST_F(RunEnd, tells_its_figures_where_a_recording_fails_at_its_end) {
  const auto full = [] {
    const rlimit limit{5000, 5000};  // less than what is kept back until then
    return signal(SIGXFSZ, SIG_IGN) != SIG_ERR && setrlimit(RLIMIT_FSIZE, &limit) == 0;
  };
  for (const std::string name : {"run.csv", "run.h5"}) {
    const Outcome outcome = run("scene.toml --seconds 0.1 --json -o " + name, full);
    EXPECT_EQ(outcome.code, 1);
    EXPECT_THAT(outcome.err, HasSubstr("File too large"));
    EXPECT_GT(json_of(outcome).at("ticks").get<int>(), 0);
    EXPECT_FALSE(std::filesystem::exists(folder_ / name));
  }
}

// It does so after a second: whatever the machine, a run is soon made that takes longer. The hand's
// path must not end before.
TEST_F(RunEnd, shows_how_far_it_is_where_there_is_no_clock) {
  const std::string scene = folder_.read("scene.toml");
  folder_.write("long.toml",
                std::regex_replace(scene, std::regex("rounds = 1000"), "rounds = 1000000"));
  double seconds = 500;
  Outcome outcome;
  while (outcome.err.empty() && seconds < 1e5) {
    seconds *= 2;
    outcome = run(fmt::format("long.toml --no-wait --seconds {}", seconds));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
  }
  EXPECT_THAT(outcome.err, ::testing::StartsWith("run: "));
  EXPECT_THAT(outcome.err, EndsWith("/s\n"));
  EXPECT_THAT(outcome.err, HasSubstr("run: " + count_text(1000 * seconds) + " ticks in "));
}

// It is the name that it takes over at the end that counts.
TEST_F(RunEnd, replaces_a_recording_when_it_is_whole) {
  folder_.write("run.csv", "old");
  const auto loop = start_recording("scene.toml --device sim", "run.csv");
  EXPECT_EQ(folder_.read("run.csv"), "old");
  loop->kill(SIGKILL);
  EXPECT_EQ(loop->wait().code, -1);
  EXPECT_EQ(folder_.read("run.csv"), "old");
}

}  // namespace
}  // namespace gliss
