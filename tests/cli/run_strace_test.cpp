// The loop's thread asks two things of the system in a tick: its sleep, and the device. What the
// system takes long for does not keep a loop from its device.
#include "gliss/device/udp_socket.h"
#include "tests/support/places.h"
#include "tests/support/require.h"
#include "tests/support/run_files.h"

namespace gliss {
namespace {

using test::Outcome, test::Process;

struct Calls {
  std::map<std::string, int> count;  // of the loop's thread, between its first and its last sleep
  std::string others;                // but for the sleeps: the lines that tell of them, some
};

// From what strace -f wrote: "PID call(arguments) = result", where a call that others came between
// is told in two lines.
Calls calls_of_loop(const std::string& told) {
  const auto lines = test::split(told, '\n');
  const auto sleeps = [](const std::string& line) {
    return line.find(" clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME") != line.npos;
  };
  const auto thread_of = [](const std::string& line) { return line.substr(0, line.find(' ')); };
  std::map<std::string, std::pair<std::size_t, std::size_t>> slept;  // by thread: first and last
  std::map<std::string, int> sleeps_of;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!sleeps(lines[i])) continue;
    const std::string thread = thread_of(lines[i]);
    if (sleeps_of[thread]++ == 0) slept[thread].first = i;
    slept[thread].second = i;
  }
  Calls calls;
  if (sleeps_of.size() != 1) return calls;  // there is one loop
  const auto& [thread, range] = *slept.begin();
  for (std::size_t i = range.first; i < range.second; ++i) {
    const std::string& line = lines[i];
    const auto paren = line.find('(');
    const bool resumed = line.find(" resumed>") != line.npos;
    if (thread_of(line) != thread || paren == line.npos || resumed) continue;
    const auto name = line.substr(line.find_last_of(' ', paren) + 1);
    // Where the system has no clock that can be read without a call.
    if (name.starts_with("clock_gettime(CLOCK_MONOTONIC,")) continue;
    ++calls.count[name.substr(0, name.find('('))];
    if (!sleeps(line) && calls.others.size() < 2000) calls.others += line + '\n';
  }
  return calls;
}

class RunStrace : public test::RunTest {
 protected:
  void SetUp() override {
    Process probe(folder_ / "", "strace", {"-f", "-o", "probe", "true"});
    const Outcome outcome = probe.wait();
    if (outcome.code == test::kNotStarted) GLISS_SKIP_UNLESS_REQUIRED("strace is absent");
    if (outcome.code != 0) GTEST_SKIP() << "strace is refused: " << outcome.err;
  }
  // Starts gliss under strace, which tells its calls to a file.
  std::unique_ptr<Process> start_traced(const std::string& options, const std::string& words,
                                        const std::string& told = "told") const {
    return std::make_unique<Process>(
        folder_ / "", "strace",
        test::split(fmt::format("-f -o {} {}{} {}", told, options, test::kProgram, words), ' '));
  }
  Calls trace(const std::string& device, int& ticks) const {
    const Outcome outcome =
        start_traced("", "run scene.toml --seconds 2 --json --device " + device)->wait();
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    ticks = json_of(outcome).at("ticks");
    return calls_of_loop(folder_.read("told"));
  }
};

TEST_F(RunStrace, a_tick_is_one_system_call) {
  int ticks = 0;
  Calls calls = trace("sim", ticks);
  EXPECT_GT(ticks, 200);
  // The last sleep ends what is counted.
  EXPECT_EQ(calls.count["clock_nanosleep"], ticks - 1);
  calls.count.erase("clock_nanosleep");
  int others = 0;
  for (const auto& [name, count] : calls.count) others += count;
  EXPECT_LE(others, 3) << calls.others;
}

// One to sleep, one to send, and two or three to receive: what has come, and that it was all.
TEST_F(RunStrace, a_tick_with_a_udp_device_is_few) {
  Process server(folder_ / "", test::kProgram, {"serve", "scene.toml", "--port", "0"});
  const auto told = [&] { return server.err().find("udp:") != std::string::npos; };
  ASSERT_TRUE(test::await(told));
  const std::string err = server.err(),
                    port = err.substr(err.find("udp:"), err.find('\n') - err.find("udp:"));
  int ticks = 0;
  Calls calls = trace(port, ticks);
  EXPECT_GT(ticks, 200);
  EXPECT_EQ(calls.count["clock_nanosleep"], ticks - 1);
  EXPECT_EQ(calls.count["sendto"], ticks - 1);
  // Each tick but some finds nothing more at last; the rest is what the device sent.
  EXPECT_GE(calls.count["recvfrom"], ticks - 1);
  const int sleeps = calls.count["clock_nanosleep"];
  EXPECT_LE(calls.count["recvfrom"], 5 * sleeps);
  for (const char* name : {"clock_nanosleep", "sendto", "recvfrom"}) calls.count.erase(name);
  int others = 0;
  for (const auto& [name, count] : calls.count) others += count;
  EXPECT_LE(others, 3) << calls.others;
}

// The server is bound before it may let anybody in, here for long.
TEST_F(RunStrace, a_loop_that_starts_with_its_server_waits_for_it) {
  const std::string port = std::to_string(udp::Socket().port());
  const auto server = start_traced("-e trace=flock -e inject=flock:delay_enter=400000 ",
                                   "serve scene.toml --seconds 2 --port " + port, "served");
  EXPECT_EQ(gliss("run scene.toml --seconds 0.5 --device udp:" + port).code, 0);
  EXPECT_EQ(server->wait().code, 0);
}

// A hello is not old before it is sent, however long the pass takes to find.
TEST_F(RunStrace, a_pass_that_is_found_slowly_lets_a_loop_in) {
  const std::string port = std::to_string(udp::Socket().port());
  const auto server = start("serve", "scene.toml --seconds 4 --port " + port);
  EXPECT_TRUE(test::await([&] { return server->err().find("udp:") != std::string::npos; }));
  const Outcome outcome = start_traced("-e trace=flock -e inject=flock:delay_exit=20000 ",
                                       "run scene.toml --seconds 0.5 --device udp:" + port)
                              ->wait();
  EXPECT_EQ(outcome.code, 0) << outcome.err;
}

// The list of users may lie on another machine, and a loop asks for its device every 5 ms.
TEST_F(RunStrace, a_user_is_looked_up_once) {
  const std::string port = std::to_string(udp::Socket().port());
  const Outcome outcome =
      start_traced("-P /etc/passwd -e trace=openat ", "run scene.toml --device udp:" + port)
          ->wait();
  expect_error(outcome, 4, "no haptic device answered");
  const std::string told = folder_.read("told"), call = "openat(";
  int calls = 0;
  for (auto at = told.find(call); at != told.npos; at = told.find(call, at + 1)) ++calls;
  EXPECT_EQ(calls, 1) << told.substr(0, 2000);
}

}  // namespace
}  // namespace gliss
