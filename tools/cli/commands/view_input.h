// Opens what gliss view shows, and writes it down as a command or a scene.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "gliss/scene/scene.h"
#include "tools/cli/words/command.h"
#include "tools/view/view_session.h"

namespace gliss::tools {

struct ViewingOptions : SurfaceOptions {
  std::optional<double> stiffness, settle;  // each: as the scene or the default has it
  FrictionOptions friction{std::numeric_limits<double>::quiet_NaN()};
  EffectOptions effects;
  std::optional<Method> method;
  std::string device;  // "": the pointer's hand
  int port = 0, cpu = -1;
  double seconds = 0;  // 0: until it is interrupted
  std::string recording, replay;
  bool watch = false, open = false;
};

// True if the surface is a scene rather than a mesh or a cache.
bool is_scene(const ViewingOptions& options);
// Returns the scene of the options; that of a mesh has no objects.
Scene view_scene_of(const ViewingOptions& options);
// Opens the objects, built as a page has chosen, for a device; null: the pointer's hand. Where
// nobody has told the unit of a mesh, guesses one that a hand can touch, and sets it. Throws
// InputError, and what the readers throw.
ViewScene open_view(ViewingOptions& options, const BuildChoice& build, const DeviceInfo* device);
// Returns the command that shows the same, without --method, --stiffness, --friction, --settle and
// --texture.
std::string view_command(const ViewingOptions& options, const BuildChoice& build);
// Writes a scene that feels the same, and returns its path: beside the scene that is shown, or of a
// mesh in the folder where the program runs. Throws as AtomicFile and read_scene.
std::string save_view(const ViewingOptions& options, const BuildChoice& build,
                      const TuneMessage& tuning);

}  // namespace gliss::tools
