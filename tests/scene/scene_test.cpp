// Every key of a scene file ends in its place and in SI, and what is not listed is as the header
// says.
#include "gliss/scene/scene.h"

#include <numbers>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tests/support/scene_files.h"

namespace gliss {
namespace {

using namespace std::chrono_literals;
using test::SceneFiles;

// A vector as numbers that a list can be compared with.
std::vector<double> list(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
using List = std::vector<double>;

TEST(Scene, reads_a_tool) {
  const SceneFiles files;
  const Scene scene =
      files.read("[device]\ntool = {mesh = 'ball.obj', unit = 'mm', points = 200}\n");
  ASSERT_TRUE(scene.tool);
  EXPECT_EQ(scene.tool->mesh, files.folder / "ball.obj");
  EXPECT_EQ(scene.tool->unit, 1e-3);
  EXPECT_EQ(scene.tool->points, 200);
  EXPECT_EQ(scene.files.back(), files.folder / "ball.obj");
}

TEST(Scene, reads_motions) {
  const SceneFiles files;
  const std::string object = "[[object]]\nmesh = 'ball.obj'\n";
  const Scene keyframes = files.read(object + R"(
motion = {repeat = true, keyframes = [{time = 0}, {time = "500ms", position = ["10mm", 0, 0]},
    {time = 1, rotation = {axis = [0, 0, 1], degrees = 90}}]}
)");
  ASSERT_NE(keyframes.objects[0].motion, nullptr);
  const Motion& motion = *keyframes.objects[0].motion;
  EXPECT_EQ(motion.duration(), 1);
  EXPECT_EQ(list(motion.at(0.25).translation()), (List{0.005, 0, 0}));
  EXPECT_LT((motion.at(1.75).linear() * Vec3::UnitX() - Vec3(1, 1, 0).normalized()).norm(), 1e-12);
  files.folder.write("poses.csv",
                     "t,x_mm,y_mm,z_mm,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n2,4,0,0,0,0,0,1\n");
  const Scene table = files.read(object + "motion = {path = 'poses.csv'}\n");
  EXPECT_EQ(list(table.objects[0].motion->at(1).translation()), (List{0.002, 0, 0}));
  EXPECT_LT((table.objects[0].motion->at(2).linear() * Vec3::UnitX() + Vec3::UnitX()).norm(),
            1e-12);
  EXPECT_EQ(table.files.back(), files.folder / "poses.csv");
  EXPECT_EQ(files.read(object).objects[0].motion, nullptr);
}

TEST(Scene, reads_every_key) {
  const SceneFiles files;
  const Scene scene = files.read(R"(
[[object]]
name = "ball"
mesh = "ball.obj"
unit = "mm"
precision = "float"
stiffness = "0.7N/mm"
level = "exact"
method = "shaded"
solver = "gauss-newton"
settle = "5ms"
friction = {static = 0.5, dynamic = 0.3, settle = "2ms"}
damping = "2s/m"
viscosity = "3 N s/m"
magnet = {force = "0.2N", range = "2mm"}
texture = {kind = "grating", height = "50um", period = "2mm", along = [0, 1, 2]}
position = ["10mm", "-2cm", 0.3]
rotation = {axis = [0, 0, 2], degrees = 90}

[[object]]
cache = "ball.gliss"
method = "flat"
solver = "paper"
friction = {static = 0.4}
texture = {kind = "noise", height = 1e-5, period = "1mm"}

[loop]
rate = 2000
priority = 42

[guards]
max_force = 2.5
max_rate = 800
max_torque = 0.2
max_torque_rate = 90
hold_after = "3ms"
ramp_from = 0.004
ramp_to = "9000us"
engage_below = 0.1
engage_ramp = "1.5s"
reengage = true

[device]
max_force = 1.5
max_torque = 0.1
max_stiffness = "1.2N/mm"
hips = [[0, 0, 0], ["1mm", "2mm", "-3mm"]]
workspace = {min = ["-5cm", -0.06, -0.07], max = [0.05, 0.06, "70mm"]}

[sim]
waypoints = [[0, 0, "20mm"], [0, 0, "10mm"]]
speed = 0.05
rounds = 3
mass = 0.2
hand_stiffness = "0.4N/mm"
hand_damping = 6
resolution = "3um"
noise = "2um"
delay = "1.5ms"
turning = {axis = [0, 0, 3], degrees = 180}
inertia = 1e-4
wrist_stiffness = 1.5
wrist_damping = 0.01
seed = 77
)");
  ASSERT_EQ(scene.objects.size(), 2u);
  const ObjectDescription& ball = scene.objects[0];
  EXPECT_EQ(ball.name, "ball");
  EXPECT_THAT(ball.place, ::testing::EndsWith("scene.toml:2: object 'ball'"));
  EXPECT_EQ(ball.surface, files.folder / "ball.obj");
  EXPECT_EQ(ball.unit, 1e-3);
  EXPECT_EQ(ball.precision, Precision::kFloat);
  EXPECT_EQ(ball.stiffness, 700);
  EXPECT_EQ(ball.method, Method::kShaded);
  EXPECT_EQ(ball.solver, Solver::kGaussNewton);
  EXPECT_EQ(ball.settle, 0.005);
  EXPECT_EQ(ball.friction.at_rest, 0.5);
  EXPECT_EQ(ball.friction.slipping, 0.3);
  EXPECT_EQ(ball.friction.settle, 0.002);
  EXPECT_EQ(ball.effects.damping, 2);
  EXPECT_EQ(ball.effects.viscosity, 3);
  EXPECT_EQ(ball.effects.magnet.force, 0.2);
  EXPECT_EQ(ball.effects.magnet.range, 2e-3);
  EXPECT_EQ(ball.effects.texture.relief, Relief::kGrating);
  EXPECT_EQ(ball.effects.texture.height, 50e-6);
  EXPECT_EQ(ball.effects.texture.period, 2e-3);
  EXPECT_EQ(list(ball.effects.texture.along), (List{0, 1, 2}));
  EXPECT_EQ(list(ball.pose.translation()), (List{0.01, -0.02, 0.3}));
  // A quarter turn about z leads x to y.
  EXPECT_LT((ball.pose * Vec3(1, 2, 3) - Vec3(-1.99, 0.98, 3.3)).norm(), 1e-12);
  const ObjectDescription& second = scene.objects[1];
  EXPECT_EQ(second.name, "2");
  EXPECT_EQ(second.surface, files.folder / "ball.gliss");
  EXPECT_EQ(second.method, Method::kFlat);
  EXPECT_EQ(second.friction.at_rest, 0.4);
  EXPECT_EQ(second.friction.slipping, 0.4);
  EXPECT_EQ(second.friction.settle, 0);
  EXPECT_EQ(second.effects.texture.relief, Relief::kNoise);
  EXPECT_EQ(second.effects.texture.height, 1e-5);
  EXPECT_EQ(second.effects.damping, 0);
  EXPECT_EQ(second.solver, Solver::kPaper);

  EXPECT_EQ(scene.loop.period, 500us);
  EXPECT_EQ(scene.priority, 42);
  EXPECT_TRUE(scene.loop.reengage);
  const GuardLimits& guard = scene.loop.guard;
  EXPECT_EQ(guard.max_force, 2.5);
  EXPECT_EQ(guard.max_rate, 800);
  EXPECT_EQ(guard.max_torque, 0.2);
  EXPECT_EQ(guard.max_torque_rate, 90);
  EXPECT_EQ(scene.max_torque, 0.1);
  ASSERT_TRUE(scene.sim && scene.sim->turning);
  EXPECT_LT((*scene.sim->turning - std::numbers::pi * Vec3::UnitZ()).norm(), 1e-12);
  EXPECT_EQ(scene.sim->max_torque, 0.1);
  EXPECT_EQ(scene.sim->inertia, 1e-4);
  EXPECT_EQ(scene.sim->wrist_stiffness, 1.5);
  EXPECT_EQ(scene.sim->wrist_damping, 0.01);
  EXPECT_EQ(guard.hold_after, 3ms);
  EXPECT_EQ(guard.ramp_from, 4ms);
  EXPECT_EQ(guard.ramp_to, 9ms);
  EXPECT_EQ(guard.engage_below, 0.1);
  EXPECT_EQ(guard.engage_ramp, 1500ms);

  EXPECT_EQ(scene.max_force, 1.5);
  EXPECT_EQ(scene.max_stiffness, 1200);
  ASSERT_EQ(scene.hips.size(), 2u);
  EXPECT_EQ(list(scene.hips[0]), (List{0, 0, 0}));
  EXPECT_EQ(list(scene.hips[1]), (List{0.001, 0.002, -0.003}));
  ASSERT_TRUE(scene.sim);
  const SimOptions& sim = *scene.sim;
  EXPECT_EQ(list(sim.workspace.min()), (List{-0.05, -0.06, -0.07}));
  EXPECT_EQ(list(sim.workspace.max()), (List{0.05, 0.06, 0.07}));
  EXPECT_EQ(sim.max_force, 1.5);
  EXPECT_EQ(sim.max_stiffness, 1200);
  EXPECT_EQ(sim.mass, 0.2);
  EXPECT_EQ(sim.hand_stiffness, 400);
  EXPECT_EQ(sim.hand_damping, 6);
  EXPECT_EQ(sim.resolution, 3e-6);
  EXPECT_EQ(sim.noise, 2e-6);
  EXPECT_EQ(sim.delay, 1500us);
  EXPECT_EQ(sim.seed, 77u);
  HandPath path = scene.sim_path;  // 10 mm there and back, there and back, there
  EXPECT_NEAR(path.duration(), 5 * 0.01 / 0.05, 1e-12);
  EXPECT_LT((path.at(0.1) - Vec3(0, 0, 0.015)).norm(), 1e-12);
}

TEST(Scene, has_the_defaults_of_its_headers) {
  const SceneFiles files;
  const Scene scene = files.read("[[object]]\nmesh = 'ball.obj'\n[sim]\nwaypoints = [[0, 0, 0]]\n");
  const Scene none;
  ASSERT_EQ(scene.objects.size(), 1u);
  const ObjectDescription& object = scene.objects[0];
  EXPECT_EQ(object.name, "1");
  EXPECT_EQ(object.unit, 1);
  EXPECT_FALSE(object.precision);
  EXPECT_EQ(object.stiffness, 500);
  EXPECT_EQ(object.method, Method::kGregory);
  EXPECT_EQ(object.solver, Solver::kNewton);
  EXPECT_TRUE(object.pose.isApprox(Eigen::Isometry3d::Identity(), 0));
  EXPECT_TRUE(scene.hips.empty());
  EXPECT_EQ(scene.priority, 80);
  EXPECT_EQ(scene.loop.period, 1ms);
  EXPECT_FALSE(scene.loop.reengage);
  EXPECT_EQ(scene.loop.guard.max_force, 3.3);
  EXPECT_EQ(scene.loop.guard.ramp_to, 10ms);
  EXPECT_EQ(scene.max_force, none.max_force);
  EXPECT_EQ(scene.max_stiffness, none.max_stiffness);
  ASSERT_TRUE(scene.sim);
  const SimOptions sim;
  EXPECT_EQ(scene.sim->mass, sim.mass);
  EXPECT_EQ(scene.sim->resolution, sim.resolution);
  EXPECT_EQ(scene.sim->delay, sim.delay);
  EXPECT_EQ(scene.sim->seed, sim.seed);
  EXPECT_TRUE(scene.sim->workspace.isEmpty());
  EXPECT_FALSE(files.read("[[object]]\nmesh = 'ball.obj'\n").sim);
}

TEST(Scene, may_be_empty) {
  const SceneFiles files;
  for (const char* text : {"", "# nothing\n", "\n\n", "[loop]\n[guards]\n[device]\n"}) {
    const Scene scene = files.read(text);
    EXPECT_TRUE(scene.objects.empty());
    EXPECT_FALSE(scene.sim);
    EXPECT_EQ(scene.loop.period, 1ms);
  }
}

// Each limit of the device holds for the simulated one, whose own may be lower.
TEST(Scene, takes_the_lower_limit_of_the_simulated_device) {
  const SceneFiles files;
  const Scene scene = files.read(
      "[device]\nmax_force = 100\nmax_stiffness = 1e5\n[sim]\nwaypoints = [[0, 0, 0]]\n");
  EXPECT_EQ(scene.max_force, 100);
  EXPECT_EQ(scene.sim->max_force, SimOptions().max_force);
  EXPECT_EQ(scene.sim->max_stiffness, SimOptions().max_stiffness);
}

TEST(Scene, reads_the_path_of_a_hand_from_a_file) {
  const SceneFiles files;
  files.folder.write("mm.csv", "x_mm,y_mm,z_mm\n1,2,3\n3,2,1\n5,2,1\n");
  files.folder.write("m.csv",
                     "step,z,y,x\n0,0.003,0.002,0.001\n1,0.001,0.002,0.003\n"
                     "2,0.001,0.002,0.005\n");
  for (const char* name : {"mm.csv", "m.csv"}) {
    HandPath path =
        files.read(fmt::format("[sim]\npath = '{}'\ninterval = '2ms'\nrounds = 2\n", name))
            .sim_path;
    EXPECT_NEAR(path.duration(), 0.010, 1e-15) << name;
    EXPECT_EQ(list(path.at(0)), (List{0.001, 0.002, 0.003})) << name;
    EXPECT_LT((path.at(0.001) - Vec3(0.002, 0.002, 0.002)).norm(), 1e-12) << name;
    EXPECT_LT((path.at(0.006) - Vec3(0.001, 0.002, 0.003)).norm(), 1e-12) << name;
    EXPECT_EQ(list(path.at(1)), (List{0.005, 0.002, 0.001})) << name;
  }
}

// From wherever the program is started.
TEST(Scene, finds_its_files_beside_itself) {
  const SceneFiles files;
  namespace fs = std::filesystem;
  fs::create_directory(files.folder / "parts");
  fs::copy(files.folder / "ball.obj", files.folder / "parts/part.obj");
  files.folder.write("parts/path.csv", "x,y,z\n0,0,0\n");
  const Scene scene =
      files.read(fmt::format("[[object]]\nmesh = 'parts/part.obj'\n[[object]]\nmesh = '{}'\n"
                             "[sim]\npath = 'parts/path.csv'\n",
                             files.folder / "ball.obj"));
  EXPECT_EQ(scene.objects[0].surface, files.folder / "parts/part.obj");
  EXPECT_EQ(scene.objects[1].surface, files.folder / "ball.obj");
  files.folder.write("parts/scene.toml", "[[object]]\nmesh = '../ball.obj'\n");
  EXPECT_TRUE(fs::equivalent(read_scene(files.folder / "parts/scene.toml").objects[0].surface,
                             files.folder / "ball.obj"));
}

TEST(Scene, takes_names_in_any_script_and_both_micro_signs) {
  const SceneFiles files;
  const Scene scene = files.read(
      "\xEF\xBB\xBF[[object]]\r\nname = \"K\\u00f6rper \xE7\x90\x83\"\r\nmesh = 'ball.obj'\r\n"
      "[sim]\r\nwaypoints = [[0, 0, 0]]\r\nnoise = '2\xC2\xB5m'\r\n");
  EXPECT_EQ(scene.objects[0].name, "K\xC3\xB6rper \xE7\x90\x83");
  EXPECT_EQ(scene.sim->noise, 2e-6);
}

}  // namespace
}  // namespace gliss
