#include "gliss/engine/engine.h"

#include <algorithm>
#include <array>
#include <utility>

#include "gliss/base/pace.h"
#include "gliss/surface/instances.h"

namespace gliss {
namespace {

constexpr std::size_t kPointGrain = 4096, kHipGrain = 256;

class SerialEngine final : public Engine {
 public:
  using Engine::Engine;
  const char* name() const override { return "serial"; }
  int threads() const override { return 1; }
  std::size_t batch() const override { return kPointGrain; }
  void for_each(std::size_t count, std::size_t grain,
                const std::function<void(std::size_t, std::size_t)>& body) const override {
    serial_for(count, grain, [&](std::size_t begin, std::size_t end) {
      poll();
      body(begin, end);
    });
  }
};

template <class T>
PointArrays<T> piece_of(const PointArrays<T>& points, std::size_t begin, std::size_t end) {
  return {end - begin, points.face.from(begin), points.xi.from(begin), points.eta.from(begin)};
}
template <class T>
HipArrays<T> piece_of(const HipArrays<T>& hips, std::size_t begin, std::size_t end) {
  return {end - begin, hips.position.from(begin)};
}

// In the host's memory, where the cache is.
class HostSurface final : public ResidentSurface {
 public:
  HostSurface(const Engine& engine, const PatchCache& cache) : engine_(engine), cache_(cache) {
    require_patches(cache);
  }

  void evaluate(const PointArrays<double>& points,
                const SurfaceArrays<double>& out) const override {
    evaluate_pieces(points, out);
  }
  void evaluate_grid(std::span<const std::uint32_t> faces, std::span<const double> xi,
                     std::span<const double> eta, const SurfaceArrays<double>& out) const override {
    grid_pieces(faces, xi, eta, out);
  }
  void nearest(const HipArrays<double>& hips, std::span<const Method> methods,
               const QueryOptions& options,
               std::span<const ContactArrays<double>> out) const override {
    nearest_pieces(hips, methods, options, out);
  }
  void track(const HipArrays<double>& hips, const PointArrays<double>& starts,
             const QueryOptions& options, const ContactArrays<double>& out) const override {
    track_pieces(hips, starts, options, out);
  }
  void evaluate(const PointArrays<float>& points, const SurfaceArrays<float>& out) const override {
    evaluate_pieces(points, out);
  }
  void evaluate_grid(std::span<const std::uint32_t> faces, std::span<const float> xi,
                     std::span<const float> eta, const SurfaceArrays<float>& out) const override {
    grid_pieces(faces, xi, eta, out);
  }
  void nearest(const HipArrays<float>& hips, std::span<const Method> methods,
               const QueryOptions& options,
               std::span<const ContactArrays<float>> out) const override {
    nearest_pieces(hips, methods, options, out);
  }
  void track(const HipArrays<float>& hips, const PointArrays<float>& starts,
             const QueryOptions& options, const ContactArrays<float>& out) const override {
    track_pieces(hips, starts, options, out);
  }

 private:
  template <class T>
  void evaluate_pieces(const PointArrays<T>& points, const SurfaceArrays<T>& out) const {
    engine_.for_each(points.count, kPointGrain, [&](std::size_t begin, std::size_t end) {
      gliss::evaluate(cache_, piece_of(points, begin, end), out.from(begin));
    });
  }

  template <class T>
  void grid_pieces(std::span<const std::uint32_t> faces, std::span<const T> xi,
                   std::span<const T> eta, const SurfaceArrays<T>& out) const {
    const std::size_t points = std::max<std::size_t>(xi.size(), 1);
    engine_.for_each(faces.size(), (kPointGrain + points - 1) / points,
                     [&](std::size_t begin, std::size_t end) {
                       gliss::evaluate_grid(cache_, faces.subspan(begin, end - begin), xi, eta,
                                            out.from(begin * xi.size()));
                     });
  }

  template <class T>
  void nearest_pieces(const HipArrays<T>& hips, std::span<const Method> methods,
                      const QueryOptions& options, std::span<const ContactArrays<T>> out) const {
    require_room(kMethods, methods.size());
    require_room(out.size(), methods.size());
    for_hips(hips.count, [&](std::size_t begin, std::size_t end) {
      std::array<ContactArrays<T>, kMethods> there;
      for (std::size_t m = 0; m < methods.size(); ++m) there[m] = out[m].from(begin);
      gliss::nearest(cache_, piece_of(hips, begin, end), methods, options, there);
    });
  }

  template <class T>
  void track_pieces(const HipArrays<T>& hips, const PointArrays<T>& starts,
                    const QueryOptions& options, const ContactArrays<T>& out) const {
    require_room(starts.count, hips.count);
    for_hips(hips.count, [&](std::size_t begin, std::size_t end) {
      gliss::track(cache_, piece_of(hips, begin, end), piece_of(starts, begin, end), options,
                   out.from(begin));
    });
  }

  // Calls body(begin, end) for few HIPs at a time where each takes long. A few have a thread each.
  template <class Body>
  void for_hips(std::size_t count, Body body) const {
    const std::size_t shares = 4 * static_cast<std::size_t>(engine_.threads());
    const std::size_t grain = std::clamp<std::size_t>(count / shares, 1, kHipGrain);
    Pace pace;
    engine_.for_each(count, grain, [&](std::size_t first, std::size_t last) {
      pace.for_pieces(last - first, [&](std::size_t begin, std::size_t end) {
        engine_.poll();
        body(first + begin, first + end);
      });
    });
  }

  const Engine& engine_;
  const PatchCache& cache_;
};

}  // namespace

BuildBackend Engine::build_backend() const {
  BuildBackend backend;
  backend.parallel = [this](std::size_t count, std::size_t grain, const auto& body) {
    for_each(count, grain, body);
  };
  backend.poll = poll_;
  return backend;
}

PatchCache Engine::build(const Mesh& mesh, const BuildOptions& options, BuildReport* report) const {
  return build_cache(mesh, options, report, build_backend());
}

std::unique_ptr<ResidentSurface> Engine::reside(const PatchCache& cache) const {
  return std::make_unique<HostSurface>(*this, cache);
}

std::unique_ptr<Engine> make_serial_engine(Poll poll) {
  return std::make_unique<SerialEngine>(std::move(poll));
}

const char* instruction_set() { return kernels<double>().isa; }

}  // namespace gliss
