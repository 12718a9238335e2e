// gliss view as its user calls it: the browser it opens, and meshes that cannot be shown.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "gliss/files/mesh_file.h"
#include "gliss/generate/generate.h"
#include "tests/support/gliss_process.h"

namespace gliss {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;

#ifdef GLISS_WITH_REPORT

class ViewCommand : public ::testing::Test {
 protected:
  ViewCommand() { save_obj(torus_knot(24, 6).mesh, folder_ / "knot.obj"); }

  // Opens the page with these programs; the folder holds what only its user can read.
  test::Outcome open_browser(const std::string& programs) const {
    return test::Process(folder_.path(), test::kProgram,
                         {"view", "knot.obj", "--unit", "mm", "--open", "--seconds", "1"},
                         [&] {
                           return setenv("PATH", programs.c_str(), 1) == 0 &&
                                  setenv("XDG_RUNTIME_DIR", folder_.path().c_str(), 1) == 0;
                         })
        .wait();
  }

  const test::ScratchFolder folder_;
};

// The words of a command are seen by all users of a machine, and the address has a secret.
TEST_F(ViewCommand, opens_a_browser_by_a_file_that_its_user_alone_can_read) {
  const std::string browser = folder_.write(
      "xdg-open", "#!/bin/sh\nstat -c %a \"$1\" >mode\ncp \"$1\" door\necho \"$*\" >words\n");
  std::filesystem::permissions(browser, std::filesystem::perms::owner_all);
  const test::Outcome viewed = open_browser(folder_.path() + ":" + std::getenv("PATH"));
  EXPECT_EQ(viewed.code, 0) << viewed.err;
  const std::string url = viewed.err.substr(0, viewed.err.find('\n'));
  EXPECT_THAT(url, ::testing::StartsWith("http://127.0.0.1:"));
  EXPECT_THAT(folder_.read("door"), HasSubstr(fmt::format("url={}\"", url)));
  EXPECT_EQ(folder_.read("mode"), "600\n");
  const std::string words = folder_.read("words"), token = url.substr(url.find('#') + 1);
  EXPECT_THAT(words, EndsWith(".html\n"));
  EXPECT_THAT(words, ::testing::Not(HasSubstr(token)));
  EXPECT_FALSE(std::filesystem::exists(words.substr(0, words.size() - 1))) << "it goes at the end";
}

TEST_F(ViewCommand, says_where_there_is_no_browser) {
  const test::Outcome viewed = open_browser("/nowhere");
  EXPECT_EQ(viewed.code, 4);
  EXPECT_THAT(viewed.err, HasSubstr("--open: there is no xdg-open here (package xdg-utils)"));
  EXPECT_EQ(folder_.file_count(), 1u);  // the mesh
}

// It is read after the page is served.
TEST_F(ViewCommand, ends_where_a_mesh_cannot_be_shown_and_leaves_no_recording) {
  folder_.write("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 nonsense\nf 1 2 3\n");
  const test::Outcome viewed =
      test::Process(folder_.path(), test::kProgram,
                    {"view", "bad.obj", "--unit", "mm", "--record", "ticks.h5"})
          .wait();
  EXPECT_EQ(viewed.code, 2);
  EXPECT_THAT(viewed.err, HasSubstr("bad.obj:3"));
  EXPECT_EQ(viewed.out, "");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "ticks.h5"));
}

TEST_F(ViewCommand, ends_while_a_mesh_is_still_built) {
  save_obj(torus(600, 300).mesh, folder_ / "large.obj");
  test::Process viewing(folder_.path(), test::kProgram, {"view", "large.obj", "--unit", "mm"});
  ASSERT_TRUE(test::await([&] { return viewing.catches(SIGINT); }));
  viewing.kill(SIGINT);
  EXPECT_EQ(viewing.wait().code, 130);
}

#endif

}  // namespace
}  // namespace gliss
