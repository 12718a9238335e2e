// gliss view: a mesh or scene under the pointer of a browser, with the methods beside one another.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>

#include "gliss/base/units.h"
#include "tools/cli/commands/browser.h"
#include "tools/cli/commands/commands.h"
#include "tools/cli/commands/scene_device.h"
#include "tools/cli/commands/view_input.h"
#include "tools/cli/terminal/interrupt.h"
#include "tools/cli/terminal/terminal.h"
#include "tools/cli/terminal/watch.h"
#include "tools/cli/words/outputs.h"
#include "tools/report/report_page.h"

namespace gliss::tools {
namespace {

void describe_feel(Command& command, ViewingOptions& options) {
  add_name_option(command,
                  {"--method", "NAME",
                   "the hand feels gregory (default), shaded or flat; others "
                   "are tracked beside it"},
                  options.method, kMethodNames);
  command.option({"--stiffness", "STIFFNESS", "stiffness: force over depth; default 0.5N/mm"},
                 [&](const std::string& text) { options.stiffness = positive_stiffness(text); });
  add_settle_option(command, options.settle);
  add_friction_options(command, options.friction);
  add_effect_options(command, options.effects);
}

void describe(Command& command, ViewingOptions& options) {
  add_surface_options(command, options, "MESH_OR_SCENE");
  describe_feel(command, options);
  add_device_option(command, options.device, "the pointer of the page");
  command.option({"--port", "PORT", "port on 127.0.0.1; 0, the default: any free one"},
                 options.port, 0, 65535);
  command.flag("--open", options.open, "open the page in a browser, by xdg-open");
  command.flag("--watch", options.watch, "read the mesh or scene again when its file changes");
  add_record_option(command, "record each tick from the first", options.recording);
  command.option({"--replay", "FILE", "move the hand along a path first, such as a recording"},
                 options.replay);
  command.option({"--seconds", "SECONDS", "end after this time; default: when interrupted"},
                 options.seconds, 1e-3, 1e7);
  add_cpu_option(command, options.cpu);
}

#ifdef GLISS_WITH_REPORT

constexpr char kTokenVariable[] = "GLISS_VIEW_TOKEN";

// Returns a new one, or that of the environment, with which pages find a server again.
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

// The functions that the session calls from two threads; the first call opens for the first time,
// and says what was repaired.
void set_doings(const ViewingOptions& options, ViewSetting& setting) {
  const auto shared = std::make_shared<ViewingOptions>(options);
  std::optional<DeviceInfo> device;
  if (setting.device) device = setting.device->info();
  setting.open = [shared, device](const BuildChoice& build) {
    ViewScene scene = open_view(*shared, build, device ? &*device : nullptr);
    shared->quiet = true;
    return scene;
  };
  setting.command = [shared](const BuildChoice& build) { return view_command(*shared, build); };
  setting.save = [shared](const BuildChoice& build, const TuneMessage& tuning) {
    return save_view(*shared, build, tuning);
  };
}

ViewSetting setting_of(const ViewingOptions& options) {
  if (options.friction.settle > 0 && std::isnan(options.friction.at_rest))
    throw InputError("--friction-settle goes with --friction");
  ViewSetting setting;
  const Scene scene = view_scene_of(options);
  if (!options.device.empty()) setting.device = open_scene_device(options.device, scene);
  setting.session.scheduling.priority = scene.priority;
  set_doings(options, setting);
  setting.token = token();
  setting.page = kViewPage;
  setting.title = std::filesystem::path(options.surface).filename().string();
  setting.port = static_cast<std::uint16_t>(options.port);
  setting.recording = options.recording;
  setting.free_recordings = options.recording.empty() ? "gliss-view.h5" : options.recording;
  setting.replay = options.replay;
  setting.watch = options.watch;
  setting.session.seconds = options.seconds;
  setting.session.scheduling.cpu = options.cpu;
  setting.provenance = {{"program", "gliss"},
                        {"version", GLISS_VERSION},
                        {"command_line", command_line()},
                        {"scene", options.surface},
                        {"device", options.device.empty() ? "view" : options.device}};
  return setting;
}

// Serves until the loop ends or Ctrl-C is pressed.
void serve(ViewSession& session, bool quiet) {
  tell(fmt::format("{}\n", session.url()));
  if (!quiet)
    tell("open it in a browser of this machine; from elsewhere: ssh -L PORT:127.0.0.1:PORT\n");
  for (bool told = quiet; session.turn() && !interrupted();) {
    const auto grants = told || !session.loop() ? std::nullopt : session.loop()->grants();
    if (!grants) continue;
    for (const std::string& line : grants->refusals) tell(fmt::format("gliss: {}\n", line));
    told = true;
  }
  session.end();
}

void report_end(const ViewingOptions& options, const ViewSession& session) {
  if (!session.loop()) return;
  const TickRecord& record = session.loop()->loop().record();
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

void run(const ViewingOptions& options) {
  check_input("MESH_OR_SCENE", options.surface);
  check_outputs({options.recording}, {options.surface, options.replay});
  if (!options.device.empty() && !options.replay.empty())
    throw InputError("--replay: a device moves itself; --device replay:FILE is another");
  ViewSession session(setting_of(options));
  std::optional<BrowserWindow> window;
  if (options.open) window.emplace(session.url());
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
