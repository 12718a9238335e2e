// The commands say where a surface curves tighter than a HIP is deep.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gliss/files/mesh_file.h"
#include "gliss/generate/generate.h"
#include "tests/support/gliss_process.h"
#include "tests/support/places.h"
#include "tests/support/scratch_folder.h"

namespace gliss {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr char kBelow[] = "of the faces have a radius of curvature below ";

class Curvature : public ::testing::Test {
 protected:
  // A ball of radius 10 mm, and a ring of 600 mm whose tube has a radius of 0.5 mm.
  Curvature() {
    save_obj(goldberg(2).mesh, folder_ / "ball.obj");
    save_obj(torus(40, 20, 300, 0.5).mesh, folder_ / "ring.obj");
    folder_.write("path.csv", "x_mm,y_mm,z_mm\n0,0,12\n0,0,9\n0,0,4\n0,0,0.5\n");
    folder_.write("scene.toml", "[[object]]\nmesh = 'ball.obj'\nunit = 'mm'\n");
  }

  std::string said_by(std::vector<std::string> words) const {
    const test::Outcome ran = test::Process(folder_ / "", test::kProgram, words).wait();
    EXPECT_EQ(ran.code, 0) << ran.err;
    return ran.err;
  }

  test::ScratchFolder folder_;
};

TEST_F(Curvature, is_said_where_it_is_tighter_than_the_depth_that_a_command_uses) {
  const auto all = [](const char* depth) {
    return HasSubstr(fmt::format("100 % {}{}: expect jumps there\n", kBelow, depth));
  };
  EXPECT_THAT(said_by({"sweep", "ball.obj", "--unit", "mm", "--depth", "2mm,20mm", "--rings", "1"}),
              all("20 mm"));
  EXPECT_THAT(said_by({"compare", "ball.obj", "--unit", "mm", "--depth", "20mm", "--levels", "flat",
                       "--precisions", "double", "--dense-limit", "0", "--ticks", "100"}),
              all("20 mm"));
  EXPECT_THAT(said_by({"trace", "ball.obj", "--unit", "mm", "--path", "path.csv", "-o", "t.csv"}),
              HasSubstr("mm (the deepest contact): expect jumps there\n"));
  EXPECT_THAT(said_by({"run", "scene.toml", "--device", "replay:path.csv", "--no-wait"}),
              HasSubstr("gliss: ball.obj: 100 % of the faces"));
  // The tube is thinner than half a percent of the ring.
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"check", "ring.obj", "--unit", "mm"},
        {"bake", "ring.obj", "--unit", "mm", "-o", "ring.gliss"}})
    EXPECT_THAT(said_by(words), HasSubstr("mm (0.5 % of the diagonal): expect jumps there\n"));
}

TEST_F(Curvature, is_not_said_where_it_is_no_tighter_or_nobody_listens) {
  const std::vector<std::string> sweep = {"sweep", "ball.obj", "--unit", "mm", "--rings", "1"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), sweep.begin(), sweep.end());
    return said_by(more);
  };
  EXPECT_THAT(with({"--depth", "1mm"}), Not(HasSubstr(kBelow)));
  EXPECT_THAT(with({"--depth", "20mm", "--method", "flat"}), Not(HasSubstr(kBelow)));
  EXPECT_EQ(with({"--depth", "20mm", "--quiet"}), "");
  EXPECT_THAT(said_by({"bake", "ball.obj", "--unit", "mm", "-o", "ball.gliss"}),
              Not(HasSubstr(kBelow)));
}

}  // namespace
}  // namespace gliss
