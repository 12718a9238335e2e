// Holds that gliss reads and writes the same bytes where the user's numbers have a comma.
#include <gmock/gmock.h>

#include "gliss/files/mesh_file.h"
#include "gliss/generate/generate.h"
#include "tests/support/german_locale.h"
#include "tests/support/places.h"
#include "tests/support/require.h"

namespace gliss {
namespace {

using ::testing::HasSubstr;

class LocaleTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!german_.made()) GLISS_SKIP_UNLESS_REQUIRED(test::GermanLocale::kAbsent);
    ASSERT_THAT(run("locale", {"-k", "decimal_point"}, true).out, HasSubstr("\",\""));
    save_obj(goldberg(2).mesh, folder_ / "ball.obj");
    folder_.write("tent.off",
                  "OFF\n5 5 0\n0 0 0\n1.5 0 0\n1.5 1.5 0\n0 1.5 0\n0.75 0.75 1.125e0\n"
                  "4 3 2 1 0\n3 0 1 4\n3 1 2 4\n3 2 3 4\n3 3 0 4\n");
    folder_.write("tent.ply",
                  "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\n"
                  "property double z\nelement face 4\nproperty list uchar int vertex_indices\n"
                  "end_header\n0 0 0\n1.5 0 0\n0 1.5 0\n0 0 1.125\n3 2 1 0\n3 0 1 3\n3 1 2 3\n"
                  "3 2 0 3\n");
    folder_.write("hips.csv", "x,y,z\n0.25,0.125,0.0625\n0.5,0.375,-1.5\n9.25,-0.5,1234.5\n");
    folder_.write("points.csv", "patch,xi,eta\n0,0.25,-0.125\n1,1.5e-1,0\n");
  }

  test::Outcome run(const std::string& program, const std::vector<std::string>& words,
                    bool german) const {
    const auto environment = [&] {
      return german ? german_.set_environment() : setenv("LC_ALL", "C", 1) == 0;
    };
    return test::Process(folder_ / "", program, words, environment).wait();
  }
  void expect_same(const std::vector<std::string>& words, const std::string& file = "") const {
    SCOPED_TRACE(::testing::PrintToString(words));
    std::string text[2];
    for (const bool german : {false, true}) {
      const test::Outcome outcome = run(test::kProgram, words, german);
      EXPECT_EQ(outcome.code, 0) << outcome.err;
      text[german] = outcome.out + outcome.err + (file.empty() ? "" : folder_.read(file));
    }
    EXPECT_THAT(text[0], HasSubstr("."));
    EXPECT_EQ(text[0], text[1]);
  }

  const test::GermanLocale german_{};
  const test::ScratchFolder folder_;
};

TEST_F(LocaleTest, gliss_reads_and_writes_the_same_where_numbers_have_a_comma) {
  for (const std::string mesh : {"ball.obj", "tent.off", "tent.ply"}) {
    expect_same({"check", mesh, "--json"});
    expect_same({"info", mesh, "--unit", "mm"});
    expect_same({"info", mesh, "--unit", "mm", "--json"});
    expect_same({"bake", mesh, "--quiet", "-o", "baked.gliss"}, "baked.gliss");
    expect_same({"eval", mesh, "--at", "points.csv"});
    expect_same({"project", mesh, "--hip", "hips.csv", "--tolerance", "0.5e-9", "--quiet"});
    expect_same({"trace", mesh, "--path", "hips.csv", "--stiffness", "0.5N/mm", "--unit", "mm"});
  }
  expect_same({"generate", "knot", "--tube", "7.5", "--quiet", "-o", "knot.obj"}, "knot.obj");
  expect_same({"sweep", "ball.obj", "--unit", "mm", "--depth", "0.25mm,1.5e-3", "--samples",
               "1.5e3", "--quiet", "--parts", "none", "-o", "forces.csv"},
              "forces.csv");
}

TEST_F(LocaleTest, gliss_refuses_numbers_with_a_comma) {
  folder_.write("comma.obj", "v 0 0 0\nv 1,5 0 0\nv 0 1 0\nf 1 2 3\n");
  for (const bool german : {false, true}) {
    const test::Outcome outcome = run(test::kProgram, {"check", "comma.obj"}, german);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("comma.obj:2"));
    EXPECT_EQ(run(test::kProgram, {"info", "ball.obj", "--depth", "1,5mm"}, german).code, 2);
  }
}

}  // namespace
}  // namespace gliss
