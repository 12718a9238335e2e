// The figures of a traced path as scripts read them.
#pragma once

#include "gliss/query/trace.h"
#include "tools/cli/json.h"

namespace gliss::tools {

// Without `slipping`, which means something with friction.
Json json_of(const TraceStatistics& statistics);

}  // namespace gliss::tools
