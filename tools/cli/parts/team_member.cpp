#include "tools/cli/parts/team_member.h"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "gliss/base/stopwatch.h"
#include "tools/cli/terminal/watch.h"

namespace gliss::tools {

TeamMember::TeamMember(const Team& team, PartFolder& parts, std::size_t count, PartWork work)
    : team_(team), parts_(parts), count_(count), work_(std::move(work)) {
  agree_on_folder(team, parts);
}

// The farthest, for rank 0 goes to and fro between the parts that it does and those that it reads.
PartProgress TeamMember::reach() {
  return [this](std::uint64_t done, std::uint64_t total) {
    team_.answer();
    reached_ = std::max(reached_, done);
    progress_(reached_, total);
  };
}

void TeamMember::do_parts(const PartProgress& progress) {
  progress_ = progress;
  do_parts_until([] { return false; }, work_);
}

void TeamMember::do_parts_until(const std::function<bool()>& enough, const PartWork& work) {
  const Stopwatch clock;
  const auto next_part = [&] {
    if (none_left_ || enough()) return count_;
    const Stopwatch asked;
    const std::size_t part = team_.next_part();
    at_counter_ += asked.seconds();
    none_left_ = part >= count_;
    return part;
  };
  computed_ += work(next_part, reach());
  at_parts_ += clock.seconds();
}

// What another rank has taken is there before long: if that rank dies, so does the job.
void TeamMember::wait_for(std::size_t part) {
  while (!parts_.is_whole(part)) {
    if (!none_left_) {
      do_parts_until([&] { return parts_.is_whole(part); }, work_);
      continue;
    }
    const Stopwatch clock;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    stop_if_interrupted();
    team_.answer();
    waiting_ += clock.seconds();
  }
}

void TeamMember::do_all(const PartWork& whole, const PartProgress& progress) {
  progress_ = progress;
  const Stopwatch clock;
  const auto in_order = [&, next = std::size_t{0}]() mutable {
    if (next < count_) wait_for(next);
    return next++;
  };
  computed_ += whole(in_order, reach());
  all_ = clock.seconds();
}

void TeamMember::do_share(const PartWork& make, const PartProgress& progress) {
  progress_ = progress;
  do_parts_until([] { return false; }, make);
  const Stopwatch clock;
  team_.gather("");
  waiting_ = clock.seconds();
  all_ = at_parts_ + waiting_;
}

Json TeamMember::report() const {
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
