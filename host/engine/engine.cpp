#include "gliss/engine/engine.h"

namespace gliss {
namespace {

constexpr std::size_t kPointGrain = 4096, kHipGrain = 256;

class SerialEngine final : public Engine {
 public:
  const char* name() const override { return "serial"; }
  int threads() const override { return 1; }
  std::size_t batch() const override { return kPointGrain; }
  void for_each(std::size_t count, std::size_t grain,
                const std::function<void(std::size_t, std::size_t)>& body) const override {
    serial_for(count, grain, body);
  }
};

// In the host's memory, where the cache is.
class HostSurface final : public ResidentSurface {
 public:
  HostSurface(const Engine& engine, const PatchCache& cache) : engine_(engine), cache_(cache) {
    require_patches(cache);
  }

  void evaluate(std::span<const DomainPoint> points, std::span<SurfacePoint> out) const override {
    require_room(out.size(), points.size());
    engine_.for_each(points.size(), kPointGrain, [&](std::size_t begin, std::size_t end) {
      const std::size_t count = end - begin;
      gliss::evaluate(cache_, points.subspan(begin, count), out.subspan(begin, count));
    });
  }

  void nearest(std::span<const Vec3> hips, std::span<const Method> methods,
               const QueryOptions& options, std::span<Contact> out) const override {
    require_room(out.size(), methods.size() * hips.size());
    engine_.for_each(hips.size(), kHipGrain, [&](std::size_t begin, std::size_t end) {
      gliss::nearest(cache_, hips.subspan(begin, end - begin), methods, options, hips.size(),
                     out.data() + begin);
    });
  }

  void track(std::span<const Vec3> hips, std::span<const DomainPoint> starts,
             const QueryOptions& options, std::span<Contact> out) const override {
    require_room(starts.size(), hips.size());
    require_room(out.size(), hips.size());
    engine_.for_each(hips.size(), kHipGrain, [&](std::size_t begin, std::size_t end) {
      const std::size_t count = end - begin;
      gliss::track(cache_, hips.subspan(begin, count), starts.subspan(begin, count), options,
                   out.subspan(begin, count));
    });
  }

 private:
  const Engine& engine_;
  const PatchCache& cache_;
};

}  // namespace

BuildBackend Engine::build_backend() const {
  BuildBackend backend;
  backend.parallel = [this](std::size_t count, std::size_t grain, const auto& body) {
    for_each(count, grain, body);
  };
  return backend;
}

PatchCache Engine::build(const Mesh& mesh, const BuildOptions& options, BuildReport* report) const {
  return build_cache(mesh, options, report, build_backend());
}

std::unique_ptr<ResidentSurface> Engine::reside(const PatchCache& cache) const {
  return std::make_unique<HostSurface>(*this, cache);
}

std::unique_ptr<Engine> make_serial_engine() { return std::make_unique<SerialEngine>(); }

}  // namespace gliss
