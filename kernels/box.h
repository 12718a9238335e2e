// Boxes of patches, and how far a HIP is from them. Packed, each lane has a patch.

// A point of the mesh frame as a sum of two numbers, so that a float surface far from the origin
// loses nothing.
typedef struct {
  real3 high, low;
} hip_point;

// Six rows of `stride` numbers.
FN hip_point load_hip(GLOBAL scalar* at, ulong stride) {
  hip_point h;
  h.high = make3(load_lanes(at), load_lanes(at + stride), load_lanes(at + 2 * stride));
  h.low =
      make3(load_lanes(at + 3 * stride), load_lanes(at + 4 * stride), load_lanes(at + 5 * stride));
  return h;
}

// The HIP in the frame of a patch with these numbers.
FN real3 hip_in_frame(control_data numbers, hip_point h) {
  const real3 from_origin = sub3(h.high, load3(numbers, PATCH_ORIGIN));
  return mul3(number_at(numbers, PATCH_SCALE), add3(from_origin, h.low));
}

// Squared distance (mesh frame) from the HIP to the oriented box of a patch: no point of the patch
// or of its base polygon is nearer.
FN real oriented_box_distance2(control_data numbers, hip_point h) {
  const real3 normal = load3(numbers, PATCH_NORMAL), tangent = load3(numbers, PATCH_TANGENT);
  const real3 x = hip_in_frame(numbers, h);
  const real3 along = make3(dot3(x, tangent), dot3(x, cross3(normal, tangent)), dot3(x, normal));
  const real3 low = sub3(load3(numbers, PATCH_LOW), along),
              high = sub3(along, load3(numbers, PATCH_HIGH));
  const real zero = splat(K(0));
  const real3 out = make3(larger(larger(low.x, high.x), zero), larger(larger(low.y, high.y), zero),
                          larger(larger(low.z, high.z), zero));
  const real unscale = number_at(numbers, PATCH_UNSCALE);
  return dot3(out, out) * unscale * unscale;
}

// Squared distance from x to a box along the axes of the mesh frame.
FN real box_distance2(control_data box, real3 x) {
  const real zero = splat(K(0));
  const real dx = larger(larger(number_at(box, 0) - x.x, x.x - number_at(box, 3)), zero);
  const real dy = larger(larger(number_at(box, 1) - x.y, x.y - number_at(box, 4)), zero);
  const real dz = larger(larger(number_at(box, 2) - x.z, x.z - number_at(box, 5)), zero);
  return fma(dx, dx, fma(dy, dy, dz * dz));
}
