#include <algorithm>

#include "gliss/engine/opencl_shared.h"

namespace gliss {
namespace {

class OpenClEngine final : public Engine {
 public:
  explicit OpenClEngine(const OpenClOptions& options)
      : Engine(options.poll), shared_(options), builder_(make_opencl_builder(shared_)) {}
  const char* name() const override { return "opencl"; }
  int threads() const override { return shared_.host->threads(); }
  std::size_t batch() const override {
    return shared_.on_gpu() ? std::size_t{1} << 19 : std::size_t{1} << 15;
  }
  double device_seconds() const override { return shared_.kernel_seconds; }
  void for_each(std::size_t count, std::size_t grain,
                const std::function<void(std::size_t, std::size_t)>& body) const override {
    shared_.host->for_each(count, grain, body);
  }
  BuildBackend build_backend() const override {
    BuildBackend backend = Engine::build_backend();
    backend.build = builder_;
    const std::size_t busy = shared_.on_gpu() ? 1 << 16 : backend.chunk;
    backend.chunk = std::clamp<std::size_t>(shared_.device.memory() >> 13, 256, busy);
    return backend;
  }
  std::unique_ptr<ResidentSurface> reside(const PatchCache& cache) const override {
    return shared_.run([&] { return make_opencl_surface(shared_, cache); },
                       [&] { return shared_.host->reside(cache); });
  }

 private:
  OpenClShared shared_;
  BatchBuilder builder_;
};

}  // namespace

std::unique_ptr<Engine> make_opencl_engine(const OpenClOptions& options) {
  try {
    return std::make_unique<OpenClEngine>(options);
  } catch (const DeviceError& e) {
    if (!options.fall_back) throw;
    tell_fallback(options, e);
    return make_tbb_engine(options.threads, options.poll);
  }
}

}  // namespace gliss
