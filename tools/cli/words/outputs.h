// Checks what a command writes against what it reads.
#pragma once

#include <string>
#include <vector>

namespace gliss::tools {

// Throws InputError where an output is one of the inputs, by whatever name, or is another output;
// std::system_error where it cannot be created, so that nobody waits for work that is lost then.
// Empty names and "-" are no files.
void check_outputs(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs);

}  // namespace gliss::tools
