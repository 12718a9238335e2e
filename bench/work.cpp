#include "bench/work.h"

#include <benchmark/benchmark.h>

#include <ctime>

namespace gliss::bench {
namespace {

double timed(const Work& work, clockid_t clock) {
  const auto now = [clock] {
    timespec t;
    clock_gettime(clock, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  };
  const double start = now();
  work.run();
  return now() - start;
}

struct Side {
  Work work;
  double items = 0, seconds = 0;

  double rate() const { return items / seconds; }
  double take_turn(clockid_t clock) {
    const double took = timed(work, clock);
    items += work.items;
    seconds += took;
    return took;
  }
};

void time_in_turn(benchmark::State& state, clockid_t clock, const WorkMaker& make,
                  const std::vector<Rival>& rivals) {
  Side own{make()};
  std::vector<Side> others;
  for (const Rival& rival : rivals) others.push_back({rival.make()});
  own.work.run();  // what is made or read once
  for (Side& other : others) other.work.run();
  for (auto _ : state) {
    own.take_turn(clock);
    state.PauseTiming();
    for (Side& other : others) {  // a slow one has fewer turns
      if (other.seconds < own.seconds) other.take_turn(clock);
    }
    state.ResumeTiming();
  }
  // Not by UseManualTime, which would be part of the name.
  state.counters["items_per_second"] = own.rate();
  for (const auto& [name, value] : own.work.counters) state.counters[name] = value;
  for (std::size_t i = 0; i < rivals.size(); ++i) {
    const std::string& by = rivals[i].scaled_by;
    const double scale = by.empty() ? 1 : own.work.counters.at(by);
    state.counters[rivals[i].counter] = scale * own.rate() / others[i].rate();
  }
}

}  // namespace

void add_work(const std::string& name, int threads, const WorkMaker& make,
              const std::vector<Rival>& rivals) {
  const clockid_t clock = threads == 1 ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC;
  benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
    time_in_turn(state, clock, make, rivals);
  })->Unit(benchmark::kMillisecond);
}

}  // namespace gliss::bench
