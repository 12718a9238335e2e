#include "tools/cli/words/outputs.h"

#include <fmt/format.h>

#include <filesystem>

#include "gliss/files/atomic_file.h"
#include "tools/cli/words/command_line.h"

namespace gliss::tools {
namespace {

bool is_file(const std::string& name) { return !name.empty() && name != "-"; }

// True if both are one file, or would be.
bool are_same(const std::string& a, const std::string& b) {
  if (!is_file(a) || !is_file(b)) return false;
  std::error_code error;
  if (std::filesystem::equivalent(a, b, error)) return true;
  const auto whole = [&](const std::string& name) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(name, error), error);
  };
  return whole(a) == whole(b) && !error;
}

}  // namespace

void check_outputs(const std::vector<std::string>& outputs,
                   const std::vector<std::string>& inputs) {
  for (auto output = outputs.begin(); output != outputs.end(); ++output) {
    for (const std::string& input : inputs) {
      if (!are_same(*output, input)) continue;
      throw InputError(fmt::format(
          "'{}' is read, and would be lost where it is written as well: name another output",
          *output));
    }
    for (auto other = outputs.begin(); other != output; ++other) {
      if (!are_same(*output, *other)) continue;
      throw InputError(fmt::format("'{}' would be written twice: name another output", *output));
    }
  }
  for (const std::string& output : outputs) {
    if (is_file(output)) const AtomicFile created(output);
  }
}

}  // namespace gliss::tools
