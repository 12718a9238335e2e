// The loop's tick on the knot of 1,440 quads, 2 mm beneath its surface, 0.15 mm a tick: device,
// tracker, guard. Back to back, and woken 1000 times a second, when its memory has gone cold; and
// with friction, under which nearly every tick slips, with a texture, and with a tool of 100 HIPs.
#include <benchmark/benchmark.h>

#include <cmath>

#include "bench/benches.h"
#include "bench/setup.h"
#include "gliss/device/replay_device.h"
#include "gliss/loop/loop.h"
#include "gliss/thread/realtime.h"

namespace gliss::bench {
namespace {

constexpr double kDepth = 2, kStep = 0.15;  // mm
constexpr std::size_t kTicks = 100000, kWokenTicks = 5000;

struct LoopCase {
  const char* name;
  bool woken = false;
  FrictionOptions friction = {};
  EffectOptions effects = {};
  std::size_t hips = 1;  // of a tool that is a grid of them, all in contact
};

// A grid of `count` HIPs about a point, 0.2 mm apart.
std::vector<Vec3> grid_of(std::size_t count) {
  const double side = std::ceil(std::sqrt(static_cast<double>(count)));
  std::vector<Vec3> hips;
  for (std::size_t i = 0; i < count; ++i) {
    const double row = std::floor(static_cast<double>(i) / side);
    hips.emplace_back(2e-4 * (static_cast<double>(i) - side * row - (side - 1) / 2),
                      2e-4 * (row - (side - 1) / 2), 0);
  }
  return hips;
}

void loop(benchmark::State& state, Precision precision, const LoopCase& of) {
  const bool woken = of.woken;
  const Generated knot = torus_knot();
  const std::vector<Vec3> round = path_beneath(knot, 120, 12, kDepth, kStep);
  std::vector<Vec3> path;
  for (std::size_t i = 0; i < (woken ? kWokenTicks : kTicks); ++i)
    path.push_back(round[i % round.size()] * knot.mesh.unit);
  SceneObject object;
  object.cache = std::make_shared<PatchCache>(make_setup(precision, 1).cache);
  object.friction = of.friction;
  object.effects = of.effects;
  DurationHistogram compute, wake;
  for (auto _ : state) {
    ReplayDevice device(path);
    Tracker tracker({&object, 1}, grid_of(of.hips));
    HapticLoop loop(device, tracker, {.wait = woken});
    const auto run = [&] { loop.run([](const LoopTick&) { return true; }); };
    if (woken) {
      const Realtime realtime;
      run();
    } else {
      run();
    }
    compute = loop.record().compute();
    wake = loop.record().lateness();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(path.size()));
  const auto us = [](Nanoseconds time) { return static_cast<double>(time.count()) / 1e3; };
  state.counters["p50_us"] = us(compute.quantile(0.5));
  state.counters["p99_us"] = us(compute.quantile(0.99));
  state.counters["p999_us"] = us(compute.quantile(0.999));
  if (woken) state.counters["wake_p99_us"] = us(wake.quantile(0.99));
}

}  // namespace

void register_loop() {
  const LoopCase cases[] = {{"back_to_back"},
                            {"woken_1kHz", true},
                            {"friction", false, {0.5, 0.3}},
                            {"tool_of_100", false, {}, {}, 100},
                            {"texture", false, {}, {.texture = {Relief::kNoise, 5e-5, 2e-3}}}};
  for (const Precision p : {Precision::kDouble, Precision::kFloat}) {
    for (const LoopCase& of : cases) {
      const std::string name = "loop/exact/" + name_of(p) + "/4/" + of.name;
      benchmark::RegisterBenchmark(name.c_str(), loop, p, of)->UseRealTime();
    }
  }
}

}  // namespace gliss::bench
