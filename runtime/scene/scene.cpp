#include "gliss/scene/scene.h"

#include <filesystem>

#include "gliss/base/units.h"
#include "gliss/scene/read_motion.h"
#include "gliss/scene/toml_table.h"
#include "gliss/tables/csv_reader.h"
#include "gliss/tables/point_table.h"

namespace gliss {
namespace {

constexpr Named<Patches> kPatchesNames[] = {{"all", Patches::kAll}, {"lazy", Patches::kLazy}};

std::string beside(const std::string& scene, const std::string& path) {
  return (std::filesystem::path(scene).parent_path() / path).string();
}

// A time from 0 to 1 s, of which `usual` is a sensible one.
void read_settle(TomlTable& table, double& settle, const char* usual) {
  table.get("settle", settle, parse_time);
  if (!(settle >= 0 && settle <= 1))
    table.fail("settle", fmt::format("must be from 0 to 1 s; \"{}\" is usual", usual));
}

// { static = 0.5, dynamic = 0.3, settle = "2ms" }
FrictionOptions read_friction(TomlTable table) {
  FrictionOptions friction;
  table.get("static", friction.at_rest);
  if (!(friction.at_rest >= 0 && friction.at_rest <= FrictionOptions::kMost))
    table.fail("static", fmt::format("must be from 0 to {:g}", FrictionOptions::kMost));
  friction.slipping = friction.at_rest;
  table.get("dynamic", friction.slipping);
  if (!(friction.slipping >= 0 && friction.slipping <= friction.at_rest))
    table.fail("dynamic", "must be from 0 to static");
  read_settle(table, friction.settle, "2ms");
  table.done();
  return friction;
}

// { force = "0.5N", range = "2mm" }
MagnetOptions read_magnet(TomlTable table) {
  MagnetOptions magnet;
  if (!table.has("force") || !table.has("range")) table.fail("", "needs force and range");
  table.get_positive("force", magnet.force, parse_force);
  table.get_positive("range", magnet.range, parse_length);
  table.done();
  return magnet;
}

// { kind = "grating", height = "50um", period = "2mm", along = [1, 0, 0] }
TextureOptions read_texture(TomlTable table) {
  TextureOptions texture;
  for (const char* key : {"kind", "height", "period"})
    if (!table.has(key)) table.fail("", "needs kind, height and period");
  table.get("kind", texture.relief, kReliefNames);
  table.get_positive("height", texture.height, parse_length);
  table.get_positive("period", texture.period, parse_length);
  if (table.has("along") && texture.relief != Relief::kGrating)
    table.fail("along", "goes with kind = \"grating\"");
  table.get_point("along", texture.along);
  if (texture.along.isZero(0)) table.fail("along", "must be three numbers that are not all zero");
  table.done();
  if (const double steepest = Texture(texture).steepest(); !(steepest <= Texture::kSteepest))
    table.fail("height",
               fmt::format("makes slopes up to {:.3g}; at most {:g} can be felt: lower it, "
                           "or make the period longer",
                           steepest, Texture::kSteepest));
  return texture;
}

void read_effects(TomlTable& table, EffectOptions& effects, bool lazy) {
  table.get("damping", effects.damping, parse_damping);
  if (!(effects.damping >= 0 && effects.damping <= EffectOptions::kMostDamping))
    table.fail("damping", fmt::format("must be from 0 to {:g} s/m", EffectOptions::kMostDamping));
  table.get("viscosity", effects.viscosity, parse_viscosity);
  if (!(effects.viscosity >= 0 && effects.viscosity <= EffectOptions::kMostViscosity))
    table.fail("viscosity",
               fmt::format("must be from 0 to {:g} N s/m", EffectOptions::kMostViscosity));
  if (auto magnet = table.table("magnet")) effects.magnet = read_magnet(*magnet);
  if (effects.magnet.any() && lazy)
    table.fail("magnet", "needs all patches; take patches = \"all\"");
  if (auto texture = table.table("texture")) effects.texture = read_texture(*texture);
}

void read_patches(TomlTable& table, ObjectDescription& object, bool from_cache) {
  table.get("patches", object.patches, kPatchesNames);
  const bool lazy = object.patches == Patches::kLazy;
  if (lazy && from_cache) table.fail("patches", "a cache has its patches; lazy needs a mesh");
  if (lazy && object.method != Method::kGregory)
    table.fail("patches", "lazy is for the method gregory; the others need no patches");
  if (table.has("rings") && !lazy) table.fail("rings", "goes with patches = \"lazy\"");
  table.get("rings", object.rings, 2, 100);
}

// Sets `value` to what `parse` makes of the key's text, if the key is there. Returns if it is.
template <class Value>
bool get_parsed(TomlTable& table, const std::string& key, Value& value,
                Value (*parse)(std::string_view)) {
  std::string text;
  table.get(key, text);
  if (text.empty()) return false;
  try {
    value = parse(text);
  } catch (const UnitError& error) {
    table.fail(key, error.what());
  }
  return true;
}

// Adds the files that it names to `files`, whose first is the scene's own.
ObjectDescription read_object(TomlTable table, std::size_t number, std::vector<std::string>& files,
                              const Poll& poll) {
  const std::string scene = files.front();
  ObjectDescription object;
  object.name = fmt::format("{}", number);
  table.get("name", object.name);
  const auto place_of = [&](const std::string& key) {
    return fmt::format("{} of '{}'", table.place(key), object.name);
  };
  object.place = fmt::format("{} '{}'", table.place(""), object.name);
  object.stiffness_place = place_of("stiffness");
  object.magnet_place = place_of("magnet");
  std::string mesh, cache;
  table.get("mesh", mesh);
  table.get("cache", cache);
  if (mesh.empty() == cache.empty()) table.fail("", "needs a mesh or a cache, one of them");
  object.from_cache = mesh.empty();
  object.surface = beside(scene, mesh.empty() ? cache : mesh);
  std::error_code unknown;  // a name too long for the system throws without
  if (!std::filesystem::exists(object.surface, unknown))
    table.fail(mesh.empty() ? "cache" : "mesh", fmt::format("there is no '{}'", object.surface));
  object.has_unit = get_parsed(table, "unit", object.unit, parse_unit);
  if (object.has_unit && mesh.empty()) table.fail("unit", "a cache has its own unit");
  if (table.has("precision")) table.get("precision", object.precision.emplace(), kPrecisionNames);
  table.get_positive("stiffness", object.stiffness, parse_stiffness);
  std::string level;
  table.get("level", level);
  if (!level.empty() && !(object.level = find_level(level))) table.fail("level", no_level(level));
  if (table.has("construction"))
    table.get("construction", object.construction.emplace(), kConstructionNames);
  if (mesh.empty() && (table.has("orient") || table.has("flip")))
    table.fail(table.has("orient") ? "orient" : "flip",
               "a cache is the way round that it was baked with");
  table.get("orient", object.orient, kOrientNames);
  table.get("flip", object.flip);
  if (get_parsed(table, "crease", object.creases, parse_creases) && mesh.empty())
    table.fail("crease", "a cache has the creases that it was baked with");
  if (std::string& edges = object.creases.edges; !edges.empty()) edges = beside(scene, edges);
  table.get_positive("radius", object.crease_radius, parse_length);
  if (object.crease_radius > 0 && mesh.empty())
    table.fail("radius", "a cache has the creases that it was baked with");
  if (object.crease_radius > 0 && object.creases.none)
    table.fail("radius", "rounds the edges that crease names, and there is no crease");
  table.get("method", object.method, kMethodNames);
  table.get("solver", object.solver, kSolverNames);
  table.get("iterations", object.max_iterations, 1, 10000);
  table.get("tolerance", object.tolerance);
  if (!(object.tolerance >= 0 && object.tolerance < 1))
    table.fail("tolerance", "must be 0 or more and less than 1");
  read_settle(table, object.settle, "5ms");
  if (auto friction = table.table("friction")) object.friction = read_friction(*friction);
  read_patches(table, object, mesh.empty());
  read_effects(table, object.effects, object.patches == Patches::kLazy);
  Vec3 position = Vec3::Zero();
  table.get_point("position", position);
  object.pose.translation() = position;
  if (auto rotation = table.table("rotation")) object.pose.linear() = read_rotation(*rotation);
  files.push_back(object.surface);
  if (!object.creases.edges.empty()) files.push_back(object.creases.edges);
  if (auto motion = table.table("motion")) object.motion = read_motion(*motion, files, poll);
  table.done();
  return object;
}

// {mesh = "probe.obj", unit = "mm", points = 200}
ToolDescription read_tool(TomlTable table, std::vector<std::string>& files) {
  ToolDescription tool;
  table.get("mesh", tool.mesh);
  if (tool.mesh.empty()) table.fail("", "needs a mesh");
  tool.mesh = beside(files.front(), tool.mesh);
  std::error_code unknown;
  if (!std::filesystem::exists(tool.mesh, unknown))
    table.fail("mesh", fmt::format("there is no '{}'", tool.mesh));
  files.push_back(tool.mesh);
  get_parsed(table, "unit", tool.unit, parse_unit);
  table.get("points", tool.points, 1, ToolDescription::kMostPoints);
  table.done();
  return tool;
}

void read_device(TomlTable table, Scene& scene) {
  Eigen::AlignedBox3d workspace;
  table.get_positive("max_force", scene.max_force);
  table.get_positive("max_stiffness", scene.max_stiffness, parse_stiffness);
  table.get_positive("max_torque", scene.max_torque);
  table.get_points("hips", scene.hips);
  if (auto tool = table.table("tool")) scene.tool = read_tool(*tool, scene.files);
  if (scene.tool && !scene.hips.empty()) table.fail("tool", "has HIPs of its own; leave out hips");
  const std::size_t hips =
      scene.tool ? static_cast<std::size_t>(scene.tool->points) : scene.hips.size();
  if (hips * scene.objects.size() > Tracker::kMostContacts)
    table.fail(scene.tool ? "tool" : "hips",
               fmt::format("has {} HIPs; on {} objects {} are the most", hips, scene.objects.size(),
                           Tracker::kMostContacts / scene.objects.size()));
  if (auto box = table.table("workspace")) {
    Vec3 least, most;
    if (!box->has("min") || !box->has("max")) table.fail("workspace", "needs min and max");
    box->get_point("min", least);
    box->get_point("max", most);
    box->done();
    if (!(least.array() < most.array()).all()) table.fail("workspace", "min must be below max");
    workspace = {least, most};
  }
  table.done();
  if (!scene.sim) return;
  scene.sim->workspace = workspace;
  scene.sim->max_force = std::min(scene.sim->max_force, scene.max_force);
  scene.sim->max_stiffness = std::min(scene.sim->max_stiffness, scene.max_stiffness);
  scene.sim->max_torque = std::min(scene.sim->max_torque, scene.max_torque);
}

void read_guards(TomlTable table, Scene& scene) {
  GuardLimits& limits = scene.loop.guard;
  table.get_positive("max_force", limits.max_force);
  table.get_positive("max_rate", limits.max_rate);
  table.get_positive("max_torque", limits.max_torque);
  table.get_positive("max_torque_rate", limits.max_torque_rate);
  table.get("hold_after", limits.hold_after);
  table.get("ramp_from", limits.ramp_from);
  table.get("ramp_to", limits.ramp_to);
  table.get_positive("engage_below", limits.engage_below);
  table.get("engage_ramp", limits.engage_ramp);
  table.get("reengage", scene.loop.reengage);
  table.done();
  table.checked([&] { Guard{limits}; });
}

void read_loop(TomlTable table, Scene& scene) {
  double rate = 1000;
  table.get_positive("rate", rate);
  if (!(rate >= 1 && rate <= 100000)) table.fail("rate", "must be 1 to 100000 Hz");
  scene.loop.period = Nanoseconds(std::llround(1e9 / rate));
  table.get("priority", scene.priority, 1, 99);
  table.done();
}

HandPath read_hand_path(TomlTable& table, const Poll& poll, std::vector<std::string>& files) {
  std::string path;
  table.get("path", path);
  std::vector<Vec3> waypoints;
  table.get_points("waypoints", waypoints);
  double speed = 0.1, interval = 1e-3;
  table.get_positive("speed", speed);
  table.get_positive("interval", interval, parse_time);
  int rounds = 1;
  table.get("rounds", rounds, 1, 1000000);
  if (path.empty() == waypoints.empty())
    table.fail("", "needs a path (a file) or waypoints, one of them");
  if (path.empty()) return HandPath::along(waypoints, speed, rounds);
  std::vector<Vec3> points;
  try {
    points =
        points_in_metres(read_points(files.emplace_back(beside(files.front(), path)), 1, {}, poll));
  } catch (const CsvError&) {
    throw;  // which names its own file and line
  } catch (const std::runtime_error& error) {
    table.fail("path", error.what());
  }
  if (points.empty()) table.fail("path", fmt::format("there is no point in '{}'", path));
  return HandPath::sampled(std::move(points), interval, rounds);
}

// {axis = [x, y, z], degrees = 30}, in a second; rad/s.
Vec3 read_turning(TomlTable table) {
  const AxisAngle turn = read_axis_angle(table);
  return turn.angle * turn.axis;
}

void read_sim(TomlTable table, const Poll& poll, Scene& scene) {
  table.checked([&] { scene.sim_path = read_hand_path(table, poll, scene.files); });
  SimOptions& sim = scene.sim.emplace();
  table.get_positive("mass", sim.mass);
  table.get_positive("hand_stiffness", sim.hand_stiffness, parse_stiffness);
  table.get("hand_damping", sim.hand_damping, nullptr);
  table.get("resolution", sim.resolution, parse_length);
  table.get("noise", sim.noise, parse_length);
  table.get("delay", sim.delay);
  if (auto turning = table.table("turning")) sim.turning = read_turning(*turning);
  table.get_positive("inertia", sim.inertia);
  table.get_positive("wrist_stiffness", sim.wrist_stiffness);
  table.get("wrist_damping", sim.wrist_damping, nullptr);
  int seed = 1;
  table.get("seed", seed, 0, std::numeric_limits<int>::max());
  sim.seed = static_cast<std::uint64_t>(seed);
  table.done();
  table.checked([&] { SimDevice(scene.sim_path, sim); });
}

}  // namespace

Scene read_scene(const std::string& path, const Poll& poll) {
  toml::table storage;
  TomlTable root = TomlTable::read(path, storage);
  Scene scene;
  scene.files.push_back(path);
  for (const TomlTable& table : root.tables("object")) {
    scene.objects.push_back(read_object(table, scene.objects.size() + 1, scene.files, poll));
  }
  auto guards = root.table("guards"), loop = root.table("loop");
  if (guards) read_guards(*guards, scene);
  if (loop) read_loop(*loop, scene);
  if (guards || loop) {
    TomlTable& wrong = guards && (guards->has("hold_after") || !loop) ? *guards : *loop;
    wrong.checked([&] { guard_limits(scene.loop); });
  }
  if (auto table = root.table("sim")) read_sim(*table, poll, scene);
  if (auto table = root.table("device")) read_device(*table, scene);
  root.done();
  return scene;
}

}  // namespace gliss
