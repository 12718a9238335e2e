#include "tools/surface_input.h"

#include <fmt/format.h>

#include "tools/interrupt.h"
#include "tools/watch.h"

namespace gliss::tools {

Mesh read_mesh(const SurfaceOptions& options) {
  std::vector<Finding> findings;
  Mesh mesh = load_mesh(options.surface,
                        {.unit = options.unit, .split_non_manifold = options.split_non_manifold},
                        &findings);
  for (const Finding& finding : findings) {
    if (finding.severity != Severity::kRepaired || options.quiet) continue;
    fmt::print(stderr, "gliss: repaired: {} ({} in all)\n", finding.message, finding.count);
  }
  return mesh;
}

PatchCache build(const Mesh& mesh, const SurfaceOptions& options, const Engine& engine,
                 BuildOptions build_options, BuildReport* report) {
  build_options.precision = options.precision.value_or(Precision::kDouble);
  Watch watch(options, "build",
              build_options.faces.empty() ? mesh.face_count() : build_options.faces.size(),
              "faces");
  BuildBackend backend = engine.build_backend();
  backend.parallel = [&](std::size_t count, std::size_t grain, const auto& body) {
    engine.for_each(count, grain, [&](std::size_t begin, std::size_t end) {
      if (interrupted()) throw Interrupted();
      body(begin, end);
    });
  };
  backend.progress = [&](std::size_t faces) { watch.reach(faces); };
  return build_cache(mesh, build_options, report, backend);
}

PatchCache open_surface(const SurfaceOptions& options, const Engine& engine) {
  if (!is_cache_file(options.surface)) return build(read_mesh(options), options, engine);
  PatchCache cache = load_cache(options.surface);
  if (options.precision && *options.precision != cache.precision()) {
    throw CacheError(
        fmt::format("{}: a cache in {}; for --precision {} bake the mesh again", options.surface,
                    precision_name(cache.precision()), precision_name(*options.precision)),
        true);
  }
  return cache;
}

PointTable read_points(const std::string& path, double unit,
                       const std::vector<std::string>& optional) {
  const std::vector<std::vector<std::string>> names = {{"x", "y", "z"}, {"x_mm", "y_mm", "z_mm"}};
  PointTable result;
  result.table = read_csv(path, {.alternatives = names, .optional = optional});
  const std::size_t chosen = result.table.alternative;
  result.unit = chosen == 0 ? unit : 1e-3;
  const auto &x = *result.table.find(names[chosen][0]), &y = *result.table.find(names[chosen][1]),
             &z = *result.table.find(names[chosen][2]);
  result.points.reserve(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) result.points.emplace_back(x[i], y[i], z[i]);
  return result;
}

}  // namespace gliss::tools
