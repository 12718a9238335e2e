// Points of patches: a work-item takes GLISS_LANES points of one patch.
#define GLISS_LARGE  // the one call there is goes inline
#include "kernels/kernels.h"
#include "kernels/arguments.h"

__kernel GROUP void evaluate_blocks(SURFACE_ARGUMENTS, uint count, __global const uint* block_patch,
                                    __global const scalar* at, __global scalar* out) {
  const ulong i = get_global_id(0), slots = (ulong)count * GLISS_LANES, first = i * GLISS_LANES;
  if (i >= count) return;
  const surface_view view = SURFACE_VIEW;
  const real xi = load_lanes(at + first), eta = load_lanes(at + slots + first);
  store_point(out + first, ROW_STRIDE(slots), evaluate_patch(view, block_patch[i], xi, eta));
}
