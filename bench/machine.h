// Measures what the machine can do at most, with the instructions that the kernels' lanes use.
#pragma once

#include "bench/work.h"
#include "gliss/surface/patch_cache.h"

namespace gliss::bench {

Work fma_work(Precision precision, int threads);  // items: operations, an fma being two
// Items: bytes of memory, over arrays that no cache holds.
Work read_work(int threads);
Work write_work(int threads);
Work triad_work(int threads);  // a = b + s c, as STREAM counts it: three arrays

}  // namespace gliss::bench
