// gliss sweep --shard as users run it.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <fmt/format.h>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/run_files.h"

namespace gliss {
namespace {

namespace fs = std::filesystem;
using test::Outcome, test::Process;
using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;

class Shards : public test::RunTest {
 protected:
  void expect_refused(const std::string& words, const std::string& what) const {
    const Outcome outcome = gliss(words);
    EXPECT_EQ(outcome.code, 2) << words;
    EXPECT_THAT(outcome.err, HasSubstr(what));
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }

  // Four parts.
  const std::string sweep_ = "sweep ball.obj --unit mm --depth 1mm --method flat --samples 1.7e6";
};

TEST_F(Shards, write_no_result_and_the_same_command_without_them_does) {
  const std::string words = sweep_ + " -o s.h5 --summary s.json";
  ASSERT_EQ(gliss(words).code, 0);
  const std::string want = folder_.read("s.h5");
  const auto want_json = nlohmann::json::parse(folder_.read("s.json"));
  fs::remove(folder_ / "s.h5");
  fs::remove(folder_ / "s.json");

  const Outcome first = gliss(words + " --shard 2/2");
  EXPECT_EQ(first.code, 0) << first.err;
  EXPECT_EQ(first.out,
            "shard 2/2 is done: 2 of 4 parts are in 's.h5.parts'; once the others are, the result "
            "comes by\ngliss " +
                words + "\n");
  EXPECT_FALSE(fs::exists(folder_ / "s.h5"));
  EXPECT_FALSE(fs::exists(folder_ / "s.json"));
  const Outcome again = gliss(words + " --json --shard=1/2");
  const auto json = nlohmann::json::parse(again.out);
  EXPECT_EQ(json["shard"], "1/2");
  EXPECT_EQ(json["parts"], 4);
  EXPECT_EQ(json["parts_done"], 4);
  EXPECT_EQ(json["parts_folder"], "s.h5.parts");
  EXPECT_EQ(json["command_of_result"], "gliss " + words + " --json");
  EXPECT_GT(json["contacts_computed"], 0);
  EXPECT_THAT(gliss(words + " --shard 1/1").out,
              AllOf(HasSubstr("4 of 4 parts are in 's.h5.parts'; the result comes by\n"),
                    Not(HasSubstr("others"))));

  const Outcome last = gliss(words);
  EXPECT_EQ(last.code, 0) << last.err;
  EXPECT_THAT(last.err, HasSubstr("goes on from 4 parts in 's.h5.parts'"));
  EXPECT_TRUE(folder_.read("s.h5") == want);
  EXPECT_EQ(nlohmann::json::parse(folder_.read("s.json"))["statistics"], want_json["statistics"]);
  EXPECT_FALSE(fs::exists(folder_ / "s.h5.parts"));
}

TEST_F(Shards, that_make_no_sense_are_refused_with_the_cure) {
  const std::string words = sweep_ + " -o s.h5 --shard ";
  expect_refused(words + "0/4", "--shard: '0/4': shards are counted from 1, so these are 1/4 to");
  expect_refused(words + "5/4", "--shard: '5/4': shards are counted from 1, so these are 1/4 to");
  expect_refused(words + "1/0", "--shard: '1/0': there is no shard of none; write I/N, as 3/16");
  for (const char* text : {"x", "3", "3/", "/3", "1/2/3", "-1/2", "1/2x", "1.5/2"})
    expect_refused(words + text, "write I/N for shard I of N, as 3/16");
  expect_refused(
      sweep_ + " --shard 1/2",
      "parts that are shared need a folder; add what the whole command writes, as -o FILE");
  expect_refused(sweep_ + " -o s.h5 --parts none --shard 1/2",
                 "parts that are shared need a folder");
  expect_refused(sweep_ + " -o - --shard 1/2", "parts that are shared need a folder");
  EXPECT_FALSE(fs::exists(folder_ / "s.h5.parts"));
}

// True if a process holds a lock of a folder.
bool has_locked(pid_t process, const fs::path& folder) {
  struct stat status;
  if (stat(folder.c_str(), &status) != 0) return false;
  std::ifstream locks("/proc/locks");
  for (std::string line; std::getline(locks, line);) {
    if (line.find(fmt::format(" {} ", process)) != line.npos &&
        line.find(fmt::format(":{} ", status.st_ino)) != line.npos)
      return true;
  }
  return false;
}

TEST_F(Shards, and_a_whole_sweep_do_not_work_in_one_folder_at_once) {
  const std::string words = sweep_ + " --summary s.json";
  // It takes seconds, and has locked its folder a while after that is there.
  Process shard(folder_ / "", test::kProgram,
                test::split("sweep ball.obj --unit mm --depth 1mm,2mm,3mm,4mm --method flat "
                            "--samples 1.7e6 --summary s.json0 --parts p --shard 1/1",
                            ' '));
  ASSERT_TRUE(test::await([&] { return has_locked(shard.id(), folder_ / "p"); }));
  // It is stopped lest it ends first.
  shard.kill(SIGSTOP);
  const Outcome outcome = gliss(words + " --parts p");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("shards are at work here; go on when they are"));
  EXPECT_EQ(gliss(words + " --parts p --shard 4/4").code, 0);
  shard.kill(SIGCONT);
  EXPECT_EQ(shard.wait().code, 0);
  EXPECT_EQ(gliss(words + " --parts p").code, 0);
}

}  // namespace
}  // namespace gliss
