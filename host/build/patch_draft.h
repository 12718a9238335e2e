// One patch on its way into the cache: its frame and base polygon, what sampling finds of it, and
// all of it in double.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gliss/base/poll.h"
#include "gliss/build/patch_batch.h"
#include "gliss/surface/instances.h"
#include "gliss/surface/layout.h"
#include "gliss/surface/patch_cache.h"

namespace gliss {

// Corners of one face in the mesh frame, with unit normals. Beside creases it has the tangents of
// its sides ([side][2], Mesh::tangents), and in the fair construction its sides
// ([side][kFairReals], mesh frame). Both are fewer than corners where a centre was added.
struct FaceCorners {
  std::vector<Vec3> position, normal;
  std::vector<Vec3> tangent{};
  std::vector<double> side{};

  bool is_fair() const { return !side.empty(); }
};

// The corners of a face of n sides: 0 to n - 1.
std::vector<std::uint32_t> all_corners(std::uint32_t n);

// A patch's local frame.
struct PatchFrame {
  Vec3 origin;           // in the mesh frame; a float in each coordinate
  double scale = 1;      // local length of a mesh-frame length of 1: a power of two
  Vec3 normal, tangent;  // unit normal and a tangent of the base polygon

  void store(double* reals) const;  // normal and tangent: kFrameReals of them
  // Takes a side of the fair construction, kFairReals numbers, from the mesh frame to this one.
  void place_side(double* side) const;
};

// Frame of the polygon that some corners of a face make, its corners [n][2][3] in that frame, and
// its triangles [n - 2][3].
PatchFrame place_polygon(const FaceCorners& face, std::span<const std::uint32_t> face_corner,
                         double* corner, std::uint32_t* triangle);

// The shape of a patch by samples, in its local frame.
struct PatchShape {
  Box box{Vec3::Zero(), Vec3::Zero()};  // of the patch and its base polygon
  // The same along tangent, normal x tangent, normal of its frame.
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();
  Vec3 second_form = Vec3::Zero();  // n . (G_xixi, G_xieta, G_etaeta) at the centre
  double sag = 0;           // distance from the base polygon that no point of the patch exceeds
  double sampled_sag = 0;   // the same of the samples alone
  double rho_min = 0;       // least radius of curvature
  double least_cosine = 1;  // least cosine between the patch's normal and the base polygon's
  double unseen = 0;        // rad, by which the normal may turn between two samples

  void hold(const Vec3& point, const PatchFrame& frame);  // makes the boxes hold a point too
};

// Samples of one patch along its frame: kCutRows rows of `count`.
struct PatchSamples {
  std::vector<double> rows;
  std::uint32_t count = 0;
  bool is_gentle = false;  // the coarse probes alone
  double stretch2 = 0;     // the largest squared length of G_xi and G_eta

  // Takes what does not stand in the rows from kShapeReals numbers of a patch of n sides.
  void set_shape(const double* reals, std::uint32_t n);
};

// The control data of a patch, kept elsewhere.
struct ControlData {
  const double* reals;  // as its form has them (Kernels::control_reals)
  std::uint32_t form;   // kFormPaper and so on
  std::uint32_t sides;
};

// Makes a shape of kShapeReals numbers: its bounds are widened by what lies between samples.
PatchShape shape_from(const double* reals);

// Below it the slopes of a ribbon lose too many of a float's digits.
inline constexpr double kDegenerate = 1e-2;

// A patch's normal turns against its face, or its ribbons vanish.
inline bool is_folded(const PatchShape& shape) { return !(shape.least_cosine > 0); }
// ... or may between the samples.
bool may_fold_unseen(const PatchShape& shape);
inline bool is_degenerate(double soundness) { return !(soundness > kDegenerate); }

// One patch by itself.
struct PatchDraft {
  PatchKind kind = PatchKind::kPlain;
  std::vector<std::uint32_t> face_corner;  // [corner], which corner of the face it is
  PatchFrame frame;
  std::vector<double> corner;           // [corner][2][3], local frame
  std::vector<std::uint32_t> triangle;  // [n - 2][3]
  // Of a face that is cut round a centre: corners of the face that make the piece of its polygon
  // which this patch holds (FAN_PIECE of kernels/layout.h), and their places, local frame.
  std::vector<std::uint32_t> piece;
  std::vector<Vec3> piece_corner;
  std::uint32_t form = kFormPaper;
  std::vector<double> side;     // [corner][kFairReals], local frame; of the fair construction
  std::vector<double> control;  // in its form
  double soundness = 1;         // of its weakest ribbon
  double inward_share = 1;      // 0 or less: a fair patch that doubles back along a side
  PatchShape shape;

  std::uint32_t valence() const { return static_cast<std::uint32_t>(face_corner.size()); }
  ControlData control_data() const { return {control.data(), form, valence()}; }
};

// The form of a fair patch.
constexpr std::uint32_t fair_form(std::uint32_t n) {
  return n == 3 ? kFormSextic : n == 4 ? kFormBezier : kFormCurved;
}

// The patch of some corners of a face, not yet examined: a fair one where the face has fair sides
// and no more than kMostFairSides, else the paper's.
PatchDraft draft_patch(const FaceCorners& face, std::vector<std::uint32_t> face_corner);
// The same in a draft that has its face_corner and may be one of before, whose memory it takes.
void draft_patch(const FaceCorners& face, PatchDraft& draft);
// The paper's patch, whatever the face has.
PatchDraft draft_paper(const FaceCorners& face, std::vector<std::uint32_t> face_corner);
// The tables that patches are sampled by, and a question that is asked between samples of patches
// of many sides: what it throws ends the build.
struct Sampler {
  Sampler(const ValenceTables& with, const Poll* asked = nullptr) : tables(with), poll(asked) {}
  void ask(std::uint32_t n) const {
    if (n > 64 && poll != nullptr) (*poll)();
  }

  const ValenceTables& tables;
  const Poll* poll;  // null: nobody asks
};

// Normals, of any length, at `at`: domain points.
std::vector<Vec3> normals_of(const PatchDraft& draft, const Sampler& sampler,
                             std::span<const Eigen::Vector2d> at);
// PatchShape::turn of these points alone.
double least_turn(const PatchDraft& draft, const Sampler& sampler,
                  std::span<const Eigen::Vector2d> at);
// `samples`: null, or what becomes of the probes for tiles to be cut from (patch_tiles.h).
PatchShape examine(const PatchDraft& draft, const Sampler& sampler,
                   PatchSamples* samples = nullptr);
// The shape of a patch in any form, from its pieces.
PatchShape examine(const PatchFrame& frame, const double* corner, const std::uint32_t* triangle,
                   const ControlData& control, const Sampler& sampler,
                   PatchSamples* samples = nullptr);
// True if the normals of a patch at the coarse probes are as near to its base polygon's as a gentle
// patch's. False for triangles that blend sides and where there are no such probes.
bool keeps_direction(const PatchFrame& frame, const ControlData& control, const Sampler& sampler);
// PatchShape::turn of more samples.
double least_cosine_closely(const PatchDraft& draft, const Sampler& sampler);

// The control data of a patch in another form, with room in `out` (Kernels::to_form).
void take_to_form(const double* corner, const ControlData& control, std::uint32_t form,
                  const Sampler& sampler, double* out);

}  // namespace gliss
