// gliss judge: the verdict by its goals, and the command as outsiders see it.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "gliss/loop/verdict.h"
#include "tests/support/gliss_process.h"
#include "tests/support/places.h"
#include "tests/support/surfaces.h"
#include "tests/support/unprivileged.h"

namespace gliss {
namespace {

using namespace std::chrono_literals;
using test::Outcome;

// 1000 ticks, the slowest two wakes of which are `late`, and which compute so long in 12.
std::unique_ptr<TickRecord> record_of(Nanoseconds late, Nanoseconds compute, std::uint64_t missed) {
  auto record = std::make_unique<TickRecord>();
  for (int i = 0; i < 1000; ++i) {
    record->add({i < 2 ? late : 20us, i % 90 == 0 ? compute : 0us, 0}, i == 0 ? missed : 0);
  }
  return record;
}

TEST(Judge, judges_by_the_goals) {
  const auto floor = record_of(300us, 0us, 0);
  const auto verdict = [&](Nanoseconds late, Nanoseconds compute, std::uint64_t missed) {
    return std::string(verdict_name(judge(*floor, *record_of(late, compute, missed))));
  };
  EXPECT_EQ(verdict(345us, 49us, 1), "good");
  EXPECT_EQ(verdict(355us, 49us, 1), "usable");
  EXPECT_EQ(verdict(345us, 51us, 1), "usable");
  EXPECT_EQ(verdict(345us, 49us, 2), "usable");
  EXPECT_EQ(verdict(1900us, 490us, 10), "usable");
  EXPECT_EQ(verdict(2100us, 10us, 0), "unfit");
  EXPECT_EQ(verdict(20us, 510us, 0), "unfit");
  EXPECT_EQ(verdict(20us, 10us, 11), "unfit");
  EXPECT_EQ(judge(*floor, TickRecord()), Verdict::kUnfit);
  // A machine whose empty loop wakes late is no good one.
  EXPECT_EQ(judge(*record_of(800us, 0us, 0), *record_of(820us, 10us, 0)), Verdict::kUsable);
}

// Runs gliss judge; `in_child` first, `meanwhile` once it is under way.
template <class InChild, class Meanwhile>
Outcome judge_with(std::vector<std::string> words, InChild in_child, Meanwhile meanwhile) {
  words.insert(words.begin(), "judge");
  test::Process judge("/", test::kProgram, words, in_child);
  meanwhile(judge);
  return judge.wait();
}

constexpr auto kAsIs = [] { return true; };
constexpr auto kWait = [](const test::Process&) {};

TEST(Judge, reports_floor_wake_and_compute) {
  const Outcome outcome = judge_with({"--seconds", "1", "--json"}, kAsIs, kWait);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  for (const char* name : {"floor", "wake", "compute"}) {
    SCOPED_TRACE(name);
    const auto& object = json.at(name);
    ASSERT_EQ(object.size(), 4u);
    double before = 0;
    for (const char* key : {"p50_us", "p99_us", "p999_us", "max_us"}) {
      const double value = object.at(key);
      EXPECT_GE(value, before) << key;
      EXPECT_LT(value, 1e6) << key;
      before = value;
    }
    EXPECT_GT(object.at("max_us").get<double>(), 0);
  }
  // Longer than the clock's resolution: something was computed.
  EXPECT_GT(json.at("compute").at("p50_us").get<double>(), 0.1);
  const double ticks = json.at("ticks"), missed = json.at("missed");
  EXPECT_GE(ticks + missed, 500);
  EXPECT_EQ(json.at("errors"), 0);
  EXPECT_DOUBLE_EQ(json.at("success_rate"), ticks / (ticks + missed));
  EXPECT_THAT(json.at("verdict"), ::testing::AnyOf("good", "usable", "unfit"));
  EXPECT_EQ(json.at("seconds"), 1);
  EXPECT_EQ(json.at("patches"), 10000);
  test::record(
      "judge", "floor p50 {:.0f} us, wake p50 {:.0f} us, compute p50 {:.1f} us, {}",
      json.at("floor").at("p50_us").get<double>(), json.at("wake").at("p50_us").get<double>(),
      json.at("compute").at("p50_us").get<double>(), json.at("scheduling").get<std::string>());
}

TEST(Judge, says_what_was_refused_or_ends_with_it) {
  const auto unprivileged = [] { return test::limit_realtime(); };
  const Outcome told = judge_with({"--seconds", "0.2", "--json"}, unprivileged, kWait);
  if (told.code == test::kNotStarted) GTEST_SKIP() << "capabilities cannot be dropped here";
  ASSERT_EQ(told.code, 0) << told.err;
  const auto json = nlohmann::json::parse(told.out);
  EXPECT_EQ(json.at("scheduling"), "SCHED_OTHER");
  ASSERT_GE(json.at("refusals").size(), 1u);
  for (const std::string line : json.at("refusals")) {
    EXPECT_THAT(told.err, ::testing::HasSubstr("gliss: " + line + "\n"));
  }

  const Outcome refused = judge_with({"--seconds", "60", "--require-rt"}, unprivileged, kWait);
  EXPECT_EQ(refused.code, 4);
  EXPECT_EQ(refused.out, "");
  EXPECT_THAT(refused.err, ::testing::HasSubstr("CAP_SYS_NICE"));
  EXPECT_EQ(std::count(refused.err.begin(), refused.err.end(), '\n'), 1);
}

TEST(Judge, stops_when_interrupted) {
  const Nanoseconds start = monotonic_time();
  const Outcome outcome =
      judge_with({"--seconds", "600", "--json"}, kAsIs, [](const test::Process& judge) {
        // It tells of its loop first: the signal is caught by then.
        EXPECT_TRUE(test::await([&] { return judge.err().starts_with("judge: "); }));
        judge.kill(SIGINT);
      });
  EXPECT_EQ(outcome.code, 130) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_LT(monotonic_time() - start, 60s);
}

}  // namespace
}  // namespace gliss
