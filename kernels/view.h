// A surface as a query sees it: arrays by value, all in the instance's own precision. One lane a
// query. Three frames: the mesh's file units; the mesh frame (origin removed, scaled by a power of
// two into [-1, 1]); and each patch's local frame (its own origin, a number of the mesh frame; its
// own power of two).

typedef struct {
  GLOBAL scalar* domain;       // tables of the valences in use (domain.h)
  GLOBAL uint* domain_begin;   // [valence], where its table begins
  GLOBAL uint* side_begin;     // [patch + 1]
  GLOBAL uint* side_patch;     // [side]
  GLOBAL uint* side_twin;      // [side], NONE: border
  GLOBAL scalar* control;      // of all patches, by their forms
  GLOBAL uint* control_begin;  // [patch], where its own begins, in triples
  GLOBAL uint* form;           // [patch], FORM_*; of a table with r << 8
  GLOBAL scalar* corner;       // [side][2][3], base polygon: position (local frame) and unit normal
  GLOBAL scalar* patch;        // [patch][PATCH_REALS]
  // [side_begin[p] - 2 p][3], local corners: fixed triangulation of p's base polygon; or FAN_PIECE.
  GLOBAL uint* triangle;
  GLOBAL scalar* node;      // [node][NODE_REALS]
  GLOBAL uint* child;       // [node][2]
  GLOBAL uint* tile;        // [TILE_UINTS][tile], patch by patch (tile.h)
  GLOBAL uint* tile_begin;  // [patch + 1], tiles before its own
  // Overlapping parts (union.h), where HAS_UNION:
  GLOBAL uint* part;        // [patch], its part and PATCH_BURIED or PATCH_MIXED
  GLOBAL uint* part_table;  // [part][PART_UINTS]
  GLOBAL uint* partner;     // solid parts that may hold points of a part
  GLOBAL scalar* part_box;  // [part][6], mesh frame
  uint patch_count;
} surface_view;

#ifdef __OPENCL_C_VERSION__
#define HAS_UNION(view) (GLISS_FORMS >> 8 & 1u)
#else
#define HAS_UNION(view) ((view).part != 0)
#endif

// True if edges of the mesh are creases, and if faces are cut into patches round a centre. No
// polygon has 0 sides: the word where its table would begin says it.
#define HAS_CREASES(view) (((view).domain_begin[0] & SURFACE_CREASES) != 0u)
#define HAS_FANS(view) (((view).domain_begin[0] & SURFACE_FANS) != 0u)

FN int valence_of(surface_view view, uint patch) {
  return (int)(view.side_begin[patch + 1] - view.side_begin[patch]);
}
FN uint part_of(surface_view view, uint patch) { return view.part[patch] & PART_MASK; }
FN GLOBAL scalar* domain_of(surface_view view, int n) { return view.domain + view.domain_begin[n]; }
FN GLOBAL scalar* control_of(surface_view view, uint patch) {
  return view.control + 3 * (ulong)view.control_begin[patch];
}
FN GLOBAL scalar* numbers_of(surface_view view, uint patch) {
  return view.patch + (ulong)patch * PATCH_REALS;
}

// True if a patch has its neighbour's normals along a side, as its build has found: else any may
// lead from a tile there to a HIP, which the tile at the side's end says
// (host/build/patch_tiles.h).
FN int is_smooth_side(surface_view view, uint side) {
  const uint patch = view.side_patch[side], k = side - view.side_begin[patch];
  const uint first = view.tile_begin[patch], count = view.tile_begin[patch + 1] - first,
             of_side = count / (uint)valence_of(view, patch);
  const uint last =
      view.tile[TILE_UINTS * (ulong)first + TILE_AXIS * count + (k + 1) * of_side - 1];
  return (last >> 24 & TILE_ANY_LEAN) != TILE_ANY_LEAN;
}

FN real3 local_hip(surface_view view, hip_point h, uint patch) {
  return hip_in_frame(numbers_of(view, patch), h);
}

FN patch_point evaluate_patch(surface_view view, uint patch, real xi, real eta) {
  const int n = valence_of(view, patch);
  return evaluate_form(domain_of(view, n), control_of(view, patch), view.form[patch], n, xi, eta);
}
