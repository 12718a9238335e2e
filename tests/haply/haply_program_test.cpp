// gliss run and gliss serve with a mock of Haply's service: the thread that takes the force away
// where the loop gets stuck must not wait for the loop.
#include "tests/haply/haply_mock.h"
#include "tests/support/run_files.h"
#include "tests/support/unprivileged.h"
#include "tests/thread/fifo_priorities.h"

namespace gliss {
namespace {

using namespace std::chrono_literals;
using test::Process;
using ::testing::HasSubstr;

constexpr auto kAsIs = [] { return true; };
constexpr char kRefused[] = "haply's thread: SCHED_FIFO 81 is refused";

class HaplyProgram : public test::RunTest, public ::testing::WithParamInterface<const char*> {
 protected:
  std::unique_ptr<Process> start_it(const std::function<bool()>& in_child) const {
    return start(GetParam(),
                 fmt::format("scene.toml --seconds 20 --device haply:127.0.0.1:{}{}", mock_.port(),
                             std::string(GetParam()) == "serve" ? " --port 0" : ""),
                 in_child);
  }

  const test::HaplyMock mock_{[](std::uint64_t) {
    std::this_thread::sleep_for(1ms);
    return test::HaplyReply{test::haply_message("049D", Vec3(0, 0, 0.05), Vec3::Zero())};
  }};
};

TEST_P(HaplyProgram, talks_in_a_thread_above_the_loops) {
  const auto program = start_it(kAsIs);
  const auto count = [&](int priority) {
    return std::ranges::count(test::fifo_priorities(program->id()), priority);
  };
  const auto says = [&](const char* words) {
    return program->err().find(words) != std::string::npos;
  };
  // The loop's is the last to be scheduled.
  ASSERT_TRUE(test::await(
      [&] { return count(80) > 0 || says("gliss: SCHED_FIFO 80 is refused") || program->over(); }));
  EXPECT_EQ(count(81), says(kRefused) ? 0 : 1);
  program->kill(SIGINT);
  const test::Outcome outcome = program->wait();
  EXPECT_EQ(outcome.code, 130) << outcome.err;
}

TEST_P(HaplyProgram, tells_that_its_thread_is_not_above_the_loops) {
  const auto program = start_it([] { return test::limit_realtime(); });
  EXPECT_TRUE(test::await(
      [&] { return program->err().find(kRefused) != std::string::npos || program->over(); }));
  EXPECT_EQ(test::fifo_priorities(program->id()), std::vector<int>());
  program->kill(SIGINT);
  const test::Outcome outcome = program->wait();
  if (outcome.code == test::kNotStarted) GTEST_SKIP() << "capabilities cannot be dropped here";
  EXPECT_EQ(outcome.code, 130) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr(kRefused));
}

// There is none above it.
TEST_P(HaplyProgram, refuses_a_loop_of_the_highest_priority) {
  write_scene("", "[loop]\npriority = 99");
  expect_error(start_it(kAsIs)->wait(), 2, "so that the loop's is at most 98");
}

INSTANTIATE_TEST_SUITE_P(Commands, HaplyProgram, ::testing::Values("run", "serve"),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace gliss
