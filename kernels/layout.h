// Places of the numbers in the arrays that the host and the kernels share, and the words' meanings.
// OpenCL C and C++ both read it: plain numbers only. A triple is three numbers; offsets are in
// triples where they say so.

#define NONE 0xFFFFFFFFu

// The form of a patch: how its control data are kept. A level, which a user asks for, picks a form
// for each patch: `bezier` FORM_BEZIER for 3 and 4 sides and FORM_RIBBON for more; `exact` of the
// fair construction FORM_SEXTIC, FORM_BEZIER, and FORM_CURVED for 5 sides and more. Whatever
// their forms, neighbours have one normal along their edge, that of eq. 10; but for tables, which
// come near to it.
enum {
  FORM_PAPER = 0,   // the paper's patch
  FORM_RIBBON = 1,  // the same blend of sides whose cross tangents are polynomials (ribbon.h)
  FORM_BEZIER = 2,  // a Gregory quad or triangle (bezier.h)
  FORM_TABLE = 3,   // samples (table.h)
  FORM_SEXTIC = 4,  // a Gregory triangle of degree 6 (sextic.h)
  FORM_CURVED = 5,  // a blend of curved ribbons (curved.h)
  FORM_COUNT = 6,
};
// True if patches of the form are a blend of corner interpolators (patch.h).
#define BLENDS_SIDES(form) ((form) == FORM_PAPER || (form) == FORM_RIBBON)
enum {
  // The most cells of a table along half a side.
  TABLE_MOST_CELLS = 64,
  // Up to this valence loops over the sides are unrolled, and patches can be packed.
  UNROLLED_VALENCE = 6,
  MANY_SIDES = UNROLLED_VALENCE + 1,
  // The most sides of a fair patch; the blend of more is the paper's, whose numbers are made for
  // it.
  FAIR_MOST_SIDES = 31,
};

// Control data of a side, in the patch's local frame. Polynomials ascend in powers of t. What both
// forms that blend sides (forms.h) begin with:
enum {
  SIDE_C = 0,        // boundary curve, cubic: 4 triples
  SIDE_T_0 = 4,      // T(0), the corner's Q'(0): 1 triple (eq. 1)
  SIDE_T_1 = 5,      // T(1), the next corner's P'(0): 1 triple
  SIDE_TWIST_0 = 6,  // T'(0): 1 triple
  SIDE_TWIST_1 = 7,  // T'(1): 1 triple
  // And the paper's T:
  SIDE_NORMAL = 8,   // n_c divided by the square of the edge's length, cubic: 4 triples (eq. 10)
  SIDE_INNER = 12,   // (1-t) n_(s-) + t n_(e+): 2 triples (eq. 13)
  SIDE_ACROSS = 14,  // v_(s-) - v_s, v_(e+) - v_e: 2 triples (eq. 12)
  SIDE_LENGTH = 48,  // size of T: (1-t) L_prev + t L_next: 2 numbers (eq. 14)
  // 0 for the paper's patch; a tamer one shortens T to (1 - ease) of it at mid-side.
  SIDE_EASE = 50,
  SIDE_REALS = 51,
};

// A side as the construction gives it, in any frame: the curve C and the normal n in powers of t,
// and its soundness (build.h).
enum {
  FAIR_CURVE = 0,   // 6 triples
  FAIR_NORMAL = 6,  // 4 triples
  FAIR_SOUND = 30,  // 1 number
  FAIR_REALS = 31,
};

// Table of a valence: cos(pi / n) as high and low part, then for each k the outward normal m_k of
// side k (x, y, their low parts) and the corner C_k (x, y).
enum {
  DOMAIN_HEAD = 2,
  DOMAIN_STRIDE = 6,
  DOMAIN_CORNER = 4,
};

// Unit normal and unit tangent of the base polygon, local frame: 2 triples.
enum {
  FRAME_NORMAL = 0,
  FRAME_TANGENT = 1,
  FRAME_REALS = 6,
};

// Numbers of a shape as stored, local frame. LOW to BEND count in triples.
enum {
  SHAPE_LOW = 0,         // box of the probes and of the base polygon: 1 triple
  SHAPE_HIGH = 1,        // 1 triple
  SHAPE_ALONG_LOW = 2,   // the same along tangent, normal x tangent, normal: 1 triple
  SHAPE_ALONG_HIGH = 3,  // 1 triple
  // Second fundamental form n . (G_xixi, G_xieta, G_etaeta) at the centre: 1 triple.
  SHAPE_SECOND_FORM = 4,
  SHAPE_LEAST_COSINE = 15,  // least cosine between the patch's normal and the base polygon's
  SHAPE_CURVATURE = 16,     // largest |principal curvature|
  SHAPE_STRETCH2 = 17,      // largest squared length of G_xi and G_eta
  SHAPE_SAG2 = 18,          // largest squared distance to the base polygon
  SHAPE_FINITE = 19,        // 1: every probe has a position and a normal; else 0
  SHAPE_RINGS = 20,         // of probes that were sampled
  SHAPE_REALS = 21,
};
// The least SHAPE_LEAST_COSINE of a gentle patch.
#define GENTLE_COSINE 0.75f

// Numbers of a patch besides its sides. ORIGIN, NORMAL, TANGENT, LOW and HIGH count in triples.
enum {
  PATCH_ORIGIN = 0,   // origin in the mesh frame: 1 triple
  PATCH_NORMAL = 1,   // unit normal of the base polygon: 1 triple
  PATCH_SCALE = 6,    // local length of a mesh-frame length of 1, a power of two
  PATCH_UNSCALE = 7,  // its inverse
  // No point of the patch is farther than this from the base polygon, local frame.
  PATCH_SAG = 8,
  PATCH_TANGENT = 3,  // unit tangent of the base polygon: triple 3
  // Oriented box of the patch along tangent, normal x tangent, normal, local frame: triple 4.
  PATCH_LOW = 4,
  PATCH_HIGH = 5,  // triple 5
  // Second fundamental form n . (G_xixi, G_xieta, G_etaeta) at the centre, local frame.
  PATCH_SECOND_FORM = 18,
  PATCH_CURVATURE = 21,  // largest |principal curvature|, local frame
  PATCH_REALS = 22,
};

// True if more than rounding is left of a tangent plane: `across`, the length of G_xi x G_eta, is
// the normal's then; else the base polygon's normal stands for it. longest2: the longer one's
// square.
#define SPANS_A_PLANE(across, longest2, epsilon) ((across) > 8 * (epsilon) * (longest2))

// What a surface has: bits of domain_begin[0].
enum {
  SURFACE_CREASES = 1,
  SURFACE_FANS = 2,
};

// A face may be cut into patches round a centre, patch k at side k. The base polygon of each is a
// triangle that need not lie on the face's polygon, so its patches hold the triangles of that too,
// in any order: in place of a patch's own triangle, 0 1 2, stand this bit with three corners of the
// face, FAN_BITS each; then the first side of the face's first patch, and the number of its sides.
// For two of the patches there is no triangle left: theirs is a corner, three times.
#define FAN_PIECE 0x80000000u
enum {
  FAN_BITS = 7,
  FAN_CORNER = 127,
};

// Numbers of a hierarchy node: the boxes of its two children, mesh frame, low and high corner each.
enum {
  NODE_REALS = 12,
  HIERARCHY_DEPTH = 64,  // levels, at most
};
#define NODE_LEAF 0x80000000u  // a child with this bit is a patch

// A patch lies in a solid part other than its own, or may do so in places; else nowhere.
enum {
  PATCH_BURIED = 0x40000000,
};
#define PATCH_MIXED 0x80000000u
enum {
  PART_MASK = 0x3FFFFFFF,
  // Numbers of a part: where its partners begin and end, its first patch.
  PART_PARTNERS = 0,
  PART_PARTNERS_END = 1,
  PART_FIRST = 2,
  PART_UINTS = 3,
};

// Words of a tile. Lengths are local, directions are along tangent, normal x tangent and normal of
// the base polygon.
enum {
  TILE_CENTRE_XY = 0,        // 16 bits each, from the low to the high corner of the patch's box
  TILE_CENTRE_Z_RADIUS = 1,  // the same, and of the cylinder in 2 / 65535 of the box's length
  // x and y of the unit axis, (12 bits - 2048) / 2048 each; z is not negative. Then 7 bits: their
  // square is 2^TILE_LEAN_SHIFT times the tangent of an angle that no normal's to the axis exceeds;
  // with TILE_LEANS_BY_CURVATURE so long is at most what its lean, its part aside over that along
  // the axis, differs by from the mean of both curvatures times the way aside from the centre.
  // TILE_ANY_LEAN: a nearest point may lie there though its normal does not lead to the HIP.
  TILE_AXIS = 2,
  TILE_LEAN_SHIFT = 13,
  TILE_ANY_LEAN = 127,
  TILE_LEANS_BY_CURVATURE = 128,
  // Half the height, as the radius; 8 bits each: least and largest curvature, ((bits - 128) /
  // 127)^3 of PATCH_CURVATURE.
  TILE_HALF_CURVES = 3,
  // Mean second fundamental form n . (G_xixi, G_xieta, G_etaeta): (9 bits - 256) each, times
  // 2^(the highest 5 bits - 24).
  TILE_SECOND_FORM = 4,
  TILE_UINTS = 5,
};

// The samples that tiles are cut from (cut.h): rows of the position and of the unit normal along
// tangent, normal x tangent and normal of the base polygon; a tile has CUT_RINGS of them to a side,
// or CUT_FEW_RINGS where the patch is gentle (examine.h).
enum {
  CUT_ROWS = 6,
  CUT_RINGS = 4,
  CUT_FEW_RINGS = 2,
};
#define CUT_POINTS(rings) (((rings) + 1) * ((rings) + 2) / 2)
// Rows of the two transforms from a tile's small triangles to the domain.
enum {
  CUT_TRANSFORMS = 8,
  // Rows of tiles: TILE_UINTS words, and what they need of each other (cut_tile).
  CUT_OUT_ROWS = 10,
  // Counts of samples and of tiles are multiples of it.
  CUT_PAD = 16,
};

// Methods and solvers.
enum {
  METHOD_GREGORY = 0,  // this library's
  METHOD_SHADED = 1,   // force shading on the base polygons (Morgenbesser and Srinivasan 1996)
  METHOD_FLAT = 2,     // god-object on the base polygons (Zilles and Salisbury 1995)
};

enum {
  CONTACT_FREE = 0,
  CONTACT_TOUCHING = 1,
};

// Gauss-Newton with a secant estimate of the curvature term (Dennis, Gay, Welsch 1981).
enum {
  SOLVER_NEWTON = 0,
  SOLVER_GAUSS_NEWTON = 1,  // tangent plane only
  SOLVER_PAPER = 2,         // section 4.2 as printed: secants of 0.1, no safeguard
};

// A contact in memory: a row for each number, and each coordinate of a triple, by what it is
// measured in. NUMBER and LENGTH: one, a length of the mesh frame; POINT, DIRECTION and WAY:
// triples, a point of the patch's frame, a unit vector, a vector of the mesh frame. Words are whole
// numbers. Each has the name of its row and that of its member (contact.h).
#define CONTACT_NUMBERS(NUMBER, LENGTH, POINT, DIRECTION, WAY) \
  NUMBER(Xi, xi)                                               \
  NUMBER(Eta, eta)                                             \
  POINT(Scp, scp)                                              \
  DIRECTION(Normal, normal)                                    \
  WAY(Offset, offset)                                          \
  WAY(Push, push)                                              \
  LENGTH(Clear, clear)
#define CONTACT_WORDS(WORD)    \
  WORD(State, state)           \
  WORD(Patch, patch)           \
  WORD(Iterations, iterations) \
  WORD(Crossings, crossings)   \
  WORD(Flags, flags)
// Its rows, kContactXi to kContactClear and kContactState to kContactFlags, and how many there are.
#define CONTACT_ROW(name, member) kContact##name,
#define CONTACT_ROWS(name, member) kContact##name, kContact##name##End = kContact##name + 2,
enum {
  CONTACT_NUMBERS(CONTACT_ROW, CONTACT_ROW, CONTACT_ROWS, CONTACT_ROWS, CONTACT_ROWS) CONTACT_REALS
};
enum { CONTACT_WORDS(CONTACT_ROW) CONTACT_UINTS };

// A contact's flags, of its foot.
enum {
  FOOT_CONVERGED = 1,  // the next step is shorter than the tolerance
  FOOT_BORDER = 2,     // held by an open border
  FOOT_CREASE = 4,     // held by an edge that is not smooth, or by a corner
  // The budget of the search was spent: a point may be nearer, but none is nearer than clear2.
  FOOT_UNFINISHED = 16,
};
