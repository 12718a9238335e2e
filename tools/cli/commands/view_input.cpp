#include "tools/cli/commands/view_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <sstream>
#include <utility>

#include "gliss/files/atomic_file.h"
#include "gliss/files/cache_file.h"
#include "gliss/files/mesh_file.h"
#include "gliss/results/lengths.h"
#include "gliss/scene/open_scene.h"
#include "gliss/scene/toml_table.h"
#include "gliss/surface/names.h"
#include "tools/cli/terminal/terminal.h"
#include "tools/cli/terminal/watch.h"
#include "tools/cli/words/scene_input.h"
#include "tools/cli/words/surface_input.h"

namespace gliss::tools {
namespace {

// Returns the unit in which a mesh of that diagonal is nearest to a tenth of a metre.
double likely_unit(double diagonal) {
  const auto away = [&](double unit) { return std::abs(std::log(diagonal * unit / 0.1)); };
  constexpr std::array<double, 4> kUnits = {1, 1e-3, 1e-6, 1e-9};
  return *std::min_element(kUnits.begin(), kUnits.end(),
                           [&](double one, double other) { return away(one) < away(other); });
}

void guess_unit(ViewingOptions& options, Mesh& mesh) {
  const bool has_lengths = options.weld > 0 || options.crease_radius > 0;
  const double diagonal = diagonal_of(gliss::box_of(mesh));
  if (options.has_unit || has_lengths || !(diagonal > 0)) return;
  mesh.unit = options.unit = likely_unit(diagonal);
  options.has_unit = true;
  if (!options.quiet)
    tell(fmt::format("gliss: {}: no --unit: taken as {}, so that it is {:.3g} mm across\n",
                     options.surface, unit_name(options.unit), 1e3 * diagonal * options.unit));
}

// Puts a choice into options or a description of an object.
void choose(const BuildChoice& build, auto& to) {
  if (!build) return;
  to.level = build->level;
  to.construction = build->level.construction;
  if (!build->crease) return;
  to.creases = {};
  to.creases.none = *build->crease >= 180;
  if (!to.creases.none) to.creases.angle = *build->crease * std::numbers::pi / 180;
  if (to.creases.none) to.crease_radius = 0;
}

[[noreturn]] void refuse_choice(const std::string& place) {
  throw InputError(fmt::format("{}: a cache is as it was baked", place));
}

PatchCache open_whole(ViewingOptions& options, const BuildChoice& build) {
  const auto engine = make_engine(options);
  if (is_cache(options)) {
    if (build) refuse_choice(options.surface);
    return read_cache(options);
  }
  SurfaceOptions chosen = options;
  choose(build, chosen);
  Mesh mesh = read_mesh(chosen);
  guess_unit(options, mesh);
  return tools::build(mesh, chosen, *engine);
}

void check_scene_options(const ViewingOptions& options) {
  if (options.has_unit || options.precision || options.level || options.construction ||
      !options.creases.are_usual() || options.crease_radius > 0)
    throw InputError(fmt::format(
        "{}: a scene says itself how its objects are built; --unit, --precision, --level, "
        "--construction and creases go with a mesh",
        options.surface));
}

void open_listed(const ViewingOptions& options, const BuildChoice& build, Scene& scene,
                 ViewScene& view) {
  check_scene_options(options);
  if (scene.objects.empty())
    throw InputError(fmt::format("{}: there is no [[object]] to view", options.surface));
  for (ObjectDescription& object : scene.objects) {
    if (object.motion != nullptr || object.patches == Patches::kLazy)
      throw InputError(fmt::format(
          "{}: gliss view shows neither objects that move nor lazy ones; gliss run touches them",
          object.place));
    if (build && object.from_cache) refuse_choice(object.place);
    choose(build, object);
    view.names.push_back(object.name);
  }
  view.objects = open_scene_objects(scene, options.threads, options.quiet);
  view.hips = open_hips(scene, {.poll = stop_if_interrupted});
  view.files = scene.files;
}

void feel_as_told(const ViewingOptions& options, ViewScene& view) {
  for (SceneObject& object : view.objects) {
    object.method = options.method.value_or(object.method);
    object.stiffness = options.stiffness.value_or(object.stiffness);
    object.settle = options.settle.value_or(object.settle);
    if (!std::isnan(options.friction.at_rest)) object.friction = options.friction;
    if (options.effects.any()) object.effects = options.effects;
    if (object.stiffness > view.max_stiffness)
      throw InputError(
          fmt::format("--stiffness: the hand takes {:g} N/m at most", view.max_stiffness));
  }
}

SimOptions hand_of(const Scene& scene) {
  SimOptions hand = scene.sim.value_or(SimOptions{});
  hand.turning.reset();
  hand.max_force = std::min(hand.max_force, scene.max_force);
  hand.max_stiffness = std::min(hand.max_stiffness, scene.max_stiffness);
  return hand;
}

// The table of a mesh, as the options have it.
toml::table object_of(const ViewingOptions& options) {
  const std::filesystem::path path(options.surface);
  toml::table object{{"name", path.filename().string()},
                     {is_cache(options) ? "cache" : "mesh", path.string()}};
  if (is_cache(options)) return object;
  object.insert("unit", unit_name(options.unit));
  if (options.level) object.insert("level", level_name(*options.level));
  if (options.construction) object.insert("construction", construction_name(*options.construction));
  if (options.precision) object.insert("precision", precision_name(*options.precision));
  return object;
}

void write_feel(const BuildChoice& build, const TuneMessage& tuning, toml::table& object) {
  if (build) {
    object.insert_or_assign("level", level_name(build->level));
    object.insert_or_assign("construction", construction_name(build->level.construction));
    if (build->crease)
      object.insert_or_assign(
          "crease", *build->crease >= 180 ? "none" : fmt::format("{:g}deg", *build->crease));
  }
  object.insert_or_assign("method", method_name(tuning.method));
  object.insert_or_assign("stiffness", tuning.stiffness);
  object.insert_or_assign("settle", fmt::format("{:g}ms", 1e3 * tuning.settle));
  object.insert_or_assign("friction", toml::table{{"static", tuning.friction.at_rest},
                                                  {"dynamic", tuning.friction.slipping},
                                                  {"settle", tuning.friction.settle}});
  if (!tuning.texture.any()) {
    object.erase("texture");
    return;
  }
  toml::table texture{{"kind", name_of(kReliefNames, tuning.texture.relief)},
                      {"height", tuning.texture.height},
                      {"period", tuning.texture.period}};
  if (const toml::array* along = object["texture"]["along"].as_array())
    if (tuning.texture.relief == Relief::kGrating) texture.insert("along", *along);
  object.insert_or_assign("texture", std::move(texture));
}

}  // namespace

bool is_scene(const ViewingOptions& options) {
  const std::string& path = options.surface;
  return path.ends_with(".toml") || (!is_meant_as_cache(path) && !has_mesh_ending(path));
}

Scene view_scene_of(const ViewingOptions& options) {
  return is_scene(options) ? read_scene(options.surface, stop_if_interrupted) : Scene{};
}

ViewScene open_view(ViewingOptions& options, const BuildChoice& build, const DeviceInfo* device) {
  ViewScene view;
  Scene scene = view_scene_of(options);
  if (is_scene(options)) {
    open_listed(options, build, scene, view);
  } else {
    SceneObject object;
    object.cache = std::make_shared<const PatchCache>(open_whole(options, build));
    view.objects = {object};
    view.names = {std::filesystem::path(options.surface).filename().string()};
    view.files = {options.surface};
  }
  constexpr double kMost = 1e4;  // N/m, of a device that knows no limit
  view.hand = hand_of(scene);
  view.max_stiffness = std::min(
      {kMost, scene.max_stiffness, device ? device->max_stiffness : view.hand.max_stiffness});
  DeviceInfo limits = device ? *device : DeviceInfo{};
  if (!device) limits.name = "the simulated hand";
  limits.max_stiffness = std::min(limits.max_stiffness, view.max_stiffness);
  view.rules = loop_options(scene, limits);
  view.rules.guard = guard_limits(view.rules);
  view.rules.reengage |= device == nullptr;  // a page that was silent for a moment may go on
  feel_as_told(options, view);
  return view;
}

std::string view_command(const ViewingOptions& options, const BuildChoice& build) {
  std::string command = fmt::format("gliss view '{}'", options.surface);
  if (is_scene(options) || is_cache(options)) return command;
  command += fmt::format(" --unit '{}'", unit_name(options.unit));
  SurfaceOptions chosen = options;
  choose(build, chosen);
  if (chosen.level) command += fmt::format(" --level {}", level_name(*chosen.level));
  if (chosen.construction)
    command += fmt::format(" --construction {}", construction_name(*chosen.construction));
  if (chosen.precision)
    command += fmt::format(" --precision {}", precision_name(*chosen.precision));
  if (build && build->crease)
    command +=
        chosen.creases.none ? " --crease none" : fmt::format(" --crease {:g}deg", *build->crease);
  return command;
}

std::string save_view(const ViewingOptions& options, const BuildChoice& build,
                      const TuneMessage& tuning) {
  const std::filesystem::path from(options.surface);
  toml::table root;
  std::string path = from.stem().string() + "-view.toml";
  if (is_scene(options)) {
    TomlTable::read(options.surface, root);
    path = (from.parent_path() / path).string();
  } else {
    root.insert("object", toml::array{object_of(options)});
  }
  for (toml::node& object : *root["object"].as_array())
    write_feel(build, tuning, *object.as_table());
  std::ostringstream text;
  text << root << '\n';
  AtomicFile file(free_name(path));
  file.write(text.str());
  file.commit();
  return file.path();
}

}  // namespace gliss::tools
