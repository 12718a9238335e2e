#include "gliss/scene/open_scene.h"

#include <fmt/format.h>

#include <algorithm>

#include "gliss/files/cache_file.h"
#include "gliss/files/mesh_file.h"
#include "gliss/mesh/rounding.h"
#include "gliss/scene/tool.h"
#include "gliss/surface/names.h"

namespace gliss {
namespace {

Mesh read_mesh(const ObjectDescription& described, const SceneOpening& opening) {
  if (opening.read_mesh) return opening.read_mesh(described);
  Mesh mesh = load_mesh(described.surface, {.unit = described.unit,
                                            .orient = described.orient,
                                            .flip = described.flip,
                                            .creases = described.creases,
                                            .poll = opening.poll});
  if (described.crease_radius > 0) round_creases(mesh, described.crease_radius, opening.poll);
  return mesh;
}

PatchCache build_surface(const Mesh& mesh, const ObjectDescription& described,
                         const SceneOpening& opening) {
  BuildOptions options;
  options.precision = described.precision.value_or(Precision::kDouble);
  options.level = chosen_level(described.level, described.construction);
  if (opening.build) return opening.build(mesh, options);
  BuildBackend backend;
  backend.poll = opening.poll;
  return build_cache(mesh, options, nullptr, backend);
}

PatchCache open_surface(const ObjectDescription& described, const SceneOpening& opening) {
  if (described.from_cache || is_meant_as_cache(described.surface))
    return load_cache_of(described.surface,
                         {described.precision, described.level, described.construction},
                         opening.poll);
  return build_surface(read_mesh(described, opening), described, opening);
}

}  // namespace

std::vector<SceneObject> open_objects(const Scene& scene, const SceneOpening& opening) {
  std::vector<SceneObject> objects;
  for (const ObjectDescription& described : scene.objects) {
    SceneObject object;
    object.stiffness = described.stiffness;
    object.method = described.method;
    object.solver = described.solver;
    object.max_iterations = described.max_iterations;
    object.tolerance = described.tolerance;
    object.settle = described.settle;
    object.friction = described.friction;
    object.effects = described.effects;
    object.pose = described.pose;
    object.motion = described.motion;
    if (described.patches == Patches::kLazy) {
      const Precision precision = described.precision.value_or(Precision::kDouble);
      const Mesh mesh = read_mesh(described, opening);
      auto lazy = std::make_shared<const LazyMesh>(
          mesh, LazyOptions{described.rings, precision,
                            chosen_level(described.level, described.construction)});
      if (lazy->needs_all())
        object.cache = std::make_shared<const PatchCache>(build_surface(mesh, described, opening));
      else
        object.lazy = std::move(lazy);
    } else {
      object.cache = std::make_shared<const PatchCache>(open_surface(described, opening));
    }
    objects.push_back(std::move(object));
  }
  return objects;
}

std::vector<Vec3> open_hips(const Scene& scene, const SceneOpening& opening) {
  if (!scene.tool) return scene.hips;
  LoadOptions options;
  options.unit = scene.tool->unit;
  options.poll = opening.poll;
  const Mesh mesh = load_mesh(scene.tool->mesh, options);
  return spread_points(mesh, static_cast<std::size_t>(scene.tool->points), opening.poll);
}

Eigen::AlignedBox3d box_of(const SceneObject& object) {
  const Box own = object.cache->bounds();
  Eigen::AlignedBox3d box;
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner(i & 1 ? own.low.x() : own.high.x(), i & 2 ? own.low.y() : own.high.y(),
                      i & 4 ? own.low.z() : own.high.z());
    box.extend(object.pose * (corner * object.cache->unit));
  }
  return box;
}

LoopOptions loop_options(const Scene& scene, const DeviceInfo& device) {
  const double most = std::min(scene.max_stiffness, device.max_stiffness);
  const auto check = [&](const std::string& what, double stiffness) {
    if (stiffness <= most) return;
    throw SceneError(fmt::format("{} is {:g} N/m, and {} renders at most {:g} N/m", what, stiffness,
                                 device.name, most));
  };
  for (const ObjectDescription& object : scene.objects) {
    check(object.stiffness_place, object.stiffness);
    check(object.magnet_place + ": its stiffness, 3.08 force / range,",
          object.effects.magnet.stiffness());
  }
  LoopOptions options = scene.loop;
  options.guard.max_force = std::min(scene.loop.guard.max_force, scene.max_force);
  options.guard.max_torque = std::min(scene.loop.guard.max_torque, scene.max_torque);
  return options;
}

}  // namespace gliss
