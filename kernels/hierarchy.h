// The hierarchy over the patches: a binary tree of boxes, walked nearest first. A box holds a patch
// and its base polygon.

typedef struct {
  uint node[HIERARCHY_DEPTH];
  real distance2[HIERARCHY_DEPTH];
  int count;
} walk;

FN walk start_walk(surface_view view) {
  walk w;
  w.node[0] = view.patch_count == 1 ? NODE_LEAF : 0u;
  w.distance2[0] = K(0);
  w.count = 1;
  return w;
}

// Squared distance from x to the box of the patch that next_patch gave last.
FN real last_box_distance2(const walk* w) { return w->distance2[w->count]; }

// The next patch whose box is nearer to x (mesh frame) than the limit, or NONE.
FN_LARGE uint next_patch(surface_view view, walk* w, real3 x, real limit2) {
  while (w->count > 0) {
    const int top = --w->count;
    uint node = w->node[top];
    if (!(w->distance2[top] < limit2)) continue;
    if (node & NODE_LEAF) return node & ~NODE_LEAF;
    GLOBAL scalar* boxes = view.node + (ulong)node * NODE_REALS;
    const real a = box_distance2(boxes, x), b = box_distance2(boxes + 6, x);
    const uint left = view.child[2 * (ulong)node], right = view.child[2 * (ulong)node + 1];
    const int left_first = a <= b;
    const real near = left_first ? a : b, far = left_first ? b : a;
    // Written whether they count or not: which ones do is not to be foreseen.
    w->node[w->count] = left_first ? right : left;
    w->distance2[w->count] = far;
    w->count += far < limit2;
    w->node[w->count] = left_first ? left : right;
    w->distance2[w->count] = near;
    w->count += near < limit2;
  }
  return NONE;
}
