// What the checks of a mesh find, as scripts read it.
#pragma once

#include "gliss/results/json.h"
#include "gliss/validate/validate.h"

namespace gliss {

const char* severity_name(Severity severity);  // "error", "repaired", "warning"
// Numbers that are not known are null.
Json json_of(const Finding& finding);

}  // namespace gliss
