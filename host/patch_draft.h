// One patch on its way into the cache: built and examined in double, tamed where it folds.
#pragma once

#include <cstdint>
#include <vector>

#include "host/patch_cache.h"

namespace gliss {

// What sampling finds of a patch, in its local frame.
struct PatchShape {
  Box box;         // of the patch and its base polygon
  Vec3 low, high;  // oriented box of the patch alone, along tangent, normal x tangent, normal of
                   // the draft
  Vec3 bend;       // n . (G_xixi, G_xieta, G_etaeta) at the centre
  double sag = 0;  // distance from the base polygon that no point of the patch exceeds
  double rho_min = 0;  // least radius of curvature
  double turn = 1;     // least cosine between the patch's normal and the base polygon's
};

struct PatchDraft {
  PatchKind kind = PatchKind::kExact;
  std::vector<std::uint32_t> face_corner;  // [corner], which corner of the face it is
  Vec3 origin;                 // of the local frame, in the mesh frame; a float in each coordinate
  double scale = 1;            // local length of a mesh-frame length of 1: a power of two
  Vec3 normal, tangent;        // unit normal and a tangent of the base polygon
  std::vector<double> corner;  // [corner][2][3], local frame
  std::vector<std::uint32_t> triangle;  // [n - 2][3]
  std::vector<double> control;          // [corner][kSideReals]

  double soundness = 1;  // of its weakest ribbon; below kDegenerate it is not well defined
  PatchShape shape;
};

inline constexpr double kDegenerate = 1e-4;

// A patch's normal turns against its face, or its ribbons vanish.
inline bool is_folded(const PatchDraft& draft) { return !(draft.shape.turn > 0); }
inline bool is_degenerate(const PatchDraft& draft) { return !(draft.soundness > kDegenerate); }

// Corners of one face in the mesh frame, with unit normals.
struct FaceCorners {
  std::vector<Vec3> position, normal;
};

// Frame, base polygon and control data of the exact patch of a face; and its shape, by sampling.
PatchDraft draft_exact(const FaceCorners& face);
PatchShape examine(const PatchDraft& draft);
PatchShape base_shape(const PatchDraft& draft);  // of the base polygon alone

// What stands in for a patch that folds or degenerates: one patch, or one for each triangle of the
// face. Boundary curves are kept, so that the surface stays closed; boundary normals unless the
// kind is kBent.
std::vector<PatchDraft> draft_tamer(const FaceCorners& face, PatchDraft exact);

}  // namespace gliss
