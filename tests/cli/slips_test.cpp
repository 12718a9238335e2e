// Likely slips: each ends in an error, or in a line on stderr, that names the cure.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>

#include "gliss/files/mesh_file.h"
#include "gliss/generate/generate.h"
#include "tests/support/gliss_process.h"
#include "tests/support/open_meshes.h"
#include "tests/support/run_files.h"
#include "tests/support/scratch_folder.h"

namespace gliss {
namespace {

using ::testing::AllOf, ::testing::EndsWith, ::testing::HasSubstr, ::testing::IsEmpty,
    ::testing::Not;

class Slips : public ::testing::Test {
 protected:
  Slips() {
    save_obj(torus(24, 12).mesh, folder_ / "torus.obj");  // 80 mm across
    folder_.write("touching.csv", "x_mm,y_mm,z_mm\n45,0,0\n38,0,0\n37,0,0\n");
    folder_.write("far.csv", "x,y,z\n45,0,0\n38,0,0\n37,0,0\n");
  }

  test::Outcome run(const std::string& words) const {
    std::vector<std::string> all = test::split(words, ' ');
    return test::Process(folder_ / "", test::kProgram, all).wait();
  }
  // The words on stderr of a command that ends well.
  std::string told(const std::string& words) const {
    const test::Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, 0) << words << '\n' << outcome.err;
    return outcome.err;
  }
  // The one line of a command that is refused.
  std::string refusal(const std::string& words, int code = 2) const {
    const test::Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, code) << words;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    return outcome.err;
  }

  test::ScratchFolder folder_;
};

TEST_F(Slips, an_option_that_there_is_not_comes_before_one_that_is_missing) {
  EXPECT_EQ(refusal("sweep torus.obj --deph 2mm -o a.h5"),
            "gliss: there is no option '--deph'; did you mean --depth?\n");
  EXPECT_EQ(refusal("sweep torus.obj --deph=2mm -o a.h5"),
            "gliss: there is no option '--deph'; did you mean --depth?\n");
  EXPECT_EQ(refusal("check torus.obj --unti mm"),
            "gliss: there is no option '--unti'; did you mean --unit?\n");
  EXPECT_EQ(refusal("sweep torus.obj --friction 0.3 --depth 2mm"),
            "gliss: there is no option '--friction'; gliss trace, gliss view have it\n");
  EXPECT_EQ(refusal("check torus.obj --frobnicate"), "gliss: there is no option '--frobnicate'\n");
  EXPECT_EQ(refusal("sweep torus.obj -o a.h5"), "gliss: --depth is required\n");
}

TEST_F(Slips, a_command_that_there_is_not_comes_before_its_options) {
  EXPECT_EQ(refusal("generate bunny -o b.obj"),
            "gliss: there is no command 'bunny'; gliss generate --help lists them\n");
  EXPECT_EQ(refusal("chek --unit mm"),
            "gliss: there is no command 'chek'; gliss --help lists them\n");
  EXPECT_EQ(refusal("generate"), "gliss: a command is wanted; gliss generate --help lists them\n");
}

TEST_F(Slips, the_list_of_commands_has_a_line_for_each) {
  const std::string help = run("--help").out;
  EXPECT_THAT(help, AllOf(HasSubstr("Measure what each level costs and gives, on this mesh and "
                                    "machine.\n"),
                          Not(HasSubstr("per 100,000 ticks"))));
  EXPECT_THAT(run("compare --help").out, HasSubstr("per 100,000 ticks"));
}

TEST_F(Slips, a_word_too_many_is_told_how_units_and_lists_are_written) {
  for (const char* words : {"trace torus.obj --depth 2 mm", "sweep torus.obj --depth 1mm 2mm",
                            "trace torus.obj --depth 2mm --stiffness 0.5 N/mm"})
    EXPECT_THAT(refusal(words), HasSubstr("mm' is a word too many; a number and its unit are one "
                                          "word, as 2mm, and a list has commas"));
  EXPECT_EQ(refusal("check torus.obj far.csv"),
            "gliss: 'far.csv' is a word too many; gliss check --help says which words it takes\n");
}

TEST_F(Slips, an_option_without_its_value_and_one_that_is_there_twice_are_named) {
  EXPECT_EQ(refusal("sweep torus.obj --depth"), "gliss: --depth wants a value behind it\n");
  EXPECT_EQ(refusal("info torus.obj --unit mm --unit cm"),
            "gliss: --unit is there more than once\n");
  EXPECT_THAT(refusal("bake torus.obj --unit mm -o b.gliss --region 0,0,0:1mm,1,1"),
              HasSubstr("--region, in the unit of --unit: '1mm' is not a number"));
  EXPECT_THAT(refusal("info torus.obj --crease 40"), HasSubstr("a bare number is radians"));
}

TEST_F(Slips, an_output_that_cannot_be_created_is_told_before_the_work) {
  // A mesh that is not there would be told of first.
  EXPECT_EQ(refusal("bake none.obj -o no/b.gliss", 1),
            "gliss: cannot create 'no/b.gliss': No such file or directory\n");
  EXPECT_EQ(refusal("generate knot -o knot.stl"), "gliss: 'knot.stl' must end in .obj\n");
}

TEST_F(Slips, a_mesh_a_cache_and_a_scene_are_not_taken_for_each_other) {
  told("bake torus.obj --unit mm -o torus.gliss");
  for (const std::string command : {"run ", "serve "}) {
    EXPECT_THAT(refusal(command + "torus.obj"),
                HasSubstr("torus.obj is a mesh: a scene is a text file, such as scene.toml, that "
                          "names it by mesh = \"torus.obj\"\n"));
    EXPECT_THAT(refusal(command + "torus.gliss"), HasSubstr("names it by cache = \"torus.gliss\""));
  }
  EXPECT_THAT(refusal("check torus.gliss"), HasSubstr("torus.gliss is a cache: name the mesh"));
  EXPECT_THAT(refusal("bake torus.gliss -o b.gliss"), HasSubstr("torus.gliss is a cache"));
}

TEST_F(Slips, what_a_download_left_in_place_of_a_mesh_is_told) {
  const auto refused = [&](const std::string& text) {
    folder_.write("down.obj", text);
    return refusal("info down.obj");
  };
  EXPECT_THAT(refused("version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n"),
              HasSubstr("'git lfs pull' fetches it"));
  EXPECT_THAT(refused("<!DOCTYPE html>\n<html></html>\n"), HasSubstr("is a web page"));
  EXPECT_THAT(refused("PK\x03\x04zip"), HasSubstr("is a zip archive; unpack it first"));
  EXPECT_THAT(refused("v 0 0 0\nv 1 0 0\n"),
              HasSubstr("there are 2 vertices and no faces: points alone have no surface"));
}

TEST_F(Slips, units_have_names_as_people_write_them) {
  for (const char* unit : {"mm", "millimetre", "millimeter"})
    EXPECT_THAT(told(fmt::format("check torus.obj --unit {}", unit)), Not(HasSubstr("across")));
  EXPECT_THAT(
      told("info torus.obj"),
      HasSubstr("torus.obj is 115 m across: '--unit mm' if its coordinates are millimetres"));
  EXPECT_THAT(told("info torus.obj --unit m"), Not(HasSubstr("across")));
  EXPECT_THAT(told("info torus.obj --unit nm"),
              HasSubstr("torus.obj is 0.115 um across: is '--unit nm' right?"));
  EXPECT_THAT(told("info torus.obj --quiet"), IsEmpty());
  folder_.write("metres.obj", "v 0 0 0\nv 0.08 0 0\nv 0 0.08 0\nf 1 2 3\n");
  EXPECT_THAT(told("info metres.obj --unit um"),
              HasSubstr("metres.obj is 0.113 um across: '--unit m' if its coordinates are metres"));
  EXPECT_THAT(run("info torus.obj --unit mm").out, HasSubstr(" mm, 114.9 mm across\n"));
}

TEST_F(Slips, a_scene_that_does_not_name_a_unit_hears_of_an_odd_size) {
  folder_.write("metres.toml", "[[object]]\nmesh = \"torus.obj\"\n");
  EXPECT_THAT(told("run metres.toml --device replay:far.csv --no-wait"),
              HasSubstr("torus.obj is 115 m across: 'unit = \"mm\"' if its coordinates are "
                        "millimetres\n"));
  folder_.write("meant.toml", "[[object]]\nmesh = \"torus.obj\"\nunit = \"m\"\n");
  EXPECT_THAT(told("run meant.toml --device replay:far.csv --no-wait"), Not(HasSubstr("across")));
}

TEST_F(Slips, depths_beyond_the_mesh_are_refused_and_beyond_its_thickness_said) {
  EXPECT_THAT(refusal("sweep torus.obj --unit mm --depth 2 -o a.csv --samples 500"),
              AllOf(HasSubstr("a depth of 2 m is more than the 115 mm that the surface is across"),
                    HasSubstr("'2mm' is two millimetres")));
  const std::string sweep = "sweep torus.obj --unit mm -o a.csv --samples 500 --depth ";
  EXPECT_THAT(told(sweep + "90mm"), HasSubstr("at 90 mm only 0 % of the HIPs feel a force"));
  EXPECT_THAT(told(sweep + "2mm"), Not(HasSubstr("feel a force")));
}

TEST_F(Slips, springs_that_no_hand_feels_are_said) {
  const std::string trace = "trace torus.obj --unit mm --path touching.csv -o t.csv --stiffness ";
  EXPECT_THAT(told(trace + "0.5"), HasSubstr("--stiffness: 0.5 N/m gives 0.0005 N a millimetre"));
  EXPECT_THAT(told(trace + "0.5N/mm"), Not(HasSubstr("no hand feels")));
  folder_.write("soft.toml",
                "[[object]]\nmesh = \"torus.obj\"\nunit = \"mm\"\nstiffness = \"0.5\"\n");
  EXPECT_THAT(told("run soft.toml --device replay:touching.csv --no-wait"),
              HasSubstr("torus.obj: 0.5 N/m gives"));
}

TEST_F(Slips, paths_that_never_touch_say_how_far_off_they_are) {
  const std::string trace = "trace torus.obj --unit mm -o t.csv --path ";
  EXPECT_THAT(told(trace + "touching.csv"), Not(HasSubstr("touches")));
  EXPECT_THAT(told("trace torus.obj --unit m -o t.csv --path touching.csv"),
              HasSubstr("touching.csv: no HIP touches the surface"));
  folder_.write("scene.toml", "[[object]]\nmesh = \"torus.obj\"\nunit = \"mm\"\n");
  const std::string replayed = told("run scene.toml --device replay:far.csv --no-wait");
  EXPECT_THAT(replayed,
              AllOf(HasSubstr("far.csv: no HIP touches the surface, and none comes nearer "
                              "to its box than 37 m"),
                    HasSubstr("if its numbers are millimetres, name the columns "
                              "x_mm,y_mm,z_mm")));
  EXPECT_THAT(told("run scene.toml --device replay:touching.csv --no-wait"),
              Not(HasSubstr("no HIP touches")));
}

TEST_F(Slips, hips_that_are_farther_off_than_the_mesh_is_across_are_told) {
  folder_.write("hips.csv", "x,y,z\n90,0,0\n");
  const std::string project = "project torus.obj --hip hips.csv -o near.csv --unit ";
  EXPECT_THAT(told(project + "mm"), IsEmpty());
  folder_.write("hips.csv", "x_mm,y_mm,z_mm\n0.09,0,300\n");
  EXPECT_THAT(told(project + "mm"), HasSubstr("none comes nearer to its box than 29"));
}

TEST_F(Slips, a_simulated_hand_says_how_far_off_it_was_and_that_it_began_inside) {
  const std::string object = "[[object]]\nmesh = \"torus.obj\"\nunit = \"mm\"\n[sim]\nwaypoints = ";
  folder_.write("far.toml", object + "[[45, 0, 0], [38, 0, 0]]\nspeed = 1e3\n");
  EXPECT_THAT(told("run far.toml --no-wait"),
              AllOf(HasSubstr("far.toml: no HIP touches the surface, and none comes nearer to its "
                              "box than 38 m"),
                    HasSubstr("if its numbers are millimetres, write \"40mm\" for 40\n")));
  folder_.write("inside.toml", object + "[[\"38mm\", 0, 0], [\"37mm\", 0, 0]]\n");
  EXPECT_THAT(told("run inside.toml --no-wait"),
              HasSubstr("the hand begins inside an object: until it has been outside, the force is "
                        "at most 0.2 N\n"));
}

TEST_F(Slips, a_simulated_hand_that_damps_less_than_a_stiff_wall_asks_for_is_told) {
  const auto scene = [&](const char* stiffness, const char* delay, int rate) {
    folder_.write(
        "stiff.toml",
        fmt::format("[[object]]\nmesh = \"torus.obj\"\nunit = \"mm\"\nstiffness = "
                    "\"{}N/mm\"\n[loop]\nrate = {}\n[sim]\ndelay = \"{}ms\"\nhand_damping = 4\n"
                    "waypoints = [[\"45mm\", 0, 0], [\"38mm\", 0, 0]]\n",
                    stiffness, rate, delay));
    return told("run stiff.toml --no-wait");
  };
  EXPECT_THAT(
      scene("2", "2", 1000),
      HasSubstr("object '1': 2000 N/m at 1000 ticks a second, with 2 ms of delay, ask for 5 "
                "N s/m of damping, and the hand has 4: it will swing; cure: "));
  EXPECT_THAT(scene("1.5", "2", 1000), Not(HasSubstr("it will swing")));
  EXPECT_THAT(scene("2", "0", 1000), Not(HasSubstr("it will swing")));
  EXPECT_THAT(scene("2", "1", 300), HasSubstr("it will swing"));
}

TEST_F(Slips, a_file_that_is_named_as_a_cache_and_is_none_ends_with_code_3) {
  folder_.write("x.gliss", "hello\n");
  EXPECT_THAT(refusal("info x.gliss", 3), HasSubstr("x.gliss: not a gliss cache"));
}

TEST_F(Slips, a_mesh_that_was_edited_after_its_cache_was_baked_is_said) {
  namespace fs = std::filesystem;
  told("bake torus.obj --unit mm -o torus.gliss");
  EXPECT_THAT(told("info torus.gliss"), IsEmpty());
  const auto later = fs::last_write_time(folder_ / "torus.gliss") + std::chrono::seconds(5);
  fs::last_write_time(folder_ / "torus.obj", later);
  EXPECT_THAT(told("info torus.gliss"), IsEmpty());  // written anew, but the same
  save_obj(torus(24, 10).mesh, folder_ / "torus.obj");
  fs::last_write_time(folder_ / "torus.obj", later);
  EXPECT_THAT(told("info torus.gliss"),
              HasSubstr("torus.obj has changed since torus.gliss was baked"));
}

TEST_F(Slips, seams_whose_vertices_are_a_little_apart_are_said_with_the_length_that_closes_them) {
  // Each face has vertices of its own, off by up to 1e-5 mm.
  const Mesh whole = torus(24, 12).mesh;
  Mesh loose;
  for (std::size_t face = 0; face < whole.face_count(); ++face) {
    for (std::uint32_t c = whole.face_begin[face]; c < whole.face_begin[face + 1]; ++c) {
      const double off = 1e-5 * std::sin(static_cast<double>(c));
      loose.corner_vertex.push_back(static_cast<std::uint32_t>(loose.positions.size()));
      loose.positions.push_back(whole.positions[whole.corner_vertex[c]] + Vec3(off, 0, -off));
    }
    loose.face_begin.push_back(static_cast<std::uint32_t>(loose.corner_vertex.size()));
  }
  save_obj(loose, folder_ / "loose.obj");
  const std::string words = told("info loose.obj --unit mm");
  EXPECT_THAT(words, HasSubstr("vertices at borders are within 11.5 um of others: '--weld "
                               "0.011mm' makes them one\n"));
  EXPECT_THAT(told("check loose.obj --unit mm"), HasSubstr("--weld"));
  EXPECT_THAT(told("info loose.obj --unit mm --weld 0.011mm"), Not(HasSubstr("--weld")));
  EXPECT_THAT(told("info loose.obj --unit mm --weld none"), Not(HasSubstr("--weld")));
  EXPECT_THAT(run("info loose.obj --unit mm --weld 0.011mm").out, HasSubstr("border sides 0,"));
  save_obj(test::open_strip(40), folder_ / "open.obj");
  EXPECT_THAT(told("info open.obj --unit mm"), Not(HasSubstr("--weld")));
}

TEST_F(Slips, numbers_with_commas_and_headers_that_are_none_are_told_the_rule) {
  folder_.write("comma.obj", "v 0,5 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_THAT(refusal("info comma.obj"),
              HasSubstr("comma.obj:1: coordinate '0,5' is not a number: decimals follow a point"));
  const auto refused = [&](const std::string& text) {
    folder_.write("hips.csv", text);
    return refusal("project torus.obj --unit mm --hip hips.csv");
  };
  EXPECT_THAT(refused("x;y;z\n1;2;3\n"),
              HasSubstr("the header has x;y;z: commas part the columns, and decimals follow a "
                        "point\n"));
  EXPECT_THAT(refused("x y z\n1 2 3\n"), HasSubstr(": commas part the columns"));
  EXPECT_THAT(refused("1,2,3\n"), HasSubstr("1,2,3: the first line names the columns\n"));
  EXPECT_THAT(refused("a,b\n1,2\n"), EndsWith("the header has a,b\n"));
}

// README and docs/cli.md promise these of all commands.
TEST_F(Slips, every_command_has_the_options_that_all_share_and_no_device_that_it_does_not_use) {
  const std::set<std::string> computing{"bake", "check",   "compare", "eval", "generate knot",
                                        "info", "project", "sweep",   "trace"};
  for (const std::string command :
       {"bake", "check", "compare", "devices", "eval", "generate knot", "info", "judge", "project",
        "report", "run", "serve", "sweep", "trace"}) {
    SCOPED_TRACE(command);
    const std::string help = run(command + " --help").out;
    EXPECT_THAT(help,
                AllOf(HasSubstr("--json "), HasSubstr("--quiet "), HasSubstr("Example: gliss ")));
    EXPECT_EQ(help.find("--threads ") != help.npos,
              computing.contains(command) || command == "run");
    EXPECT_EQ(help.find("--opencl-device ") != help.npos, computing.contains(command));
  }
}

TEST_F(Slips, an_opencl_device_without_its_backend_is_refused) {
  EXPECT_THAT(refusal("info torus.obj --unit mm --opencl-device 0"),
              HasSubstr("--opencl-device and --device-memory ask for --backend opencl"));
}

}  // namespace
}  // namespace gliss
