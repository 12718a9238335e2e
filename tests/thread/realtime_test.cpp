// What is granted holds, what is refused is said in a line with its limit and cure, and all of it
// ends with the object. In child processes: limits, once lowered, stay.
#include "gliss/thread/realtime.h"

#include <gmock/gmock.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <functional>
#include <optional>
#include <thread>

#include "tests/support/scratch_folder.h"
#include "tests/support/unprivileged.h"

namespace gliss {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;

constexpr int kCannot = 77;

// Exit code of a child that does this; what it says goes to the file.
int in_child(const std::string& file, const std::function<void(std::FILE*)>& act) {
  const pid_t child = fork();
  if (child == 0) {
    std::FILE* out = std::fopen(file.c_str(), "w");
    act(out);
    std::fclose(out);
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void say(std::FILE* out, const Realtime& realtime) {
  std::fprintf(out, "priority %d scheduler %d slack %d locked %d\n", realtime.priority(),
               sched_getscheduler(0), prctl(PR_GET_TIMERSLACK), realtime.memory_locked());
  for (const std::string& line : realtime.refusals()) std::fprintf(out, "%s\n", line.c_str());
}

const auto kNoPriority = AllOf(
    HasSubstr("SCHED_FIFO 80 is refused"), HasSubstr("ulimit -r (RLIMIT_RTPRIO) is 0; cure: "),
    HasSubstr("rtprio 80"), HasSubstr("/etc/security/limits.d"), HasSubstr("CAP_SYS_NICE"));
const auto kNoMemory =
    AllOf(HasSubstr("locking memory is refused"), HasSubstr("ulimit -l (RLIMIT_MEMLOCK) is 64; "),
          HasSubstr("memlock unlimited"), HasSubstr("CAP_IPC_LOCK"));

#ifdef __SANITIZE_ADDRESS__
constexpr bool kMemoryIsLocked = true;  // the sanitizer answers for mlockall, and locks nothing
#else
constexpr bool kMemoryIsLocked = false;
#endif

TEST(Realtime, each_refusal_is_a_line_with_its_limit_and_cure) {
  const test::ScratchFolder folder;
  const int code = in_child(folder / "said", [](std::FILE* out) {
    if (!test::limit_realtime()) _exit(kCannot);
    const Realtime realtime;
    say(out, realtime);
  });
  if (code == kCannot) GTEST_SKIP() << "capabilities cannot be dropped here";
  ASSERT_EQ(code, 0);
  const std::string said = folder.read("said");
  EXPECT_THAT(said, HasSubstr("priority 0 scheduler 0 slack 1 "));
  EXPECT_THAT(said, kNoPriority);
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), kMemoryIsLocked ? 2 : 3);
  if (!kMemoryIsLocked) {
    EXPECT_THAT(said, kNoMemory);
  }
}

TEST(Realtime, what_is_required_and_refused_is_an_error_and_leaves_no_trace) {
  const test::ScratchFolder folder;
  const int code = in_child(folder / "said", [](std::FILE* out) {
    if (!test::limit_realtime()) _exit(kCannot);
    const int slack = prctl(PR_GET_TIMERSLACK);
    const std::string error = test::message_of<LoopError>([] { Realtime({.require = true}); });
    std::fprintf(out, "%s\nslack is back: %d\n", error.c_str(),
                 prctl(PR_GET_TIMERSLACK) == slack && slack != 1);
  });
  if (code == kCannot) GTEST_SKIP() << "capabilities cannot be dropped here";
  ASSERT_EQ(code, 0);
  const std::string said = folder.read("said");
  EXPECT_THAT(said, AllOf(kNoPriority, HasSubstr("\nslack is back: 1\n")));
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 2);
  if (!kMemoryIsLocked) {
    EXPECT_THAT(said, kNoMemory);
  }
}

// The line of /proc/self/status.
std::string locked_memory() {
  std::ifstream status("/proc/self/status");
  std::string line;
  while (std::getline(status, line) && !line.starts_with("VmLck:")) {
  }
  return line;
}

// A limit that is enough for now would refuse memory later.
TEST(Realtime, locks_what_is_there_where_a_limit_may_refuse_the_rest) {
  if (kMemoryIsLocked) GTEST_SKIP() << "the sanitizer answers for mlockall";
  const test::ScratchFolder folder;
  const int code = in_child(folder / "said", [](std::FILE* out) {
    if (!test::limit_realtime(rlim_t{1} << 36)) _exit(kCannot);
    const Realtime realtime;
    const std::string before = locked_memory();
    std::vector<char> later(64 << 20, 1);
    say(out, realtime);
    std::fprintf(out, "%s\n", locked_memory() == before ? "nothing more" : "more");
  });
  if (code == kCannot) GTEST_SKIP() << "capabilities cannot be dropped here";
  ASSERT_EQ(code, 0);
  const std::string said = folder.read("said");
  EXPECT_THAT(said, HasSubstr("locked 1\n"));
  EXPECT_THAT(said, HasSubstr("locking memory that comes later is left out"));
  EXPECT_THAT(said, HasSubstr("ulimit -l (RLIMIT_MEMLOCK) is 67108864; "));
  EXPECT_THAT(said, HasSubstr("nothing more"));
}

TEST(Realtime, ends_with_the_object) {
  const test::ScratchFolder folder;
  const auto act = [](std::FILE* out) {
    const int slack = prctl(PR_GET_TIMERSLACK);
    {
      const Realtime realtime;
      say(out, realtime);
    }
    std::fprintf(out, "then scheduler %d slack %d %s\n", sched_getscheduler(0),
                 prctl(PR_GET_TIMERSLACK) - slack, locked_memory().c_str());
  };
  ASSERT_EQ(in_child(folder / "said", act), 0);
  const std::string said = folder.read("said");
  EXPECT_THAT(said, ContainsRegex("then scheduler 0 slack 0 VmLck:[ \t]+0 kB"));
  // Where it was granted.
  if (said.starts_with("priority 80 ")) {
    EXPECT_THAT(said, HasSubstr("priority 80 scheduler 1 "));
  }
}

// Memory stays locked until the last of two loops ends; each thread has its own scheduling.
TEST(Realtime, serves_two_threads) {
  const test::ScratchFolder folder;
  const auto act = [](std::FILE* out) {
    auto one = std::make_optional<Realtime>();
    std::thread([&] {
      const Realtime other;
      std::fprintf(out, "alike %d\n", other.priority() == one->priority());
    }).join();
    const bool is_locked = locked_memory().find(" 0 kB") == std::string::npos;
    std::fprintf(out, "still %d\n", is_locked == one->memory_locked());
    one.reset();
    std::fprintf(out, "%s\n", locked_memory().c_str());
  };
  ASSERT_EQ(in_child(folder / "said", act), 0);
  EXPECT_THAT(folder.read("said"), AllOf(HasSubstr("alike 1\n"), HasSubstr("still 1\n"),
                                         ContainsRegex("VmLck:[ \t]+0 kB")));
}

TEST(Realtime, fits_stacks_that_are_small) {
  for (const std::size_t bytes : {64u << 10, 256u << 10, 512u << 10, 2048u << 10}) {
    pthread_attr_t attributes;
    pthread_attr_init(&attributes);
    ASSERT_EQ(pthread_attr_setstacksize(&attributes, bytes), 0);
    pthread_t thread;
    const auto body = [](void*) -> void* {
      const Realtime realtime;
      return nullptr;
    };
    ASSERT_EQ(pthread_create(&thread, &attributes, body, nullptr), 0);
    pthread_join(thread, nullptr);
    pthread_attr_destroy(&attributes);
  }
}

TEST(Realtime, keeps_to_one_processor) {
  cpu_set_t before, after;
  sched_getaffinity(0, sizeof before, &before);
  int one = 0;
  while (!CPU_ISSET(one, &before)) ++one;
  {
    const Realtime realtime({.cpu = one});
    EXPECT_EQ(sched_getcpu(), one);
    sched_getaffinity(0, sizeof after, &after);
    EXPECT_EQ(CPU_COUNT(&after), 1);
  }
  sched_getaffinity(0, sizeof after, &after);
  EXPECT_TRUE(CPU_EQUAL(&before, &after));
  const Realtime nowhere({.cpu = 1023});
  EXPECT_THAT(nowhere.refusals(), ::testing::Contains(HasSubstr("processor 1023 is refused")));
}

TEST(Realtime, refuses_a_priority_that_is_none) {
  for (const int priority : {-1, 0, 100}) {
    EXPECT_THROW(Realtime({.priority = priority}), std::invalid_argument) << priority;
  }
}

}  // namespace
}  // namespace gliss
