// The program and files that mean ill: it says so in a line, keeps what it reads, and gives a
// terminal no commands of theirs.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <filesystem>

#include "gliss/tables/result_table.h"
#include "tests/support/reserved_file.h"
#include "tests/support/run_files.h"

namespace gliss {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class HostileProgram : public test::RunTest {
 protected:
  HostileProgram() {
    folder_.write("path.csv", "x_mm,y_mm,z_mm\n0,0,11\n0,0,9\n0,0,8\n");
    EXPECT_EQ(gliss("bake ball.obj --unit mm -o ball.gliss --quiet").code, 0);
  }
};

TEST_F(HostileProgram, refuses_pipes_and_devices_as_inputs) {
  for (const char* name : {"p.obj", "p.csv", "p.h5", "p.toml"})
    ASSERT_EQ(mkfifo((folder_ / name).c_str(), 0600), 0);
  fs::create_symlink("/dev/zero", folder_ / "zero.obj");
  for (const char* words :
       {"info p.obj", "bake p.obj -o a.gliss", "trace ball.gliss --path p.csv",
        "trace ball.gliss --path p.h5", "project ball.gliss --hip p.csv", "run p.toml --device sim",
        "eval ball.gliss --at p.csv", "compare ball.obj --unit mm --path p.csv --depth 1mm",
        "run scene.toml --device replay:p.csv", "run scene.toml --device replay:p.h5"}) {
    expect_error(gliss(words), 2, "it is a pipe, and only regular files are read");
  }
  expect_error(gliss("info zero.obj"), 2, "zero.obj: cannot be read: it is a device");
  expect_error(gliss("info -"), 2, "standard input is not read");
  expect_error(gliss("trace ball.gliss --path -"), 2, "standard input is not read");
}

// A file that takes long is stopped by Ctrl-C: one that is all lines, and one that is all numbers,
// which takes half a minute to read. A busy machine is given five seconds; half a second of
// processor time is held by HostileFiles.that_are_large_are_stopped_in_the_middle.
TEST_F(HostileProgram, stops_reading_at_once) {
  folder_.write("lines.obj", "v 0 0 0\n");
  std::string block;
  while (block.size() < (1u << 20)) block += "v 0.125 0.25 0.5\n";
  std::ofstream lines(folder_ / "lines.obj", std::ios::binary | std::ios::app);
  for (int i = 0; i < 256; ++i) lines << block;
  lines.close();
  std::ofstream(folder_ / "numbers.ply", std::ios::binary)
      << "ply\nformat binary_little_endian 1.0\nelement vertex 300000000\nproperty uchar x\n"
         "property uchar y\nproperty uchar z\nend_header\n";
  if (!test::reserve(folder_ / "numbers.ply", 1'000'000'000))
    GTEST_SKIP() << "no place for a gigabyte";
  for (const char* name : {"lines.obj", "numbers.ply"}) {
    const auto program = start("info", name);
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    const auto asked = std::chrono::steady_clock::now();
    program->kill(SIGINT);
    EXPECT_EQ(program->wait().code, 130) << name;
    EXPECT_LE(std::chrono::steady_clock::now() - asked, std::chrono::seconds(5)) << name;
    EXPECT_THAT(program->err(), HasSubstr("interrupted"));
  }
}

TEST_F(HostileProgram, writes_no_output_over_an_input) {
  fs::create_hard_link(folder_ / "path.csv", folder_ / "hard.csv");
  fs::create_symlink("path.csv", folder_ / "soft.csv");
  fs::copy_file(folder_ / "path.csv", folder_ / "hips.csv");
  fs::copy_file(folder_ / "ball.obj", folder_ / "ball.h5");
  const std::string path = folder_.read("path.csv"), scene = folder_.read("scene.toml");
  for (const char* words : {"bake ball.obj -o ball.obj", "bake ball.obj -o ./ball.obj",
                            "trace ball.gliss --path path.csv -o path.csv",
                            "trace ball.gliss --path path.csv -o hard.csv",
                            "trace ball.gliss --path soft.csv -o path.csv",
                            "project ball.gliss --hip path.csv -o soft.csv",
                            "eval ball.gliss --at path.csv -o path.csv",
                            "sweep ball.obj --depth 1mm --summary ball.obj",
                            "sweep ball.obj --depth 1mm -o ball.csv --summary ball.obj",
                            "compare ball.obj --path path.csv --depth 1mm -o path.csv",
                            "run scene.toml --no-wait --seconds 0.1 --summary scene.toml",
                            "run scene.toml --no-wait --seconds 0.1 -o hand.csv",
                            "run scene.toml --no-wait --seconds 0.1 --summary ball.obj",
                            "run scene.toml --device replay:path.csv --no-wait -o path.csv"}) {
    SCOPED_TRACE(words);
    expect_error(gliss(words), 2, "is read, and would be lost where it is written as well");
  }
  EXPECT_EQ(folder_.read("path.csv"), path);
  EXPECT_EQ(folder_.read("scene.toml"), scene);
  expect_error(gliss("run scene.toml --no-wait --seconds 0.1 -o a.csv --summary ./a.csv"), 2,
               "'./a.csv' would be written twice");
  EXPECT_FALSE(fs::exists(folder_ / "ball.csv"));
}

TEST_F(HostileProgram, writes_no_cache_under_the_name_of_a_mesh) {
  folder_.write("other.obj", "v 0 0 0\n");
  for (const std::string name : {"other.obj", "none.OFF", "none.ply"}) {
    expect_error(gliss("bake ball.obj -o " + name), 2,
                 "'" + name + "' has the ending of a mesh, and bake writes a cache");
  }
  EXPECT_EQ(folder_.read("other.obj"), "v 0 0 0\n");
  EXPECT_FALSE(fs::exists(folder_ / "none.OFF") || fs::exists(folder_ / "none.ply"));
}

TEST_F(HostileProgram, takes_names_as_long_as_they_may_be) {
  const std::string name(252, 'n');
  const auto quiet = [&](const std::string& words) {
    const Outcome outcome = gliss(words + " --quiet");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
  };
  quiet("bake ball.obj -o " + name.substr(3) + ".gliss");
  quiet("sweep ball.gliss --depth 1mm --rings 2 -o " + name + ".h5 --vtp " + name.substr(1) +
        ".vtp");
  quiet("run scene.toml --device sim --no-wait --seconds 0.1 -o " + name + ".h5");
  std::size_t left = 0;
  for (const auto& file : fs::directory_iterator(folder_ / ""))
    left += file.path().string().find(".gliss-tmp") != std::string::npos || file.is_directory();
  EXPECT_EQ(left, 0u);
}

TEST_F(HostileProgram, keeps_the_folder_for_parts_that_was_there) {
  fs::create_directory(folder_ / "mine");
  EXPECT_EQ(gliss("sweep ball.gliss --depth 1mm --rings 2 --parts mine --summary a.json").code, 0);
  EXPECT_TRUE(fs::is_empty(folder_ / "mine"));
  EXPECT_EQ(gliss("sweep ball.gliss --depth 1mm --rings 2 --parts ours --summary a.json").code, 0);
  EXPECT_FALSE(fs::exists(folder_ / "ours"));
}

TEST_F(HostileProgram, says_nothing_that_commands_a_terminal) {
  const auto no_control = [](const Outcome& outcome) {
    const std::string said = outcome.out + outcome.err;
    for (std::size_t i = 0; i < said.size(); ++i) {
      const auto c = static_cast<unsigned char>(said[i]);
      const bool is_c1 = c >= 0x80 && c < 0xa0 && i > 0 && said[i - 1] == '\xc2';
      EXPECT_TRUE(c == '\n' || (c >= ' ' && c != 0x7f && !is_c1)) << said;
    }
  };
  folder_.write("esc.csv",
                "x,\x1b[31my\xc2\x9b"
                "2J,\xff,\xc3\xa9\n1,2,3,4\n");
  const Outcome csv = gliss("trace ball.gliss --path esc.csv");
  expect_error(csv, 2, "the header has x,\\x1b[31my\\xc2\\x9b2J,\\xff,\xc3\xa9\n");
  EXPECT_THAT(csv.err, Not(HasSubstr("\x1b")));

  write_scene("\"\\u001b[2J\" = 1");
  const Outcome scene = gliss("run scene.toml --device sim");
  expect_error(scene, 2, "\\x1b[2J");
  no_control(scene);
  folder_.write("scene.toml", "[[object]]\nname = 'ball'\nmesh = \"\\u001b]0;x\\u0007.obj\"\n");
  const Outcome mesh = gliss("run scene.toml --device sim");
  expect_error(mesh, 2, "\\x1b]0;x\\x07.obj");
  no_control(mesh);

  folder_.write("esc.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n\x1b[1m 3\nf 1 2 3\nf 1 2 \x1b[31m\n");
  no_control(gliss("check esc.obj"));
  // A name of a file in a table, and in JSON, which allows U+007F to U+009F.
  const std::string name =
      "\x1b[5m\x7f\xc2\x9b"
      "1m\xc3\xa9.obj";
  fs::copy_file(folder_ / "ball.obj", folder_ / name);
  no_control(gliss("check " + name));
  const Outcome json = gliss("check " + name + " --json");
  no_control(json);
  EXPECT_THAT(json.out, HasSubstr("\\u001b[5m\\u007f\\u009b1m\xc3\xa9.obj"));
  EXPECT_EQ(nlohmann::json::parse(json.out)["mesh"], name);
  no_control(gliss("trace ball.gliss --path path.csv -o \xc2\x9b.csv --json"));
}

#ifdef GLISS_WITH_REPORT
TEST_F(HostileProgram, names_what_a_result_lacks) {
  const auto keep_only = [&](const std::string& name, const std::string& group,
                             const std::vector<std::string>& columns) {
    const auto file = create_result_file(folder_ / name);
    Columns made;
    for (const std::string& column : columns) made.add({column.c_str()});
    ResultTable table(*file, group, made);
    for (std::size_t i = 0; i < columns.size(); ++i) table.fill(3, [](std::size_t) { return 1.0; });
    table.write();
    file->close();
    return gliss("report " + name + " -o a.html");
  };
  expect_error(keep_only("r.h5", "ticks", {"x", "y", "z"}), 2,
               "column 'ticks/time': it is not there");
  expect_error(keep_only("s.h5", "statistics", {"depth"}), 2,
               "column 'statistics/method': it is not there");
  expect_error(keep_only("t.h5", "", {"step", "x", "y", "z", "fx", "fy", "fz", "patch"}), 2,
               "column 'method': it is not there");
  expect_error(keep_only("u.h5", "", {"x"}), 2, "HDF5 without 'statistics', 'ticks'");
  ASSERT_EQ(mkfifo((folder_ / "p.json").c_str(), 0600), 0);
  expect_error(gliss("report p.json -o a.html"), 2, "it is a pipe");
  EXPECT_EQ(gliss("run scene.toml --device sim --no-wait --seconds 0.1 --summary run.html").code,
            0);
  expect_error(gliss("report run.html -o run.html"), 2, "is read, and would be lost");
}
#endif

TEST_F(HostileProgram, names_caches_that_do_not_fit_into_memory_and_their_size) {
  folder_.write("large.gliss", "GLISS");
  std::error_code too_large;  // for this file system
  std::filesystem::resize_file(folder_ / "large.gliss", std::uint64_t{12} << 40, too_large);
  if (too_large) GTEST_SKIP() << too_large.message();
  const Outcome outcome = gliss("info large.gliss");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err,
              HasSubstr("gliss: large.gliss: a cache of 1.23e+04 GiB does not fit into"));
}

}  // namespace
}  // namespace gliss
