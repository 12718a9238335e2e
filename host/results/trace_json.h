// The figures of a traced path as scripts read them.
#pragma once

#include "gliss/query/trace.h"
#include "gliss/results/json.h"

namespace gliss {

// Without `slipping`, which means something with friction.
Json json_of(const TraceStatistics& statistics);

}  // namespace gliss
