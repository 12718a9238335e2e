// The local projection: a work-item takes a HIP.
#include "kernels/kernels.h"
#include "kernels/arguments.h"

// The local contact from a start.
__kernel GROUP void track(SURFACE_ARGUMENTS, uint count, __global const scalar* hip,
                          __global const uint* start_patch, __global const scalar* start, int method,
                          int solver, int max_iterations, scalar tolerance, int budget,
                          __global scalar* reals, __global uint* uints) {
  const ulong i = get_global_id(0);
  if (i >= count) return;
  const surface_view view = SURFACE_VIEW;
  effort spent = begin_effort(budget);
  const track_options options = {solver, max_iterations, tolerance, &spent};
  contact last;
  last.method = method;
  last.patch = start_patch[i];
  last.xi = start[i];
  last.eta = start[count + i];
  last.held_count = 0;
  contact c = track_contact(view, load_hip(hip + i, count), last, options);
  tell(&c, &spent);
  store_contact(reals + i, uints + i, ROW_STRIDE(count), c);
}
