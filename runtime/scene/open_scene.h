// From a scene to what a loop runs: its objects, and its rules for a device.
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/base/poll.h"
#include "gliss/build/build_cache.h"
#include "gliss/contact/tracker.h"
#include "gliss/scene/scene.h"

namespace gliss {

// The ways to read and to build what a scene names.
struct SceneOpening {
  // Null: load_mesh with the description's unit.
  std::function<Mesh(const ObjectDescription& described)> read_mesh = nullptr;
  // Null: build_cache on one thread.
  std::function<PatchCache(const Mesh& mesh, const BuildOptions& options)> build = nullptr;
  Poll poll = {};
};

// Opens the objects of a scene, in its order, for a Tracker. Caches are loaded, and other patches
// are built, or near the hand later where the scene says lazy and the mesh permits it
// (LazyMesh::needs_all). Throws MeshError, CacheError,
// NoFileError, std::system_error.
GLISS_EXPORT std::vector<SceneObject> open_objects(const Scene& scene,
                                                   const SceneOpening& opening = {});

// The HIPs of a scene's tool, for a Tracker: those that it lists, or points of its mesh. Throws
// MeshError, NoFileError, std::system_error.
GLISS_EXPORT std::vector<Vec3> open_hips(const Scene& scene, const SceneOpening& opening = {});

// Returns the box of an object in the world's frame, m: that of its cache, which it must have.
GLISS_EXPORT Eigen::AlignedBox3d box_of(const SceneObject& object);

// The rules of a loop with these objects under a device: the scene's, and no force or torque
// above what the scene allows. Throws SceneError where an object is stiffer than the scene or the
// device permits: such a surface may shake the hand.
GLISS_EXPORT LoopOptions loop_options(const Scene& scene, const DeviceInfo& device);

}  // namespace gliss
