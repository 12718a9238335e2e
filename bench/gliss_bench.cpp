// Rates of the hot paths on generated meshes. Names: path/level/precision/n/backend/threads.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <map>
#include <optional>
#include <string>

#include "bench/setup.h"
#include "host/names.h"
#include "host/sweep.h"
#include "host/tessellate.h"

namespace {

using namespace gliss;
using bench::Setup;

const Setup& setup(Precision precision) {
  static const Setup in_float = bench::make_setup(Precision::kFloat, 4096),
                     in_double = bench::make_setup(Precision::kDouble, 4096);
  return precision == Precision::kFloat ? in_float : in_double;
}

void build(benchmark::State& state, Precision precision, int threads) {
  const Mesh mesh = torus_knot().mesh;
  const auto engine = make_tbb_engine(threads);
  BuildOptions options;
  options.precision = precision;
  for (auto _ : state) benchmark::DoNotOptimize(engine->build(mesh, options));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(mesh.face_count()));
}

Mesh triangle_knot() {
  const Mesh quads = torus_knot(60, 6).mesh;
  return tessellate(quads, build_cache(quads), 1);
}

// A mesh of faces of n sides, but for a few.
Mesh mesh_of_valence(std::uint32_t n) {
  if (n == 4) return torus_knot().mesh;
  if (n == 3) return triangle_knot();
  return goldberg(12).mesh;
}

// Of the same benchmark with exact patches, earlier in the run; none: it was left out.
double exact_rate(bool is_float, std::uint32_t n, std::optional<double> rate = std::nullopt) {
  static std::map<std::pair<bool, std::uint32_t>, double> rates;
  if (rate) rates[{is_float, n}] = *rate;
  return rates[{is_float, n}];
}

// Positions and normals, 256 points of a patch at a time.
template <class Real>
void evaluate_points(benchmark::State& state, Level level, std::uint32_t n) {
  BuildOptions options;
  options.precision = sizeof(Real) == 4 ? Precision::kFloat : Precision::kDouble;
  options.level = level;
  const PatchCache cache = build_cache(mesh_of_valence(n), options);
  const Surface<Real>& s = std::get<Surface<Real>>(cache.surface);
  std::vector<std::uint32_t> patches;
  for (std::uint32_t p = 0; p < s.patch_count(); ++p) {
    if (s.valence(p) == n) patches.push_back(p);
  }
  std::vector<Real> xi(256), eta(256), out(9 * 256);
  for (std::size_t i = 0; i < 256; ++i) {
    xi[i] = static_cast<Real>(i % 16) / Real(24) - Real(0.3);
    eta[i] = static_cast<Real>(i / 16) / Real(24) - Real(0.3);
  }
  std::size_t next = 0;
  const std::clock_t start = std::clock();
  for (auto _ : state) {
    const std::uint32_t patch = patches[next];
    kernels<Real>().evaluate(&s.domain[s.domain_begin[n]],
                             &s.control[3 * std::size_t{s.control_begin[patch]}], s.form[patch], n,
                             xi.data(), eta.data(), 256, 256, out.data());
    benchmark::DoNotOptimize(out.data());
    next = next + 1 < patches.size() ? next + 1 : 0;
  }
  state.SetItemsProcessed(state.iterations() * 256);
  const double rate = static_cast<double>(state.iterations()) /
                      static_cast<double>(std::max<std::clock_t>(std::clock() - start, 1));
  const bool is_float = sizeof(Real) == 4;
  if (level == Level{}) {
    exact_rate(is_float, n, rate);
  } else if (const double exact = exact_rate(is_float, n); exact > 0) {
    state.counters["times_exact"] = rate / exact;
  }
}

void project(benchmark::State& state, Precision precision, Method method, Solver solver,
             int threads) {
  const Setup& s = setup(precision);
  const auto engine = make_tbb_engine(threads);
  QueryOptions options;
  options.method = method;
  options.solver = solver;
  std::vector<Contact> contacts(s.hips.size());
  const auto surface = engine->reside(s.cache);
  for (auto _ : state) surface->project(s.hips, options, contacts);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(s.hips.size()));
}

// A contact that slides 0.01 mm a tick.
void tick(benchmark::State& state, Precision precision) {
  const Setup& s = setup(precision);
  ContactTracker tracker(s.cache, {});
  const std::uint32_t face = 7;
  double t = 0;
  for (auto _ : state) {
    t = t > 0.8 ? 0 : t + 0.002;
    const SurfacePoint p = evaluate(s.cache, {face, t - 0.4, 0.1});
    benchmark::DoNotOptimize(tracker.tick(p.position - 2 * p.normal));
  }
  state.SetItemsProcessed(state.iterations());
}

void sweep_knot(benchmark::State& state, Precision precision, int threads) {
  const auto engine = make_tbb_engine(threads);
  SweepOptions options;
  options.depths = {2e-3, 4e-3};
  options.rings = 6;
  std::int64_t samples = 0;
  for (auto _ : state) {
    for (const SweepStatistics& s : sweep(setup(precision).cache, *engine, options).statistics) {
      samples += static_cast<std::int64_t>(s.samples);
    }
  }
  state.SetItemsProcessed(samples);
}

void register_all() {
  for (const Precision p : {Precision::kFloat, Precision::kDouble}) {
    const std::string precision = bench::name_of(p);
    for (const char* level : {"exact", "ribbon", "bezier", "table"}) {
      for (const std::uint32_t n : {4u, 3u, 5u, 6u}) {
        benchmark::RegisterBenchmark(
            fmt::format("evaluate/{}/{}/{}/tbb/1", level, precision, n).c_str(),
            p == Precision::kFloat ? evaluate_points<float> : evaluate_points<double>,
            find_level(level).value(), n);
      }
    }
    const auto name = [&](const std::string& path, const std::string& level, int threads) {
      return path + "/" + level + "/" + precision + "/4/tbb/" + std::to_string(threads);
    };
    benchmark::RegisterBenchmark(name("tick", "exact", 1).c_str(), tick, p);
    for (const int threads : {1, 2}) {
      benchmark::RegisterBenchmark(name("build", "exact", threads).c_str(), build, p, threads)
          ->UseRealTime();
      benchmark::RegisterBenchmark(name("nearest", "exact", threads).c_str(), project, p,
                                   Method::kGregory, Solver::kNewton, threads)
          ->UseRealTime();
      benchmark::RegisterBenchmark(name("sweep", "exact", threads).c_str(), sweep_knot, p, threads)
          ->UseRealTime();
    }
    benchmark::RegisterBenchmark(name("nearest", "exact-gauss-newton", 1).c_str(), project, p,
                                 Method::kGregory, Solver::kGaussNewton, 1);
    benchmark::RegisterBenchmark(name("nearest", "exact-paper", 1).c_str(), project, p,
                                 Method::kGregory, Solver::kPaper, 1);
    benchmark::RegisterBenchmark(name("nearest", "shaded", 1).c_str(), project, p, Method::kShaded,
                                 Solver::kNewton, 1);
    benchmark::RegisterBenchmark(name("nearest", "flat", 1).c_str(), project, p, Method::kFlat,
                                 Solver::kNewton, 1);
  }
}

}  // namespace

// --device=NAME: part of the name of an OpenCL device, or its number.
int main(int argc, char** argv) {
  std::string device;
  const std::string option = "--device=";
  for (int i = 1; i < argc; ++i) {
    if (std::string(argv[i]).rfind(option, 0) != 0) continue;
    device = argv[i] + option.size();
    std::rotate(argv + i, argv + i + 1, argv + argc);
    --argc;
    break;
  }
  register_all();
  bench::register_loop();
  bench::register_opencl(device);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
