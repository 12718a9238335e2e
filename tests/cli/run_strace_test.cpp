// The loop's thread asks two things of the system in a tick: its sleep, and the device.
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
  Calls trace(const std::string& device, int& ticks) const {
    std::vector<std::string> words{"-f", "-o", "told", test::kProgram, "run", "scene.toml"};
    for (const char* word : {"--seconds", "2", "--json", "--device", device.c_str()})
      words.push_back(word);
    Process process(folder_ / "", "strace", words);
    const Outcome outcome = process.wait();
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

}  // namespace
}  // namespace gliss
