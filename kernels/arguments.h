// A surface as kernel arguments: a struct must not carry pointers into a kernel.

#define SURFACE_ARGUMENTS                                                                          \
  __global const scalar *domain, __global const uint *domain_begin,                                \
      __global const uint *side_begin, __global const uint *side_patch,                            \
      __global const uint *side_twin, __global const scalar *control,                              \
      __global const uint *control_begin, __global const uint *form,                               \
      __global const scalar *corner, __global const scalar *patch, __global const uint *triangle,  \
      __global const scalar *node, __global const uint *child, __global const uint *tile,          \
      __global const uint *tile_begin, __global const uint *part, __global const uint *part_table, \
      __global const uint *partner, __global const scalar *part_box, uint patch_count

#define SURFACE_VIEW                                                                               \
  {                                                                                                \
    domain, domain_begin, side_begin, side_patch, side_twin, control, control_begin, form, corner, \
        patch, triangle, node, child, tile, tile_begin, part, part_table, partner, part_box,       \
        patch_count                                                                                \
  }

// Work-groups have this size; what is over does nothing.
#define GROUP __attribute__((reqd_work_group_size(GLISS_GROUP, 1, 1)))

// Distance between rows of `count` results. Not the count itself: rows a power of two apart fall
// into the same sets of the host's caches.
#define ROW_STRIDE(count) ((ulong)(count) + 16)
