// Parts of a sweep that somebody else left, forged or put something else in the place of: they are
// done again, and folders that others can write to are not used.
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>

#include "gliss/files/cache_format.h"
#include "gliss/generate/generate.h"
#include "gliss/sweep/sweep_parts.h"
#include "tests/support/allocations.h"
#include "tests/support/bytes.h"
#include "tests/support/part_files.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

namespace fs = std::filesystem;
using test::swept;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// A part's file holds a name, a checksum of all behind it, its number, statistics, blocks.
constexpr std::size_t kStatisticsAt = 24;

TEST(PartFolder, that_cannot_be_listed_lets_go_of_its_lock) {
  if (!test::allocations_are_counted()) GTEST_SKIP() << "skipped: a sanitizer allocates";
  const test::ScratchFolder folder;
  const std::string parts = folder / "parts";
  std::uint64_t failed = 0;
  for (std::uint64_t k = 1, in_a_row = 0; in_a_row < 3; ++k) {
    {
      test::FailingAllocation failing(k, false);
      try {
        PartFolder(parts, 1);
      } catch (const std::exception&) {
      }
      failing.end();
      in_a_row = failing.has_failed() ? 0 : in_a_row + 1;
      failed += failing.has_failed();
    }
    ASSERT_NO_THROW(PartFolder(parts, 1)) << "after failure of allocation " << k;
  }
  EXPECT_GT(failed, 2u);
}

class HostileParts : public ::testing::Test {
 protected:
  HostileParts() {
    umask(022);  // what is put in the place of parts is written by its owner alone
    options_.depths = {1e-3};
    options_.methods = {Method::kFlat};
    options_.rings = 3;
    options_.part_contacts = 1;
    want_ = swept(cache_, *engine_, options_);
    SweepParts parts = open();
    swept(cache_, *engine_, options_, &parts);
    paths_ = test::part_paths(parts_);
  }

  SweepParts open() const { return SweepParts(parts_, cache_, options_, true); }
  std::string refusal(const std::string& folder) const {
    return test::message_of<std::runtime_error>(
        [&] { SweepParts(folder, cache_, options_, true); });
  }

  std::string read(std::size_t part) const { return test::read_file(paths_[part]); }
  // Writes a part with a checksum that is right.
  void write(std::size_t part, std::string bytes) const {
    test::set_part_checksum(bytes);
    std::ofstream(paths_[part], std::ios::binary) << bytes;
  }
  // The block of a part of one: behind its number of depth, method and rows.
  static std::size_t block_at() { return kStatisticsAt + sizeof(SweepStatistics); }
  static std::uint64_t rows(const std::string& bytes) {
    std::uint64_t rows = 0;
    std::memcpy(&rows, &bytes[block_at() + 16], sizeof rows);
    return rows;
  }
  template <class Value>
  static void put(std::string& bytes, std::size_t at, Value value) {
    ASSERT_LE(at + sizeof value, bytes.size());
    std::memcpy(&bytes[at], &value, sizeof value);
  }

  // The part is done again, once, and the result is as ever.
  void expect_done_again(std::size_t part, const std::string& what) const {
    SCOPED_TRACE(what);
    {
      SweepParts parts = open();
      EXPECT_EQ(swept(cache_, *engine_, options_, &parts), want_);
      EXPECT_THAT(parts.damaged(), ElementsAre(paths_[part]));
    }
    SweepParts parts = open();
    EXPECT_EQ(swept(cache_, *engine_, options_, &parts), want_);
    EXPECT_THAT(parts.damaged(), ElementsAre());
    EXPECT_EQ(parts.kept(), paths_.size());
  }

  const PatchCache cache_ = test::cache_of(torus_knot(60, 8).mesh);
  const std::unique_ptr<Engine> engine_ = make_serial_engine();
  const test::ScratchFolder folder_;
  const std::string parts_ = folder_ / "parts";
  SweepOptions options_;
  std::string want_;
  std::vector<std::string> paths_;  // [part]
};

TEST_F(HostileParts, are_kept_from_others) {
  struct stat status {};
  ASSERT_EQ(stat(parts_.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0700u);
  ASSERT_GE(paths_.size(), 2u);
  for (const std::string& path : paths_) {
    ASSERT_EQ(stat(path.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, 0600u) << path;
  }
}

TEST_F(HostileParts, that_a_group_may_write_are_named) {
  ASSERT_EQ(chmod(paths_[1].c_str(), 0660), 0);
  SweepParts parts = open();
  EXPECT_THAT(
      test::message_of<std::runtime_error>([&] { swept(cache_, *engine_, options_, &parts); }),
      AllOf(HasSubstr(paths_[1]), HasSubstr("may be written by others")));
}

TEST(PartFolder, removes_no_folder_but_its_own) {
  const test::ScratchFolder folder;
  const std::string own = folder / "own", given = folder / "given";
  ASSERT_EQ(mkdir(given.c_str(), 01700), 0);
  { PartFolder(given, 1).remove(); }
  EXPECT_TRUE(fs::is_empty(given));
  {
    PartFile part;
    PartFolder(own, 1).save(0, part);
  }
  ASSERT_EQ(chmod(own.c_str(), 0750), 0);
  EXPECT_EQ(PartFolder(own, 1).foreign(), 0u);
  EXPECT_TRUE(fs::exists(own));
  { EXPECT_TRUE(PartFolder(own, 1).remove()); }
  EXPECT_FALSE(fs::exists(own));
  PartFolder gone(own, 1);
  fs::remove_all(own);
  EXPECT_TRUE(gone.remove());
}

TEST_F(HostileParts, that_are_something_else_are_done_again) {
  const std::string path = paths_[1];
  const auto replace = [&](const std::string& what, const auto& make) {
    fs::remove(path);
    make();
    expect_done_again(1, what);
    EXPECT_TRUE(fs::is_regular_file(fs::symlink_status(path)));
  };
  replace("pipe", [&] { ASSERT_EQ(mkfifo(path.c_str(), 0600), 0); });
  replace("folder", [&] { fs::create_directory(path); });
  replace("device", [&] { fs::create_symlink("/dev/zero", path); });
  replace("dangling link", [&] { fs::create_symlink("nowhere", path); });
  replace("link to another", [&] { fs::create_symlink(paths_[0], path); });
  replace("empty", [&] { std::ofstream(path, std::ios::binary); });
  const std::string sound = read(1);
  replace("unreadable", [&] {
    std::ofstream(path, std::ios::binary) << sound.substr(0, kStatisticsAt);
    fs::permissions(path, fs::perms::none);
  });
  EXPECT_NE(fs::status(path).permissions() & fs::perms::owner_read, fs::perms::none);
}

TEST_F(HostileParts, that_cannot_be_removed_are_named) {
  fs::remove(paths_[1]);
  fs::create_directories(paths_[1] + "/in");
  SweepParts parts = open();
  EXPECT_THAT(
      test::message_of<std::system_error>([&] { swept(cache_, *engine_, options_, &parts); }),
      AllOf(HasSubstr(paths_[1]), HasSubstr("is not a part and cannot be removed"),
            HasSubstr("Directory not empty")));
}

TEST_F(HostileParts, with_a_right_checksum_and_wrong_numbers_are_done_again) {
  const std::string sound = read(1);
  const auto count = rows(sound);
  const auto forge = [&](const std::string& what, const auto& change) {
    std::string bytes = sound;
    change(bytes);
    write(1, bytes);
    expect_done_again(1, what);
    EXPECT_EQ(read(1), sound);
  };
  // Columns: face, xi, eta, hip, scp, force, residual_angle, iterations, crossings, flags.
  const std::size_t face = block_at() + 24, xi = face + 4 * count, hip = xi + 16 * count,
                    scp = hip + 24 * count, force = scp + 24 * count, residual = force + 24 * count;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  forge("a depth that is not there", [&](auto& b) { put(b, block_at(), std::uint64_t{1}); });
  forge("a method that is not there", [&](auto& b) { put(b, block_at() + 8, ~std::uint64_t{0}); });
  for (const std::uint64_t rows : {std::uint64_t{0}, count - 1, count + 1, std::uint64_t{1} << 62})
    forge(fmt::format("{} rows", rows), [&](auto& b) { put(b, block_at() + 16, rows); });
  forge("a block too many", [&](auto& b) { b += b.substr(block_at()); });
  forge("no block", [&](auto& b) { b.resize(block_at()); });
  forge("a face beyond the last", [&](auto& b) { put(b, face, cache_.mesh_face_count); });
  forge("another face", [&](auto& b) { put(b, face, std::uint32_t{0}); });
  forge("another point", [&](auto& b) { put(b, xi, 0.1); });
  for (const std::size_t at : {xi, hip, scp, force})
    forge("NaN", [&](auto& b) { put(b, at + 8 * (count / 2), nan); });
  forge("an angle that is not finite",
        [&](auto& b) { put(b, residual, std::numeric_limits<float>::infinity()); });
  forge("forces of -777 N", [&](auto& b) {
    for (std::uint64_t i = 0; i < 3 * count; ++i) put(b, force + 8 * i, -777.0);
  });
  forge("surface points elsewhere", [&](auto& b) {
    for (std::uint64_t i = 0; i < 3 * count; ++i) put(b, scp + 8 * i, 1.0);
  });
  forge("the part of another number", [&](auto& b) { b = read(0); });
  forge("the header of an older build", [&](auto& b) { b.insert(kStatisticsAt, 16, '\0'); });
}

// A surface is at fault: its numbers that are not finite are computed again, and agree.
TEST_F(HostileParts, that_are_not_finite_by_right_are_kept) {
  PatchCache broken = cache_;
  auto& control = std::get<1>(broken.surface).control;
  const auto some = static_cast<std::ptrdiff_t>(control.size() / 4);
  std::fill(control.begin() + some, control.begin() + 2 * some, std::nan(""));
  options_.methods = {Method::kGregory};
  const std::string folder = folder_ / "broken";
  const auto swept_by = [&](SweepParts& parts) {
    return sweep(
        broken, *engine_, options_, [](const SweepBlock&) {}, nullptr, &parts);
  };
  SweepParts first(folder, broken, options_, true);
  const SweepResult whole = swept_by(first);
  ASSERT_GT(whole.statistics[0].error.unsound(), 0u);
  ASSERT_LT(whole.statistics[0].error.unsound(), whole.statistics[0].samples);
  const std::size_t kept = first.kept();
  ASSERT_GE(kept, 2u);
  const SweepResult again = swept_by(first);
  EXPECT_THAT(first.damaged(), ElementsAre());
  EXPECT_EQ(first.kept(), kept);
  EXPECT_LT(again.computed, whole.computed / 2);  // of the last part, which is not kept
  EXPECT_EQ(again.statistics[0].error.unsound(), whole.statistics[0].error.unsound());
}

TEST_F(HostileParts, with_statistics_that_cannot_be_are_done_again) {
  const std::string sound = read(1);
  SweepStatistics statistics;
  const auto forge = [&](const std::string& what, const auto& change) {
    std::memcpy(&statistics, &sound[kStatisticsAt], sizeof statistics);
    change(statistics);
    std::string bytes = sound;
    put(bytes, kStatisticsAt, statistics);
    write(1, bytes);
    expect_done_again(1, what);
  };
  using S = SweepStatistics;
  forge("another depth", [](S& s) { s.depth = 2; });
  forge("another method", [](S& s) { s.method = Method::kShaded; });
  forge("more contacts than samples", [](S& s) { s.touching = s.samples + 1; });
  forge("other samples", [](S& s) { ++s.samples; });
  forge("other samples, counted so", [](S& s) { ++s.samples, s.error.add(0), s.residual.add(0); });
  forge("more lost than jumps", [](S& s) { s.lost = s.jumps + 1; });
  forge("more leaps than jumps", [](S& s) { s.leaps = s.jumps + 1; });
  forge("a histogram of something else", [](S& s) {
    unsigned char bytes[sizeof s.step];
    std::memset(bytes, 0xff, sizeof bytes);
    std::memcpy(&s.step, bytes, sizeof bytes);
  });
}

TEST_F(HostileParts, are_not_looked_for_where_others_may_leave_them) {
  fs::create_directory_symlink(parts_, folder_ / "link");
  EXPECT_THAT(refusal(folder_ / "link"),
              AllOf(HasSubstr("link'"), HasSubstr("it is a symbolic link; name the folder")));
  fs::permissions(parts_, fs::perms::all);
  EXPECT_THAT(refusal(parts_),
              AllOf(HasSubstr(parts_), HasSubstr("others may write to it; chmod go-w")));
  if (geteuid() != 0) GTEST_SKIP() << "only root can give a folder away";
  fs::permissions(parts_, fs::perms::owner_all);
  ASSERT_EQ(chown(parts_.c_str(), 65534, 65534), 0);
  EXPECT_THAT(refusal(parts_), AllOf(HasSubstr(parts_), HasSubstr("it belongs to another user")));
}

// A group may write to the folder, say; a checksum is no proof of whose numbers they are.
TEST_F(HostileParts, of_another_user_are_not_taken) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can give a file away";
  ASSERT_EQ(chown(paths_[1].c_str(), 65534, 65534), 0);
  const std::string told = test::message_of<std::runtime_error>([&] {
    SweepParts parts = open();
    swept(cache_, *engine_, options_, &parts);
  });
  EXPECT_THAT(told, AllOf(HasSubstr(paths_[1]), HasSubstr("belongs to another user; remove it")));
  EXPECT_TRUE(fs::exists(paths_[1]));
}

// A folder that a sweep made is removed by the one that goes on, and any other one stays.
TEST_F(HostileParts, leave_folders_that_were_there) {
  open().remove();
  EXPECT_FALSE(fs::exists(parts_));
  fs::create_directory(parts_);
  {
    SweepParts parts = open();
    swept(cache_, *engine_, options_, &parts);
    parts.remove();
  }
  EXPECT_TRUE(fs::is_empty(parts_));
}

}  // namespace
}  // namespace gliss
