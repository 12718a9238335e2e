#include "tools/cli/terminal/status_line.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>

#include "gliss/base/utf8.h"
#include "tools/cli/terminal/terminal.h"

namespace gliss::tools {
namespace {

std::size_t terminal_width() {
  winsize size{};
  const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col : 80;
}

}  // namespace

StatusLine::StatusLine(bool silent)
    : place_(silent                  ? Place::kNowhere
             : isatty(STDERR_FILENO) ? Place::kTerminal
                                     : Place::kLog) {}

StatusLine::~StatusLine() {
  if (open_) tell("\n");
}

void StatusLine::show(const std::string& text) {
  if (place_ == Place::kLog) tell(text + "\n");
  if (place_ != Place::kTerminal) return;
  // Over the old text, cut to the terminal: a wrapped line could not be drawn over.
  const std::string plain = for_terminal(text);
  std::fputs(fmt::format("\r{}\x1b[K", cut_text(plain, terminal_width() - 1)).c_str(), stderr);
  std::fflush(stderr);
  open_ = true;
}

void StatusLine::finish(const std::string& text) {
  show(text);
  if (open_) tell("\n");
  open_ = false;
  place_ = Place::kNowhere;
}

}  // namespace gliss::tools
