// The answer of a command: text, or JSON with --json.
#pragma once

#include <string>

#include "gliss/results/json.h"

namespace gliss::tools {

struct ReportOptions {
  bool json = false, quiet = false;
};

// To standard output, or to stderr where a table goes to standard output: JSON with --json, else
// text, nothing with --quiet.
void report(const ReportOptions& options, const std::string& text, const Json& json,
            bool table_on_stdout = false);

// Prints with a line end, by json_for_terminal; text that is no UTF-8 is made some.
std::string printed(const Json& json);

}  // namespace gliss::tools
