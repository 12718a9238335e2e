// The statistics of a sweep as people read them.
#pragma once

#include <string>

#include "gliss/sweep/sweep.h"

namespace gliss::tools {

std::string text_of(const SweepResult& result);

}  // namespace gliss::tools
