// Shards of a sweep: whoever does which parts, in whatever order, twice or halfway, the sweep that
// goes on from them ends in the same bytes.
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <random>
#include <thread>

#include "gliss/generate/generate.h"
#include "gliss/sweep/sweep_grid.h"
#include "gliss/sweep/sweep_parts.h"
#include "tests/support/bytes.h"
#include "tests/support/part_files.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

namespace fs = std::filesystem;
using test::swept;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Eight parts of a chunk each.
class SweepShards : public ::testing::Test {
 protected:
  SweepShards() {
    options_.depths = {1e-3, 2e-3};
    options_.methods = {Method::kShaded, Method::kFlat};
    options_.rings = 5;
    options_.part_contacts = 16'000;
    want_ = swept(cache_, *engine_, options_);
  }

  SweepParts open(PartsAccess access) const {
    return {folder_ / "parts", cache_, options_, true, access};
  }
  // From 1 on, as users count them.
  SweepResult shard(std::size_t number, std::size_t count, const Engine& engine,
                    const SweepProgress& progress = nullptr) const {
    SweepParts parts = open(PartsAccess::kShared);
    return sweep_parts(cache_, engine, options_, every_part(number - 1, count), parts, progress);
  }
  // The whole sweep from the parts that are there; how many contacts it had to compute.
  std::uint64_t expect_whole() const {
    SweepParts parts = open(PartsAccess::kAlone);
    const SweepResult rest = sweep(
        cache_, *engine_, options_, [](const SweepBlock&) {}, nullptr, &parts);
    EXPECT_TRUE(swept(cache_, *engine_, options_, &parts) == want_);
    parts.remove();
    return rest.computed;
  }
  std::size_t whole() const { return open(PartsAccess::kShared).whole(); }

  static constexpr std::size_t kParts = 8;
  const PatchCache cache_ = test::cache_of(torus_knot(60, 8).mesh);
  const std::unique_ptr<Engine> engine_ = make_tbb_engine(2);
  const test::ScratchFolder folder_;
  SweepOptions options_;
  std::string want_;
};

TEST_F(SweepShards, of_any_number_end_in_the_same_bytes) {
  EXPECT_EQ(part_count(cache_, options_), kParts);
  for (std::size_t count = 1; count <= 4; ++count) {
    std::size_t done = 0;
    for (std::size_t number = count; number > 0; --number) {
      shard(number, count, *engine_);
      done += (kParts + count - number) / count;
      EXPECT_EQ(whole(), done);
    }
    EXPECT_EQ(expect_whole(), 0u) << count;  // the last part is there as well
    EXPECT_FALSE(fs::exists(folder_ / "parts"));
  }
}

TEST_F(SweepShards, of_several_counts_overlap) {
  EXPECT_GT(shard(1, 2, *engine_).computed, 0u);
  EXPECT_EQ(shard(1, 4, *engine_).computed, 0u);  // all of it is there
  EXPECT_GT(shard(3, 3, *engine_).computed, 0u);
  EXPECT_EQ(shard(9, 9, *engine_).computed, 0u);  // there are not as many parts
  EXPECT_EQ(whole(), 5u);
  EXPECT_GT(expect_whole(), 0u);
}

// Parts that are computed say so, and those that are there.
TEST_F(SweepShards, know_the_rows_of_their_samples) {
  const std::size_t kinds = options_.depths.size() * options_.methods.size();
  std::vector<std::vector<std::uint32_t>> faces(kinds);
  sweep(cache_, *engine_, options_, [&](const SweepBlock& block) {
    auto& of_kind = faces[block.depth_index * options_.methods.size() + block.method_index];
    EXPECT_EQ(block.row, of_kind.size());
    of_kind.insert(of_kind.end(), block.face.begin(), block.face.end());
  });
  for (int round = 0; round < 2; ++round) {
    SweepParts parts = open(PartsAccess::kShared);
    std::size_t blocks = 0;
    sweep_parts(cache_, *engine_, options_, every_part(1, 3), parts, nullptr,
                [&](const SweepBlock& block) {
                  const auto& of_kind =
                      faces[block.depth_index * options_.methods.size() + block.method_index];
                  ASSERT_LE(block.row + block.face.size(), of_kind.size());
                  EXPECT_TRUE(std::equal(block.face.begin(), block.face.end(),
                                         of_kind.begin() + static_cast<std::ptrdiff_t>(block.row)));
                  ++blocks;
                });
    EXPECT_EQ(blocks, kinds * 3);
  }
}

TEST_F(SweepShards, put_their_statistics_together_in_the_order_of_parts) {
  const SweepResult want = sweep(cache_, *engine_, options_);
  for (const std::size_t number : {3, 1}) shard(number, 3, *engine_);
  const SweepParts parts = open(PartsAccess::kShared);
  EXPECT_THAT(
      test::message_of<std::runtime_error>([&] { kept_statistics(cache_, options_, parts); }),
      HasSubstr("/parts': part 1 is gone or damaged; the same command does it again"));
  shard(2, 3, *engine_);
  const SweepResult found = kept_statistics(cache_, options_, parts);
  ASSERT_EQ(found.statistics.size(), want.statistics.size());
  EXPECT_EQ(std::memcmp(found.statistics.data(), want.statistics.data(),
                        want.statistics.size() * sizeof want.statistics[0]),
            0);
}

// There are too many to keep the beginnings of all.
TEST_F(SweepShards, find_each_of_many_parts) {
  options_.rings = 400;
  options_.part_contacts = 1;  // a chunk each
  options_.methods = {Method::kFlat};
  const SweepGrid grid(cache_, options_.rings);
  const std::size_t count = part_count(cache_, options_);
  ASSERT_EQ(count, grid.chunk_count());
  ASSERT_GT(count, 10'000u);
  std::vector<std::size_t> numbers{0, 1, 4095, 4096, 4097, 8193, count - 1, count};
  SweepParts parts(folder_ / "many", cache_, options_, true);
  std::size_t asked = 0, blocks = 0;
  sweep_parts(
      cache_, *engine_, options_, [&] { return numbers[asked++]; }, parts, nullptr,
      [&](const SweepBlock& block) {
        EXPECT_EQ(block.row, grid.points_before(numbers[asked - 1]));
        blocks += 1;
      });
  EXPECT_EQ(blocks, (numbers.size() - 1) * options_.depths.size());
  parts.remove();
}

TEST_F(SweepShards, count_all_samples_before_what_is_done_as_progress) {
  const std::uint64_t total = sample_count(cache_, options_.rings) * options_.depths.size();
  std::vector<std::uint64_t> reached;
  shard(3, 4, *engine_, [&](std::uint64_t done, std::uint64_t all) {  // the third and the seventh
    EXPECT_EQ(all, total);
    reached.push_back(done);
  });
  ASSERT_FALSE(reached.empty());
  EXPECT_TRUE(std::is_sorted(reached.begin(), reached.end()));
  EXPECT_GT(reached.front(), total / 5);
  EXPECT_GT(reached.back(), total * 4 / 5);
  EXPECT_LT(reached.back(), total);
}

// All at a time, the same part by several of them.
TEST_F(SweepShards, in_one_folder_at_once_harm_nobody) {
  std::vector<std::thread> jobs;
  for (const auto& [number, count] :
       std::vector<std::pair<std::size_t, std::size_t>>{{1, 2}, {2, 2}, {1, 1}, {2, 3}, {1, 1}}) {
    jobs.emplace_back([&, number = number, count = count] {
      const auto engine = make_serial_engine();
      SweepParts parts = open(PartsAccess::kShared);
      sweep_parts(cache_, *engine, options_, every_part(number - 1, count), parts);
      EXPECT_THAT(parts.damaged(), ElementsAre());
    });
  }
  for (std::thread& job : jobs) job.join();
  EXPECT_EQ(whole(), kParts);
  EXPECT_EQ(expect_whole(), 0u);
}

// By kill -9, each time with another count; what is whole is never done again.
TEST_F(SweepShards, survive_kills) {
  const auto serial = make_serial_engine();
  const auto start = std::chrono::steady_clock::now();
  swept(cache_, *serial, options_);
  const std::chrono::duration<double> whole_time = std::chrono::steady_clock::now() - start;
  std::mt19937_64 rng(3);
  std::size_t before = 0;
  for (std::size_t round = 0; round < 20; ++round) {
    const std::size_t count = 1 + rng() % 4;
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      shard(1 + rng() % count, count, *serial);
      _exit(0);
    }
    // Later and later, for to keep a part may take longer than to do it.
    const double latest = 0.4 + 0.1 * static_cast<double>(round);
    std::this_thread::sleep_for(whole_time * std::uniform_real_distribution<>(0, latest)(rng));
    kill(child, SIGKILL);
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    const std::size_t now = whole();
    EXPECT_GE(now, before);
    before = now;
  }
  EXPECT_GT(before, 0u);
  SweepParts parts = open(PartsAccess::kAlone);
  EXPECT_TRUE(swept(cache_, *engine_, options_, &parts) == want_);
  EXPECT_THAT(parts.damaged(), ElementsAre());
}

TEST_F(SweepShards, find_damaged_parts_of_theirs_and_leave_those_of_others) {
  shard(1, 1, *engine_);
  const std::vector<std::string> paths = test::part_paths(folder_ / "parts");
  for (const std::size_t part : {2, 3}) std::ofstream(paths[part], std::ios::app) << 'x';
  {
    SweepParts parts = open(PartsAccess::kShared);
    const SweepResult result = sweep_parts(cache_, *engine_, options_, every_part(0, 2), parts);
    EXPECT_THAT(parts.damaged(), ElementsAre(paths[2]));
    EXPECT_GT(result.computed, 0u);
  }
  SweepParts parts = open(PartsAccess::kAlone);
  EXPECT_TRUE(swept(cache_, *engine_, options_, &parts) == want_);
  EXPECT_THAT(parts.damaged(), ElementsAre(paths[3]));
}

TEST_F(SweepShards, share_the_folder_with_each_other_and_with_no_whole_sweep) {
  const auto refusal = [&](PartsAccess access) {
    return test::message_of<std::runtime_error>([&] { open(access); });
  };
  {
    const SweepParts shared = open(PartsAccess::kShared);
    EXPECT_EQ(refusal(PartsAccess::kShared), "");
    EXPECT_THAT(refusal(PartsAccess::kAlone),
                AllOf(HasSubstr(folder_ / "parts"), HasSubstr("shards are at work")));
  }
  EXPECT_TRUE(fs::exists(folder_ / "parts"));
  {
    const SweepParts alone = open(PartsAccess::kAlone);
    EXPECT_THAT(refusal(PartsAccess::kShared), HasSubstr("another command is at work here"));
  }
  EXPECT_FALSE(fs::exists(folder_ / "parts"));
}

// Sweeps end and remove the folder while others begin: nobody works in one that is gone.
TEST_F(SweepShards, never_keep_parts_in_a_folder_that_is_gone) {
  std::atomic<bool> over = false;
  std::thread other([&] {
    while (!over) {
      try {
        open(PartsAccess::kAlone);
      } catch (const std::runtime_error&) {  // shards are at work
      }
    }
  });
  std::size_t opened = 0;
  while (opened < 200) {
    try {
      const SweepParts parts = open(PartsAccess::kShared);
      parts.leave_mark(opened);
      EXPECT_TRUE(parts.has_mark(opened));
      parts.remove_mark(opened++);
    } catch (const std::system_error& error) {
      ADD_FAILURE() << error.what();
      ++opened;
    } catch (const std::runtime_error&) {  // a sweep is at work
    }
  }
  over = true;
  other.join();
}

TEST_F(SweepShards, know_their_folder_by_a_mark) {
  const SweepParts here = open(PartsAccess::kShared), same = open(PartsAccess::kShared);
  const SweepParts there(folder_ / "others", cache_, options_, true);
  here.leave_mark(7);
  EXPECT_TRUE(same.has_mark(7));
  EXPECT_FALSE(same.has_mark(8));
  EXPECT_FALSE(there.has_mark(7));
  EXPECT_EQ(open(PartsAccess::kShared).kept(), 0u);
  same.remove_mark(7);
  EXPECT_FALSE(here.has_mark(7));
}

// Rank 0 of a team puts the result together so, while others do the parts.
TEST_F(SweepShards, are_read_in_order_as_they_come) {
  std::thread other;
  SweepParts parts = open(PartsAccess::kShared);
  const auto in_order = [&, next = std::size_t{0}]() mutable {
    if (next == 2) other = std::thread([&] { shard(1, 1, *make_serial_engine()); });
    while (next >= 2 && next < kParts && !parts.is_whole(next)) std::this_thread::yield();
    return next++;
  };
  std::string got;
  const SweepResult result =
      sweep_parts(cache_, *engine_, options_, in_order, parts, nullptr,
                  [&](const SweepBlock& block) { test::append(got, block.scp); });
  other.join();
  EXPECT_GT(result.computed, 0u);  // the first two
  std::string want;
  sweep(cache_, *engine_, options_,
        [&](const SweepBlock& block) { test::append(want, block.scp); });
  EXPECT_TRUE(got == want);
  EXPECT_TRUE(parts.remove());
}

TEST_F(SweepShards, are_removed_by_the_last_who_has_the_folder) {
  shard(1, 1, *engine_);
  SweepParts parts = open(PartsAccess::kShared);
  {
    const SweepParts other = open(PartsAccess::kShared);
    EXPECT_FALSE(parts.remove());
    EXPECT_EQ(parts.whole(), kParts);
  }
  EXPECT_TRUE(parts.remove());
  EXPECT_EQ(parts.whole(), 0u);
}

}  // namespace
}  // namespace gliss
