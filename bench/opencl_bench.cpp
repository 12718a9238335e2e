// The OpenCL engine beside oneTBB's: both do the same work in turn, so that their ratio holds on a
// machine that others use too. Names: path/level/precision/n/opencl.
#include <benchmark/benchmark.h>

#include <chrono>
#include <cstdio>
#include <memory>

#include "bench/benches.h"
#include "bench/device_peak.h"
#include "bench/setup.h"
#include "gliss/build/build_cache.h"
#include "gliss/engine/opencl.h"
#include "gliss/sweep/sweep.h"

namespace gliss::bench {
namespace {

// Operations of a position with both derivatives on an exact quad, an fma being two: those of the
// kernel as clang -O3 leaves it, with its loops unrolled. Bytes: a point in, nine numbers out.
constexpr double kQuadOperations = 42 + 40 + 359 + 15 + 8 + 2 * 742;

struct Engines {
  std::unique_ptr<Engine> tbb = make_tbb_engine(), opencl;
};

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Times work(tbb) and work(opencl) in turn; `items` of each.
template <class Work>
void in_turn(benchmark::State& state, const Engines& engines, double items, Work work) {
  work(*engines.opencl);  // compiles
  double tbb = 0, opencl = 0, kernels = -engines.opencl->device_seconds();
  for (auto _ : state) {
    const double start = seconds();
    work(*engines.tbb);
    const double middle = seconds();
    work(*engines.opencl);
    const double end = seconds();
    tbb += middle - start;
    opencl += end - middle;
    state.SetIterationTime(end - middle);
  }
  kernels += engines.opencl->device_seconds();
  const double all = items * static_cast<double>(state.iterations());
  state.counters["per_s"] = all / opencl;
  state.counters["tbb_per_s"] = all / tbb;
  state.counters["of_tbb"] = tbb / opencl;
  if (kernels > 0) state.counters["kernel_per_s"] = all / kernels;
}

void add(const std::string& path, Precision precision,
         std::function<void(benchmark::State&)> body) {
  const std::string name = path + "/exact/" + name_of(precision) + "/4/opencl";
  benchmark::RegisterBenchmark(name.c_str(), body)->UseManualTime()->Unit(benchmark::kMillisecond);
}

}  // namespace

void register_opencl(const std::string& device) {
  OpenClOptions options;
  options.device = device;
  const auto engines = std::make_shared<Engines>();
  try {
    engines->opencl = make_opencl_engine(options);
  } catch (const DeviceError& error) {
    std::fprintf(stderr, "skipped: %s\n", error.what());
    return;
  }
  const std::size_t count = engines->opencl->batch() * 16;
  for (const Precision precision : {Precision::kFloat, Precision::kDouble}) {
    const auto made = std::make_shared<std::unique_ptr<Setup>>();
    const auto setup = [=]() -> const Setup& {
      if (*made == nullptr) *made = std::make_unique<Setup>(make_setup(precision, count));
      return **made;
    };
    add("build", precision, [=](benchmark::State& state) {
      BuildOptions build;
      build.precision = precision;
      const Setup& s = setup();
      in_turn(state, *engines, static_cast<double>(s.mesh.face_count()),
              [&](const Engine& engine) { benchmark::DoNotOptimize(engine.build(s.mesh, build)); });
    });
    add("evaluate", precision, [=](benchmark::State& state) {
      static const DevicePeak peak = measure_peak(device);
      const Setup& s = setup();
      const auto tbb = engines->tbb->reside(s.cache), opencl = engines->opencl->reside(s.cache);
      std::vector<SurfacePoint> out(count);
      in_turn(state, *engines, static_cast<double>(count), [&](const Engine& engine) {
        (&engine == engines->tbb.get() ? tbb : opencl)->evaluate(s.points, out);
      });
      const double real = precision == Precision::kFloat ? 4 : 8;
      const double rate = state.counters["kernel_per_s"];
      if (precision == Precision::kFloat)
        state.counters["of_peak"] = rate * kQuadOperations / peak.operations;
      state.counters["of_bandwidth"] = rate * 11 * real / peak.bandwidth;
    });
    add("nearest", precision, [=](benchmark::State& state) {
      const Setup& s = setup();
      const auto tbb = engines->tbb->reside(s.cache), opencl = engines->opencl->reside(s.cache);
      std::vector<Contact> out(count);
      in_turn(state, *engines, static_cast<double>(count), [&](const Engine& engine) {
        (&engine == engines->tbb.get() ? tbb : opencl)->project(s.hips, {}, out);
      });
    });
    add("track", precision, [=](benchmark::State& state) {
      const Setup& s = setup();
      const auto tbb = engines->tbb->reside(s.cache), opencl = engines->opencl->reside(s.cache);
      std::vector<Contact> out(count);
      in_turn(state, *engines, static_cast<double>(count), [&](const Engine& engine) {
        (&engine == engines->tbb.get() ? tbb : opencl)->track(s.hips, s.points, {}, out);
      });
    });
    add("sweep", precision, [=](benchmark::State& state) {
      const Setup& s = setup();
      SweepOptions sweeping;
      sweeping.depths = {2e-3, 4e-3};
      sweeping.rings = 6;
      const double contacts =
          static_cast<double>(sample_count(s.cache, sweeping.rings)) * 2 * kMethods;
      in_turn(state, *engines, contacts,
              [&](const Engine& engine) { sweep(s.cache, engine, sweeping); });
    });
  }
}

}  // namespace gliss::bench
