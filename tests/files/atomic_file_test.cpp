// Atomic writing: the old file or the new one, never a part or a mixture, and nothing left over.
#include "gliss/files/atomic_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <system_error>

#include "tests/support/scratch_folder.h"

namespace gliss {
namespace {

using test::ScratchFolder;
using ::testing::HasSubstr;

TEST(AtomicFile, ReplacesWholeFilesAndKeepsPermissionsAndLinks) {
  const ScratchFolder folder;
  namespace fs = std::filesystem;
  folder.write("old", "old");
  fs::permissions(folder / "old", fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink(folder / "old", folder / "link");
  std::string text(1 << 20, 'x');
  {
    AtomicFile file(folder / "link");
    file.write("head ");
    file.write(text);
    EXPECT_EQ(folder.read("old"), "old");
    file.commit();
  }
  EXPECT_EQ(folder.read("old"), "head " + text);
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(fs::status(folder / "old").permissions(),
            fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(folder.file_count(), 2u);
}

TEST(AtomicFile, WritersOfOnePathDoNotMix) {
  const ScratchFolder folder;
  AtomicFile a(folder / "r"), b(folder / "r");
  a.write("aaa");
  b.write("bb");
  b.commit();
  a.commit();
  EXPECT_EQ(folder.read("r"), "aaa");
  EXPECT_EQ(folder.file_count(), 1u);
}

TEST(AtomicFile, NothingIsLeftWithoutCommit) {
  const ScratchFolder folder;
  AtomicFile(folder / "r").write("text");
  EXPECT_EQ(folder.file_count(), 0u);
}

TEST(AtomicFile, RemovesWhatKilledWritersLeftAndOnlyThat) {
  const ScratchFolder folder;
  const auto left_by_a_killed_writer = [&] {
    const pid_t child = fork();
    if (child == 0) {
      AtomicFile file(folder / "r");
      file.write("left");
      kill(getpid(), SIGKILL);
    }
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status));
    EXPECT_EQ(folder.file_count(), 1u);
  };
  left_by_a_killed_writer();
  left_by_a_killed_writer();  // instead of the first one's
  {
    AtomicFile alive(folder / "r");
    EXPECT_EQ(folder.file_count(), 1u);
    AtomicFile(folder / "r").write("beside it");
    EXPECT_EQ(folder.file_count(), 1u);
    alive.write("whole");
    alive.commit();
  }
  EXPECT_EQ(folder.file_count(), 1u);
  EXPECT_EQ(folder.read("r"), "whole");
}

// Whatever else has that name.
TEST(AtomicFile, FoldersAndLinksOfATemporarysNameStay) {
  const ScratchFolder folder;
  std::filesystem::create_directory(folder / "r.gliss-tmp0");
  folder.write("other", "other");
  folder.write("r.gliss-tmp-notes", "kept");
  std::filesystem::create_symlink(folder / "other", folder / "r.gliss-tmp1");
  AtomicFile file(folder / "r");
  file.write("text");
  file.commit();
  EXPECT_EQ(folder.read("r"), "text");
  EXPECT_EQ(folder.read("other"), "other");
  EXPECT_EQ(folder.file_count(), 5u);
}

// Each writes many times what names itself throughout; half of them are killed on the way.
TEST(AtomicFile, ManyProcessesWritingAndDyingLeaveOneWholeFile) {
  const ScratchFolder folder;
  const auto write_for_ever = [&](char self) {
    const std::string text(100000, self);
    for (;;) {
      AtomicFile file(folder / "r");
      file.write(text);
      file.commit();
    }
  };
  AtomicFile first(folder / "r");
  first.write(std::string(100000, '-'));
  first.commit();
  pid_t writers[8];
  for (int i = 0; i < 8; ++i) {
    writers[i] = fork();
    if (writers[i] == 0) write_for_ever(static_cast<char>('a' + i));
  }
  for (int i = 0; i < 8; ++i) {
    for (int look = 0; look < 20; ++look) {
      const std::string text = folder.read("r");
      ASSERT_EQ(text, std::string(100000, text.empty() ? '?' : text[0]));
      usleep(1000);
    }
    kill(writers[i], SIGKILL);
    waitpid(writers[i], nullptr, 0);
  }
  AtomicFile last(folder / "r");
  last.write("last");
  last.commit();
  EXPECT_EQ(folder.read("r"), "last");
  EXPECT_EQ(folder.file_count(), 1u);
}

TEST(AtomicFile, RefusesWhatIsNoFile) {
  const auto error = [](const std::string& path) {
    return test::message_of<std::system_error>([&] { AtomicFile file(path); });
  };
  EXPECT_THAT(error("/dev/null"), HasSubstr("not a regular file, cannot replace '/dev/null'"));
  EXPECT_THAT(error("/"), HasSubstr("cannot write '/': Is a directory"));
  EXPECT_THAT(error(""), HasSubstr("cannot create '': No such file"));
}

}  // namespace
}  // namespace gliss
