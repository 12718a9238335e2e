#include "tools/cli/terminal/progress.h"

#include <fmt/format.h>

#include <utility>

namespace gliss::tools {
namespace {

constexpr double kRedraw = 0.1, kWorthALine = 0.5;  // seconds
constexpr int kBarWidth = 26;

}  // namespace

Progress::Progress(std::string label, std::uint64_t total, std::string noun, ProgressStyle style)
    : label_(std::move(label)), noun_(std::move(noun)), line_(style == ProgressStyle::kSilent) {
  state_.total = total;
}

void Progress::update(std::uint64_t done) {
  if (line_.place() == StatusLine::Place::kNowhere) return;
  state_.done = done;
  state_.seconds = clock_.seconds();
  if (line_.place() == StatusLine::Place::kLog) {
    if (pace_.due(state_)) line_.show(fmt::format("{}: {}", label_, progress_text(state_, noun_)));
  } else if (drawn_ < 0 || state_.seconds - drawn_ >= kRedraw) {
    drawn_ = state_.seconds;
    line_.show(fmt::format("{} {} {}", label_, progress_bar(state_, kBarWidth),
                           progress_text(state_, noun_)));
  }
}

void Progress::finish() {
  if (line_.place() == StatusLine::Place::kNowhere) return;
  state_.seconds = clock_.seconds();
  if (line_.place() == StatusLine::Place::kLog && state_.seconds < kWorthALine) return;
  if (state_.total != 0) state_.done = state_.total;
  line_.finish(fmt::format("{}: {}", label_, finished_text(state_, noun_)));
}

}  // namespace gliss::tools
