// The global projection: a work-item takes a HIP.
#include "kernels/kernels.h"
#include "kernels/arguments.h"

// For each of the methods, four bits each, the nearest contact of all.
__kernel GROUP void nearest(SURFACE_ARGUMENTS, uint count, __global const scalar* hip, uint methods,
                            uint method_count, int solver, int max_iterations, scalar tolerance,
                            int budget, __global scalar* reals, __global uint* uints) {
  const ulong i = get_global_id(0), stride = ROW_STRIDE(count * (ulong)method_count);
  if (i >= count) return;
  const surface_view view = SURFACE_VIEW;
  effort spent;
  const track_options options = {solver, max_iterations, tolerance, &spent};
  const hip_point h = load_hip(hip + i, count);
  near_patches near;
  const base_point base = nearest_base(view, h, 0u, 1, &near);
  const polygon_blend blend = blend_on_polygon(view, base);
  for (uint m = 0; m < method_count; ++m) {
    const ulong at = m * (ulong)count + i;
    spent = begin_effort(budget);
    contact c = nearest_contact(view, h, base, blend, &near, (int)(methods >> 4 * m & 15u), options);
    tell(&c, &spent);
    store_contact(reals + at, uints + at, stride, c);
  }
}
