// Control data of a side from its polygon's corners and normals: eq. 6 to 14.

typedef struct {
  real3 p, n;  // position in the patch's local frame, unit normal
} corner;

// The coefficients of a side, before they are stored.
typedef struct {
  real3 curve[4], normal[4], inner[2], across[2];
  real length[2];
  real sound;  // least of |n x (e x n_avg)| / |e| and |n x e| / |e| at the ends: 0 where the ribbon
               // degenerates
} side_data;

// A tangent of the edge's length, along s; along the edge where s has no direction.
FN real3 end_tangent(real3 s, real3 edge, real length) {
  const real size = norm3(s);
  return pick3(size > splat(K(1e-6f)), mul3(length / size, s), edge);
}

// An edge, its tangents of eq. 7 to 9, and its normals' m = n x e of eq. 10, at both ends.
typedef struct {
  real3 edge, ts, te, m0, me;
  real length;
  real sound;  // as in side_data
} side_ends;

FN side_ends side_ends_of(corner start, corner end) {
  side_ends r;
  r.edge = sub3(end.p, start.p);
  r.length = norm3(r.edge);
  const real3 e = unit3(r.edge);
  // Only the direction of n_avg matters.
  const real3 across = cross3(e, unit3(add3(start.n, end.n)));
  const real3 s = cross3(start.n, across), t = cross3(end.n, across);
  r.m0 = cross3(start.n, e);
  r.me = cross3(end.n, e);
  r.sound = smaller(smaller(norm3(s), norm3(t)), smaller(norm3(r.m0), norm3(r.me)));
  r.ts = end_tangent(s, r.edge, r.length);
  r.te = end_tangent(t, r.edge, r.length);
  return r;
}

// Eq. 6 in powers of t: the coefficients of t^2 and t^3.
FN real3 cubic_2(real3 edge, real3 ts, real3 te) {
  return sub3(sub3(mul3(splat(K(3)), edge), mul3(splat(K(2)), ts)), te);
}
FN real3 cubic_3(real3 edge, real3 ts, real3 te) {
  return sub3(add3(ts, te), mul3(splat(K(2)), edge));
}

FN side_data build_side(corner before, corner start, corner end, corner after, side_ends ends) {
  side_data r;
  r.sound = ends.sound;
  r.curve[0] = start.p;
  r.curve[1] = ends.ts;
  r.curve[2] = cubic_2(ends.edge, ends.ts, ends.te);
  r.curve[3] = cubic_3(ends.edge, ends.ts, ends.te);
  // Eq. 10: C'(t) x m(t), m(t) = ((1-t) n_s + t n_e) x e; over |e|, so that it is of the order
  // of 1.
  const real3 m1 = sub3(ends.me, ends.m0);
  const real over = K(1) / larger(ends.length, splat(TINY));
  const real3 d0 = mul3(over, r.curve[1]), d1 = mul3(K(2) * over, r.curve[2]),
              d2 = mul3(K(3) * over, r.curve[3]);
  r.normal[0] = cross3(d0, ends.m0);
  r.normal[1] = cross_add3(d1, ends.m0, cross3(d0, m1));
  r.normal[2] = cross_add3(d2, ends.m0, cross3(d1, m1));
  r.normal[3] = cross3(d2, m1);
  r.inner[0] = before.n;
  r.inner[1] = sub3(after.n, before.n);
  r.across[0] = sub3(before.p, start.p);
  r.across[1] = sub3(after.p, end.p);
  r.length[0] = norm3(sub3(start.p, before.p));
  r.length[1] = norm3(sub3(after.p, end.p));
  return r;
}

FN void put3(control_out side, int i, real3 a) {
  side[3 * i] = a.x;
  side[3 * i + 1] = a.y;
  side[3 * i + 2] = a.z;
}

// T and T' at the ends of a side, once the rest of its control data stands.
FN void store_ends(control_out side) {
  const real zero = splat(K(0)), one = splat(K(1));
  const side_point start = side_at(side, zero, one), end = side_at(side, one, zero);
  put3(side, SIDE_T_0, start.t);
  put3(side, SIDE_T_1, end.t);
  put3(side, SIDE_TWIST_0, start.dt);
  put3(side, SIDE_TWIST_1, end.dt);
}

FN corner load_corner(control_data corners, int k) {
  const corner r = {load3(corners, 2 * k), load3(corners, 2 * k + 1)};
  return r;
}

// Stores them and returns their soundness.
FN real store_data(side_data data, control_out side) {
  for (int i = 0; i < 4; ++i) {
    put3(side, SIDE_C + i, data.curve[i]);
    put3(side, SIDE_NORMAL + i, data.normal[i]);
  }
  for (int i = 0; i < 2; ++i) {
    put3(side, SIDE_INNER + i, data.inner[i]);
    put3(side, SIDE_ACROSS + i, data.across[i]);
    side[SIDE_LENGTH + i] = data.length[i];
  }
  side[SIDE_EASE] = splat(K(0));
  store_ends(side);
  return data.sound;
}

// Control data of side k of a polygon from its corners [n][2][3]: position, unit normal. Returns
// the soundness of its ribbon: 0 where the edge is parallel to a normal, 1 at right angles.
FN real store_side(control_data corners, int n, int k, control_out side) {
  const int next = wrap(k + 1, n);
  const corner start = load_corner(corners, k), end = load_corner(corners, next);
  return store_data(build_side(load_corner(corners, wrap(k - 1, n)), start, end,
                               load_corner(corners, wrap(next + 1, n)), side_ends_of(start, end)),
                    side);
}
