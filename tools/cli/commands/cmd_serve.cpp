// gliss serve: a device for a loop in another process of this machine.
#include <fmt/format.h>

#include <algorithm>

#include "gliss/device/udp_server.h"
#include "gliss/thread/realtime.h"
#include "tools/cli/commands/commands.h"
#include "tools/cli/commands/scene_device.h"
#include "tools/cli/terminal/interrupt.h"
#include "tools/cli/terminal/terminal.h"
#include "tools/cli/terminal/watch.h"
#include "tools/cli/words/command.h"

namespace gliss::tools {
namespace {

struct ServeOptions : ReportOptions {
  std::string scene, device = "sim";
  int port = 10002, cpu = -1;
  double seconds = 0;  // 0: until it is interrupted
  bool at_once = false;
};

void describe(Command& command, ServeOptions& options) {
  add_scene_option(command, options.scene, "scene file (.toml): its [sim] and [device]");
  add_device_option(command, options.device);
  command.option({"--port", "PORT", "UDP port on 127.0.0.1; 0: any free one; default 10002"},
                 options.port, 0, 65535);
  command.option({"--seconds", "SECONDS", "end after this time; default: when interrupted"},
                 options.seconds, 1e-3, 1e7);
  add_cpu_option(command, options.cpu);
  command.flag("--at-once", options.at_once,
               "start the hand of sim and replay now, not when the first loop comes");
}

void run(const ServeOptions& options) {
  const Scene scene = read_scene(options.scene, stop_if_interrupted);
  const auto device = open_scene_device(options.device, scene);
  UdpServerOptions limits;
  limits.guard = scene.loop.guard;
  limits.guard->max_force = std::min(limits.guard->max_force, scene.max_force);
  limits.guard->max_torque = std::min(limits.guard->max_torque, scene.max_torque);
  const bool has_path = options.device == "sim" || !replayed_file(options.device).empty();
  limits.waits = has_path && !options.at_once;
  UdpServer server(*device, static_cast<std::uint16_t>(options.port), limits);
  if (!options.quiet)
    tell(fmt::format("serving {0} as udp:{1}\ngliss run SCENE --device udp:{1} attaches a loop\n",
                     device->info().name, server.port()));
  {
    const Realtime realtime({.priority = scene.priority, .cpu = options.cpu});
    std::vector<std::string> refusals = realtime.refusals();
    for (const std::string& line : device->refusals()) refusals.push_back(line);
    for (const std::string& line : refusals) {
      if (!options.quiet) tell(fmt::format("gliss: {}\n", line));
    }
    const Stopwatch clock;
    server.run([&] {
      return interrupted() || (options.seconds > 0 && clock.seconds() >= options.seconds);
    });
  }
  const UdpServerCounts& counts = server.counts();
  report(options,
         fmt::format("{} loops, {} datagrams from them, {} to them, {} rejected, {} refused, {} "
                     "ignored; the watchdog took the force away {}x, {} loops died\n",
                     counts.peers, counts.received, counts.sent, counts.rejected, counts.refused,
                     counts.ignored, counts.watchdog_trips, counts.lost),
         {{"loops", counts.peers},
          {"received", counts.received},
          {"sent", counts.sent},
          {"rejected", counts.rejected},
          {"refused", counts.refused},
          {"ignored", counts.ignored},
          {"watchdog_trips", counts.watchdog_trips},
          {"lost", counts.lost}});
  stop_if_interrupted();
}

}  // namespace

void add_serve(Command& program) {
  add_command<ServeOptions>(
      program, "serve",
      "Give a device to a loop in another process: gliss run SCENE --device udp:PORT.\n"
      "The device has no force unless that loop sent one in the last 20 ms, and no more than the "
      "scene's [guards] let through. Loops of this user alone are served.",
      "gliss serve scene.toml --device sim --port 10002", describe, run);
}

}  // namespace gliss::tools
