// Samples patches: a work-item takes a patch, GLISS_LANES probes at a time. `second`: the
// tables of second derivatives (second.h), for each valence that of fair patches and that of the
// forms that blend sides. `rows`: samples for tiles to be cut from.
#include "kernels/arguments.h"
#include "kernels/kernels.h"

__kernel GROUP void examine_patches(
    uint count, __global const scalar* domain, __global const uint* domain_begin,
    __global const scalar* probe, __global const uint* probe_begin, __global const uint* side_begin,
    __global const scalar* corner, __global const uint* triangle, __global const scalar* frame,
    __global const scalar* control, __global const uint* control_begin, __global const uint* form,
    __global const scalar* second, __global const uint* second_begin,
    __global const uint* rows_begin, __global scalar* rows, __global scalar* shape) {
  const uint i = (uint)get_global_id(0);
  if (i >= count) return;
  const uint first = side_begin[i];
  const int n = (int)(side_begin[i + 1] - first);
  const uint its_table = second_begin[2 * n + BLENDS_SIDES(form[i])];
  __global const scalar* table = second_rows(form[i], n) > 0 ? second + its_table : 0;
  store_shape(shape + (ulong)i * SHAPE_REALS,
              examine(domain + domain_begin[n], probe + probe_begin[n], probe_coarse(n),
                      probe_count(n), control + control_begin[i], form[i], corner + 6 * (ulong)first,
                      triangle + 3 * (ulong)(first - 2 * i), frame + (ulong)i * FRAME_REALS, n,
                      table, rows + rows_begin[i]));
}
