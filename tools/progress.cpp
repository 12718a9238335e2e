#include "tools/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>
#include <utility>

namespace gliss {
namespace {

constexpr double kRedraw = 0.1;  // seconds
constexpr int kBarWidth = 26;

// A log that cannot be written must not end the work that it tells of: failures are ignored.
void say(const std::string& text) { std::fputs(text.c_str(), stderr); }

std::size_t terminal_width() {
  winsize size{};
  const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col : 80;
}

}  // namespace

Progress::Progress(std::string label, std::uint64_t total, std::string noun, ProgressStyle style)
    : label_(std::move(label)),
      noun_(std::move(noun)),
      display_(style == ProgressStyle::kSilent ? Display::kNone
               : isatty(STDERR_FILENO)         ? Display::kBar
                                               : Display::kLines) {
  state_.total = total;
}

Progress::~Progress() {
  if (open_line_) say("\n");
}

void Progress::update(std::uint64_t done) {
  if (display_ == Display::kNone) return;
  state_.done = done;
  state_.seconds = seconds();
  if (display_ == Display::kLines) {
    if (pace_.due(state_)) say(fmt::format("{}: {}\n", label_, progress_text(state_, noun_)));
  } else if (drawn_ < 0 || state_.seconds - drawn_ >= kRedraw) {
    drawn_ = state_.seconds;
    draw(fmt::format("{} {} {}", label_, progress_bar(state_, kBarWidth),
                     progress_text(state_, noun_)));
  }
}

void Progress::finish() {
  if (display_ == Display::kNone) return;
  state_.seconds = seconds();
  if (state_.total != 0) state_.done = state_.total;
  const std::string text = fmt::format("{}: {}", label_, finished_text(state_, noun_));
  if (display_ == Display::kBar) draw(text);
  if (display_ == Display::kLines) say(text);
  say("\n");
  open_line_ = false;
  display_ = Display::kNone;
}

double Progress::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

// Over the old text, cut to the terminal: a wrapped line could not be drawn over.
void Progress::draw(const std::string& text) {
  say(fmt::format("\r{}\x1b[K", text.substr(0, terminal_width() - 1)));
  std::fflush(stderr);
  open_line_ = true;
}

}  // namespace gliss
