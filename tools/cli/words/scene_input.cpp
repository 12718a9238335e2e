#include "tools/cli/words/scene_input.h"

#include "tools/cli/terminal/watch.h"
#include "tools/cli/words/surface_input.h"

namespace gliss::tools {

std::vector<SceneObject> open_scene_objects(const Scene& scene, int threads, bool quiet) {
  const auto engine = make_tbb_engine(threads, stop_if_interrupted);
  SurfaceOptions surface;
  surface.threads = threads;
  surface.quiet = quiet;
  SceneOpening opening;
  opening.read_mesh = [&](const ObjectDescription& described) {
    surface.surface = described.surface;
    surface.unit = described.unit;
    surface.has_unit = described.has_unit;
    surface.in_scene = true;
    surface.orient = described.orient;
    surface.flip = described.flip;
    surface.creases = described.creases;
    surface.crease_radius = described.crease_radius;
    return read_mesh(surface);
  };
  opening.build = [&](const Mesh& mesh, const BuildOptions& wanted) {
    surface.precision = wanted.precision;
    surface.level = wanted.level;
    surface.construction = wanted.level.construction;
    return build(mesh, surface, *engine);
  };
  opening.poll = stop_if_interrupted;
  return open_objects(scene, opening);
}

}  // namespace gliss::tools
