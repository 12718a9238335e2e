// The writers of files, killed at every system call that has to do with files, and with each of
// these calls failing: afterwards the old file is there or the whole new one, and nothing else.
#include <sstream>

#include "gliss/tables/hdf5_reader.h"
#include "tests/support/places.h"
#include "tests/support/require.h"
#include "tests/support/run_files.h"

namespace gliss {
namespace {

using test::Outcome, test::Process;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

constexpr char kCalls[] =
    "openat,write,pwrite64,fsync,rename,close,ftruncate,truncate,unlink,flock,fchmod";
constexpr char kOld[] = "what was there before";

bool is_long() { return std::getenv("GLISS_LONG_TESTS") != nullptr; }

struct Call {
  std::string name;
  int number;    // of the calls of this name by this thread, from 1
  bool writing;  // from the first that names the temporary; those before are the loader's as well
};

class FaultInjection : public test::RunTest {
 protected:
  void SetUp() override {
    const int code =
        strace({"-o", "probe", "-e", "inject=fsync:error=EIO:when=1"}, {"--version"}).code;
    if (code == test::kNotStarted) GLISS_SKIP_UNLESS_REQUIRED("strace is absent");
    if (code != 0) GTEST_SKIP() << "strace is refused";
    folder_.write("tet.obj",
                  "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    folder_.write("path.csv", "x,y,z\n0.1,0.1,2\n0.1,0.1,0.5\n0.1,0.1,0.4\n0.2,0.1,0.4\n");
    folder_.write("tet.toml", "[[object]]\nname = 'tet'\nmesh = 'tet.obj'\n");
  }

  Outcome strace(std::vector<std::string> options, const std::vector<std::string>& words) const {
    options.insert(options.begin(), "-f");
    options.push_back(test::kProgram);
    options.insert(options.end(), words.begin(), words.end());
    Process process(folder_ / "", "strace", options);
    return process.wait();
  }

  // The calls of the main thread from the first that has to do with the temporary; with
  // GLISS_LONG_TESTS all of them.
  std::vector<Call> calls_of(const std::vector<std::string>& words) const {
    const Outcome outcome = strace({"-o", "told", "-e", std::string("trace=") + kCalls}, words);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    const auto lines = test::split(folder_.read("told"), '\n');
    const std::string main_thread = lines.at(0).substr(0, lines[0].find(' '));
    std::map<std::string, int> count;
    std::vector<Call> calls;
    bool writing = false;
    for (const std::string& line : lines) {
      const auto begin = line.find_first_not_of(' ', main_thread.size());
      const auto paren = line.find('(');
      if (!line.starts_with(main_thread + ' ') || paren == line.npos || line[begin] == '<' ||
          line[begin] == '+')
        continue;
      const std::string name = line.substr(begin, paren - begin);
      const int number = ++count[name];
      const bool fails_anyway = line.find(" = -1 ENOENT") != line.npos;
      writing = writing || line.find(".gliss-tmp") != line.npos;
      if ((writing || is_long()) && !fails_anyway) calls.push_back({name, number, writing});
    }
    return calls;
  }

  std::vector<std::filesystem::path> temporaries() const {
    std::vector<std::filesystem::path> found;
    for (const auto& file : std::filesystem::directory_iterator(folder_ / "")) {
      if (file.path().string().find(".gliss-tmp") != std::string::npos) found.push_back(file);
    }
    return found;
  }
  void remove_temporaries() const {
    for (const auto& file : temporaries()) std::filesystem::remove(file);
  }

  // `is_whole` of what the file holds.
  template <class Whole>
  void expect_old_or_new(const std::vector<std::string>& words, const std::string& output,
                         const Whole& is_whole) const {
    folder_.write(output, kOld);
    const std::vector<Call> calls = calls_of(words);
    EXPECT_TRUE(is_whole(folder_.read(output)));
    EXPECT_GT(calls.size(), 5u);
    int runs = 0, survived = 0;
    for (const auto& [name, number, writing] : calls) {
      for (const char* fault : {"signal=KILL", "error=ENOSPC", "error=EIO", "error=EINTR"}) {
        SCOPED_TRACE(fmt::format("{} {} of {} ({})", name, number, words[0], fault));
        folder_.write(output, kOld);
        const Outcome outcome = strace({"-o", "told", "-e", "trace=" + name, "-e",
                                        fmt::format("inject={}:{}:when={}", name, fault, number)},
                                       words);
        ++runs;
        const std::string left = folder_.read(output);
        const bool is_new = is_whole(left);
        EXPECT_TRUE(is_new || left == kOld);
        if (fault == std::string("signal=KILL")) {
          EXPECT_EQ(outcome.code, -1);
          remove_temporaries();
          continue;
        }
        EXPECT_THAT(temporaries(), IsEmpty());
        if (outcome.code == 0) {
          EXPECT_TRUE(is_new);
          ++survived;
          continue;
        }
        if (!writing) continue;
        EXPECT_THAT(outcome.code, AnyOf(1, 2)) << outcome.err;
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
        EXPECT_THAT(outcome.err, StartsWith("gliss: "));
        EXPECT_THAT(outcome.err, AnyOf(HasSubstr(output), HasSubstr(words[1]), HasSubstr("tet.obj"),
                                       HasSubstr("path.csv")));
      }
    }
    fmt::print("  {} {}: {} calls, {} runs, {} of them done all the same\n", words[0], output,
               calls.size(), runs, survived);
  }

  // Expects the old file or a whole one: what the same command writes undisturbed is the whole.
  void expect_old_or_the_same(const std::vector<std::string>& words,
                              const std::string& output) const {
    EXPECT_EQ(strace({"-o", "told", "-e", "trace=fsync"}, words).code, 0);
    const std::string whole = folder_.read(output);
    expect_old_or_new(words, output, [&](const std::string& text) { return text == whole; });
  }

  std::vector<std::string> trace_to(const std::string& output) const {
    return {"trace", "tet.obj",   "--path", "path.csv", "-o",
            output,  "--backend", "serial", "--quiet"};
  }
  std::vector<std::string> run_to(const std::string& output) const {
    return {"run", "tet.toml", "--no-wait", "--device", "replay:path.csv", "-o", output, "--quiet"};
  }
};

TEST_F(FaultInjection, caches_are_old_or_whole) {
  expect_old_or_the_same({"bake", "tet.obj", "-o", "out.gliss", "--threads", "1", "--quiet"},
                         "out.gliss");
}

TEST_F(FaultInjection, traces_are_old_or_whole) {
  expect_old_or_the_same(trace_to("out.csv"), "out.csv");
  expect_old_or_the_same(trace_to("out.h5"), "out.h5");
}

TEST_F(FaultInjection, recordings_are_old_or_whole) {
  constexpr int kTicks = 4;  // a row of the path each
  expect_old_or_new(run_to("out.csv"), "out.csv", [&](const std::string& text) {
    return text.starts_with("tick,") && text.ends_with('\n') &&
           std::count(text.begin(), text.end(), '\n') == kTicks + 1;
  });
  if (!is_long()) return;
  expect_old_or_new(run_to("out.h5"), "out.h5", [&](const std::string& text) {
    return text != kOld && Hdf5Reader(folder_ / "out.h5", "a recording").rows("ticks/x") == kTicks;
  });
}

#ifdef GLISS_WITH_REPORT
TEST_F(FaultInjection, pages_are_old_or_whole) {
  EXPECT_EQ(strace({"-o", "told", "-e", "trace=fsync"}, trace_to("forces.csv")).code, 0);
  expect_old_or_the_same({"report", "forces.csv", "-o", "out.html", "--quiet"}, "out.html");
}
#endif

}  // namespace
}  // namespace gliss
