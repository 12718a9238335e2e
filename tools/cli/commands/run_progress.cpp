#include "tools/cli/commands/run_progress.h"

#include <fmt/format.h>

#include <algorithm>

#include "tools/cli/terminal/terminal.h"

namespace gliss::tools {
namespace {

using namespace std::chrono_literals;
using std::chrono::steady_clock;

constexpr double kPatience = 1;  // seconds, with what has no clock

}  // namespace

RunProgress::RunProgress(bool quiet, bool no_wait, std::uint64_t total)
    : quiet_(quiet),
      no_wait_(no_wait),
      total_(total),
      line_(std::in_place, quiet),
      pace_(line_->place() == StatusLine::Place::kTerminal ? 250ms : 5000ms),
      next_(steady_clock::now() + pace_),
      progress_("run", total, "ticks", quiet ? ProgressStyle::kSilent : ProgressStyle::kAutomatic) {
}

void RunProgress::update(RunReport& report, std::uint64_t ticks) {
  if (no_wait_) {
    // A guard takes some ticks more to be safe.
    if (clock_.seconds() > kPatience)
      progress_.update(total_ > 0 ? std::min(ticks, total_) : ticks);
  } else if (steady_clock::now() >= next_) {
    next_ += pace_;
    show(report);
  }
}

void RunProgress::finish(RunReport& report, std::uint64_t ticks) {
  if (!no_wait_) {
    if (ticks > 0) show(report);
  } else if (clock_.seconds() > kPatience && ticks >= total_) {
    progress_.update(ticks);
    progress_.finish();
  }
}

void RunProgress::say(const std::string& text) {
  if (quiet_) return;
  line_.emplace(quiet_);  // the old one ends its line
  tell(fmt::format("gliss: {}\n", text));
}

}  // namespace gliss::tools
