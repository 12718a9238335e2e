#include "tools/cli/commands/browser.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "tools/cli/words/command.h"

extern char** environ;

namespace gliss::tools {
namespace {

[[noreturn]] void fail(const std::string& what) {
  throw std::system_error(errno, std::generic_category(), what);
}

// Writes a page that leads there, for its user's eyes alone, and returns its path.
std::string write_door(const std::string& url) {
  const char* own = std::getenv("XDG_RUNTIME_DIR");
  const std::filesystem::path folder =
      own != nullptr && *own != 0 ? own : std::filesystem::temp_directory_path();
  std::string path = (folder / "gliss-view-XXXXXX.html").string();
  const int file = mkostemps(path.data(), 5, O_CLOEXEC);  // mode 0600
  if (file < 0) fail(path);
  const std::string text = fmt::format(
      "<!doctype html><meta http-equiv=\"refresh\" content=\"0; url={0}\"><a href=\"{0}\">Gliss "
      "view</a>\n",
      url);
  const bool done = write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  close(file);
  if (!done) fail(path);
  return path;
}

}  // namespace

BrowserWindow::BrowserWindow(const std::string& url) : path_(write_door(url)) {
  std::string program = "xdg-open";
  char* words[] = {program.data(), path_.data(), nullptr};
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  // A browser that kept the server's socket would keep its port.
  posix_spawn_file_actions_addclosefrom_np(&files, STDERR_FILENO + 1);
  pid_t child = 0;
  const int error = posix_spawnp(&child, program.c_str(), &files, nullptr, words, environ);
  posix_spawn_file_actions_destroy(&files);
  if (error == 0) return;
  unlink(path_.c_str());
  throw Unavailable("--open: there is no xdg-open here (package xdg-utils)");
}

BrowserWindow::~BrowserWindow() { unlink(path_.c_str()); }

}  // namespace gliss::tools
