// What the checks of a mesh find, as scripts read it.
#pragma once

#include "gliss/validate/validate.h"
#include "tools/cli/json.h"

namespace gliss::tools {

const char* severity_name(Severity severity);  // "error", "repaired", "warning"
// Numbers that are not known are null.
Json json_of(const Finding& finding);

}  // namespace gliss::tools
