// A scene file that is wrong is refused in one line, which names the file, the line and the key.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tests/support/scene_files.h"

namespace gliss {
namespace {

using test::SceneFiles;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

struct Wrong {
  const char *text, *place, *why;
};

void expect_refused(std::initializer_list<Wrong> all) {
  const SceneFiles files;
  for (const auto& [text, place, why] : all) {
    SCOPED_TRACE(text);
    const std::string error = files.error_of(text);
    EXPECT_THAT(error, AllOf(StartsWith(std::string("scene.toml:") + place), HasSubstr(why)));
    EXPECT_EQ(error.find('\n'), error.npos);
  }
}

TEST(SceneError, names_what_is_no_toml) {
  expect_refused({
      {"[loop\nrate = 1000\n", "1: ", ""},
      {"[loop]\nrate = \n", "2: ", ""},
      {"[loop]\nrate = 1000\nrate = 2000\n", "3: ", "rate"},
      {"[loop]\n\n[loop]\n", "3: ", "loop"},
      {"[sim]\nwaypoints = [[0, 0, 0\n", "", ""},
      {"name = \"\xFF\"\n", "1: ", ""},
      {"name = 'a", "1: ", ""},
  });
}

TEST(SceneError, names_hips_that_are_too_many_for_the_objects) {
  const SceneFiles files;
  std::string text =
      "[[object]]\nmesh = 'ball.obj'\n[[object]]\nmesh = 'ball.obj'\n[device]\nhips = [";
  for (int i = 0; i < 5001; ++i) text += "[0, 0, 0], ";
  EXPECT_THAT(files.error_of(text + "]\n"),
              AllOf(StartsWith("scene.toml:6: device.hips: "), HasSubstr("on 2 objects 5000")));
}

// Letters stand where toml++ says that it cannot get (CMakeLists.txt): compiled as it is here, it
// refuses them.
TEST(SceneError, names_letters_that_stand_where_none_may) {
  const SceneFiles files;
  const auto utf8 = [](unsigned code) {
    const auto byte = [](unsigned bits) { return static_cast<char>(bits); };
    std::string text;
    if (code < 0x800) {
      text = {byte(0xC0 | code >> 6)};
    } else {
      text = {byte(0xE0 | code >> 12), byte(0x80 | (code >> 6 & 0x3F))};
    }
    return text + byte(0x80 | (code & 0x3F));
  };
  const auto expect_none = [&](unsigned first, unsigned last) {
    for (unsigned code = first; code <= last; ++code) {
      const std::string letter = utf8(code);
      for (const std::string& text :
           {letter + " = 1", "name" + letter + " = 1", "loop = " + letter})
        EXPECT_THAT(files.error_of(text + "\n"), StartsWith("scene.toml:1: ")) << std::hex << code;
    }
  };
  expect_none(0xA1, 0x1FF);
  expect_none(0x2C5E, 0x2CFF);
  expect_none(0xFE26, 0xFEFE);
}

TEST(SceneError, names_keys_that_there_are_not) {
  expect_refused({
      {"title = 'x'\n", "1: title: ", "no such key; there are device, guards, loop, object, sim"},
      {"[objects]\n", "1: objects: ", "no such key"},
      {"[[object]]\nmesh = 'ball.obj'\nstifness = 500\n", "3: object.stifness: ", "stiffness"},
      {"[[object]]\nmesh = 'ball.obj'\n[[object]]\nmesh = 'ball.obj'\nMethod = 'flat'\n",
       "5: object.Method: ", "method"},
      {"[[object]]\nmesh = 'ball.obj'\nrotation = {axis = [0, 0, 1], radians = 1}\n",
       "3: object.rotation.radians: ", "axis, degrees"},
      {"[loop]\nrate = 1000\nperiod = '1ms'\n", "3: loop.period: ", "priority, rate"},
      {"[guards]\nmax_stiffness = 1\n", "2: guards.max_stiffness: ", "max_force"},
      {"[device]\nhip = [[0, 0, 0]]\n", "2: device.hip: ", "hips"},
      {"[device]\nworkspace = {min = [0, 0, 0], max = [1, 1, 1], mid = 1}\n",
       "2: device.workspace.mid: ", "max, min"},
      {"[device.workspace]\nmin = [0, 0, 0]\nmax = [1, 1, 1]\nunit = 'mm'\n",
       "4: device.workspace.unit: ", "max, min"},
      {"[sim]\nwaypoints = [[0, 0, 0]]\nweight = 1\n", "3: sim.weight: ", "mass"},
  });
}

TEST(SceneError, names_values_of_another_kind) {
  expect_refused({
      {"object = 3\n", "1: object: ", "[[object]]"},
      {"[object]\nmesh = 'ball.obj'\n", "1: object: ", "[[object]]"},
      {"object = []\nloop = 1000\n", "", ""},
      {"loop = 1000\n", "1: loop: ", "table"},
      {"[[loop]]\nrate = 1000\n", "1: loop: ", "table"},
      {"[[object]]\nmesh = 3\n", "2: object.mesh: ", "text"},
      {"[[object]]\nmesh = 'ball.obj'\ncrease = 40\n", "3: object.crease: ", "text"},
      {"[[object]]\nmesh = 'ball.obj'\ncrease = '40mm'\n", "3: object.crease: ", "deg or rad"},
      {"[[object]]\ncache = 'ball.gliss'\ncrease = '40deg'\n", "3: object.crease: ", "baked"},
      {"[[object]]\nmesh = 'ball.obj'\ncrease = 'none'\nradius = '1mm'\n",
       "4: object.radius: ", "no crease"},
      {"[[object]]\nmesh = 'ball.obj'\ncrease = '9deg'\nradius = '0mm'\n",
       "4: object.radius: ", "positive"},
      {"[[object]]\ncache = 'ball.gliss'\nradius = '1mm'\n", "3: object.radius: ", "baked"},
      {"[[object]]\nmesh = ''\n", "2: object.mesh: ", "text"},
      {"[[object]]\nmesh = 'ball.obj'\nunit = 1e-3\n", "3: object.unit: ", "text"},
      {"[[object]]\nmesh = 'ball.obj'\nstiffness = true\n", "3: object.stiffness: ", "number"},
      {"[[object]]\nmesh = 'ball.obj'\nstiffness = [500]\n", "3: object.stiffness: ", "number"},
      {"[[object]]\nmesh = 'ball.obj'\nstiffness = '500'\nmethod = 1\n",
       "4: object.method: ", "text"},
      {"[[object]]\nmesh = 'ball.obj'\nposition = 'mm'\n", "3: object.position: ", "[x, y, z]"},
      {"[[object]]\nmesh = 'ball.obj'\nposition = [1, 2]\n", "3: object.position: ", "[x, y, z]"},
      {"[[object]]\nmesh = 'ball.obj'\nposition = [1, 2, 3, 4]\n",
       "3: object.position: ", "[x, y, z]"},
      {"[[object]]\nmesh = 'ball.obj'\nposition = [1, 2, [3]]\n", "3: object.position: ", "number"},
      {"[[object]]\nmesh = 'ball.obj'\nrotation = [0, 0, 1]\n", "3: object.rotation: ", "table"},
      {"[loop]\nrate = '1kHz'\n", "2: loop.rate: ", "number"},
      {"[loop]\npriority = 80.0\n", "2: loop.priority: ", "whole number from 1 to 99"},
      {"[loop]\npriority = '80'\n", "2: loop.priority: ", "whole number"},
      {"[guards]\nreengage = 1\n", "2: guards.reengage: ", "true or false"},
      {"[guards]\nmax_force = '3N'\n", "2: guards.max_force: ", "number"},
      {"[guards]\nhold_after = 1979-05-27\n", "2: guards.hold_after: ", "number"},
      {"[device]\nhips = [0, 0, 0]\n", "2: device.hips: ", "[x, y, z]"},
      {"[device]\nhips = 'none'\n", "2: device.hips: ", "list of points"},
      {"[device]\nworkspace = [[0, 0, 0], [1, 1, 1]]\n", "2: device.workspace: ", "table"},
      {"[sim]\npath = ['path.csv']\n", "2: sim.path: ", "text"},
      {"[sim]\nwaypoints = 3\n", "2: sim.waypoints: ", "list of points"},
      {"[sim]\nwaypoints = [[0, 0, 0]]\nseed = 0.5\n", "3: sim.seed: ", "whole number"},
  });
}

TEST(SceneError, names_numbers_out_of_range) {
  expect_refused({
      {"[[object]]\nmesh = 'ball.obj'\nstiffness = 0\n", "3: object.stiffness: ", "positive"},
      {"[[object]]\nmesh = 'ball.obj'\nstiffness = '-1N/mm'\n",
       "3: object.stiffness: ", "positive"},
      {"[[object]]\nmesh = 'ball.obj'\nunit = '-1'\n", "3: object.unit: ", "'-1'"},
      {"[[object]]\nmesh = 'ball.obj'\nsettle = 5\n", "3: object.settle: ", "from 0 to 1 s"},
      {"[[object]]\nmesh = 'ball.obj'\nsettle = '-1ms'\n", "3: object.settle: ", "from 0"},
      {"[[object]]\nmesh = 'ball.obj'\nfriction = 0.5\n", "3: object.friction: ", "table"},
      {"[[object]]\nmesh = 'ball.obj'\nfriction = {static = -0.1}\n",
       "3: object.friction.static: ", "from 0 to 5"},
      {"[[object]]\nmesh = 'ball.obj'\nfriction = {static = 1e9}\n",
       "3: object.friction.static: ", "from 0 to 5"},
      {"[[object]]\nmesh = 'ball.obj'\nfriction = {static = nan}\n",
       "3: object.friction.static: ", ""},
      {"[[object]]\nmesh = 'ball.obj'\nfriction = {static = 0.3, dynamic = 0.4}\n",
       "3: object.friction.dynamic: ", "from 0 to static"},
      {"[[object]]\nmesh = 'ball.obj'\nfriction = {dynamic = 0.1}\n",
       "3: object.friction.dynamic: ", "from 0 to static"},
      {"[[object]]\nmesh = 'ball.obj'\nfriction = {static = 1, settle = '2s'}\n",
       "3: object.friction.settle: ", "from 0 to 1 s"},
      {"[[object]]\nmesh = 'ball.obj'\nfriction = {kinetic = 1}\n", "3: object.friction.kinetic",
       ""},
      {"[[object]]\nmesh = 'ball.obj'\ndamping = -1\n", "3: object.damping: ", "from 0 to 20 s/m"},
      {"[[object]]\nmesh = 'ball.obj'\ndamping = '2N'\n", "3: object.damping: ", "such as 2 s/m"},
      {"[[object]]\nmesh = 'ball.obj'\nviscosity = 21\n",
       "3: object.viscosity: ", "from 0 to 20 N s/m"},
      {"[[object]]\nmesh = 'ball.obj'\nviscosity = nan\n", "3: object.viscosity: ", ""},
      {"[[object]]\nmesh = 'ball.obj'\nmagnet = {force = 1}\n", "3: object.magnet",
       "force and range"},
      {"[[object]]\nmesh = 'ball.obj'\nmagnet = {force = 0, range = 1}\n",
       "3: object.magnet.force: ", "positive"},
      {"[[object]]\nmesh = 'ball.obj'\nmagnet = {force = 1, range = '-2mm'}\n",
       "3: object.magnet.range: ", "positive"},
      {"[[object]]\nmesh = 'ball.obj'\npatches = 'lazy'\nmagnet = {force = 1, range = 1}\n",
       "4: object.magnet: ", "patches = \"all\""},
      {"[[object]]\nmesh = 'ball.obj'\ntexture = {kind = 'grating', height = 1e-3}\n",
       "3: object.texture", "needs kind, height and period"},
      {"[[object]]\nmesh = 'ball.obj'\ntexture = {kind = 'bumps', height = 1e-3, period = 1}\n",
       "3: object.texture.kind: ", "grating, noise"},
      {"[[object]]\nmesh = 'ball.obj'\ntexture = {kind = 'grating', height = '1mm', period = "
       "'2mm'}\n",
       "3: object.texture.height: ", "slopes up to 1.57"},
      {"[[object]]\nmesh = 'ball.obj'\ntexture = {kind = 'noise', height = 1e-5, period = 1e-3, "
       "along = [1, 0, 0]}\n",
       "3: object.texture.along: ", "grating"},
      {"[[object]]\nmesh = 'ball.obj'\ntexture = {kind = 'grating', height = 1e-5, period = 1e-3, "
       "along = [0, 0, 0]}\n",
       "3: object.texture.along: ", "zero"},
      {"[[object]]\nmesh = 'ball.obj'\nmotion = {repeat = true}\n", "3: object.motion",
       "a path (a table of poses) or keyframes"},
      {"[[object]]\nmesh = 'ball.obj'\nmotion = {keyframes = []}\n", "3: object.motion",
       "once for each"},
      {"[[object]]\nmesh = 'ball.obj'\nmotion = {keyframes = [{position = [0, 0, 0]}]}\n",
       "3: object.motion.keyframes", "needs a time"},
      {"[[object]]\nmesh = 'ball.obj'\nmotion = {keyframes = [{time = 1}, {time = 1}]}\n",
       "3: object.motion.keyframes.time: ", "later than"},
      {"[[object]]\nmesh = 'ball.obj'\nmotion = {keyframes = [{time = -1}]}\n", "3: object.motion",
       "pose 0 is not at 0 s or later"},
      {"[[object]]\nmesh = 'ball.obj'\nmotion = {keyframes = [{time = 1}], repeat = true}\n",
       "3: object.motion", "repeats a single pose"},
      {"[[object]]\nmesh = 'ball.obj'\nmotion = {path = 'none.csv'}\n",
       "3: object.motion.path: ", "none.csv"},
      {"[[object]]\nmesh = 'ball.obj'\nmotion = {path = 'back.csv'}\n",
       "3: object.motion.path: ", "back.csv:3: its time is not later"},
      {"[[object]]\nmesh = 'ball.obj'\nmotion = {path = 'long.csv'}\n",
       "3: object.motion.path: ", "long.csv:2: qw, qx, qy and qz have the length 2"},
      {"[[object]]\nmesh = 'ball.obj'\nmotion = {path = 'half.csv'}\n",
       "3: object.motion.path: ", "qw, qx, qy and qz"},
      {"[[object]]\nmesh = 'ball.obj'\nrotation = {axis = [0, 0, 0], degrees = 9}\n",
       "3: object.rotation.axis: ", "zero"},
      {"[[object]]\nmesh = 'ball.obj'\nrotation = {degrees = 9}\n", "3: object.rotation", "axis"},
      {"[device]\ntool = {points = 5}\n", "2: device.tool", "needs a mesh"},
      {"[device]\ntool = {mesh = 'none.obj'}\n", "2: device.tool.mesh: ", "there is no"},
      {"[device]\ntool = {mesh = 'ball.obj', points = 1001}\n",
       "2: device.tool.points: ", "1 to 1000"},
      {"[device]\nhips = [[0, 0, 0]]\ntool = {mesh = 'ball.obj'}\n",
       "3: device.tool: ", "leave out hips"},
      {"[device]\nmax_torque = 0\n", "2: device.max_torque: ", "positive"},
      {"[guards]\nhold_after = '0.5ms'\n", "2: guards.hold_after: ", "a period at least, 1 ms"},
      {"[guards]\nmax_torque_rate = 10\n", "2: guards.max_torque_rate: ", "too low"},
      {"[sim]\nwaypoints = [[0, 0, 0]]\nturning = {axis = [0, 0, 0], degrees = 1}\n",
       "3: sim.turning.axis: ", "zero"},
      {"[sim]\nwaypoints = [[0, 0, 0]]\ninertia = 1e-9\n", "3: sim.inertia: ", "too small"},
      {"[loop]\nrate = 0\n", "2: loop.rate: ", "positive"},
      {"[loop]\nrate = 0.5\n", "2: loop.rate: ", "1 to 100000"},
      {"[loop]\nrate = 100\n", "2: loop.rate: ", "at 100 Hz the guard takes an input as late"},
      {"[loop]\nrate = 100001\n", "2: loop.rate: ", "1 to 100000"},
      {"[loop]\npriority = 0\n", "2: loop.priority: ", "1 to 99"},
      {"[loop]\npriority = 100\n", "2: loop.priority: ", "1 to 99"},
      {"[loop]\npriority = 9223372036854775807\n", "2: loop.priority: ", "1 to 99"},
      {"[device]\nmax_force = 0\n", "2: device.max_force: ", "positive"},
      {"[device]\nmax_stiffness = -1\n", "2: device.max_stiffness: ", "positive"},
      {"[device]\nworkspace = {max = [1, 1, 1]}\n", "2: device.workspace: ", "min and max"},
      {"[device]\nworkspace = {min = [1, 1, 1]}\n", "2: device.workspace: ", "min and max"},
      {"[device]\nworkspace = {min = [0, 1, 0], max = [1, 1, 1]}\n",
       "2: device.workspace: ", "min must be below max"},
      {"[sim]\nwaypoints = [[0, 0, 0]]\nspeed = 0\n", "3: sim.speed: ", "positive"},
      {"[sim]\nwaypoints = [[0, 0, 0], [1, 0, 0]]\nspeed = 1e-310\n", "", "path"},
      {"[sim]\nwaypoints = [[1e61, 0, 0], [-1e61, 0, 0]]\n", "2: sim.waypoints: ", "beyond 1e+60"},
      {"[sim]\nwaypoints = [[0, 0, 0]]\nrounds = 0\n", "3: sim.rounds: ", "whole number"},
      {"[sim]\npath = 'path.csv'\ninterval = '0ms'\n", "3: sim.interval: ", "positive"},
      {"[sim]\npath = 'path.csv'\ninterval = 1e61\nrounds = 2\n",
       "3: sim.interval: ", "beyond 1e+60"},
      {"[sim]\nwaypoints = [[0, 0, 0]]\nmass = -0.1\n", "3: sim.mass: ", "positive"},
      {"[sim]\nwaypoints = [[0, 0, 0]]\nmass = 1e-9\n", "3: sim.mass: ", "too small"},
      {"[sim]\nwaypoints = [[0, 0, 0]]\nhand_damping = -1\n", "3: sim.hand_damping: ", "negative"},
      {"[sim]\nwaypoints = [[0, 0, 0]]\nresolution = '-1um'\n", "3: sim.resolution: ", "negative"},
      {"[sim]\nwaypoints = [[0, 0, 0]]\nnoise = -1\n", "3: sim.noise: ", "negative"},
      {"[sim]\nwaypoints = [[0, 0, 0]]\ndelay = '21ms'\n", "3: sim.delay: ", "20 ms"},
      {"[sim]\nwaypoints = [[0, 0, 0]]\ndelay = 1e50\n", "3: sim.delay: ", "time"},
      {"[sim]\nwaypoints = [[0, 0, 0]]\nseed = -1\n", "3: sim.seed: ", "whole number"},
  });
}

// TOML has them; none is a number here.
TEST(SceneError, names_numbers_that_are_not_finite) {
  for (const char* value : {"nan", "inf", "-inf", "+nan", "1e400", "'nan'", "'inf'"}) {
    const SceneFiles files;
    for (const auto& [text, place] : std::initializer_list<std::pair<std::string, std::string>>{
             {"[[object]]\nmesh = 'ball.obj'\nstiffness = {}\n", "3: object.stiffness"},
             {"[[object]]\nmesh = 'ball.obj'\nposition = [0, {}, 0]\n", "3: object.position"},
             {"[loop]\nrate = {}\n", "2: loop.rate"},
             {"[guards]\nmax_force = {}\n", "2: guards.max_force"},
             {"[guards]\nramp_to = {}\n", "2: guards.ramp_to"},
             {"[device]\nhips = [[0, 0, {}]]\n", "2: device.hips"},
             {"[sim]\nwaypoints = [[{}, 0, 0]]\n", "2: sim.waypoints"},
             {"[sim]\nwaypoints = [[0, 0, 0]]\nhand_damping = {}\n", "3: sim.hand_damping"}}) {
      const std::string filled = fmt::format(fmt::runtime(text), value);
      const std::string error = files.error_of(filled);
      // What TOML itself has no room for is named by its line.
      const std::string line = place.substr(0, 2);
      EXPECT_THAT(error, StartsWith("scene.toml:" + (value[0] == '1' ? line : place))) << filled;
    }
  }
}

TEST(SceneError, names_words_that_are_no_choice) {
  expect_refused({
      {"[[object]]\nmesh = 'ball.obj'\nmethod = 'phong'\n",
       "3: object.method: ", "'phong' is not one of gregory, shaded, flat"},
      {"[[object]]\nmesh = 'ball.obj'\nsolver = 'bisect'\n",
       "3: object.solver: ", "newton, gauss-newton, paper"},
      {"[[object]]\nmesh = 'ball.obj'\nprecision = 'half'\n",
       "3: object.precision: ", "float, double"},
      {"[[object]]\nmesh = 'ball.obj'\nlevel = 'coarse'\n", "3: object.level: ",
       "'coarse' is not one of exact, ribbon, bezier, table, table:1 to table:"},
      {"[[object]]\nmesh = 'ball.obj'\ntolerance = 1\n", "3: object.tolerance: ", "less than 1"},
      {"[[object]]\nmesh = 'ball.obj'\niterations = 0\n", "3: object.iterations: ", "1 to 10000"},
      {"[[object]]\nmesh = 'ball.obj'\nunit = 'parsec'\n", "3: object.unit: ", "parsec"},
      {"[[object]]\nmesh = 'ball.obj'\nmethod = \"a\\nb\"\n", "3: object.method: ", "gregory"},
      {"[[object]]\nmesh = 'ball.obj'\nstiffness = '5 lbf/in'\n", "3: object.stiffness: ", "lbf"},
      {"[[object]]\nmesh = 'ball.obj'\nposition = [0, '5 ell', 0]\n",
       "3: object.position: ", "ell"},
      {"[guards]\nhold_after = '2 min'\n", "2: guards.hold_after: ", "min"},
  });
}

TEST(SceneError, names_what_does_not_go_together) {
  expect_refused({
      {"\n[[object]]\nname = 'x'\n", "2: object: ", "a mesh or a cache, one of them"},
      {"[[object]]\nmesh = 'ball.obj'\ncache = 'ball.gliss'\n", "1: object: ", "one of them"},
      {"[[object]]\nmesh = 'none.obj'\n", "2: object.mesh: ", "none.obj"},
      {"[[object]]\ncache = 'none.gliss'\n", "2: object.cache: ", "none.gliss"},
      {"[[object]]\nmesh = 'ball.obj/x'\n", "2: object.mesh: ", "ball.obj/x"},
      {"[[object]]\ncache = 'ball.gliss'\nunit = 'mm'\n", "3: object.unit: ", "its own unit"},
      {"\n[sim]\nmass = 1\n", "2: sim: ", "path (a file) or waypoints"},
      {"[sim]\npath = 'path.csv'\nwaypoints = [[0, 0, 0]]\n", "1: sim: ", "one of them"},
      {"[sim]\nwaypoints = []\n", "1: sim: ", "path (a file) or waypoints"},
  });
  const SceneFiles files;
  const std::string longest(5000, 'x');
  EXPECT_THAT(files.error_of("[[object]]\nmesh = '" + longest + "'\n"),
              StartsWith("scene.toml:2: object.mesh: "));
}

TEST(SceneError, names_guards_that_are_none) {
  expect_refused({
      {"[guards]\nramp_to = '20ms'\n", "2: guards.ramp_to: ", "at most 10 ms"},
      {"[guards]\nramp_to = '2ms'\n", "2: guards.ramp_to: ", "after ramp_from"},
      {"\n[guards]\nramp_from = '1ms'\n", "3: guards.ramp_from: ", "hold_after"},
      {"[guards]\nhold_after = 0\n", "2: guards.hold_after: ", "positive"},
      {"[guards]\nhold_after = '-1ms'\n", "2: guards.hold_after: ", "positive"},
      {"[guards]\nmax_force = 0\n", "2: guards.max_force: ", "positive"},
      {"[guards]\nmax_rate = 100\n", "2: guards.max_rate: ", "too low"},
      // It is what is not listed that is too low.
      {"[guards]\nmax_force = 100\n", "1: guards.max_rate: ", "too low"},
      {"[guards]\nengage_below = 0.3\n", "2: guards.engage_below: ", "0.2 N"},
      {"[guards]\nengage_ramp = '0.1s'\n", "2: guards.engage_ramp: ", "0.5 s"},
  });
}

}  // namespace
}  // namespace gliss
