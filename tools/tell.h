// Words of the program on stderr.
#pragma once

#include <string>

namespace gliss {

// A log that cannot be written must not end the work that it tells of: failures are ignored.
void tell(const std::string& text) noexcept;

}  // namespace gliss
