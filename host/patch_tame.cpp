#include "host/patch_tame.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/kernels.h"

namespace gliss {
namespace {

// A patch whose normal stays within 84 degrees of its polygon's neither folds nor nearly does.
constexpr double kSafeTurn = 0.1;
constexpr std::uint32_t kMaxFan = 64;  // faces of more sides are not cut from their centre: slivers
constexpr double kFarthestCentre = 2;  // from the middle of a polygon in [-1, 1]^3
// Cross tangents of weaker ribbons turn about within less of their side than floats tell apart.
constexpr double kTurnsAbout = 1e-6;
constexpr double kInside = 1 - 1e-5;  // how far from the centre to a side counts as just inside

// The same boundary, with cross tangents shortened until the patch no longer folds; else the best
// of them. As it was where they have no direction to speak of.
PatchDraft ease(const PatchDraft& draft, const ValenceTables& tables) {
  PatchDraft best = draft;
  if (draft.soundness < kTurnsAbout) return best;
  for (const double amount : {0.25, 0.5, 0.75, 0.9}) {
    if (best.shape.turn > kSafeTurn) break;
    PatchDraft d = draft;
    if (d.kind == PatchKind::kExact) d.kind = PatchKind::kEased;
    kernels<double>().ease_patch(d.control.data(), d.valence(), amount);
    d.shape = examine(d, tables);
    if (d.shape.turn > best.shape.turn) best = std::move(d);
  }
  return best;
}

// The same boundary curves, with cross tangents in the plane of the polygon, shorter and shorter:
// without any, a corner interpolator is the sum of its two curves.
PatchDraft bend(const PatchDraft& draft, const ValenceTables& tables) {
  PatchDraft best;
  for (const double length : {1.0, 0.5, 0.0}) {
    PatchDraft d = draft;
    d.kind = PatchKind::kBent;
    d.soundness = 1;
    const std::uint32_t n = d.valence();
    for (std::size_t k = 0; k < n; ++k) {
      for (const std::size_t at : {kSideLength, kSideLength + 1})
        d.control[k * kSideReals + at] *= length;
    }
    kernels<double>().bend_patch(d.control.data(), n, d.frame.normal.data());
    d.shape = examine(d, tables);
    // Of two that are as bad, the one that moves less.
    if (best.control.empty() || d.shape.turn >= best.shape.turn) best = std::move(d);
    if (best.shape.turn > kSafeTurn) break;
  }
  return best;
}

// The cuts inside a face as straight lines, which both of their triangles can share when normals
// are given up.
void straighten_cuts(PatchDraft& d, std::uint32_t face_valence) {
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t start = d.face_corner[k], end = d.face_corner[(k + 1) % 3];
    if (start < face_valence && end == (start + 1) % face_valence) continue;
    double* curve = &d.control[k * kSideReals];
    for (std::size_t i = 0; i < 3; ++i) {
      curve[3 + i] = d.corner[6 * ((k + 1) % 3) + i] - d.corner[6 * k + i];
      curve[6 + i] = curve[9 + i] = 0;
    }
  }
}

// The face cut into triangles that share its corners and perhaps a centre, each with the normals of
// its corners: they join each other and the neighbours with G1 continuity as any two patches do.
// Bent: with continuity of position only.
std::vector<PatchDraft> split(const FaceCorners& face,
                              const std::vector<std::array<std::uint32_t, 3>>& triangles,
                              std::uint32_t face_valence, bool bent, const ValenceTables& tables) {
  std::vector<PatchDraft> parts;
  for (const auto& t : triangles) {
    PatchDraft d = draft_patch(face, {t[0], t[1], t[2]});
    if (bent) {
      straighten_cuts(d, face_valence);
      d = bend(d, tables);
    } else {
      d.kind = PatchKind::kSplit;
      d.shape = examine(d, tables);
      if (is_degenerate(d.soundness)) d.shape.turn = -1;
      d = ease(d, tables);
    }
    parts.push_back(std::move(d));
  }
  return parts;
}

// The face with a centre as its last corner: places and normals to try. Where ribbons degenerate,
// the middle of the patch may be anywhere.
std::vector<FaceCorners> with_centres(const FaceCorners& face, const PatchDraft& exact,
                                      const ValenceTables& tables) {
  Vec3 centroid = Vec3::Zero(), normal = Vec3::Zero();
  for (const Vec3& p : face.position) centroid += p / static_cast<double>(face.position.size());
  for (const Vec3& m : face.normal) normal += m;
  double at[9];
  const double zero = 0;
  const auto n = static_cast<std::uint32_t>(face.position.size());
  kernels<double>().evaluate(tables.domain_of(n), exact.control.data(), kFormExact, n, &zero, &zero,
                             1, 1, at);
  const Vec3 middle = exact.frame.origin + Vec3(at[0], at[1], at[2]) / exact.frame.scale;
  std::vector<FaceCorners> all;
  for (const Vec3& p : {middle, Vec3(0.5 * (middle + centroid)), centroid}) {
    if (!(((p - exact.frame.origin) * exact.frame.scale).norm() < kFarthestCentre)) continue;
    for (const Vec3& m : {normal, exact.frame.normal}) {
      if (!(m.norm() > 0.1)) continue;
      all.push_back(face);
      all.back().position.push_back(p);
      all.back().normal.push_back(m.normalized());
    }
  }
  return all;
}

// Whether the patch lies on the outer side of n_c all along its boundary: where a vertex normal
// points against the face, the ribbon may turn over, and the surface would double back along the
// edge.
bool keeps_normals(const PatchDraft& d, const ValenceTables& tables) {
  const std::uint32_t n = d.valence();
  const std::uint32_t steps = n > 32 ? 2 : 8;
  std::vector<Eigen::Vector2d> at;
  for (std::uint32_t side = 0; side < n; ++side) {
    for (std::uint32_t i = 0; i < steps; ++i)
      at.emplace_back(kInside * on_side(n, side, (i + 0.5) / steps));
  }
  const std::vector<Vec3> normals = normals_of(d, tables, at);
  for (std::size_t i = 0; i < at.size(); ++i) {
    double normal[3];
    kernels<double>().side_normal(&d.control[i / steps * kSideReals],
                                  (static_cast<double>(i % steps) + 0.5) / steps, normal);
    if (!(normals[i].dot(Vec3(normal[0], normal[1], normal[2])) > 0)) return false;
  }
  return true;
}

// The least of all patches; as bad as can be where boundary normals are promised and not kept.
double worst_turn(const std::vector<PatchDraft>& drafts, const ValenceTables& tables) {
  double turn = 1;
  for (const PatchDraft& d : drafts) {
    const bool kept = d.kind == PatchKind::kBent || keeps_normals(d, tables);
    turn = std::min(turn, kept ? d.shape.turn : -1);
  }
  return turn;
}

}  // namespace

std::vector<PatchDraft> draft_tamer(const FaceCorners& face, PatchDraft exact,
                                    const ValenceTables& tables) {
  if (is_degenerate(exact.soundness)) exact.shape.turn = -1;
  const std::uint32_t n = exact.valence();
  std::vector<FaceCorners> fans;
  if (n <= kMaxFan) fans = with_centres(face, exact, tables);
  std::vector<std::array<std::uint32_t, 3>> fan, ears;
  for (std::uint32_t k = 0; k < n; ++k) fan.push_back({k, (k + 1) % n, n});
  for (std::size_t t = 0; t < exact.triangle.size(); t += 3) {
    ears.push_back({exact.triangle[t], exact.triangle[t + 1], exact.triangle[t + 2]});
  }
  std::vector<PatchDraft> best;
  double best_turn = 0;
  const auto offer = [&](std::vector<PatchDraft> other) {
    const double turn = worst_turn(other, tables);
    if (best.empty() || turn > best_turn) {
      best = std::move(other);
      best_turn = turn;
    }
    return best_turn > kSafeTurn;
  };
  // With the boundary normals as they are, if that gives a surface without a fold; without them
  // otherwise.
  for (const bool bent : {false, true}) {
    best.clear();
    if (offer({bent ? bend(exact, tables) : ease(exact, tables)})) return best;
    for (const FaceCorners& f : fans) {
      if (offer(split(f, fan, n, bent, tables))) return best;
    }
    if (n > 3 && offer(split(face, ears, n, bent, tables))) return best;
  }
  return best;
}

}  // namespace gliss
