// Patches from polygons: a work-item takes a side.
#include "kernels/kernels.h"
#include "kernels/arguments.h"

__kernel GROUP void build_sides(uint count, __global const uint* side_begin,
                                __global const uint* side_patch, __global const scalar* corner,
                                __global scalar* control, __global scalar* sound) {
  const uint i = (uint)get_global_id(0);
  if (i >= count) return;
  const uint first = side_begin[side_patch[i]], end = side_begin[side_patch[i] + 1];
  sound[i] = store_side(corner + 6 * (ulong)first, (int)(end - first), (int)(i - first),
                        control + (ulong)i * SIDE_REALS);
}
