// Text on its way to a terminal.
#pragma once

#include <string>
#include <string_view>

namespace gliss::tools {

// The text with \x1b and the like in place of control characters, line ends aside, and of bytes
// that are no UTF-8: what a file, a name or a device says must not command the terminal.
std::string for_terminal(std::string_view text);

// JSON, in UTF-8, with \u007f and the like in place of the control characters that JSON allows.
std::string json_for_terminal(std::string_view json);

// Says it on stderr, for_terminal. A log that cannot be written must not end the work that it tells
// of: failures are ignored.
void tell(std::string_view text);

}  // namespace gliss::tools
