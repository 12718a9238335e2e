#include "gliss/build/patch_tame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "gliss/surface/domain.h"
#include "gliss/surface/instances.h"
#include "gliss/surface/layout.h"

namespace gliss {
namespace {

// A patch whose normal stays within 84 degrees of its polygon's neither folds nor nearly does.
constexpr double kSafeCosine = 0.1;
constexpr double kRounding = 1e-9;     // far above that of a cosine
constexpr double kMostSag = 4;         // mesh frame: no sound patch goes farther
constexpr std::uint32_t kMaxFan = 64;  // faces of more sides are not cut from their centre: slivers
static_assert(kMaxFan <= kFanCorner);
constexpr double kFarthestCentre = 2;  // from the middle of a polygon in [-1, 1]^3
// Cross tangents of weaker ribbons turn about within less of their side than floats tell apart.
constexpr double kNoDirection = 1e-6;
constexpr double kInside = 1 - 1e-5;  // how far from the centre to a side counts as just inside

// PatchShape::turn of the outermost probes alone, where most patches that fold do so: examine()
// finds no more than that. It takes a tenth of the time.
double least_cosine_at_rim(const PatchDraft& d, const Sampler& sampler) {
  const std::uint32_t n = d.valence(), levels = kernels<double>().probe_levels(n);
  const double *xi = sampler.tables.probes_of(n), *eta = xi + kernels<double>().probe_reals(n) / 2;
  std::vector<Eigen::Vector2d> at;
  for (std::uint32_t i = 0; i < n * levels; ++i) {
    const std::uint32_t place = kernels<double>().probe_place(n, levels, i);
    at.emplace_back(xi[place], eta[place]);
  }
  return least_turn(d, sampler, at) + kRounding;
}

// True if the patch lies on the outer side of n_c all along its boundary, which is that of `exact`:
// where a vertex normal points against the face, the ribbon may turn over, and the surface would
// double back along the edge.
bool keeps_normals(const PatchDraft& d, const PatchDraft& exact, const Sampler& sampler) {
  if (!d.side.empty()) return d.inward_share > 0;
  const std::uint32_t n = d.valence();
  const std::uint32_t steps = n > 32 ? 2 : 8;
  std::vector<Eigen::Vector2d> at;
  for (std::uint32_t side = 0; side < n; ++side) {
    for (std::uint32_t i = 0; i < steps; ++i)
      at.emplace_back(kInside * on_side(n, side, (i + 0.5) / steps));
  }
  const std::vector<Vec3> normals = normals_of(d, sampler, at);
  for (std::size_t i = 0; i < at.size(); ++i) {
    double normal[3];
    kernels<double>().side_normal(&exact.control[i / steps * kSideReals],
                                  (static_cast<double>(i % steps) + 0.5) / steps, normal);
    if (!(normals[i].dot(vector_at(normal)) > 0)) return false;
  }
  return true;
}

// Examines a patch with more samples where it seems safe: those of many sides have few, and one
// that is flat may fold in its plane between them though it curves nowhere.
void examine_closely(PatchDraft& d, const Sampler& sampler) {
  d.shape = examine(d, sampler);
  if (d.shape.least_cosine > kSafeCosine)
    d.shape.least_cosine = std::min(d.shape.least_cosine, least_cosine_closely(d, sampler));
}

// The same boundary, with cross tangents shortened; not examined.
PatchDraft eased(const PatchDraft& draft, double amount) {
  PatchDraft d = draft;
  if (d.kind == PatchKind::kPlain) d.kind = PatchKind::kEased;
  kernels<double>().ease_patch(d.control.data(), d.valence(), amount);
  return d;
}

// The same boundary, with cross tangents shortened until the patch is safe; none where it never is.
// Cross tangents stay as they were where they have no direction to speak of.
std::optional<PatchDraft> ease(const PatchDraft& draft, const Sampler& sampler) {
  if (draft.shape.least_cosine > kSafeCosine) return draft;
  if (draft.soundness < kNoDirection || draft.form != kFormPaper) return std::nullopt;
  for (const double amount : {0.25, 0.5, 0.75, 0.9}) {
    PatchDraft d = eased(draft, amount);
    if (!(least_cosine_at_rim(d, sampler) > kSafeCosine)) continue;
    examine_closely(d, sampler);
    if (d.shape.least_cosine > kSafeCosine) return d;
  }
  return std::nullopt;
}

// The paper's patch with cross tangents that are polynomials; empty where that is not safe either.
std::vector<PatchDraft> relaxed(const PatchDraft& exact, const Sampler& sampler) {
  const std::uint32_t n = exact.valence();
  if (is_degenerate(exact.soundness)) return {};
  PatchDraft d = exact;
  d.kind = PatchKind::kEased;
  d.form = kFormRibbon;
  d.control.resize(kernels<double>().control_reals(d.form, n));
  take_to_form(d.corner.data(), {exact.control.data(), kFormPaper, n}, d.form, sampler,
               d.control.data());
  examine_closely(d, sampler);
  if (!(d.shape.least_cosine > kSafeCosine) || !keeps_normals(d, exact, sampler)) return {};
  return {std::move(d)};
}

// Tells bent patches of one face apart. Those that are safe by how near they stay to their
// polygons, for without the boundary's normals nothing else holds them there; others by how they
// turn.
struct Quality {
  double least_cosine = -2;  // the worst
  double sag = 0;            // the largest, mesh frame

  bool is_safe() const { return least_cosine > kSafeCosine; }
  // A change has to be worth it.
  bool is_better(const Quality& than) const {
    if (is_safe() != than.is_safe()) return is_safe();
    return is_safe() ? sag < 0.5 * than.sag : least_cosine > than.least_cosine;
  }
};
// One whose slopes shoot out between samples is as bad as any.
Quality quality_of(const PatchDraft& d) {
  const double sag = d.shape.sag / d.frame.scale;
  return {sag < kMostSag ? d.shape.least_cosine : -1, sag};
}

// The same boundary curves, with cross tangents in the plane of the polygon, shorter and shorter:
// without any, a corner interpolator is the sum of its two curves. The best, if it is better than
// `worst`.
std::optional<PatchDraft> bent_patch(const PatchDraft& draft, Quality worst,
                                     const Sampler& sampler) {
  std::optional<PatchDraft> best;
  for (const double length : {1.0, 0.5, 0.0}) {
    PatchDraft d = draft;
    d.kind = PatchKind::kBent;
    d.soundness = 1;
    const std::uint32_t n = d.valence();
    if (!d.side.empty()) {
      kernels<double>().fair_controls(d.side.data(), 1, n, d.frame.normal.data(), length,
                                      d.control.data(), &d.inward_share);
    } else {
      for (std::size_t k = 0; k < n; ++k) {
        for (const std::size_t at : {kSideLength, kSideLength + 1})
          d.control[k * kSideReals + at] *= length;
      }
      kernels<double>().flatten_tangents(d.control.data(), n, d.frame.normal.data());
    }
    if (least_cosine_at_rim(d, sampler) < std::min(worst.least_cosine, kSafeCosine)) continue;
    d.shape = examine(d, sampler);
    const Quality quality = quality_of(d);
    // The shorter one wins if two are as bad.
    const bool is_as_bad = best && !quality.is_safe() && quality.least_cosine == worst.least_cosine;
    if (!is_as_bad && !quality.is_better(worst)) continue;
    worst = quality;
    best = std::move(d);
  }
  return best;
}

// The cuts inside a face as straight lines, which both of their triangles can share when normals
// are given up.
void straighten_cuts(PatchDraft& d, std::uint32_t face_valence) {
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t start = d.face_corner[k], end = d.face_corner[(k + 1) % 3];
    if (start < face_valence && end == (start + 1) % face_valence) continue;
    const bool is_fair = !d.side.empty();
    double* curve = is_fair ? &d.side[k * kFairReals] : &d.control[k * kSideReals];
    std::fill_n(curve + 3, 3 * ((is_fair ? kFairCurve : 4) - 1), 0.0);
    for (std::size_t i = 0; i < 3; ++i)
      curve[3 + i] = d.corner[6 * ((k + 1) % 3) + i] - d.corner[6 * k + i];
  }
}

// The face with a centre as its last corner: places and normals to try. Where ribbons degenerate,
// the middle of the patch may be anywhere.
std::vector<FaceCorners> with_centres(const FaceCorners& face, const PatchDraft& exact,
                                      const Sampler& sampler) {
  Vec3 centroid = Vec3::Zero(), normal = Vec3::Zero();
  for (const Vec3& p : face.position) centroid += p / static_cast<double>(face.position.size());
  for (const Vec3& m : face.normal) normal += m;
  double at[9];
  const double zero = 0;
  const auto n = static_cast<std::uint32_t>(face.position.size());
  kernels<double>().evaluate(sampler.tables.domain_of(n), exact.control.data(), exact.form, n,
                             &zero, &zero, 1, 1, at);
  const Vec3 middle = exact.frame.origin + vector_at(at) / exact.frame.scale;
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

using Cuts = std::vector<std::array<std::uint32_t, 3>>;  // triangles of corners of a face

// The face cut into triangles that share its corners and perhaps a centre, each with the normals of
// its corners: they join each other and the neighbours with G1 continuity as any two patches do.
// None where one of them is not safe.
std::vector<PatchDraft> split(const FaceCorners& face, const Cuts& cuts, const Sampler& sampler) {
  std::vector<PatchDraft> parts;
  for (const auto& t : cuts) {
    PatchDraft d = draft_patch(face, {t[0], t[1], t[2]});
    d.kind = PatchKind::kSplit;
    d.shape.least_cosine = -1;
    if (!is_degenerate(d.soundness) && least_cosine_at_rim(d, sampler) > kSafeCosine)
      d.shape = examine(d, sampler);
    std::optional<PatchDraft> safe = ease(d, sampler);
    if (!safe || !keeps_normals(*safe, *safe, sampler)) return {};
    parts.push_back(*std::move(safe));
  }
  return parts;
}

// The same with continuity of position only. None where a triangle is no better than `worst`, or is
// turned away from the face, as round a centre that lies outside of it.
std::vector<PatchDraft> split_bent(const FaceCorners& face, const Cuts& cuts,
                                   std::uint32_t face_valence, const Vec3& face_normal,
                                   const Quality& worst, const Sampler& sampler) {
  std::vector<PatchDraft> parts;
  for (const auto& t : cuts) {
    PatchDraft d = draft_patch(face, {t[0], t[1], t[2]});
    if (!(d.frame.normal.dot(face_normal) > kSafeCosine)) return {};
    straighten_cuts(d, face_valence);
    std::optional<PatchDraft> bent = bent_patch(d, worst, sampler);
    if (!bent) return {};
    parts.push_back(*std::move(bent));
  }
  return parts;
}

// Gives the patches of a face that is cut round a centre the triangles of its polygon: to each one
// that has its side, while there are such, and to two of them a corner.
void share_triangles(const FaceCorners& face, const std::vector<std::uint32_t>& triangles,
                     std::vector<PatchDraft>& parts) {
  const auto n = static_cast<std::uint32_t>(parts.size());
  std::vector<std::uint32_t> holder(triangles.size() / 3, n);
  for (std::uint32_t k = 0; k < n; ++k) parts[k].piece = {k, k, k};
  for (const bool by_side : {true, false}) {
    for (std::size_t t = 0; t < holder.size(); ++t) {
      const std::uint32_t* c = &triangles[3 * t];
      const auto takes = [&](std::uint32_t k) {
        const std::uint32_t next = (k + 1) % n;
        return !by_side || (c[0] == k && c[1] == next) || (c[1] == k && c[2] == next) ||
               (c[2] == k && c[0] == next);
      };
      for (std::uint32_t k = 0; k < n && holder[t] == n; ++k) {
        if (parts[k].piece[1] != k || parts[k].piece[0] != k || !takes(k)) continue;
        holder[t] = k;
        parts[k].piece = {c[0], c[1], c[2]};
      }
    }
  }
  for (PatchDraft& d : parts) {
    for (const std::uint32_t c : d.piece)
      d.piece_corner.push_back((face.position[c] - d.frame.origin) * d.frame.scale);
  }
}

Quality quality_of(const std::vector<PatchDraft>& drafts) {
  Quality all{1, 0};
  for (const PatchDraft& d : drafts) {
    const Quality one = quality_of(d);
    all.least_cosine = std::min(all.least_cosine, one.least_cosine);
    all.sag = std::max(all.sag, one.sag);
  }
  return all;
}

std::vector<PatchDraft> find_tamer(const FaceCorners& face, PatchDraft exact,
                                   const Sampler& sampler) {
  const bool is_curved = exact.form == kFormCurved;
  if (is_curved) {  // the paper's keeps the boundary normals too
    exact = draft_paper(face, std::move(exact.face_corner));
    exact.kind = PatchKind::kEased;
    examine_closely(exact, sampler);
  }
  if (is_degenerate(exact.soundness)) exact.shape.least_cosine = -1;
  if (is_curved && exact.shape.least_cosine > kSafeCosine) return {std::move(exact)};
  const std::uint32_t n = exact.valence();
  std::vector<FaceCorners> fans;
  if (n <= kMaxFan) fans = with_centres(face, exact, sampler);
  Cuts fan, ears;
  for (std::uint32_t k = 0; k < n; ++k) fan.push_back({k, (k + 1) % n, n});
  for (std::size_t t = 0; t < exact.triangle.size(); t += 3) {
    ears.push_back({exact.triangle[t], exact.triangle[t + 1], exact.triangle[t + 2]});
  }
  // It keeps the boundary normals as they are if that gives a safe surface.
  std::vector<PatchDraft> parts;
  if (face.is_fair() && n > 4) parts = relaxed(exact, sampler);
  if (std::optional<PatchDraft> safe = ease(exact, sampler);
      parts.empty() && safe && keeps_normals(*safe, *safe, sampler))
    parts = {*std::move(safe)};
  for (std::size_t i = 0; i < fans.size() && parts.empty(); ++i)
    parts = split(fans[i], fan, sampler);
  if (n > 3 && parts.empty()) parts = split(face, ears, sampler);
  if (!parts.empty()) return parts;

  // Without them otherwise: the best.
  std::vector<PatchDraft> best{*bent_patch(exact, {}, sampler)};
  const auto offer = [&](const FaceCorners& corners, const Cuts& cuts) {
    parts = split_bent(corners, cuts, n, exact.frame.normal, quality_of(best), sampler);
    if (!parts.empty()) best = std::move(parts);
  };
  // Fans are near their own triangles, wherever the centre lies.
  for (std::size_t i = 0; i < fans.size() && !quality_of(best).is_safe(); ++i) offer(fans[i], fan);
  if (n > 3) offer(face, ears);
  return best;
}

}  // namespace

std::vector<PatchDraft> draft_flatter(const FaceCorners& face, PatchDraft exact, double most,
                                      const Sampler& sampler) {
  if (exact.form == kFormCurved) exact = draft_paper(face, std::move(exact.face_corner));
  if (is_degenerate(exact.soundness) || exact.form != kFormPaper) return {};
  std::vector<PatchDraft> best;
  for (const double amount : {0.0, 0.25, 0.5, 0.75, 0.9}) {
    PatchDraft d = eased(exact, amount);
    d.shape = examine(d, sampler);
    if (!(d.shape.least_cosine > kSafeCosine) || !keeps_normals(d, exact, sampler)) continue;
    best = {std::move(d)};
    if (best.front().shape.sag <= most * best.front().frame.scale) break;
  }
  return best;
}

std::vector<PatchDraft> draft_tamer(const FaceCorners& face, PatchDraft exact,
                                    const Sampler& sampler) {
  const std::uint32_t n = exact.valence();
  const std::vector<std::uint32_t> triangles = exact.triangle;
  std::vector<PatchDraft> parts = find_tamer(face, std::move(exact), sampler);
  if (parts.size() > 1 && parts.front().face_corner.back() == n)
    share_triangles(face, triangles, parts);
  return parts;
}

}  // namespace gliss
