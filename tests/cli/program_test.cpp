// The program as outsiders see it: columns, units, exit codes, errors, interruption.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>

#include "gliss/build/build_cache.h"
#include "gliss/files/mesh_file.h"
#include "gliss/generate/generate.h"
#include "gliss/query/query.h"
#include "gliss/sweep/sweep.h"
#include "gliss/tables/csv_reader.h"
#include "tests/support/gliss_process.h"
#include "tests/support/part_files.h"
#include "tests/support/places.h"
#include "tests/support/require.h"
#include "tests/support/scratch_folder.h"

namespace gliss {
namespace {

using test::ScratchFolder;
using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::StartsWith;

constexpr char kEvalHeader[] =
    "face,xi,eta,x,y,z,dxi_x,dxi_y,dxi_z,deta_x,deta_y,deta_z,nx,ny,nz,patch";
constexpr char kProjectHeader[] = "face,xi,eta,x,y,z,nx,ny,nz,distance,iterations,flags,patch";
constexpr char kTraceHeader[] = "step,method,x,y,z,scp_x,scp_y,scp_z,fx,fy,fz,face,state,patch";

class Program : public ::testing::Test {
 protected:
  Program() {
    save_obj(knot_, folder_ / "knot.obj");
    folder_.write("points.csv", "face,xi,eta\n0,1,0\n3,0.1,-0.25\n77,0,0\n143,-0.3,0.2\n");
    // From above the surface to 4.5 mm beneath it, below the base polygons too, and on along it.
    const Generated tube = torus_knot(24, 6);
    std::string hips = "x_mm,y_mm,z_mm\n";
    for (int i = 0; i < 60; ++i) {
      const ExactSurface::Point p = tube.exact->nearest(knot_.positions[0] + Vec3(0, 0.1 * i, 0));
      const Vec3 hip = p.position - std::min(4.5, 0.2 * (i - 10)) * p.normal;
      hips += fmt::format("{},{},{}\n", hip.x(), hip.y(), hip.z());
    }
    folder_.write("hips.csv", hips);
  }

  test::Outcome run(const std::string& words) const {
    const std::string command = fmt::format("cd '{}' && '{}' {} >out 2>err </dev/null",
                                            folder_ / "", test::kProgram, words);
    const int status = std::system(command.c_str());
    test::Outcome outcome{WIFEXITED(status) ? WEXITSTATUS(status) : -1, folder_.read("out"),
                          folder_.read("err")};
    std::filesystem::remove(folder_ / "out");
    std::filesystem::remove(folder_ / "err");
    return outcome;
  }

  // Standard output of a run that must succeed.
  std::string output_of(const std::string& words) const {
    const test::Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, 0) << words << ": " << outcome.err;
    return outcome.out;
  }

  nlohmann::json json_of(const std::string& words) const {
    const std::string text = output_of(words + " --json");
    const auto json = nlohmann::json::parse(text, nullptr, false);
    EXPECT_FALSE(json.is_discarded()) << words << ": " << text;
    return json;
  }

  // ball.obj, and round.csv: a HIP that goes in and then `ticks` on beneath the surface.
  void write_ball_and_round(int ticks) {
    output_of("generate goldberg --frequency 2 -o ball.obj");
    std::string hips = "x_mm,y_mm,z_mm\n";
    for (int i = 0; i < 50; ++i) hips += fmt::format("{},0,0\n", 12 - 0.1 * i);
    for (int i = 0; i < ticks; ++i)
      hips += fmt::format("{},{},0\n", 7 * std::cos(0.002 * i), 7 * std::sin(0.002 * i));
    folder_.write("round.csv", hips);
  }

  const Mesh knot_ = torus_knot(24, 6).mesh;
  const ScratchFolder folder_;
};

std::vector<std::string> words_of(const std::string& text, char separator) {
  std::vector<std::string> words;
  std::istringstream stream(text);
  for (std::string word; std::getline(stream, word, separator);) words.push_back(word);
  return words;
}

// [row][column], without the header.
std::vector<std::vector<double>> numbers_of(const std::string& csv) {
  std::vector<std::vector<double>> rows;
  for (const std::string& line : words_of(csv, '\n')) {
    rows.emplace_back();
    for (const std::string& word : words_of(line, ',')) {
      double value = std::nan("");
      std::from_chars(word.data(), word.data() + word.size(), value);
      rows.back().push_back(value);
    }
  }
  if (!rows.empty()) rows.erase(rows.begin());
  return rows;
}

std::string header_of(const std::string& csv) { return csv.substr(0, csv.find('\n')); }

TEST_F(Program, EveryCommandHelpsWithAnExample) {
  EXPECT_THAT(output_of("--version"), MatchesRegex("gliss [0-9]+\\.[0-9]+\\.[0-9]+\n"));
  for (const char* command : {"bake", "info", "check", "eval", "project", "sweep", "trace",
                              "generate", "generate knot", "generate fin", "judge", "report"}) {
    const std::string help = output_of(fmt::format("{} --help", command));
    EXPECT_THAT(help, HasSubstr(fmt::format("Example: gliss {}", command)));
  }
}

TEST_F(Program, EvalWritesWhatTheLibraryFinds) {
  output_of("eval knot.obj --at points.csv --unit mm -o eval.csv");
  const std::string csv = folder_.read("eval.csv");
  EXPECT_EQ(header_of(csv), kEvalHeader);
  EXPECT_EQ(output_of("eval knot.obj --at points.csv --unit mm"), csv);
  const auto rows = numbers_of(csv);
  ASSERT_EQ(rows.size(), 4u);
  const PatchCache cache = build_cache(load_mesh(folder_ / "knot.obj", {.unit = 1e-3}));
  for (const auto& row : rows) {
    ASSERT_EQ(row.size(), 16u);
    const SurfacePoint p = evaluate(cache, {static_cast<std::uint32_t>(row[0]), row[1], row[2]});
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int i = static_cast<int>(axis);
      EXPECT_EQ(row[3 + axis], p.position[i]);
      EXPECT_EQ(row[6 + axis], p.d_xi[i]);
      EXPECT_EQ(row[9 + axis], p.d_eta[i]);
      EXPECT_EQ(row[12 + axis], p.normal[i]);
    }
  }
  const Vec3 corner(rows[0][3], rows[0][4], rows[0][5]);
  EXPECT_LT((corner - knot_.positions[knot_.corner_vertex[0]]).norm(), 1e-12);
}

// HDF5 goes round: eval's points are project's HIPs, in the unit that they name.
TEST_F(Program, ReadsTheTablesThatItWrites) {
  output_of("eval knot.obj --at points.csv --unit mm -o points.h5");
  output_of("eval knot.obj --at points.h5 --unit mm -o again.h5");
  EXPECT_EQ(output_of("eval knot.obj --at again.h5 --unit mm"),
            output_of("eval knot.obj --at points.csv --unit mm"));
  const auto points = numbers_of(output_of("eval knot.obj --at points.csv --unit mm"));
  const auto feet = numbers_of(output_of("project knot.obj --hip points.h5 --unit mm"));
  ASSERT_EQ(feet.size(), points.size());
  for (std::size_t i = 0; i < feet.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(feet[i][3 + axis], points[i][3 + axis], 1e-9);
  }
  EXPECT_THAT(run("eval knot.obj --at points.h5 --unit mm -o points.h5").err,
              HasSubstr("points.h5"));
}

TEST_F(Program, ProjectWritesItsColumns) {
  output_of("project knot.obj --hip hips.csv --unit mm -o project.csv");
  const std::string csv = folder_.read("project.csv");
  EXPECT_EQ(header_of(csv), kProjectHeader);
  const auto rows = numbers_of(csv);
  ASSERT_EQ(rows.size(), 60u);
  EXPECT_GT(rows.front()[9], 0);
  EXPECT_LT(rows.back()[9], 0);
  const auto hips = numbers_of(folder_.read("hips.csv"));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Vec3 scp(rows[i][3], rows[i][4], rows[i][5]), normal(rows[i][6], rows[i][7], rows[i][8]);
    const Vec3 hip(hips[i][0], hips[i][1], hips[i][2]);
    EXPECT_LT((scp + rows[i][9] * normal - hip).norm(), 1e-7) << i;
    EXPECT_EQ(static_cast<std::uint32_t>(rows[i][11]) & kConverged, kConverged) << i;
  }
  for (const char* options : {"--solver gauss-newton", "--solver paper", "--method shaded",
                              "--method flat", "--precision float", "--backend serial"}) {
    const std::string other =
        output_of(fmt::format("project knot.obj --hip hips.csv --unit mm {}", options));
    EXPECT_EQ(header_of(other), kProjectHeader);
    EXPECT_NEAR(numbers_of(other).back()[9], rows.back()[9], 3) << options;
  }
}

TEST_F(Program, TraceWritesItsColumns) {
  const std::string table =
      output_of("trace knot.obj --path hips.csv --unit mm --stiffness 0.5N/mm -o trace.csv");
  EXPECT_THAT(table, AllOf(HasSubstr("gregory"), HasSubstr("shaded"), HasSubstr("flat")));
  const std::string csv = folder_.read("trace.csv");
  EXPECT_EQ(header_of(csv), kTraceHeader);
  const auto lines = words_of(csv, '\n');
  ASSERT_EQ(lines.size(), 1u + 3 * 60);
  EXPECT_THAT(lines[1], AllOf(StartsWith("0,gregory,"), HasSubstr(",free,")));
  EXPECT_THAT(lines[180], AllOf(StartsWith("59,flat,"), HasSubstr(",contact,")));
  // The HIP is echoed, and pushed out by half a newton a millimetre.
  const auto hips = numbers_of(folder_.read("hips.csv"));
  const auto rows = numbers_of(csv);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Vec3 hip(rows[i][2], rows[i][3], rows[i][4]), scp(rows[i][5], rows[i][6], rows[i][7]),
        force(rows[i][8], rows[i][9], rows[i][10]);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(hip[axis], hips[i / 3][static_cast<std::size_t>(axis)]);
    }
    const bool touching = words_of(lines[i + 1], ',')[12] == "contact";
    EXPECT_NEAR(force.norm(), touching ? 0.5 * (scp - hip).norm() : 0, 1e-9);
  }
}

TEST_F(Program, TraceKeepsTheStepsOfTheFile) {
  folder_.write("path.csv", "z,step,x,y\n0,99999,0,0\n0,100000,0,0\n0,1e6,1,0\n");
  const std::string csv = output_of("trace knot.obj --path path.csv --method flat");
  EXPECT_THAT(csv, AllOf(HasSubstr("\n99999,flat,0,0,0,"), HasSubstr("\n100000,flat,0,0,0,"),
                         HasSubstr("\n1000000,flat,1,0,0,")));
}

TEST_F(Program, ContactsSettleWhereTheyAreToldTo) {
  write_ball_and_round(2000);
  const auto felt = [&](const char* settle) {
    return json_of(
        fmt::format("trace ball.obj --unit mm --path round.csv --method flat "
                    "--stiffness 0.1N/mm --settle {} -o felt.csv",
                    settle))["methods"][0];
  };
  const auto leaping = felt("0"), settling = felt("5ms");
  EXPECT_GT(leaping["jumps_per_100k"], 100);
  EXPECT_EQ(leaping["settling"], 0);
  EXPECT_EQ(settling["jumps_per_100k"], 0);
  EXPECT_GT(settling["settling"], 0);
  folder_.write("scene.toml",
                "[[object]]\nmesh = 'ball.obj'\nunit = 'mm'\nmethod = 'flat'\n"
                "stiffness = '0.1N/mm'\nsettle = '5ms'\n");
  const auto rendered = json_of("run scene.toml --device replay:round.csv --no-wait");
  EXPECT_EQ(rendered["settling"], settling["settling"]);
  EXPECT_EQ(rendered["largest_force_step"], settling["largest_step_N"]);
  const auto rows = json_of(
      "compare ball.obj --unit mm --levels exact,flat --precisions double --dense-limit 0 "
      "--ticks 100 --walks 2 --settle 5ms")["rows"];
  EXPECT_EQ(rows[0]["settling_share"], 0);
  EXPECT_GT(rows[1]["settling_share"], 0);
  const test::Outcome slip = run("trace ball.obj --path round.csv --settle 5");
  EXPECT_EQ(slip.code, 2);
  EXPECT_THAT(slip.err, HasSubstr("--settle: '5' is not from 0 to 1 s; 5ms is usual"));
}

TEST_F(Program, ContactsRubWhereTheyAreToldTo) {
  write_ball_and_round(1000);
  const std::string trace = "trace ball.obj --unit mm --path round.csv --stiffness 0.1N/mm ";
  const std::string plain = output_of(trace), none = output_of(trace + "--friction 0");
  EXPECT_EQ(none, plain);
  const std::string rubbed = output_of(trace + "--friction 0.5,0.3 --friction-settle 2ms");
  EXPECT_THAT(rubbed, AllOf(HasSubstr(",state,cone_share,grip,patch\n"), HasSubstr(",free,0,free,"),
                            HasSubstr(",stick,"), HasSubstr(",slip,")));
  const auto felt = json_of(trace + "--friction 0.5,0.3 -o felt.csv")["methods"][0];
  EXPECT_GT(felt["slipping"], 300);
  EXPECT_LT(felt["net_work_J"], 0);
  folder_.write("scene.toml",
                "[[object]]\nmesh = 'ball.obj'\nunit = 'mm'\nstiffness = '0.1N/mm'\n"
                "friction = {static = 0.5, dynamic = 0.3}\n");
  const auto rendered = json_of("run scene.toml --device replay:round.csv --no-wait");
  EXPECT_EQ(rendered["largest_force_step"], felt["largest_step_N"]);
  for (const char* bad : {"-1", "6", "nan", "0.3,0.4", "0.3,0.2,0.1", "inf", "much", "0.3,"}) {
    const test::Outcome slip = run(trace + "--friction " + bad);
    EXPECT_EQ(slip.code, 2) << bad;
    EXPECT_THAT(slip.err, HasSubstr("--friction: '")) << bad;
  }
  EXPECT_THAT(run(trace + "--friction 1 --friction-settle 2").err,
              HasSubstr("--friction-settle: '2' is not from 0 to 1 s; 2ms is usual"));
  EXPECT_THAT(run(trace + "--friction-settle 2ms").err,
              HasSubstr("--friction-settle goes with --friction"));
}

TEST_F(Program, ContactsHaveTheEffectsThatTheyAreToldTo) {
  write_ball_and_round(1000);
  const std::string trace = "trace ball.obj --unit mm --path round.csv --stiffness 0.1N/mm ";
  const std::string plain = output_of(trace);
  EXPECT_EQ(output_of(trace + "--damping 0 --viscosity 0"), plain);
  for (const char* effect : {"--damping 2s/m", "--viscosity '1 N s/m'", "--magnet 0.1N,2mm",
                             "--texture grating,50um,2mm,0,1,0", "--texture noise,50um,2mm"})
    EXPECT_NE(output_of(trace + effect), plain) << effect;
  const auto felt = json_of(trace + "--damping 2 --texture noise,50um,2mm -o felt.csv")["methods"];
  folder_.write("scene.toml",
                "[[object]]\nmesh = 'ball.obj'\nunit = 'mm'\nstiffness = '0.1N/mm'\ndamping = 2\n"
                "texture = {kind = 'noise', height = '50um', period = '2mm'}\n");
  const auto rendered = json_of("run scene.toml --device replay:round.csv --no-wait");
  EXPECT_EQ(rendered["largest_force_step"], felt[0]["largest_step_N"]);
  for (const char* bad : {"--damping -1", "--damping 30", "--viscosity nan", "--magnet 1N",
                          "--magnet 1N,0", "--magnet -1N,1mm", "--texture bumps,1um,1mm",
                          "--texture grating,1mm,1mm", "--texture grating,1um,1mm,1"}) {
    const test::Outcome slip = run(trace + bad);
    EXPECT_EQ(slip.code, 2) << bad;
    const std::string words = bad;
    EXPECT_THAT(slip.err, HasSubstr(words.substr(2, words.find(' ') - 2))) << bad;
  }
}

// A hand that rests and an object that goes the other way are a hand that goes and an object at
// rest.
TEST_F(Program, ObjectsOfScenesMove) {
  write_ball_and_round(1000);
  const std::string object = "[[object]]\nmesh = 'ball.obj'\nunit = 'mm'\nstiffness = '0.1N/mm'\n";
  std::string hand = "x,y,z\n", still = "x,y,z\n";
  for (int i = 0; i < 400; ++i) {
    hand += fmt::format("0,0,{}\n", 0.012 - 1e-5 * (i + 1));
    still += "0,0,0.012\n";
  }
  folder_.write("hand.csv", hand);
  folder_.write("still.csv", still);
  folder_.write("poses.csv", "t,x,y,z\n0,0,0,0\n0.4,0,0,0.004\n");
  folder_.write("rest.toml", object);
  folder_.write("rise.toml", object + "motion = {path = 'poses.csv'}\n");
  const auto rest = json_of("run rest.toml --device replay:hand.csv --no-wait"),
             rise = json_of("run rise.toml --device replay:still.csv --no-wait");
  const double step = rest["largest_force_step"];
  EXPECT_GT(step, 1e-4);
  EXPECT_NEAR(static_cast<double>(rise["largest_force_step"]), step, 1e-9);
}

// A tool of a mesh's points, turned by the simulated hand; its recording replays it.
TEST_F(Program, ToolsOfScenesTurn) {
  write_ball_and_round(1000);
  const std::string scene =
      "[[object]]\nmesh = 'ball.obj'\nunit = 'mm'\nstiffness = '0.1N/mm'\n"
      "[device]\ntool = {mesh = 'ball.obj', unit = '0.2mm', points = 40}\n"
      "[sim]\nwaypoints = [[0, 0.001, '14mm'], [0, 0.001, '11mm']]\nspeed = 0.005\n"
      "turning = {axis = [1, 0, 0], degrees = 90}\n";
  folder_.write("scene.toml", scene);
  const auto felt = json_of("run scene.toml --device sim --no-wait --record turned.h5");
  EXPECT_GT(felt["largest_torque_Nm"], 1e-6);
  const auto again = json_of("run scene.toml --device replay:turned.h5 --no-wait");
  EXPECT_EQ(again["largest_force_step"], felt["largest_force_step"]);
  // The ticks in which the simulation's force faded are rendered in full.
  EXPECT_GE(again["largest_torque_Nm"], felt["largest_torque_Nm"]);
  output_of("run scene.toml --device sim --no-wait --record turned.csv");
  EXPECT_THAT(folder_.read("turned.csv"),
              HasSubstr(",flags,qw,qx,qy,qz,tx,ty,tz,sent_tx,sent_ty,sent_tz,patch\n"));
  const auto csv = json_of("run scene.toml --device replay:turned.csv --no-wait");
  EXPECT_EQ(csv["largest_torque_Nm"], again["largest_torque_Nm"]);
  folder_.write("long.csv", "x,y,z,qw,qx,qy,qz\n0,0,0,2,0,0,0\n");
  EXPECT_THAT(run("run scene.toml --device replay:long.csv --no-wait").err,
              HasSubstr("long.csv:2: qw, qx, qy and qz have the length 2, and a rotation has 1"));
  folder_.write("half.csv", "x,y,z,qw,qx\n0,0,0,1,0\n");
  EXPECT_THAT(run("run scene.toml --device replay:half.csv --no-wait").err,
              HasSubstr("half.csv:2: a rotation has qw, qx, qy and qz"));
}

TEST_F(Program, CoordinatesAreInTheUnitAskedFor) {
  output_of("bake knot.obj --unit mm -o knot.gliss");
  const auto mm = numbers_of(output_of("eval knot.gliss --at points.csv --unit mm"));
  const auto m = numbers_of(output_of("eval knot.gliss --at points.csv"));
  ASSERT_EQ(m.size(), mm.size());
  for (std::size_t row = 0; row < m.size(); ++row) {
    for (std::size_t c = 0; c < 15; ++c) {
      EXPECT_EQ(m[row][c], c >= 3 && c < 12 ? mm[row][c] / 1000 : mm[row][c]);
    }
  }
  // Millimetres in the header are millimetres, whatever the unit of the answer.
  std::string metres = folder_.read("hips.csv");
  metres.replace(0, metres.find('\n'), "x,y,z");
  folder_.write("plain.csv", metres);
  EXPECT_EQ(output_of("project knot.gliss --hip plain.csv --unit mm"),
            output_of("project knot.gliss --hip hips.csv --unit mm"));
  const auto in_m = numbers_of(output_of("project knot.gliss --hip hips.csv"));
  const auto in_mm = numbers_of(output_of("project knot.gliss --hip hips.csv --unit mm"));
  EXPECT_EQ(in_m[50][9], in_mm[50][9] / 1000);
  EXPECT_EQ(in_m[50][0], in_mm[50][0]);
}

TEST_F(Program, ACacheGivesTheBitsOfItsMesh) {
  for (const char* precision : {"double", "float"}) {
    output_of(fmt::format("bake knot.obj --unit mm --precision {} -o knot.gliss", precision));
    for (const char* command :
         {"eval {} --at points.csv", "project {} --hip hips.csv", "trace {} --path hips.csv",
          "sweep {} --depth 2mm --rings 2 -o -"}) {
      const std::string options = fmt::format(" --unit mm --precision {}", precision);
      EXPECT_EQ(output_of(fmt::format(fmt::runtime(command), "knot.gliss") + options),
                output_of(fmt::format(fmt::runtime(command), "knot.obj") + options))
          << command;
    }
  }
}

TEST_F(Program, ARegionHoldsItsFacesOnly) {
  EXPECT_EQ(json_of("bake knot.obj --faces 0,2-5,3 -o part.gliss")["faces"], 5);
  EXPECT_EQ(json_of("info part.gliss")["faces"], 5);
  const test::Outcome outside = run("eval part.gliss --at points.csv");
  EXPECT_EQ(outside.code, 2);
  EXPECT_EQ(outside.err, "gliss: points.csv:4: face 77 is not in this cache of a region\n");
  EXPECT_GT(json_of("bake knot.obj --region 0,-99,-99:99,99,99 -o half.gliss")["faces"], 10);
}

TEST_F(Program, SaysInOneLineWhatIsWrong) {
  output_of("bake knot.obj -o knot.gliss");
  folder_.write("cut.gliss", folder_.read("knot.gliss").substr(0, 1000));
  folder_.write("outside.csv", "patch,xi,eta\n0,0,0\n0,1,1\n");
  folder_.write("unknown.csv", "face,xi,eta\n0,0,0\n\n");
  folder_.write("fraction.csv", "face,xi,eta\n0.5,0,0\n");
  folder_.write("beyond.csv", "face,xi,eta\n144,0,0\n");
  folder_.write("far.csv", "x,y,z\n0,0,0\n1e300,0,0\n");
  folder_.write("word.csv", "patch,xi,eta\n0,zero,0\n");
  folder_.write("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
  const struct {
    std::string words, message;
    int code;
  } kCases[] = {
      {"", "a command is wanted", 2},
      {"fly", "there is no command 'fly'", 2},
      {"eval knot.obj", "--at is required", 2},
      {"eval knot.obj --at none.csv", "none.csv", 2},
      {"eval none.obj --at points.csv", "none.obj", 2},
      {"eval knot.obj --at outside.csv", "outside.csv:3: (1, 1) is outside", 2},
      {"eval knot.obj --at fraction.csv", "fraction.csv:2: there is no face 0.5", 2},
      {"eval knot.obj --at beyond.csv", "beyond.csv:2: there is no face 144", 2},
      {"eval knot.obj --at word.csv", "word.csv:2: column 'xi'", 2},
      {"project knot.obj --hip far.csv", "far.csv:3: 1e+300 is beyond 1e+60", 2},
      {"eval knot.obj --at hips.csv", "missing columns: wanted face,xi,eta or patch,xi,eta", 2},
      {"eval knot.obj --at points.csv -o x.txt", "must end in", 2},
      {"eval knot.obj --at points.csv --unit furlong", "furlong", 2},
      {"eval knot.obj --at points.csv --threads many", "--threads: 'many'", 2},
      {"eval knot.obj --at points.csv --backend opencl --opencl-device none", "opencl: no ", 4},
      {"eval knot.gliss --at points.csv --precision float", "--precision float", 3},
      {"info cut.gliss", "cut.gliss", 3},
      {"info none.gliss", "there is no file 'none.gliss'", 2},
      {"trace none/x.gliss --depth 1mm", "there is no file 'none/x.gliss'", 2},
      {"compare knot.obj/x.gliss", "there is no file 'knot.obj/x.gliss'", 2},
      {"info bad.obj", "bad.obj:4: face 0", 2},
      {"bake knot.obj -o x.gliss --faces 9-144", "--faces: 144 is beyond", 2},
      {"bake knot.obj -o x.gliss --faces 5-2", "'5-2'", 2},
      {"bake knot.obj -o x.gliss --region 1,2", "--region", 2},
      {"bake knot.obj -o x.gliss --region 90,0,0:91,1,1", "no face meets", 2},
      {"bake knot.obj -o x.gliss --crease 200deg", "'200deg'", 2},
      {"bake knot.obj -o x.gliss --crease seams", "'seams'", 2},
      {"bake knot.obj -o x.gliss --crease groups", "names no smoothing groups", 2},
      {"bake knot.obj -o x.gliss --crease edges:points.csv", "points.csv:1: an edge is two", 2},
      {"info knot.gliss --crease 40deg", "--crease is for meshes", 2},
      {"info knot.gliss --crease-radius 1mm", "--crease-radius is for meshes", 2},
      {"bake knot.obj -o x.gliss --crease-radius 1mm", "as '--crease auto'", 2},
      {"check knot.obj --crease-radius 1mm", "as '--crease auto'", 2},
      {"bake knot.obj -o x.gliss --crease 9deg --crease-radius 0mm", "must be positive", 2},
      {"bake knot.obj -o x.gliss --crease 9deg --crease-radius 1deg", "'1deg'", 2},
      {"bake knot.obj -o x.gliss --unit mm --crease 9deg --crease-radius 1m", "no room", 2},
      {"bake knot.obj -o none/x.gliss", "none/x.gliss", 1},
      {"sweep knot.obj", "--depth is required", 2},
      {"sweep knot.obj --depth 2mm,2e-3", "twice", 2},
      {"sweep knot.obj --depth 0mm", "not positive", 2},
      {"sweep knot.obj --depth 2mm --vtp x.txt", "must end in .vtp", 2},
      {"sweep knot.obj --depth 2kg", "kg", 2},
      {"sweep knot.obj --depth 2mm --method round", "not one of gregory, shaded, flat", 2},
      {"sweep knot.obj --depth 2mm --rings 2 --samples 9", "--samples excludes --rings", 2},
      {"trace knot.obj --path hips.csv --stiffness 0", "--stiffness", 2},
      {"generate", "a command is wanted", 2},
      {"generate prism --sides 2 -o x.obj", "sides", 2},
      {"generate knot --tube thick -o x.obj", "--tube: 'thick'", 2},
  };
  const std::size_t files = folder_.file_count();
  for (const auto& [words, message, code] : kCases) {
    // The unit that is meant, lest a mesh of 169 m be a line of its own.
    const bool needs_unit =
        words.find(" knot.obj") != words.npos && words.find("--unit") == words.npos;
    const test::Outcome outcome = run(words + (needs_unit ? " --unit m" : ""));
    EXPECT_EQ(outcome.code, code) << words;
    EXPECT_EQ(outcome.out, "") << words;
    EXPECT_THAT(outcome.err, AllOf(StartsWith("gliss: "), HasSubstr(message), EndsWith("\n")));
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }
  EXPECT_EQ(folder_.file_count(), files);
}

TEST_F(Program, FiguresComeAsJson) {
  EXPECT_EQ(json_of("generate goldberg --frequency 2 -o ball.obj")["faces"], 42);
  EXPECT_EQ(json_of("bake ball.obj --unit mm -o ball.gliss")["patches"], 42);
  const auto info = json_of("info ball.gliss --unit mm");
  EXPECT_EQ(info["valences"]["5"], 12);
  EXPECT_EQ(info["valences"]["6"], 30);
  EXPECT_EQ(info["vertices"], 80);
  EXPECT_EQ(info["edges"], 120);
  EXPECT_EQ(info["border_sides"], 0);
  EXPECT_EQ(info["parts"], 1);
  EXPECT_EQ(info["folded_faces"], 0);
  EXPECT_EQ(json_of("info ball.obj --unit mm")["mesh_hash"], info["mesh_hash"]);
  EXPECT_TRUE(json_of("check ball.obj")["findings"].empty());
  EXPECT_EQ(json_of("trace ball.gliss --path hips.csv -o t.csv")["methods"].size(), 3u);
  EXPECT_EQ(json_of("project ball.gliss --hip hips.csv -o p.csv")["hips"], 60);
  const auto sweep = json_of("sweep ball.gliss --depth 1mm,2mm --samples 1000 --summary sum.json");
  EXPECT_GE(sweep["samples_per_depth"], 1000);
  ASSERT_EQ(sweep["statistics"].size(), 6u);
  EXPECT_LT(sweep["statistics"][0]["error_N"]["max"], 1e-6);
  EXPECT_EQ(nlohmann::json::parse(folder_.read("sum.json"))["statistics"], sweep["statistics"]);
}

TEST_F(Program, CheckListsAllFindingsAndRefuses) {
  folder_.write("bad.obj",
                "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 0 -1\nf 1 2 3\nf 1 2 4\nf 1 2 5\n");
  const test::Outcome text = run("check bad.obj --strict"),
                      json = run("check bad.obj --strict --json");
  EXPECT_EQ(text.code, 2);
  EXPECT_THAT(text.out, AllOf(HasSubstr("error"), HasSubstr("non-manifold-edge")));
  EXPECT_THAT(text.err, StartsWith("gliss: bad.obj:6: face 0"));
  EXPECT_EQ(json.code, 2);
  const auto found = nlohmann::json::parse(json.out);
  EXPECT_EQ(found["accepted"], false);
  EXPECT_EQ(found["findings"][0]["code"], "non-manifold-edge");
  EXPECT_EQ(found["findings"][0]["severity"], "error");
  EXPECT_EQ(run("check bad.obj --keep-non-manifold").code, 2);
}

TEST_F(Program, MeshesAreMendedAndEveryCommandSaysSoInOneLine) {
  folder_.write("bad.obj",
                "v 0 0 0\nv 2 0 0\nv 1 0 0\nv 1 2 1\nv 0 -1 0\nv 2 -1 0\nv 9 9 9\n"
                "f 1 2\nf 1 2 4\nf 2 1 3\nf 1 5 3\nf 3 6 2\nf 4 7 1\n");
  const auto found = nlohmann::json::parse(run("check bad.obj --json").out);
  EXPECT_EQ(found["state"], "repaired");
  EXPECT_EQ(found["removed_faces"], nlohmann::json({0, 2}));
  EXPECT_THAT(run("check bad.obj").out,
              HasSubstr("removed faces 0,2, those behind have moved up\n"));
  const std::string line =
      "gliss: bad.obj: repaired: too-few-vertices 1, zero-area-face 1; removed faces 0,2, those "
      "behind have moved up; 'gliss check' says where\n";
  EXPECT_THAT(run("bake bad.obj -o bad.gliss").err, HasSubstr(line));
  EXPECT_THAT(run("sweep bad.obj --depth 1mm -o bad.h5").err, HasSubstr(line));
  EXPECT_EQ(run("bake bad.obj -o bad.gliss --strict").code, 2);
  EXPECT_EQ(run("bake bad.obj -o bad.gliss --weld 1").code, 0);
  EXPECT_THAT(run("bake bad.obj -o bad.gliss --weld -1").err, HasSubstr("'none' welds nothing"));
}

TEST_F(Program, ForcesAndColumnsComeWithNearestPoints) {
  folder_.write("some.csv", "time,x_mm,y_mm,z_mm,id\n0.5,60,0,0,7\n0.25,58,1,0,9\n");
  const std::string words = "project knot.obj --unit mm --hip some.csv ";
  EXPECT_EQ(header_of(output_of(words + "--stiffness 0.5N/mm --keep id,time")),
            "face,xi,eta,x,y,z,nx,ny,nz,distance,iterations,flags,fx,fy,fz,id,time,patch");
  EXPECT_EQ(header_of(output_of(words)), kProjectHeader);
  EXPECT_THAT(run(words + "--keep name").err, HasSubstr("--keep: some.csv has no column 'name'"));
  // Through NumPy's format and back they are the same doubles.
  output_of("project knot.obj --unit mm --hip some.csv --keep id -o near.npy");
  output_of("project knot.obj --unit mm --hip some.csv --keep id -o near.csv");
  for (const char* file : {"near.npy", "near.csv"}) {
    const InputTable table =
        read_table(folder_ / file, {.alternatives = {{"x", "distance"}}, .optional = {"id"}});
    EXPECT_EQ(table.rows, 2u);
    EXPECT_EQ((*table.find("id"))[1], 9);
    EXPECT_EQ(*table.find("distance"),
              *read_table(folder_ / "near.csv", {.alternatives = {{"distance"}}}).find("distance"));
  }
  EXPECT_EQ(json_of("eval knot.obj --unit mm --at points.csv -o points.npy")["points"], 4);
}

TEST_F(Program, TablesOfOneCommandAreAnothersInput) {
  folder_.write("hand.csv", "x_mm,y_mm,z_mm\n60,0,0\n58,1,0\n50,10,2\n");
  folder_.write("scene.toml", "[[object]]\nmesh = \"knot.obj\"\nunit = \"mm\"\n");
  output_of("run scene.toml --device replay:hand.csv --no-wait --record hand.h5");
  for (const std::string hips : {"hand.csv", "hand.h5"}) {
    EXPECT_EQ(json_of("project knot.obj --unit mm --json -o n.csv --hip " + hips)["hips"], 3);
    output_of("trace knot.obj --unit mm -o t.csv --path " + hips);
    EXPECT_EQ(read_table(folder_ / "t.csv", {.alternatives = {{"step"}}}).rows, 9u) << hips;
  }
  for (const std::string near : {"near.csv", "near.h5", "near.npy"}) {
    output_of("project knot.obj --unit mm --hip hand.csv -o " + near);
    output_of("project knot.obj --unit mm -o again.csv --hip " + near);
    const InputTable again = read_table(folder_ / "again.csv", {.alternatives = {{"distance"}}});
    for (const double distance : *again.find("distance")) EXPECT_LT(std::abs(distance), 1e-9);
    EXPECT_EQ(json_of("eval knot.obj --unit mm -o points.csv --at " + near)["points"], 3) << near;
  }
}

TEST_F(Program, CreasesAreListedAndKept) {
  output_of("generate cube -o cube.obj");
  folder_.write("edges.txt", "0 1\n");
  const auto found = json_of("check cube.obj --unit mm --crease normals");
  EXPECT_EQ(found["creases"].size(), 12u);
  EXPECT_EQ(found["state"], "accepted") << found;  // creases explain its normals
  EXPECT_EQ(found["creases"][0], (std::vector<int>{0, 1}));
  const auto dart = json_of("check cube.obj --unit mm --crease edges:edges.txt --normals file");
  EXPECT_EQ(dart["creases"].size(), 1u);
  EXPECT_EQ(dart["findings"][0]["code"], "sharp-normals");
  EXPECT_EQ(dart["findings"][0]["count"], 8);
  const auto rough = json_of("check cube.obj --unit mm --normals file --crease none");
  EXPECT_TRUE(rough["creases"].empty());
  EXPECT_EQ(rough["rough_edges"].size(), 12u);  // the file's normals differ across all
  const auto smooth = json_of("check cube.obj --unit mm");
  EXPECT_EQ(smooth["findings"][0]["code"], "facet-normals");
  EXPECT_TRUE(smooth["rough_edges"].empty());
  EXPECT_TRUE(found["rough_edges"].empty());
  EXPECT_TRUE(dart["rough_edges"].empty());  // beside creases vertices that none cuts have one
  for (const char* construction : {"paper", "fair"}) {
    const std::string baked =
        fmt::format("bake cube.obj --unit mm --construction {} ", construction);
    EXPECT_EQ(json_of(baked + "--crease 40deg -o sharp.gliss")["creases"], 12);
    EXPECT_EQ(json_of(baked + "--crease none -o plain.gliss")["creases"], 0);
    EXPECT_EQ(json_of(baked + "-o usual.gliss")["creases"], 12);
    EXPECT_EQ(json_of("info sharp.gliss")["creases"], 12);
    EXPECT_NE(folder_.read("sharp.gliss"), folder_.read("plain.gliss"));
    // A mesh and its cache give one trace.
    const std::string path = " --path hips.csv --unit mm";
    EXPECT_EQ(output_of("trace sharp.gliss" + path),
              output_of(fmt::format("trace cube.obj --crease 40deg --construction {}{}",
                                    construction, path)));
    // Rules that find no crease change nothing.
    output_of(baked + "--crease 120deg -o none.gliss");
    EXPECT_EQ(folder_.read("none.gliss"), folder_.read("plain.gliss"));
  }
  const auto rows = json_of(
      "compare cube.obj --unit mm --crease normals --levels exact,bezier,fair,shaded --walks 2 "
      "--ticks 100 --dense-limit 0")["rows"];
  ASSERT_FALSE(rows.empty());
  for (const auto& row : rows) EXPECT_LT(row["max_distance"], 1e-8) << row["level"];
}

TEST_F(Program, TracesAPathOfItsOwn) {
  output_of("bake knot.obj --unit mm -o knot.gliss");
  const auto mesh = json_of("trace knot.obj --depth 0.5mm --unit mm -o own.csv"),
             cache = json_of("trace knot.gliss --depth 0.5mm --unit mm -o again.csv");
  EXPECT_EQ(cache, mesh);
  EXPECT_EQ(folder_.read("own.csv"), folder_.read("again.csv"));
  EXPECT_EQ(mesh["methods"][0]["ticks"], 4000);
  EXPECT_EQ(mesh["methods"][0]["in_contact"], 4000);
  EXPECT_NEAR(mesh["methods"][0]["largest_force_N"].get<double>(), 0.25, 0.01);
  // Its HIPs can be traced again.
  output_of("project knot.gliss --hip own.csv --unit mm");
  for (const auto& [slip, line] :
       {std::pair("trace knot.obj", "--path is required, or --depth for a path of its own"),
        std::pair("trace knot.obj --depth 1mm,2mm", "--depth: a path has one")}) {
    const test::Outcome outcome = run(slip);
    EXPECT_EQ(outcome.code, 2) << slip;
    EXPECT_THAT(outcome.err, HasSubstr(line));
  }
}

TEST_F(Program, ComparesTheMeshOfACache) {
  output_of("bake knot.obj --unit mm -o knot.gliss");
  output_of("generate cylinder -o can.obj");
  output_of("bake can.obj --unit mm --crease 40deg -o can.gliss");
  const std::string options = " --levels exact,flat --walks 2 --ticks 100 --dense-limit 0";
  for (const std::string name : {"knot", "can"}) {
    const auto of_mesh = json_of("compare " + name + ".obj --unit mm" + options),
               of_cache = json_of("compare " + name + ".gliss" + options);
    EXPECT_EQ(of_cache["faces"], of_mesh["faces"]);
    ASSERT_EQ(of_cache["rows"].size(), of_mesh["rows"].size());
    for (std::size_t i = 0; i < of_mesh["rows"].size(); ++i) {
      const auto &row = of_cache["rows"][i], &same = of_mesh["rows"][i];
      EXPECT_EQ(row["level"], same["level"]);
      EXPECT_NEAR(row["max_force_step"].get<double>(), same["max_force_step"].get<double>(), 1e-5);
    }
  }
}

TEST_F(Program, CreasesAreRounded) {
  output_of("generate cube -o cube.obj");
  const std::string rounded = "cube.obj --unit mm --crease normals --crease-radius 1mm";
  const auto found = json_of("check " + rounded);
  EXPECT_EQ(found["state"], "accepted") << found;
  EXPECT_EQ(found["faces"], 6 + 24 + 24);
  EXPECT_EQ(found["creases"].size(), 12u);
  EXPECT_EQ(found["strips"].size(), 24u);
  EXPECT_EQ(found["strips"][1], (std::vector<int>{0, 1}));
  EXPECT_EQ(found["rounded_corners"].size(), 24u);
  EXPECT_THAT(output_of("check " + rounded),
              HasSubstr("12 creases are rounded: faces 6 to 29 are their strips, 30 to 53 their "
                        "corners"));
  const auto baked = json_of("bake " + rounded + " -o round.gliss");
  EXPECT_EQ(baked["creases"], 0);
  EXPECT_EQ(baked["strips"], 24);
  EXPECT_EQ(baked["rounded_corners"], 24);
  // The radius is 1 mm, less what patches of 45 degrees miss.
  EXPECT_GT(baked["rho_min"], 0.65);
  EXPECT_EQ(json_of("info round.gliss")["mesh_faces"], 54);
  EXPECT_EQ(output_of("trace round.gliss --path hips.csv --unit mm"),
            output_of("trace " + rounded + " --path hips.csv"));
  const test::Outcome refused =
      run("bake cube.obj --unit mm --crease 40deg --crease-radius 6mm -o x.gliss");
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("face 0: no room for creases of radius 6 mm beside it; the "
                                     "largest that fits is 4.95 mm"));
  // Rules that find no crease leave nothing to round.
  output_of("bake cube.obj --unit mm --crease 120deg --crease-radius 1mm -o none.gliss");
  output_of("bake cube.obj --unit mm --crease none -o plain.gliss");
  EXPECT_EQ(folder_.read("none.gliss"), folder_.read("plain.gliss"));
  const auto rows =
      json_of("compare " + rounded +
              " --levels exact,fair,shaded --walks 2 --ticks 100 --dense-limit 0")["rows"];
  EXPECT_FALSE(rows.empty());
}

TEST_F(Program, AnyNumberOfThreadsSweepsTheSame) {
  const std::string words = "sweep knot.obj --unit mm --depth 2mm,4mm --rings 9 -o -";
  const std::string one = output_of(words + " --threads 1");
  EXPECT_EQ(output_of(words + " --threads 3"), one);
  EXPECT_EQ(output_of(words + " --backend serial"), one);
  EXPECT_EQ(header_of(one),
            "depth,method,face,xi,eta,hip_x,hip_y,hip_z,scp_x,scp_y,scp_z,fx,fy,fz,"
            "residual_angle,iterations,crossings,flags,patch");
}

TEST_F(Program, PythonReadsTheSweep) {
  if (std::system("/usr/bin/python3 -c 'import h5py' >/dev/null 2>&1") != 0)
    GLISS_SKIP_UNLESS_REQUIRED("h5py is absent");
  output_of("sweep knot.obj --unit mm --depth 2mm,4.5mm --rings 3 -o s.h5 --vtp s.vtp");
  EXPECT_THAT(folder_.read("s.vtp"), HasSubstr("\"force_shaded\""));
  EXPECT_THAT(folder_.read("s_mesh.vtp"), HasSubstr("\"rho_min\""));
  folder_.write("read.py", R"(import h5py, numpy
f = h5py.File('s.h5')
text = lambda v: v.decode() if isinstance(v, bytes) else v
assert text(f.attrs['unit']) == 'mm' and text(f.attrs['precision']) == 'double'
assert text(f.attrs['command_line']).startswith('gliss sweep knot.obj')
assert len(text(f.attrs['mesh_hash'])) == 16 and f.attrs['stiffness_N_per_m'] == 500
for depth, name in ((2, 'depth_2mm'), (4.5, 'depth_4.5mm')):
    for method in ('gregory', 'shaded', 'flat'):
        g = f[name][method]
        assert g['patch'].shape == (144 * 4 * 6,) and g['face'][-1] == 143  # patch: the old name
        assert g['hip_x'].dtype == 'f8' and g['fx'].dtype == 'f8'
        assert text(g['hip_x'].attrs['unit']) == 'mm' and text(g['fx'].attrs['unit']) == 'N'
        assert numpy.isfinite(g['scp_z']).all()
        assert g['histogram']['residual'][:].sum() == len(g['patch'])
    g = f[name]['gregory']
    force = numpy.sqrt(sum(g[c][:]**2 for c in ('fx', 'fy', 'fz')))
    assert abs(force - 0.5 * depth).max() < 1e-8, force
assert f['statistics']['samples'][0] == 144 * 4 * 6 and len(f['statistics']['depth']) == 6
)");
  const std::string command = fmt::format("cd '{}' && /usr/bin/python3 read.py", folder_ / "");
  EXPECT_EQ(std::system(command.c_str()), 0);
}

// From the middle of a cavity into its wall and back.
TEST_F(Program, ATraceFeelsTheWallsOfACavity) {
  output_of("generate hollow --radius 20 --cavity 10 -o hollow.obj");
  std::string path = "x_mm,y_mm,z_mm\n";
  for (const double z : {0, 5, 9, 10, 11, 12, 11, 9, 5}) path += fmt::format("0,0,{}\n", z);
  folder_.write("in.csv", path);
  for (const char* creases : {"", " --crease 40deg"}) {
    const test::TextTable felt(output_of(
        fmt::format("trace hollow.obj --unit mm --path in.csv --method gregory{}", creases)));
    EXPECT_EQ(felt.number("fz", 2), 0) << creases;
    EXPECT_NEAR(felt.number("fz", 5), -1, 0.01) << creases;
    EXPECT_EQ(felt.number("fz", 7), 0) << creases;
  }
}

TEST_F(Program, ASoupIsNamedByEveryCommand) {
  // The walls between the cells of a grid.
  constexpr int kSide = 5;
  std::string soup;
  for (int i = 0; i < kSide * kSide * kSide; ++i)
    soup += fmt::format("v {} {} {}\n", i % kSide, i / kSide % kSide, i / kSide / kSide);
  for (const auto& [u, v] : {std::pair{1, kSide}, {kSide, kSide * kSide}, {kSide * kSide, 1}}) {
    const auto ends = [](int i, int step) { return i / step % kSide == kSide - 1; };
    for (int i = 0; i < kSide * kSide * kSide; ++i) {
      if (!ends(i, u) && !ends(i, v))
        soup += fmt::format("f {} {} {} {}\n", i + 1, i + u + 1, i + u + v + 1, i + v + 1);
    }
  }
  folder_.write("soup.obj", soup);
  folder_.write("one.csv", "x_mm,y_mm,z_mm\n0,0,3\n");
  const test::Outcome told = run("project soup.obj --unit mm --hip one.csv");
  EXPECT_THAT(told.err, HasSubstr("soup of polygons"));
}

TEST_F(Program, ASweepTellsWhereItsSamplesMayBeTooFarApart) {
  output_of("generate knot -o knot.obj");
  const std::string told = " if those of gregory become fewer with --samples";
  EXPECT_THAT(output_of("sweep knot.obj --unit mm --depth 2mm --samples 3e3 --summary s.json"),
              HasSubstr(told));
  EXPECT_THAT(output_of("sweep knot.obj --unit mm --depth 2mm --samples 3e4 --summary s.json"),
              Not(HasSubstr(told)));
}

TEST_F(Program, PlainSweepHasTheValuesOfTheCompactOne) {
  if (std::system("/usr/bin/python3 -c 'import h5py' >/dev/null 2>&1") != 0)
    GLISS_SKIP_UNLESS_REQUIRED("h5py is absent");
  const std::string words = "sweep knot.obj --unit mm --depth 2mm,4.5mm --rings 3 ";
  output_of(words + "-o s.h5");
  output_of(words + "--layout plain -o plain.h5");
  folder_.write("read.py", R"(import h5py, numpy
names = []
f, g = h5py.File('s.h5'), h5py.File('plain.h5')
f.visit(names.append)
found = []
g.visit(found.append)
assert names == found
for name in [n for n in names if isinstance(f[n], h5py.Dataset)]:
    assert f[name].dtype == g[name].dtype and numpy.array_equal(f[name][:], g[name][:]), name
    assert dict(f[name].attrs) == dict(g[name].attrs)
    assert g[name].chunks is None and g[name].id.get_offset() > 0
assert dict(f.attrs).keys() == dict(g.attrs).keys()
)");
  const std::string command = fmt::format("cd '{}' && /usr/bin/python3 read.py", folder_ / "");
  EXPECT_EQ(std::system(command.c_str()), 0);
}

TEST_F(Program, LayoutsThatMakeNoSenseAreRefused) {
  const std::string words = "sweep knot.obj --unit mm --depth 2mm --rings 3 --layout ";
  for (const auto& [rest, cure] : std::vector<std::pair<std::string, std::string>>{
           {"plain", "--layout: only HDF5 files have one; name the samples by -o FILE.h5"},
           {"plain -o s.csv", "--layout: only HDF5 files have one"},
           {"plain --summary s.json", "--layout: only HDF5 files have one"},
           {"flat -o s.h5", "--layout: 'flat' is neither compact nor plain"}}) {
    const test::Outcome outcome = run(words + rest);
    EXPECT_EQ(outcome.code, 2) << rest;
    EXPECT_THAT(outcome.err, HasSubstr(cure));
  }
}

// Some parts' worth.
std::vector<std::string> words_of_sweep(const char* samples) {
  return {"sweep",     "knot.obj", "--unit",   "mm",   "--depth", "2mm",
          "--samples", samples,    "--method", "flat", "-o",      "s.h5"};
}

TEST_F(Program, AnInterruptedSweepLeavesNothing) {
  const std::size_t files = folder_.file_count();
  test::Process sweep(folder_ / "", test::kProgram, words_of_sweep("1e7"));
  // The temporary is there once the sweep is about to begin.
  EXPECT_TRUE(test::await([&] { return folder_.file_count() > files; }));
  sweep.kill(SIGINT);
  const test::Outcome outcome = sweep.wait();
  EXPECT_EQ(outcome.code, 130);
  EXPECT_THAT(outcome.err, EndsWith("gliss: interrupted\n"));
  EXPECT_EQ(folder_.file_count(), files);
}

// Each tick is there once a method, in the order of the path.
TEST_F(Program, TraceCarriesColumnsAlong) {
  folder_.write("timed.csv", "x_mm,y_mm,z_mm,time,id\n62,0,0,0.5,7\n61,0,0,0.25,8\n");
  const std::string out =
      output_of("trace knot.obj --unit mm --path timed.csv --method flat,shaded --keep time,id");
  std::istringstream lines(out);
  std::string line;
  std::getline(lines, line);
  EXPECT_THAT(line, EndsWith(",face,state,time,id,patch"));
  for (const char* kept : {",0.5,7,", ",0.5,7,", ",0.25,8,", ",0.25,8,"}) {
    std::getline(lines, line);
    EXPECT_THAT(line, HasSubstr(kept));
  }
  EXPECT_THAT(run("trace knot.obj --unit mm --path timed.csv --keep when").err,
              HasSubstr("--keep: timed.csv has no column 'when'"));
}

TEST_F(Program, AKilledSweepGoesOnFromItsParts) {
  const std::vector<std::string> words = words_of_sweep("2e6");
  ASSERT_EQ(test::Process(folder_ / "", test::kProgram, words).wait().code, 0);
  const std::string want = folder_.read("s.h5");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "s.h5.parts"));
  folder_.write("s.h5", "old");

  const auto parts = [&] { return test::part_paths(folder_ / "s.h5.parts").size(); };
  for (const int signal : {SIGKILL, SIGINT}) {
    const std::size_t before = parts();
    test::Process sweep(folder_ / "", test::kProgram, words);
    EXPECT_TRUE(test::await([&] { return parts() > before; }));
    sweep.kill(signal);
    const test::Outcome outcome = sweep.wait();
    EXPECT_EQ(folder_.read("s.h5"), "old");
    if (signal == SIGINT) {
      EXPECT_EQ(outcome.code, 130);
      EXPECT_THAT(outcome.err, HasSubstr("parts are in 's.h5.parts'"));
    }
  }
  const test::Outcome last = test::Process(folder_ / "", test::kProgram, words).wait();
  EXPECT_EQ(last.code, 0);
  EXPECT_THAT(last.err, HasSubstr("goes on from 2 parts in 's.h5.parts'"));
  EXPECT_TRUE(folder_.read("s.h5") == want);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "s.h5.parts"));
}

}  // namespace
}  // namespace gliss
