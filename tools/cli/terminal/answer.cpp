#include "tools/cli/terminal/answer.h"

#include <fmt/format.h>

#include "tools/cli/terminal/terminal.h"

namespace gliss::tools {

void report(const ReportOptions& options, const std::string& text, const Json& json,
            bool table_on_stdout) {
  if (options.quiet && !options.json) return;
  const std::string said = options.json ? printed(json) : for_terminal(text);
  if (table_on_stdout) return tell(said);
  fmt::print("{}", said);
}

std::string printed(const Json& json) {
  return json_for_terminal(json.dump(2, ' ', false, Json::error_handler_t::replace)) + "\n";
}

}  // namespace gliss::tools
