// gliss view: a mesh or scene under the pointer of a browser, with the methods beside one another.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <utility>

#include "gliss/base/units.h"
#include "gliss/files/cache_file.h"
#include "gliss/files/mesh_file.h"
#include "gliss/scene/open_scene.h"
#include "gliss/tables/result_table.h"
#include "tools/cli/commands/commands.h"
#include "tools/cli/terminal/interrupt.h"
#include "tools/cli/terminal/terminal.h"
#include "tools/cli/terminal/watch.h"
#include "tools/cli/words/outputs.h"
#include "tools/cli/words/scene_input.h"
#include "tools/cli/words/surface_input.h"
#include "tools/report/report_page.h"
#include "tools/view/view_session.h"

namespace gliss::tools {
namespace {

constexpr double kAsTheSceneHas = std::numeric_limits<double>::quiet_NaN();

struct ViewingOptions : SurfaceOptions {
  std::optional<double> stiffness, settle;  // each: as the scene or the default has it
  FrictionOptions friction{kAsTheSceneHas};
  std::optional<Method> method;
  int port = 0, cpu = -1;
  double seconds = 0;  // 0: until it is interrupted
  std::string recording;
};

void describe(Command& command, ViewingOptions& options) {
  add_surface_options(command, options, "MESH_OR_SCENE");
  add_name_option(command,
                  {"--method", "NAME",
                   "the hand feels gregory (default), shaded or flat; others "
                   "are tracked beside it"},
                  options.method, kMethodNames);
  command.option({"--stiffness", "STIFFNESS", "stiffness: force over depth; default 0.5N/mm"},
                 [&](const std::string& text) { options.stiffness = positive_stiffness(text); });
  command.option(
      {"--settle", "TIME",
       "when the nearest point leaps elsewhere, the contact slides there: the time in "
       "which the force changes by 20 % meanwhile; 0: it leaps; default 5ms"},
      [&](const std::string& text) {
        options.settle = parse_time(text);
        if (!(*options.settle >= 0 && *options.settle <= kMostSettleTime))
          throw InputError(fmt::format("--settle: '{}' is not from 0 to 1 s; 5ms is usual", text));
      });
  add_friction_options(command, options.friction);
  command.option({"--port", "PORT", "port on 127.0.0.1; 0, the default: any free one"},
                 options.port, 0, 65535);
  command.option(
      {"-o,--record", "FILE", "record each tick from the first: .h5, .hdf5 or .csv"},
      [&](const std::string& path) {
        if (!path.ends_with(".csv") && !path.ends_with(".h5") && !path.ends_with(".hdf5"))
          throw InputError(fmt::format("'{}' must end in .h5, .hdf5 or .csv", path));
        options.recording = path;
      });
  command.option({"--seconds", "SECONDS", "end after this time; default: when interrupted"},
                 options.seconds, 1e-3, 1e7);
  add_cpu_option(command, options.cpu);
}

#ifdef GLISS_WITH_REPORT

constexpr char kTokenVariable[] = "GLISS_VIEW_TOKEN";

// A new one, or that of the environment, with which pages find a server again.
std::string token() {
  const char* given = std::getenv(kTokenVariable);
  if (given == nullptr) return make_view_token();
  if (!is_view_token(given))
    throw InputError(
        fmt::format("{}: must be 32 digits and letters a to f, of 128 random bits: "
                    "export {}=$(openssl rand -hex 16)",
                    kTokenVariable, kTokenVariable));
  return given;
}

// The unit in which a mesh of that diagonal is nearest to a tenth of a metre.
std::pair<const char*, double> likely_unit(double diagonal) {
  constexpr std::array<std::pair<const char*, double>, 4> kUnits = {
      {{"m", 1}, {"mm", 1e-3}, {"um", 1e-6}, {"nm", 1e-9}}};
  auto best = kUnits.front();
  const auto away = [&](double unit) { return std::abs(std::log(diagonal * unit / 0.1)); };
  for (const auto& unit : kUnits) {
    if (away(unit.second) < away(best.second)) best = unit;
  }
  return best;
}

// A mesh whose unit nobody has told is given one in which a hand can touch it.
void guess_unit(ViewingOptions& options, Mesh& mesh) {
  const bool has_lengths = options.weld > 0 || options.crease_radius > 0;
  const double diagonal = diagonal_of(gliss::box_of(mesh));
  if (options.has_unit || has_lengths || !(diagonal > 0)) return;
  const auto [name, unit] = likely_unit(diagonal);
  mesh.unit = options.unit = unit;
  options.has_unit = true;
  if (!options.quiet)
    tell(fmt::format("gliss: {}: no --unit: taken as {}, so that it is {:.3g} mm across\n",
                     options.surface, name, 1e3 * diagonal * unit));
}

bool is_scene(const std::string& path) {
  return path.ends_with(".toml") || (!is_meant_as_cache(path) && !has_mesh_ending(path));
}

PatchCache open_whole(ViewingOptions& options) {
  const auto engine = make_engine(options);
  if (is_cache(options)) return read_cache(options);
  Mesh mesh = read_mesh(options);
  guess_unit(options, mesh);
  return build(mesh, options, *engine);
}

void open_mesh(ViewingOptions& options, ViewSetting& setting) {
  SceneObject object;
  object.cache = std::make_shared<const PatchCache>(open_whole(options));
  setting.objects = {object};
  setting.names = {std::filesystem::path(options.surface).filename().string()};
  setting.rules.guard = guard_limits(setting.rules);
}

void check_scene_options(const ViewingOptions& options) {
  if (options.has_unit || options.precision || options.level || options.construction ||
      !options.creases.are_usual() || options.crease_radius > 0)
    throw InputError(fmt::format(
        "{}: a scene says itself how its objects are built; --unit, --precision, --level, "
        "--construction and creases go with a mesh",
        options.surface));
}

void open_scene(const ViewingOptions& options, ViewSetting& setting) {
  check_scene_options(options);
  const Scene scene = read_scene(options.surface, stop_if_interrupted);
  if (scene.objects.empty())
    throw InputError(fmt::format("{}: there is no [[object]] to view", options.surface));
  for (const ObjectDescription& object : scene.objects) {
    if (object.motion != nullptr || object.patches == Patches::kLazy)
      throw InputError(fmt::format(
          "{}: gliss view shows neither objects that move nor lazy ones; gliss run touches them",
          object.place));
    setting.names.push_back(object.name);
  }
  setting.objects = open_scene_objects(scene, options.threads, options.quiet);
  setting.hips = open_hips(scene, {.poll = stop_if_interrupted});
  if (scene.sim) setting.hand = *scene.sim;
  setting.hand.turning.reset();
  setting.hand.max_force = std::min(setting.hand.max_force, scene.max_force);
  setting.hand.max_stiffness = std::min(setting.hand.max_stiffness, scene.max_stiffness);
  DeviceInfo device;
  device.max_stiffness = setting.hand.max_stiffness;
  setting.rules = loop_options(scene, device);
  setting.session.scheduling.priority = scene.priority;
}

void tune(const ViewingOptions& options, ViewSetting& setting) {
  for (SceneObject& object : setting.objects) {
    object.method = options.method.value_or(object.method);
    object.stiffness = options.stiffness.value_or(object.stiffness);
    object.settle = options.settle.value_or(object.settle);
    if (!std::isnan(options.friction.at_rest)) object.friction = options.friction;
    if (object.stiffness > setting.hand.max_stiffness)
      throw InputError(fmt::format("--stiffness: the simulated hand takes {:g} N/m at most",
                                   setting.hand.max_stiffness));
  }
}

// The command that shows the same, but for --method, --stiffness, --friction and --settle.
std::string command_of(const ViewingOptions& options) {
  std::string command = fmt::format("gliss view '{}'", options.surface);
  if (is_scene(options.surface) || is_cache(options)) return command;
  for (const auto& [name, unit] : {std::pair{"m", 1.0},
                                   {"cm", 1e-2},
                                   {"mm", 1e-3},
                                   {"um", 1e-6},
                                   {"nm", 1e-9},
                                   {"in", 0.0254}}) {
    if (options.unit == unit) command += fmt::format(" --unit {}", name);
  }
  if (options.level) command += fmt::format(" --level {}", level_name(*options.level));
  if (options.construction)
    command += fmt::format(" --construction {}", construction_name(*options.construction));
  if (options.precision)
    command += fmt::format(" --precision {}", precision_name(*options.precision));
  return command;
}

// Opens what is to be viewed. Throws InputError, and what the readers throw.
ViewSetting setting_of(ViewingOptions& options) {
  ViewSetting setting;
  if (is_scene(options.surface)) {
    open_scene(options, setting);
  } else {
    open_mesh(options, setting);
  }
  setting.rules.reengage = true;  // a page that was silent for a moment may go on
  if (options.friction.settle > 0 && std::isnan(options.friction.at_rest))
    throw InputError("--friction-settle goes with --friction");
  tune(options, setting);
  setting.token = token();
  setting.page = kViewPage;
  setting.title = std::filesystem::path(options.surface).filename().string();
  setting.command = command_of(options);
  setting.port = static_cast<std::uint16_t>(options.port);
  setting.recording = options.recording;
  setting.free_recordings = options.recording.empty() ? "gliss-view.h5" : options.recording;
  setting.session.seconds = options.seconds;
  setting.session.scheduling.cpu = options.cpu;
  setting.provenance = {{"program", "gliss"},
                        {"version", GLISS_VERSION},
                        {"command_line", command_line()},
                        {"scene", options.surface},
                        {"device", "view"}};
  return setting;
}

// Serves until the loop ends or Ctrl-C is pressed.
void serve(ViewSession& session, bool quiet) {
  tell(fmt::format("{}\n", session.url()));
  if (!quiet)
    tell("open it in a browser of this machine; from elsewhere: ssh -L PORT:127.0.0.1:PORT\n");
  for (bool told = quiet; session.turn() && !interrupted();) {
    const auto grants = told ? std::nullopt : session.loop().grants();
    if (!grants) continue;
    for (const std::string& line : grants->refusals) tell(fmt::format("gliss: {}\n", line));
    told = true;
  }
  session.end();
}

void report_end(const ViewingOptions& options, const ViewSession& session) {
  const TickRecord& record = session.loop().loop().record();
  const ViewServer::Counts& counts = session.counts();
  std::string text = fmt::format(
      "{} ticks, {} missed, {} in contact; {} pages, {} refused, {} closed, {} frames lost\n",
      record.ticks(), record.missed(), session.touched(), counts.pages, counts.refused,
      counts.closed, counts.frames_lost);
  for (const std::string& file : session.recorded()) text += fmt::format("recorded {}\n", file);
  report(options, text,
         {{"ticks", record.ticks()},
          {"missed", record.missed()},
          {"in_contact", session.touched()},
          {"pages", counts.pages},
          {"refused", counts.refused},
          {"closed", counts.closed},
          {"frames_lost", counts.frames_lost},
          {"recorded", session.recorded()}});
}

void run(ViewingOptions options) {
  check_input("MESH_OR_SCENE", options.surface);
  check_outputs({options.recording}, {options.surface});
  ViewSession session(setting_of(options));
  serve(session, options.quiet);
  report_end(options, session);
  if (!session.failure().empty()) throw std::runtime_error(session.failure());
  stop_if_interrupted();
}

#else

void run(const ViewingOptions&) {
  throw Unavailable(
      "this build has no page for gliss view: install npm with Node.js 18 or later, and build "
      "again with -DGLISS_REPORT=ON");
}

#endif

}  // namespace

void add_view(Command& program) {
  add_command<ViewingOptions>(
      program, "view",
      "Touch a mesh or scene with the pointer of a browser: flat, shaded and Gregory force beside "
      "one another.\n"
      "It serves one page on 127.0.0.1 and says where. The page pulls a simulated hand, 1000 times "
      "a second; after 100 ms without a word of it there is no force. docs/view.md tells more.",
      "gliss view knot.obj --unit mm", describe, run);
}

}  // namespace gliss::tools
