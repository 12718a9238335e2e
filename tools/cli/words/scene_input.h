// The objects of a scene, for commands: opened with progress, on all threads, and with Ctrl-C.
#pragma once

#include <vector>

#include "gliss/scene/open_scene.h"

namespace gliss::tools {

// Opens the objects with so many threads; 0: all. Where `quiet`, nothing is said of repairs and
// progress. Throws as gliss::open_objects, and Interrupted.
std::vector<SceneObject> open_scene_objects(const Scene& scene, int threads, bool quiet);

}  // namespace gliss::tools
