// The work that a benchmark times, and what it is compared with: both in turn, in one run, so that
// ratios hold on a machine that others use too.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace gliss::bench {

struct Work {
  double items = 0;                          // of a call
  std::function<void()> run;                 // some milliseconds' worth
  std::map<std::string, double> counters{};  // what is told besides
};
using WorkMaker = std::function<Work()>;

// The counter says how many times the rival's items a second the benchmark does; or how many times
// that of its own counter `scaled_by`: flops an item, say, where the rival's items are flops.
struct Rival {
  std::string counter;
  WorkMaker make;
  std::string scaled_by{};
};

// Registers a benchmark; nothing is made before it runs. Work of one thread is timed by that
// thread's clock, of more by the wall's.
void add_work(const std::string& name, int threads, const WorkMaker& make,
              const std::vector<Rival>& rivals = {});

}  // namespace gliss::bench
