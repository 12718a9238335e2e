// Nothing ends without a word and a zero: broken and full outputs, limits and signals at any moment
// give a documented exit code, files that are whole or not there, and a force that fades.
#include <sys/ioctl.h>
#include <sys/resource.h>

#include <array>
#include <random>

#include "tests/support/run_files.h"

namespace gliss {
namespace {

using test::Outcome, test::Process;
using ::testing::HasSubstr;

constexpr int kInterrupted = 130;
constexpr std::array kSignals{SIGHUP, SIGQUIT, SIGXCPU, SIGINT, SIGTERM, SIGALRM};

class HostileEnds : public test::RunTest {
 protected:
  HostileEnds() {
    folder_.write("hips.csv", "x_mm,y_mm,z_mm\n0,0,9\n0,1,9\n0,2,9\n");
    folder_.write("points.csv", "patch,xi,eta\n0,0,0\n1,0.1,0.1\n");
    EXPECT_EQ(go("bake ball.obj --unit mm -o ball.gliss --quiet").code, 0);
    EXPECT_EQ(go("trace ball.gliss --path hips.csv -o forces.csv --quiet").code, 0);
  }

  static std::vector<std::string> words_of(const std::string& line) {
    return test::split(line, ' ');
  }
  Outcome go(
      const std::string& line, const std::function<bool()>& in_child = [] { return true; }) const {
    return Process(folder_ / "", test::kProgram, words_of(line), in_child).wait();
  }

  // All commands at work that is soon done.
  std::vector<std::string> commands() const {
    return {
#ifdef GLISS_WITH_REPORT
        "report forces.csv -o made.html",
#endif
        "generate knot -o made.obj",
        "check ball.obj --unit mm",
        "bake ball.obj --unit mm -o made.gliss",
        "info ball.gliss",
        "eval ball.gliss --at points.csv",
        "project ball.gliss --hip hips.csv",
        "sweep ball.gliss --depth 1mm --samples 1e3 -o made.csv",
        "trace ball.gliss --path hips.csv",
        "compare ball.obj --unit mm --levels exact,flat --ticks 100 --walks 1 --dense-limit 0",
        "devices",
        "run scene.toml --no-wait --seconds 1 --record made.h5",
        "serve scene.toml --port 0 --seconds 0.1",
        "judge --seconds 0.1"};
  }
  // Those that say something on standard output.
  static bool speaks(const std::string& command) { return !command.starts_with("generate"); }

  std::string leftovers() const {
    std::string names;
    for (const auto& file : std::filesystem::directory_iterator(folder_ / "")) {
      const std::string name = file.path().filename();
      if (name.find("gliss-tmp") != name.npos) names += " " + name;
    }
    return names;
  }
};

bool become(const char* path, int descriptor) {
  return dup2(open(path, O_WRONLY), descriptor) == descriptor;
}
bool limit_files(rlim_t bytes) {
  const rlimit limit{bytes, bytes};
  return setrlimit(RLIMIT_FSIZE, &limit) == 0;
}

TEST_F(HostileEnds, do_not_come_by_a_standard_error_that_is_full_or_closed) {
  for (const std::string& command : commands()) {
    const int code = go(command).code;
    EXPECT_TRUE(code == 0 || code == 4) << command << ": " << code;
    EXPECT_EQ(go(command, [] { return become("/dev/full", 2); }).code, code) << command;
    EXPECT_EQ(go(command, [] { return close(2) == 0; }).code, code) << command;
    const std::string bad = command + " --nonsense";
    EXPECT_EQ(go(bad, [] { return become("/dev/full", 2); }).code, 2) << bad;
    EXPECT_EQ(go(bad, [] { return close(2) == 0; }).code, 2) << bad;
  }
  EXPECT_EQ(leftovers(), "");
}

TEST_F(HostileEnds, are_errors_where_standard_output_is_full_or_closed) {
  for (const std::string& command : commands()) {
    if (!speaks(command)) continue;
    for (const bool full : {true, false}) {
      const Outcome outcome =
          go(command, [&] { return full ? become("/dev/full", 1) : close(1) == 0; });
      EXPECT_EQ(outcome.code, 1) << command;
      EXPECT_THAT(outcome.err, HasSubstr("standard output")) << command;
    }
  }
  // What has a file of its own wrote it whole before, and not into another's place.
  EXPECT_EQ(go("sweep ball.gliss --depth 1mm --samples 1e3 -o again.csv").code, 0);
  EXPECT_EQ(folder_.read("made.csv"), folder_.read("again.csv"));
  EXPECT_EQ(leftovers(), "");
}

TEST_F(HostileEnds, are_errors_where_files_may_not_grow) {
  for (const std::string command : {
#ifdef GLISS_WITH_REPORT
           "report forces.csv -o made.html",
#endif
           "generate knot -o made.obj", "bake ball.obj --unit mm -o made.gliss",
           "eval ball.gliss --at points.csv -o made.csv",
           "eval ball.gliss --at points.csv -o made.h5",
           "project ball.gliss --hip hips.csv -o made.csv",
           "trace ball.gliss --path hips.csv -o made.csv",
           "trace ball.gliss --path hips.csv -o made.h5",
           "sweep ball.gliss --depth 1mm --samples 1e4 -o made.csv",
           "sweep ball.gliss --depth 1mm --samples 1e4 -o made.h5",
           "sweep ball.gliss --depth 1mm --samples 1e4 --summary made.json",
           "sweep ball.gliss --depth 1mm --samples 1e4 -o big.csv --vtp made.vtp",
           "compare ball.obj --unit mm --levels exact,flat --ticks 100 --walks 1 --dense-limit 0 "
           "-o made.csv --quiet",
           "run scene.toml --no-wait --seconds 5 --record made.csv",
           "run scene.toml --no-wait --seconds 5 --record made.h5",
           "run scene.toml --no-wait --seconds 1 --summary made.json"}) {
    const Outcome outcome = go(command, [] { return limit_files(60); });
    EXPECT_EQ(outcome.code, 1) << command << ": " << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("File too large")) << command;
  }
  EXPECT_EQ(leftovers(), "");
  for (const char* name : {"made.csv", "made.h5", "made.json", "made.vtp", "made.gliss"})
    EXPECT_FALSE(std::filesystem::exists(folder_ / name)) << name;
}

TEST_F(HostileEnds, say_that_the_stack_is_too_small) {
  const auto small = [] {
    const rlimit limit{64 << 10, 64 << 10};
    return setrlimit(RLIMIT_STACK, &limit) == 0;
  };
  const Outcome outcome = go("sweep ball.gliss --depth 1mm -o made.csv", small);
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("ulimit -s"));
}

// The system begins the stack at a random place: several runs meet several.
TEST_F(HostileEnds, do_not_come_of_the_least_stack_that_is_taken) {
  const auto least = [] {
    const rlimit limit{384 << 10, 384 << 10};
    return setrlimit(RLIMIT_STACK, &limit) == 0;
  };
  for (int i = 0; i < 10; ++i) {
    for (const char* command : {"run scene.toml --no-wait --seconds 0.1",
                                "sweep ball.gliss --depth 1mm --summary made.json"})
      ASSERT_EQ(go(command, least).code, 0) << command;
  }
}

// A program that writes into a pipe which nobody reads comes to no end by itself.
TEST_F(HostileEnds, come_two_seconds_after_a_second_signal_and_at_once_after_a_third) {
  std::string hips = "x_mm,y_mm,z_mm\n";
  for (int i = 0; i < 2000; ++i) hips += "0,0,9\n";
  folder_.write("hips.csv", hips);
  for (const bool third : {false, true}) {
    int ends[2];
    ASSERT_EQ(pipe2(ends, O_CLOEXEC), 0);
    const int room = fcntl(ends[0], F_SETPIPE_SZ, 1);  // the least there is
    const auto in_child = [&] {
      sigset_t alarms;  // where they do not come, a third signal alone ends it
      sigemptyset(&alarms);
      sigaddset(&alarms, SIGALRM);
      return dup2(ends[1], 1) == 1 && (!third || sigprocmask(SIG_BLOCK, &alarms, nullptr) == 0);
    };
    Process process(folder_ / "", test::kProgram, words_of("project ball.gliss --hip hips.csv"),
                    in_child);
    const auto is_stuck = [&] {
      int bytes = 0;
      return ioctl(ends[0], FIONREAD, &bytes) == 0 && bytes == room;
    };
    ASSERT_TRUE(test::await(is_stuck));
    const auto goes_on = [&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(300));
      return !process.over();
    };
    process.kill(SIGINT);
    EXPECT_TRUE(goes_on());
    const auto second = std::chrono::steady_clock::now();
    process.kill(SIGTERM);
    EXPECT_TRUE(goes_on());
    if (third) process.kill(SIGHUP);
    EXPECT_EQ(process.wait().code, kInterrupted);
    if (!third) {
      EXPECT_GE(std::chrono::steady_clock::now() - second, std::chrono::seconds(2));
    }
    close(ends[0]), close(ends[1]);
  }
}

TEST_F(HostileEnds, ignore_signals_that_were_ignored_before) {
  constexpr std::array kIgnored{SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGXCPU};
  Process process(folder_ / "", test::kProgram, words_of("judge --seconds 0.3"), [&] {
    return std::all_of(kIgnored.begin(), kIgnored.end(),
                       [](int number) { return signal(number, SIG_IGN) != SIG_ERR; });
  });
  ASSERT_TRUE(test::await([&] { return process.catches(SIGALRM); }));
  for (const int number : kIgnored) {
    EXPECT_FALSE(process.catches(number)) << number;
    process.kill(number);
  }
  const Outcome outcome = process.wait();
  EXPECT_TRUE(outcome.code == 0 || outcome.code == 4) << outcome.err;
}

// Long work that a signal ends at a random moment.
TEST_F(HostileEnds, leave_whole_files_whenever_a_signal_comes) {
  std::mt19937 random(5);
  const int tries = std::getenv("GLISS_LONG_TESTS") ? 20 : 1;
  for (const std::string command :
       {"sweep ball.gliss --depth 1mm --samples 1e8 -o made.h5", "judge --seconds 60",
        "compare ball.obj --unit mm --walks 1000", "serve scene.toml --port 0",
        "run scene.toml --record made.csv --summary made.json"}) {
    for (const int signal : kSignals) {
      for (int i = 0; i < tries; ++i) {
        Process process(folder_ / "", test::kProgram, words_of(command));
        ASSERT_TRUE(test::await([&] { return process.catches(signal); }));
        std::this_thread::sleep_for(std::chrono::milliseconds(random() % 450));
        process.kill(signal);
        if (i % 2) process.kill(signal);  // an impatient hand
        const Outcome outcome = process.wait();
        EXPECT_EQ(outcome.code, kInterrupted) << command << ": " << signal << outcome.err;
        EXPECT_THAT(outcome.err, HasSubstr("interrupted")) << command;
        EXPECT_EQ(leftovers(), "") << command;
      }
    }
  }
}

// Every other command, where it reads, builds, computes and writes: at two moments, or at many and
// with each signal.
TEST_F(HostileEnds, leave_whole_files_wherever_a_command_is) {
  ASSERT_EQ(go("generate knot --along 300 --around 100 -o big.obj --quiet").code, 0);
  std::string hips = "x_mm,y_mm,z_mm\n", points = "patch,xi,eta\n",
              forces = folder_.read("forces.csv");
  const std::string tick = forces.substr(forces.find('\n') + 1);
  for (int i = 0; i < 200'000; ++i) {
    hips += fmt::format("60,{},0\n", 1e-5 * i);
    points += "0,0,0\n";
    if (i % 4 == 0) forces += tick;
  }
  folder_.write("hips.csv", hips);
  folder_.write("points.csv", points);
  folder_.write("forces.csv", forces);
  std::mt19937 random(7);
  const bool all = std::getenv("GLISS_LONG_TESTS") != nullptr;
  const std::size_t tries = all ? 4 * kSignals.size() : 2;
  struct Work {
    std::string command;
    unsigned milliseconds = 1000;  // about as long as it takes, or some part of it
  };
  for (const Work& work : {Work{"generate knot --along 3000 --around 1000 -o made.obj"},
                           Work{"check big.obj --unit mm"}, Work{"info big.obj --unit mm"},
                           Work{"bake big.obj --unit mm -o made.gliss"},
                           Work{"eval big.obj --at points.csv -o made.csv"},
                           Work{"project big.obj --unit mm --hip hips.csv -o made.csv"},
                           Work{"trace big.obj --unit mm --path hips.csv -o made.h5"},
                           Work{"compare big.obj --unit mm -o made.csv"},
                           Work{"sweep big.obj --unit mm --depth 1mm --samples 1e8 -o made.csv"},
#ifdef GLISS_WITH_REPORT
                           Work{"report forces.csv -o made.html", 200},
#endif
                           Work{"devices", 5}}) {
    const std::string& command = work.command;
    for (std::size_t i = 0; i < tries; ++i) {
      const int signal = kSignals[all ? i % kSignals.size() : random() % kSignals.size()];
      Process process(folder_ / "", test::kProgram, words_of(command));
      ASSERT_TRUE(test::await([&] { return process.over() || process.catches(signal); }));
      std::this_thread::sleep_for(std::chrono::microseconds(random() % (1000 * work.milliseconds)));
      process.kill(signal);
      const Outcome outcome = process.wait();
      EXPECT_EQ(leftovers(), "") << command;
      if (outcome.code == 0) continue;  // it was quick
      EXPECT_EQ(outcome.code, kInterrupted) << command << ": " << signal << outcome.err;
      EXPECT_THAT(outcome.err, HasSubstr("interrupted")) << command;
    }
  }
}

TEST_F(HostileEnds, let_the_hand_go_and_keep_the_recording_whoever_is_impatient) {
  for (const int signal : {SIGHUP, SIGQUIT, SIGXCPU, SIGALRM}) {
    const auto loop = start_recording("scene.toml --device sim", "run.csv");
    loop->kill(signal);
    loop->kill(signal == SIGHUP ? SIGTERM : signal);
    EXPECT_EQ(loop->wait().code, kInterrupted) << signal;
    const test::TextTable felt(folder_.read("run.csv"));
    EXPECT_GT(felt.rows(), 100u);
    EXPECT_EQ(felt.sent(felt.rows() - 1), Vec3::Zero()) << signal;
    EXPECT_EQ(felt["guard"].back(), "safe") << signal;
  }
}

}  // namespace
}  // namespace gliss
