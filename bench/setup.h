// The surfaces that benchmarks share: the generated knot of 1,440 quads and HIPs beneath it.
#pragma once

#include <random>
#include <string>
#include <vector>

#include "gliss/build/build_cache.h"
#include "gliss/engine/engine.h"
#include "gliss/generate/generate.h"

namespace gliss::bench {

struct Setup {
  Mesh mesh;
  PatchCache cache;
  std::vector<DomainPoint> points;  // in the order of faces
  std::vector<Vec3> hips;           // 2 % of the tube's radius beneath them
};

inline Setup make_setup(Precision precision, std::size_t count) {
  BuildOptions options;
  options.precision = precision;
  options.level.construction = Construction::kPaper;
  Setup s{torus_knot().mesh, {}, {}, {}};
  const auto engine = make_tbb_engine();
  s.cache = engine->build(s.mesh, options);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-0.4, 0.4);
  for (std::size_t i = 0; i < count; ++i) {
    const auto face = static_cast<std::uint32_t>(i * s.cache.mesh_face_count / count);
    const double xi = uniform(random), eta = uniform(random);
    s.points.push_back({face, xi, eta});
  }
  std::vector<SurfacePoint> points(count);
  engine->reside(s.cache)->evaluate(s.points, points);
  for (const SurfacePoint& p : points) s.hips.push_back(p.position - 0.24 * p.normal);
  return s;
}

inline std::string name_of(Precision precision) {
  return precision == Precision::kFloat ? "float" : "double";
}

}  // namespace gliss::bench
