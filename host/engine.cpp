#include "host/engine.h"

namespace gliss {
namespace {

constexpr std::size_t kGrain = 256;

class SerialEngine final : public Engine {
 public:
  const char* name() const override { return "serial"; }
  int threads() const override { return 1; }
  void for_each(std::size_t count, std::size_t grain,
                const std::function<void(std::size_t, std::size_t)>& body) const override {
    serial_for(count, grain, body);
  }
};

}  // namespace

PatchCache Engine::build(const Mesh& mesh, const BuildOptions& options, BuildReport* report) const {
  BuildBackend backend;
  backend.parallel = [this](std::size_t count, std::size_t grain, const auto& body) {
    for_each(count, grain, body);
  };
  return build_cache(mesh, options, report, backend);
}

void Engine::evaluate(const PatchCache& cache, std::span<const DomainPoint> points,
                      std::span<SurfacePoint> out) const {
  for_each(points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) out[i] = gliss::evaluate(cache, points[i]);
  });
}

void Engine::project(const PatchCache& cache, std::span<const Vec3> hips,
                     const QueryOptions& options, std::span<Contact> out) const {
  for_each(hips.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) out[i] = nearest(cache, hips[i], options);
  });
}

std::unique_ptr<Engine> make_serial_engine() { return std::make_unique<SerialEngine>(); }

}  // namespace gliss
