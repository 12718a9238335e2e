#include "tools/cli/sweep_member.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "gliss/base/stopwatch.h"
#include "tools/cli/described_file.h"
#include "tools/cli/watch.h"

namespace gliss::tools {

SweepMember::SweepMember(const SweepWork& work, const SweepTeam& team, SweepParts& parts)
    : work_(work), team_(team), parts_(parts), count_(part_count(work.cache, work.grid)) {
  agree(team, "the surface", hash_name(parts.surface_hash()), "give all the same file");
  agree(team, "the sweep", hash_name(parts.hash()), "start the same with the same options");
  agree_on_folder(team, parts);
}

// The farthest, for rank 0 goes to and fro between the parts that it does and those that it reads.
bool SweepMember::reach(std::uint64_t done, std::uint64_t total) {
  team_.answer();
  reached_ = std::max(reached_, done);
  return progress_(reached_, total);
}

void SweepMember::do_parts(const SweepProgress& progress) {
  progress_ = progress;
  do_parts_until([] { return false; });
}

void SweepMember::do_parts_until(const std::function<bool()>& enough, const SweepSink& sink) {
  const Stopwatch clock;
  const auto next_part = [&] {
    if (enough() || none_left_) return count_;
    const Stopwatch asked;
    const std::size_t part = team_.next_part();
    at_counter_ += asked.seconds();
    none_left_ = part >= count_;
    return part;
  };
  const auto reach_it = [this](auto done, auto total) { return reach(done, total); };
  computed_ += sweep_parts(work_.cache, work_.engine, work_.grid, next_part, parts_, reach_it, sink)
                   .computed;
  at_parts_ += clock.seconds();
}

// What another rank has taken is there before long: if that rank dies, so does the job.
void SweepMember::wait_for(std::size_t part) {
  while (!parts_.is_whole(part)) {
    if (!none_left_) {
      do_parts_until([&] { return parts_.is_whole(part); });
      continue;
    }
    const Stopwatch clock;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    stop_if_interrupted();
    team_.answer();
    waiting_ += clock.seconds();
  }
}

SweepResult SweepMember::do_all(const SweepSink& sink, const SweepProgress& progress) {
  progress_ = progress;
  const Stopwatch clock;
  const auto in_order = [&, next = std::size_t{0}]() mutable {
    if (next < count_) wait_for(next);
    return next++;
  };
  const auto reach_it = [this](auto done, auto total) { return reach(done, total); };
  SweepResult result =
      sweep_parts(work_.cache, work_.engine, work_.grid, in_order, parts_, reach_it, sink);
  computed_ += result.computed;
  all_ = clock.seconds();
  return result;
}

SweepResult SweepMember::do_samples(SampleFile& file, const SweepProgress& progress) {
  progress_ = progress;
  const Stopwatch clock;
  const auto write = [&] {
    file.write();
    return false;
  };
  do_parts_until(write, [&](const SweepBlock& block) { file.add(block); });
  const Stopwatch waited;
  team_.gather("");
  waiting_ += waited.seconds();
  SweepResult result;
  if (team_.rank() == 0) result = kept_statistics(work_.cache, work_.grid, parts_, progress);
  team_.gather("");
  all_ = clock.seconds();
  return result;
}

Json SweepMember::report() const {
  const auto of_all = [&](double seconds) {
    constexpr double kMicro = 1e6;
    return static_cast<double>(sum(team_, static_cast<std::uint64_t>(seconds * kMicro))) / kMicro;
  };
  return {{"ranks", team_.size()},
          {"parts", count_},
          {"contacts_computed", sum(team_, computed_)},
          {"part_rank_seconds", of_all(at_parts_ - at_counter_)},
          {"counter_rank_seconds", of_all(at_counter_)},
          {"wait_seconds", waiting_},
          {"result_seconds", all_ - at_parts_ - waiting_}};
}

}  // namespace gliss::tools
