// The layout of the kernels' arrays (kernels/layout.h) for the host, all offsets in numbers.
// Private to host/.
#pragma once

#include <cstddef>
#include <cstdint>

#include "gliss/base/vector.h"
#include "gliss/surface/instances.h"
#include "gliss/surface/patch_cache.h"

namespace gliss {

#include "kernels/layout.h"

inline constexpr std::size_t kSideReals = SIDE_REALS, kPatchReals = PATCH_REALS,
                             kNodeReals = NODE_REALS;
inline constexpr std::uint32_t kFormPaper = FORM_PAPER, kFormRibbon = FORM_RIBBON,
                               kFormBezier = FORM_BEZIER, kFormTable = FORM_TABLE,
                               kFormSextic = FORM_SEXTIC, kFormCurved = FORM_CURVED;
// True if patches of the form are a blend of corner interpolators.
constexpr bool blends_sides(std::uint32_t form) { return BLENDS_SIDES(form); }
static_assert(kMostTableCells == TABLE_MOST_CELLS);
inline constexpr std::uint32_t kMostFairSides = FAIR_MOST_SIDES;
inline constexpr std::uint32_t kFormsUnited = 256;     // among bits of forms: parts overlap
inline constexpr std::size_t kManySides = MANY_SIDES;  // among bits of valences: so many and more
inline constexpr std::uint32_t kFormMask = 255;        // above it, the r of a table
inline constexpr std::size_t kSideLength = SIDE_LENGTH;
inline constexpr std::size_t kPatchOrigin = 3 * PATCH_ORIGIN, kPatchNormal = 3 * PATCH_NORMAL,
                             kPatchScale = PATCH_SCALE, kPatchUnscale = PATCH_UNSCALE,
                             kPatchSag = PATCH_SAG, kPatchTangent = 3 * PATCH_TANGENT,
                             kPatchLow = 3 * PATCH_LOW, kPatchHigh = 3 * PATCH_HIGH,
                             kPatchSecondForm = PATCH_SECOND_FORM,
                             kPatchCurvature = PATCH_CURVATURE;
inline constexpr std::size_t kDomainHead = DOMAIN_HEAD, kDomainStride = DOMAIN_STRIDE,
                             kDomainCorner = DOMAIN_CORNER;
inline constexpr std::size_t kFairReals = FAIR_REALS, kFairCurve = FAIR_NORMAL - FAIR_CURVE,
                             kFairSound = FAIR_SOUND;
inline constexpr std::size_t kFrameReals = FRAME_REALS, kShapeReals = SHAPE_REALS;
inline constexpr std::size_t kShapeLow = 3 * SHAPE_LOW, kShapeHigh = 3 * SHAPE_HIGH,
                             kShapeAlongLow = 3 * SHAPE_ALONG_LOW,
                             kShapeAlongHigh = 3 * SHAPE_ALONG_HIGH,
                             kShapeSecondForm = 3 * SHAPE_SECOND_FORM,
                             kShapeLeastCosine = SHAPE_LEAST_COSINE,
                             kShapeCurvature = SHAPE_CURVATURE, kShapeStretch2 = SHAPE_STRETCH2,
                             kShapeSag2 = SHAPE_SAG2, kShapeFinite = SHAPE_FINITE,
                             kShapeRings = SHAPE_RINGS;
inline constexpr double kGentleCosine = static_cast<double>(GENTLE_COSINE);
inline constexpr std::uint32_t kHasCreases = SURFACE_CREASES, kHasFans = SURFACE_FANS;
inline constexpr std::uint32_t kFanPiece = FAN_PIECE, kFanBits = FAN_BITS, kFanCorner = FAN_CORNER;
inline constexpr std::uint32_t kNodeLeaf = NODE_LEAF;
inline constexpr std::size_t kHierarchyDepth = HIERARCHY_DEPTH;
inline constexpr std::uint32_t kPatchBuried = PATCH_BURIED, kPatchMixed = PATCH_MIXED;
inline constexpr std::uint32_t kPartMask = PART_MASK;
inline constexpr std::size_t kPartUints = PART_UINTS;
inline constexpr std::size_t kTileAxis = TILE_AXIS, kTileUints = TILE_UINTS;
inline constexpr std::uint32_t kCutRings = CUT_RINGS, kCutFewRings = CUT_FEW_RINGS,
                               kCutPad = CUT_PAD;
inline constexpr std::size_t kCutRows = CUT_ROWS, kCutTransforms = CUT_TRANSFORMS,
                             kCutOutRows = CUT_OUT_ROWS;
inline constexpr std::uint32_t kTileAnyLean = TILE_ANY_LEAN,
                               kTileLeansByCurvature = TILE_LEANS_BY_CURVATURE;
inline constexpr int kTileLeanShift = TILE_LEAN_SHIFT;
// instances.h tells these to users without the macros.
static_assert(kContactReals >= CONTACT_REALS && kContactUints >= CONTACT_UINTS);
static_assert(kConverged == FOOT_CONVERGED && kOnBorder == FOOT_BORDER &&
              kOnCrease == FOOT_CREASE && kUnfinished == FOOT_UNFINISHED);
static_assert(static_cast<int>(Method::kGregory) == METHOD_GREGORY &&
              static_cast<int>(Method::kShaded) == METHOD_SHADED &&
              static_cast<int>(Method::kFlat) == METHOD_FLAT);
static_assert(static_cast<int>(Solver::kNewton) == SOLVER_NEWTON &&
              static_cast<int>(Solver::kGaussNewton) == SOLVER_GAUSS_NEWTON &&
              static_cast<int>(Solver::kPaper) == SOLVER_PAPER);
static_assert(kNone == NONE);

// True if a side of a patch is one of its face's: a split face has others within.
template <class Real>
bool is_outer_side(const PatchCache& cache, const Surface<Real>& surface, std::uint32_t side) {
  const std::uint32_t n = cache.face_valence[cache.patch_face[surface.side_patch[side]]],
                      corner = cache.corner_of_face[side];
  return corner < n && cache.corner_of_face[next_side(surface, side)] == (corner + 1) % n;
}

}  // namespace gliss

#undef NONE
#undef FAN_PIECE
#undef NODE_LEAF
#undef PATCH_MIXED
