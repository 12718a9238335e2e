// gliss project at a size that goes by parts, as users run it: shards, kills and whatever lies in
// the folder end in the same bytes.
#include <gmock/gmock.h>

#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "gliss/tables/input_table.h"
#include "tests/support/part_files.h"
#include "tests/support/run_files.h"

namespace gliss {
namespace {

namespace fs = std::filesystem;
using test::Outcome, test::Process;
using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr std::size_t kPartRows = 1 << 17;
constexpr std::size_t kColumnsAt = 40;  // in a part's file, behind its header and two counts

class ProjectParts : public test::RunTest {
 protected:
  // Two parts and a bit.
  static constexpr std::size_t kRows = 2 * kPartRows + 1000;

  ProjectParts() { test::write_hips(folder_ / "hips.npy", kRows); }

  std::string whole(const std::string& words, const std::string& output) const {
    const Outcome outcome = gliss(words + " -o " + output);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_FALSE(fs::exists(folder_ / (output + ".parts")));
    return folder_.read(output);
  }
  std::vector<std::string> parts(const std::string& folder = "p.h5.parts") const {
    return test::part_paths(folder_ / folder);
  }
  std::string project_of(const std::string& hips) const {
    return project_.substr(0, project_.rfind(' ') + 1) + hips;
  }
  nlohmann::json json_of(const std::string& words) const {
    const Outcome outcome = gliss(words + " --json");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out);
  }

  const std::string project_ =
      "project ball.obj --unit mm --method flat --stiffness 1N/mm --keep id --hip hips.npy";
  const std::string words_ = project_ + " -o p.h5";
};

// The rows of a part are those of a file that has no others.
TEST_F(ProjectParts, are_those_of_a_whole) {
  const std::string want = whole(project_, "p.h5");
  test::write_hips(folder_ / "some.npy", 2000, kPartRows - 1000);
  ASSERT_EQ(
      gliss("project ball.obj --unit mm --method flat --hip some.npy -o some.npy.out.npy").code, 0);
  const std::vector<std::string> columns = {"face", "xi", "x", "nz", "distance", "flags"};
  const InputTable all = read_table(folder_ / "p.h5",
                                    {.alternatives = {columns}, .optional = {"id"}}),
                   some = read_table(folder_ / "some.npy.out.npy", {.alternatives = {columns}});
  ASSERT_EQ(all.rows, kRows);
  ASSERT_EQ(some.rows, 2000u);
  for (const std::string& name : columns) {
    const auto* from = all.find(name)->data() + kPartRows - 1000;
    EXPECT_TRUE(std::equal(some.find(name)->begin(), some.find(name)->end(), from)) << name;
  }
  EXPECT_EQ((*all.find("id"))[kRows - 1], kRows - 1);
  EXPECT_EQ(all.unit("x"), "mm");
}

TEST_F(ProjectParts, are_the_same_whatever_the_input_is) {
  const std::string from_npy = whole(project_, "p.npy");
  test::write_hips(folder_ / "hips.h5", kRows);
  EXPECT_TRUE(whole(project_of("hips.h5"), "p.npy") == from_npy);
}

TEST_F(ProjectParts, of_shards_wait_for_the_command_that_writes_the_result) {
  const std::string want = whole(project_, "p.h5");
  fs::remove(folder_ / "p.h5");
  const Outcome first = gliss(words_ + " --shard 2/2");
  EXPECT_EQ(first.code, 0) << first.err;
  EXPECT_EQ(first.out,
            "shard 2/2 is done: 1 of 3 parts are in 'p.h5.parts'; once the others are, the result "
            "comes by\ngliss " +
                words_ + "\n");
  EXPECT_FALSE(fs::exists(folder_ / "p.h5"));
  const auto json = json_of(words_ + " --shard 1/3 --threads 1");
  EXPECT_EQ(json["shard"], "1/3");
  EXPECT_EQ(json["parts"], 3);
  EXPECT_EQ(json["parts_done"], 2);
  EXPECT_EQ(json["contacts_computed"], kPartRows);
  const Outcome last = gliss(words_);
  EXPECT_EQ(last.code, 0) << last.err;
  EXPECT_THAT(last.err, HasSubstr("goes on from 2 parts in 'p.h5.parts'"));
  EXPECT_THAT(last.out, StartsWith(fmt::format("{} HIPs, ", kRows)));
  EXPECT_TRUE(folder_.read("p.h5") == want);
  EXPECT_FALSE(fs::exists(folder_ / "p.h5.parts"));

  EXPECT_THAT(gliss(project_ + " --shard 1/2").err,
              HasSubstr("parts that are shared need a folder"));
}

TEST_F(ProjectParts, outlive_a_kill_and_an_interruption) {
  test::write_hips(folder_ / "hips.npy", 4 * kPartRows + 1000);  // enough for both to come in time
  const std::string want = whole(project_, "p.h5");
  folder_.write("p.h5", "old");
  for (const int signal : {SIGKILL, SIGINT}) {
    const std::size_t before = parts().size();
    Process job(folder_ / "", test::kProgram, test::split(words_, ' '));
    EXPECT_TRUE(test::await([&] { return parts().size() > before; }));
    job.kill(signal);
    const Outcome outcome = job.wait();
    EXPECT_TRUE(folder_.read("p.h5") == "old");
    if (signal == SIGKILL) continue;
    EXPECT_EQ(outcome.code, 130);
    EXPECT_THAT(outcome.err, HasSubstr("parts are in 'p.h5.parts': the same command goes on"));
  }
  EXPECT_THAT(gliss(words_).err, HasSubstr(" parts in 'p.h5.parts'"));
  EXPECT_TRUE(folder_.read("p.h5") == want);
  EXPECT_FALSE(fs::exists(folder_ / "p.h5.parts"));
}

TEST_F(ProjectParts, that_are_damaged_or_forged_are_done_again) {
  const std::string want = whole(project_, "p.h5");
  ASSERT_EQ(gliss(words_ + " --shard 1/1").code, 0);
  const auto all = parts();
  ASSERT_EQ(all.size(), 3u);
  const std::string sound = test::read_file(all[0]);
  std::ofstream(all[1], std::ios::app) << "damage";
  std::ofstream(all[2], std::ios::binary) << sound;  // of another number
  // 4 + 8 x 8 bytes a row come before the distance.
  std::string forged = sound;
  for (std::size_t row = 0; row < kPartRows; ++row) {
    const double distance = -0.777;
    std::memcpy(&forged[kColumnsAt + (4 + 8 * 8) * kPartRows + 8 * row], &distance,
                sizeof distance);
  }
  test::set_part_checksum(forged);
  std::ofstream(all[0], std::ios::binary) << forged;
  const Outcome outcome = gliss(words_);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  for (int i = 0; i < 3; ++i)
    EXPECT_THAT(outcome.err,
                HasSubstr(fs::path(all[i]).filename().string() + "' was damaged, its part is"));
  EXPECT_TRUE(folder_.read("p.h5") == want);
}

TEST_F(ProjectParts, of_other_hips_or_options_are_left_alone) {
  ASSERT_EQ(gliss(words_ + " --shard 1/4").code, 0);
  test::write_hips(folder_ / "hips.npy", kRows, 1);
  for (const std::string& other : {std::string(), std::string(" --tolerance 1e-9")}) {
    const Outcome outcome = gliss(words_ + other);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("1 files of other work in 'p.h5.parts' are left alone"));
  }
  EXPECT_EQ(parts().size(), 1u);
}

// A row at the end that is no HIP is told before anything is computed or written.
TEST_F(ProjectParts, are_not_begun_where_a_row_is_no_hip) {
  for (const char* name : {"hips.npy", "hips.h5"}) {
    test::write_hips(folder_ / name, kRows, 0, kRows - 1);
    const std::string words = project_of(name);
    for (const char* more : {" -o p.h5", " -o p.h5 --shard 4/4", ""}) {
      const Outcome outcome = gliss(words + more);
      EXPECT_EQ(outcome.code, 2);
      EXPECT_EQ(outcome.out, "");
      EXPECT_THAT(outcome.err, HasSubstr(fmt::format("{}: row {}: column 'y_mm': nan is not finite",
                                                     name, kRows - 1)));
    }
    EXPECT_FALSE(fs::exists(folder_ / "p.h5"));
    EXPECT_FALSE(fs::exists(folder_ / "p.h5.parts"));
  }
}

// A folder cannot be made there, and one is needed for what has two parts.
TEST_F(ProjectParts, need_no_folder_where_there_is_one) {
  test::write_hips(folder_ / "few.npy", kPartRows);
  const std::string few = project_of("few.npy") + " -o p.npy --parts ",
                    many = project_ + " -o p.npy --parts ";
  EXPECT_EQ(gliss(few + "no/where").code, 0);
  const Outcome outcome = gliss(many + "no/where");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("no/where"));
  EXPECT_EQ(gliss(many + "none").code, 0);
}

}  // namespace
}  // namespace gliss
