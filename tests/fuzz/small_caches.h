// Caches of few patches, in each precision and form.
#pragma once

#include "gliss/build/build_cache.h"
#include "gliss/generate/generate.h"
#include "gliss/surface/patch_cache.h"

namespace gliss::fuzz {

inline Mesh polygon(std::vector<Vec3> corners) {
  Mesh mesh;
  for (std::uint32_t v = 0; v < corners.size(); ++v) mesh.corner_vertex.push_back(v);
  mesh.face_begin.push_back(static_cast<std::uint32_t>(corners.size()));
  mesh.positions = std::move(corners);
  return mesh;
}

inline std::vector<PatchCache> small_caches() {
  const auto built = [](const Mesh& mesh, Precision precision, Level level = {}) {
    return build_cache(mesh, {.precision = precision, .level = level});
  };
  // The reflex corner makes the exact patch fold, so that it is cut.
  const Mesh dart = polygon({{0, 0, 0}, {3, -2, 0.3}, {0.4, 0, 0}, {3, 2, 0.3}});
  const Mesh triangle = polygon({{0, 0, 0}, {1, 0, 0}, {0, 1, 0.5}}), box = prism(3).mesh;
  return {built(triangle, Precision::kFloat), built(dart, Precision::kDouble),
          built(box, Precision::kDouble, {Level::kBezier}),
          built(box, Precision::kFloat, {Level::kRibbon}),
          built(box, Precision::kDouble, {Level::kTable, 1})};
}

}  // namespace gliss::fuzz
