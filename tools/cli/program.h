// What the programs have in common: whatever goes wrong becomes one line and an exit code.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/cli/words/command_line.h"

namespace gliss::tools {

struct ProgramText {
  std::string name, description;
};

// How a program ends.
struct End {
  int code = 0;
  std::string message{};  // for stderr, or ""
};

// Runs the command that the words name; each of `commands` adds one. To be called first: it sets
// signals and descriptors.
End run_program(int count, char** words, const ProgramText& text,
                const std::vector<std::function<void(Command&)>>& commands);

// Says "who: message" on stderr, on one line, where there is a message.
void tell(const std::string& who, End end);

// Returns what main() is to return. After Ctrl-C it ends the process instead: an OpenCL driver may
// still compile on a thread of its own, beneath which exit() would pull its memory away.
int leave(int code);

}  // namespace gliss::tools
