// Atomic writing: the old file or the new one, never a part or a mixture, and nothing left over.
#include "host/atomic_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <system_error>

#include "tests/scratch_folder.h"

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
