#include "tools/tell.h"

#include <cstdio>

namespace gliss {

void tell(const std::string& text) noexcept { std::fputs(text.c_str(), stderr); }

}  // namespace gliss
