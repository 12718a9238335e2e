// A member of a team at its share of a sweep.
#pragma once

#include <cstddef>
#include <functional>

#include "gliss/study/sweep_parts.h"
#include "tools/cli/json.h"
#include "tools/cli/sweep_files.h"
#include "tools/cli/sweep_team.h"

namespace gliss::tools {

// What is swept, and by what. All of it outlives who uses it.
struct SweepWork {
  const PatchCache& cache;
  const Engine& engine;
  const SweepOptions& grid;
};

class SweepMember {
 public:
  // `parts` are shared. Throws InputError, in all members, where their sweeps or folders differ.
  SweepMember(const SweepWork& work, const SweepTeam& team, SweepParts& parts);

  // Does parts that nobody has taken, one after the other, until there are none.
  void do_parts(const SweepProgress& progress);
  // The same, and the whole sweep from the parts as they come, in their order. For rank 0.
  SweepResult do_all(const SweepSink& sink, const SweepProgress& progress);
  // The same as do_parts(), with their samples to a file that all members share. Returns once all
  // are done: in rank 0 the statistics of the whole sweep.
  SweepResult do_samples(SampleFile& file, const SweepProgress& progress);

  // What all members did, once all have come here. The parts are no longer needed.
  Json report() const;

 private:
  // Asks enough() before each part, and in the end.
  void do_parts_until(const std::function<bool()>& enough, const SweepSink& sink = nullptr);
  void wait_for(std::size_t part);
  bool reach(std::uint64_t done, std::uint64_t total);

  const SweepWork work_;
  const SweepTeam& team_;
  SweepParts& parts_;
  const std::size_t count_;
  SweepProgress progress_;
  bool none_left_ = false;
  std::uint64_t reached_ = 0, computed_ = 0;
  double at_parts_ = 0, at_counter_ = 0, waiting_ = 0, all_ = 0;  // s
};

}  // namespace gliss::tools
