// Files that cannot be read, or are not what they were: errors that name them, and nothing worse.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "gliss/tables/csv_reader.h"
#include "tests/support/scene_files.h"

namespace gliss {
namespace {

using test::message_of;
using test::SceneFiles;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(SceneFile, names_the_path_file_and_its_line) {
  const SceneFiles files;
  const auto error_of = [&](const std::string& csv) {
    files.folder.write("path.csv", csv);
    return message_of<CsvError>([&] { files.read("[sim]\npath = 'path.csv'\n"); });
  };
  EXPECT_THAT(error_of("x,y,z\n0,0,0\n0,nan,0\n"), HasSubstr("path.csv:3: column 'y'"));
  EXPECT_THAT(error_of("x,y,z\n0,0,0\n\"inf\",0,0\n"), HasSubstr("path.csv:3: column 'x'"));
  EXPECT_THAT(error_of("x,y\n0,0\n"), HasSubstr("path.csv:1: missing columns"));
  EXPECT_THAT(error_of(""), HasSubstr("path.csv:"));
  EXPECT_THAT(error_of("x,y,z\n0,0\n"), HasSubstr("path.csv:2:"));
  // A path without a point is none, and is named where it is asked for.
  files.folder.write("path.csv", "x,y,z\n");
  EXPECT_THAT(files.error_of("[sim]\npath = 'path.csv'\n"), StartsWith("scene.toml:2: sim.path: "));
  EXPECT_THAT(files.error_of("[sim]\npath = 'none.csv'\n"),
              AllOf(StartsWith("scene.toml:2: sim.path: "), HasSubstr("none.csv")));
  files.folder.write("path.h5", "no HDF5");
  EXPECT_THAT(files.error_of("[sim]\npath = 'path.h5'\n"),
              AllOf(StartsWith("scene.toml:2: sim.path: "), HasSubstr("path.h5")));
}

TEST(SceneFile, names_a_scene_that_cannot_be_read) {
  const SceneFiles files;
  for (const std::string& path : {files.folder / "none.toml", files.folder / "",
                                  files.folder / "ball.obj/scene.toml", std::string()}) {
    EXPECT_THAT(message_of<SceneError>([&] { read_scene(path); }),
                StartsWith(path + ": cannot be read"));
  }
}

constexpr char kValid[] = R"([[object]]
name = "ball"
mesh = "ball.obj"
unit = "mm"
stiffness = "0.7N/mm"
method = 'flat'
position = ["1mm", 0.2, 0]
rotation = {axis = [0, 0, 1], degrees = 90}
[loop]
rate = 1000
[guards]
ramp_to = "9ms"
reengage = true
[device]
hips = [[0, 0, 0], [0, 0, 1e-3]]
workspace = {min = [-1, -1, -1], max = [1, 1, 1]}
[sim]
path = "path.csv"
interval = '2ms'
rounds = 2 # times
)";

// Any single byte lost, doubled or another: a scene all the same, or an error that names the file.
TEST(SceneFile, is_all_that_a_broken_byte_can_lead_to) {
  const SceneFiles files;
  files.read(kValid);
  const std::string valid = kValid, path = files.folder / "scene.toml";
  int read = 0, refused = 0;
  const auto try_out = [&](const std::string& text) {
    files.folder.write("scene.toml", text);
    try {
      read_scene(path);
      ++read;
    } catch (const SceneError& error) {
      EXPECT_THAT(error.what(), StartsWith(path + ":")) << text;
      EXPECT_THAT(error.what(), ::testing::Not(HasSubstr("\n"))) << text;
      ++refused;
    } catch (const CsvError& error) {
      EXPECT_THAT(error.what(), StartsWith(files.folder / "")) << text;
      ++refused;
    }
  };
  for (std::size_t i = 0; i < valid.size(); ++i) {
    std::string text = valid;
    try_out(text.erase(i, 1));
    text = valid;
    try_out(text.insert(i, 1, valid[i]));
    for (const char other : {'\0', '\n', '\xFF', '"', '[', '=', '-', '9', ' ', 'e', '/', '.'}) {
      text = valid;
      text[i] = other;
      try_out(text);
    }
  }
  EXPECT_GT(read, 500);
  EXPECT_GT(refused, 1000);
}

}  // namespace
}  // namespace gliss
