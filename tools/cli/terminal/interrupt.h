// Ctrl-C as a question asked between chunks, so that files are closed and a sweep can be resumed.
#pragma once

#include <string>

namespace gliss::tools {

struct Interrupted {   // exit code 130
  std::string hint{};  // what is left of the work
};

inline constexpr int kExitInterrupted = 130;

// Sets a flag from now on where SIGALRM comes, or one of SIGINT, SIGTERM, SIGHUP, SIGQUIT and
// SIGXCPU that is not ignored already. After a second one the program has kLastSeconds to let the
// hand go and close its files; after a third one it exits at once, with kExitInterrupted either
// way. Full pipes and files that may not grow are errors of who writes to them.
inline constexpr unsigned kLastSeconds = 2;
void catch_interrupts();
// True if one of these has come.
bool interrupted() noexcept;

}  // namespace gliss::tools
