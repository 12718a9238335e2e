#include "tools/cli/terminal/progress_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace gliss::tools {
namespace {

double fraction(const ProgressState& state) {
  if (state.total == 0) return 0;
  return std::min(1.0, static_cast<double>(state.done) / static_cast<double>(state.total));
}

double rate(const ProgressState& state) {
  return state.seconds > 0 ? static_cast<double>(state.done) / state.seconds : 0;
}

// A rate of a few a second tells nothing that the count and the time do not.
std::string rate_text(const char* separator, const ProgressState& state) {
  constexpr double kTelling = 10;
  return rate(state) < kTelling ? "" : fmt::format("{}{}/s", separator, count_text(rate(state)));
}

}  // namespace

std::string count_text(double count) {
  static constexpr const char* kPrefixes[] = {"", " k", " M", " G", " T"};
  std::size_t prefix = 0;
  for (; count >= 999.5 && prefix + 1 < std::size(kPrefixes); ++prefix) count /= 1000;
  const int decimals = prefix == 0 || count >= 99.95 ? 0 : count >= 9.995 ? 1 : 2;
  return fmt::format("{:.{}f}{}", count, decimals, kPrefixes[prefix]);
}

std::string duration_text(double seconds) {
  if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
  if (seconds < 99.5) return fmt::format("{:.0f} s", seconds);
  const auto whole = static_cast<long long>(std::llround(seconds));
  if (whole < 3600) return fmt::format("{}:{:02} min", whole / 60, whole % 60);
  return fmt::format("{}:{:02} h", whole / 3600, whole / 60 % 60);
}

std::string progress_text(const ProgressState& state, const std::string& noun) {
  if (state.done == 0 && state.total == 0) return duration_text(state.seconds);
  const std::string done = count_text(static_cast<double>(state.done));
  std::string text = state.total == 0
                         ? fmt::format("{} {}", done, noun)
                         : fmt::format("{:3.0f} %  {} of {} {}", std::floor(100 * fraction(state)),
                                       done, count_text(static_cast<double>(state.total)), noun);
  if (state.seconds <= 0) return text;
  if (state.done == 0) return text + fmt::format("  {} so far", duration_text(state.seconds));
  text += rate_text("  ", state);
  if (state.total <= state.done) return text;
  const double left = static_cast<double>(state.total - state.done) / rate(state);
  return text + fmt::format("  {} left", duration_text(left));
}

std::string finished_text(const ProgressState& state, const std::string& noun) {
  if (state.done == 0 && state.total == 0) return duration_text(state.seconds);
  const std::string done = count_text(static_cast<double>(state.done));
  return fmt::format("{} {} in {}", done, noun, duration_text(state.seconds)) +
         rate_text(", ", state);
}

std::string progress_bar(const ProgressState& state, int width) {
  if (state.total == 0 || width < 3) return "";
  const auto inside = static_cast<std::size_t>(width - 2);
  const auto full = static_cast<std::size_t>(fraction(state) * static_cast<double>(inside));
  return "[" + std::string(full, '#') + std::string(inside - full, '-') + "]";
}

bool LinePace::due(const ProgressState& state) {
  const double waited = state.seconds - last_seconds_;
  const double patience = last_seconds_ == 0 ? 5 : 60;
  if (waited < 2 || (waited < patience && fraction(state) - last_fraction_ < 0.1)) return false;
  last_seconds_ = state.seconds;
  last_fraction_ = fraction(state);
  return true;
}

}  // namespace gliss::tools
