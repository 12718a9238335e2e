// A scene: the objects and the rules that a TOML file gives a loop; docs/scenes.md has an example.
// Objects and features that a scene does not list cost nothing.
#pragma once

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/base/poll.h"
#include "gliss/contact/motion.h"
#include "gliss/device/device.h"
#include "gliss/device/sim_device.h"
#include "gliss/loop/loop.h"
#include "gliss/mesh/creases.h"
#include "gliss/query/effects.h"
#include "gliss/query/query.h"
#include "gliss/surface/patch_cache.h"
#include "gliss/validate/validate.h"

namespace gliss {

// what() names the file, the line and the key.
struct GLISS_EXPORT SceneError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The patches of an object that are built: all before the loop begins, or in it those near the
// hand.
enum class Patches { kAll, kLazy };

// An [[object]]. Numbers without a unit are SI.
struct ObjectDescription : SolverOptions {
  // "scene.toml:3: object 'knot'", for messages, and the same with the lines of two keys.
  std::string place, stiffness_place, magnet_place;
  std::string name;
  std::string surface;  // path of a mesh or a cache, from the scene's folder
  bool from_cache = false;
  double unit = 1;                           // m, of a mesh's coordinates
  bool has_unit = false;                     // the scene says so
  std::optional<Precision> precision;        // as the cache has it, or double
  std::optional<Level> level;                // as the cache has it, or exact
  std::optional<Construction> construction;  // as the cache has it, or fair
  Orient orient = Orient::kOutward;          // of a mesh, like the next three
  bool flip = false;                         // open parts
  CreaseRules creases{};                     // of a mesh; paths from the scene's folder
  double crease_radius = 0;                  // m, that they are rounded by; 0: they stay sharp
  double stiffness = 500;                    // N/m
  double settle = kSettleTime;               // s; 0: contacts leap (QueryOptions::settle)
  FrictionOptions friction{};
  EffectOptions effects{};
  Method method = Method::kGregory;
  Pose pose = Pose::Identity();
  std::shared_ptr<const Motion> motion;  // null: it rests
  Patches patches = Patches::kAll;
  int rings = 3;  // around the contact, with kLazy
};

// A tool whose HIPs are vertices of a mesh, spread over it.
struct ToolDescription {
  static constexpr int kMostPoints = 1000;
  std::string mesh;  // path, from the scene's folder
  double unit = 1;   // m
  int points = 100;  // at most
};

struct Scene {
  std::vector<ObjectDescription> objects;
  std::vector<Vec3> hips;               // m, from the device's position; empty: one, there
  std::optional<ToolDescription> tool;  // in place of `hips`
  LoopOptions loop;                     // of [loop] and [guards]
  int priority = 80;                    // of SCHED_FIFO
  // Limits of [device], in addition to the device's own.
  double max_force = std::numeric_limits<double>::infinity();      // N
  double max_stiffness = std::numeric_limits<double>::infinity();  // N/m
  double max_torque = std::numeric_limits<double>::infinity();     // N m
  std::optional<SimOptions> sim;
  HandPath sim_path;
  std::vector<std::string> files;  // paths: the scene's own, of meshes, caches, motions, the sim's
                                   // path
};

// Throws SceneError, CsvError for the table of a path.
GLISS_EXPORT Scene read_scene(const std::string& path, const Poll& poll = {});

}  // namespace gliss
