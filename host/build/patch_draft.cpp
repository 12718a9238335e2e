#include "gliss/build/patch_draft.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "gliss/mesh/triangulate.h"
#include "gliss/surface/domain.h"
#include "gliss/surface/instances.h"

namespace gliss {
namespace {

constexpr double kFarthestReach = 4;
constexpr std::uint32_t kCloser = 3;  // times as many samples along a line

}  // namespace

bool may_fold_unseen(const PatchShape& s) {
  return !is_folded(s) && std::acos(s.least_cosine) + s.unseen / 2 > std::numbers::pi / 2;
}

std::vector<std::uint32_t> all_corners(std::uint32_t n) {
  std::vector<std::uint32_t> all(n);
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

void PatchFrame::store(double* reals) const {
  std::copy_n(normal.data(), 3, reals);
  std::copy_n(tangent.data(), 3, reals + 3);
}

void PatchFrame::place_side(double* side) const {
  for (int i = 0; i < 3; ++i) side[i] -= origin[i];
  for (std::size_t i = 0; i < 3 * kFairCurve; ++i) side[i] *= scale;
}

PatchFrame place_polygon(const FaceCorners& face, std::span<const std::uint32_t> face_corner,
                         double* corner, std::uint32_t* triangle) {
  PatchFrame frame;
  const std::size_t n = face_corner.size();
  thread_local std::vector<Vec3> position;
  thread_local std::vector<std::uint32_t> triangles;
  position.clear(), triangles.clear();
  Box box{face.position[face_corner[0]], face.position[face_corner[0]]};
  for (const std::uint32_t c : face_corner) {
    position.push_back(face.position[c]);
    box.hold(position.back());
  }
  frame.origin = (0.5 * (box.low + box.high)).cast<float>().cast<double>();
  int exponent = 0;
  std::frexp((box.high - box.low).maxCoeff(), &exponent);
  frame.scale = std::ldexp(1.0, 1 - exponent);
  frame.normal = Vec3::Zero();
  for (std::size_t k = 0; k < n; ++k) {
    position[k] = (position[k] - frame.origin) * frame.scale;
    std::copy_n(position[k].data(), 3, corner + 6 * k);
    std::copy_n(face.normal[face_corner[k]].data(), 3, corner + 6 * k + 3);
  }
  for (std::size_t k = 0; k < n; ++k) frame.normal += position[k].cross(position[(k + 1) % n]);
  triangulate(position, frame.normal, triangles);
  std::copy(triangles.begin(), triangles.end(), triangle);
  // The polygon's area vanishes: any direction that its vertex normals agree on.
  if (!(frame.normal.norm() > 0)) frame.normal = face.normal[face_corner[0]];
  frame.normal.normalize();
  frame.tangent = (position[1] - position[0]).cross(frame.normal);
  if (!(frame.tangent.norm() > 0)) frame.tangent = frame.normal.unitOrthogonal();
  frame.tangent.normalize();
  return frame;
}

void PatchShape::hold(const Vec3& point, const PatchFrame& frame) {
  const Vec3 along(point.dot(frame.tangent), point.dot(frame.normal.cross(frame.tangent)),
                   point.dot(frame.normal));
  box.hold(point);
  low = low.cwiseMin(along);
  high = high.cwiseMax(along);
}

void PatchSamples::set_shape(const double* reals, std::uint32_t n) {
  is_gentle = reals[kShapeRings] < kernels<double>().probe_levels(n);
  stretch2 = reals[kShapeStretch2];
}

PatchShape shape_from(const double* reals) {
  const auto triple = [&](std::size_t at) { return Vec3(Eigen::Map<const Vec3>(reals + at)); };
  const double curvature = reals[kShapeCurvature], stretch2 = reals[kShapeStretch2];
  const double rings = reals[kShapeRings];
  // Between samples the patch leaves their triangles by at most (spacing)^2 curvature / 8; half as
  // much again for curvature between samples.
  const double spacing2 = stretch2 / (rings * rings);
  const double slack =
      std::min(std::sqrt(spacing2), spacing2 * curvature * (1.5 / 8)) + 1e-4 * std::sqrt(stretch2);
  const Vec3 margin = Vec3::Constant(slack);
  PatchShape shape;
  shape.box = {triple(kShapeLow) - margin, triple(kShapeHigh) + margin};
  shape.low = triple(kShapeAlongLow) - margin;
  shape.high = triple(kShapeAlongHigh) + margin;
  shape.second_form = triple(kShapeSecondForm);
  if (!shape.second_form.allFinite()) shape.second_form.setZero();
  shape.sampled_sag = std::sqrt(reals[kShapeSag2]);
  shape.sag = shape.sampled_sag + slack;
  shape.unseen = std::sqrt(spacing2) * curvature;
  shape.rho_min = curvature > 0 ? 1 / curvature : std::numeric_limits<double>::infinity();
  // Polygons lie in [-1, 1]^3 of their frame: where cross tangents have hardly a direction, patches
  // shoot out of it.
  const double reach =
      triple(kShapeLow).cwiseAbs().cwiseMax(triple(kShapeHigh).cwiseAbs()).maxCoeff();
  shape.least_cosine =
      reals[kShapeFinite] > 0 && reach <= kFarthestReach ? reals[kShapeLeastCosine] : -1;
  return shape;
}

namespace {

// The side of a face from one of its corners to another, mesh frame: its own, or one that cuts
// through it.
std::array<double, kFairReals> fair_side(const FaceCorners& face, std::uint32_t start,
                                         std::uint32_t end) {
  std::array<double, kFairReals> side;
  const auto n = static_cast<std::uint32_t>(face.side.size() / kFairReals);
  if (start < n && end == (start + 1) % n) {
    std::copy_n(&face.side[start * kFairReals], kFairReals, side.data());
    return side;
  }
  FairSide<double> through;
  const auto put = [&](std::uint32_t corner, double* to) {
    std::copy_n(face.position[corner].data(), 3, to);
    std::copy_n(face.normal[corner].data(), 3, to + 3);
  };
  put(start, through.edge.start);
  put(end, through.edge.end);
  through.edge.by_arc = 1;
  kernels<double>().fair_sides(&through, 1, side.data());
  return side;
}

// The paper's patch: tangents of the face's own sides, as eq. 7 to 9 have them at the others.
void draft_sharp(const FaceCorners& face, PatchDraft& d) {
  const std::uint32_t n = d.valence();
  const auto sides = static_cast<std::uint32_t>(face.tangent.size() / 2);
  std::vector<double> tangents(6 * n, 0.0);
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t start = d.face_corner[k];
    if (start >= sides || d.face_corner[(k + 1) % n] != (start + 1) % sides) continue;
    for (std::uint32_t i = 0; i < 2; ++i) {
      const Vec3 tangent = d.frame.scale * face.tangent[2 * start + i];
      std::copy_n(tangent.data(), 3, &tangents[6 * k + 3 * i]);
    }
  }
  d.soundness =
      kernels<double>().build_sharp_patch(d.corner.data(), tangents.data(), n, d.control.data());
}

void draft_paper(const FaceCorners& face, PatchDraft& d) {
  d.control.resize(d.valence() * kSideReals);
  if (!face.tangent.empty()) return draft_sharp(face, d);
  kernels<double>().build_patches(d.corner.data(), d.valence(), 1, d.control.data(), &d.soundness);
}

// Makes a plain draft of its face_corner, without control data.
void place(const FaceCorners& face, PatchDraft& d) {
  const std::size_t n = d.face_corner.size();
  d.kind = PatchKind::kPlain;
  d.form = kFormPaper;
  d.soundness = d.inward_share = 1;
  d.side.clear();
  d.corner.resize(n * 6);
  d.triangle.resize(3 * (n - 2));
  d.frame = place_polygon(face, d.face_corner, d.corner.data(), d.triangle.data());
}

// Its control data, from sides that both patches at an edge have in common.
void draft_fair(const FaceCorners& face, PatchDraft& d) {
  const std::uint32_t n = d.valence();
  d.form = fair_form(n);
  d.side.resize(n * kFairReals);
  for (std::uint32_t k = 0; k < n; ++k) {
    std::array<double, kFairReals> side =
        fair_side(face, d.face_corner[k], d.face_corner[(k + 1) % n]);
    d.frame.place_side(side.data());
    std::copy_n(side.data(), kFairReals, &d.side[k * kFairReals]);
    d.soundness = std::min(d.soundness, side[kFairSound]);
  }
  d.control.resize(kernels<double>().control_reals(d.form, n));
  kernels<double>().fair_controls(d.side.data(), 1, n, nullptr, 1, d.control.data(),
                                  &d.inward_share);
}

}  // namespace

PatchDraft draft_patch(const FaceCorners& face, std::vector<std::uint32_t> face_corner) {
  PatchDraft d;
  d.face_corner = std::move(face_corner);
  draft_patch(face, d);
  return d;
}

void draft_patch(const FaceCorners& face, PatchDraft& d) {
  place(face, d);
  if (face.is_fair() && d.valence() <= kMostFairSides) return draft_fair(face, d);
  draft_paper(face, d);
}

PatchDraft draft_paper(const FaceCorners& face, std::vector<std::uint32_t> face_corner) {
  PatchDraft d;
  d.face_corner = std::move(face_corner);
  place(face, d);
  draft_paper(face, d);
  return d;
}

PatchShape examine(const PatchFrame& frame, const double* corner, const std::uint32_t* triangle,
                   const ControlData& control, const Sampler& sampler, PatchSamples* samples) {
  const std::uint32_t n = control.sides;
  sampler.ask(n);
  const Kernels<double>& k = kernels<double>();
  double axes[kFrameReals], reals[kShapeReals];
  frame.store(axes);
  if (samples != nullptr) {
    samples->count = static_cast<std::uint32_t>(k.probe_reals(n) / 2);
    samples->rows.resize(kCutRows * samples->count);
  }
  k.examine(sampler.tables.domain_of(n), sampler.tables.probes_of(n), k.probe_coarse(n),
            sampler.tables.probe_count[n], control.reals, control.form, corner, triangle, axes, n,
            sampler.tables.second_of(control.form, n),
            samples == nullptr ? nullptr : samples->rows.data(), reals);
  if (samples != nullptr) samples->set_shape(reals, n);
  return shape_from(reals);
}

std::vector<Vec3> normals_of(const PatchDraft& d, const Sampler& sampler,
                             std::span<const Eigen::Vector2d> at) {
  constexpr std::size_t kMost = 1024;  // together
  const std::size_t stride = std::min(kMost, at.size());
  std::vector<double> xi(stride), eta(stride), rows(9 * stride);
  std::vector<Vec3> normals;
  normals.reserve(at.size());
  while (normals.size() < at.size()) {
    sampler.ask(d.valence());
    const auto some = at.subspan(normals.size(), std::min(stride, at.size() - normals.size()));
    for (std::size_t i = 0; i < some.size(); ++i) xi[i] = some[i].x(), eta[i] = some[i].y();
    kernels<double>().evaluate(sampler.tables.domain_of(d.valence()), d.control.data(), d.form,
                               d.valence(), xi.data(), eta.data(), some.size(), stride,
                               rows.data());
    for (std::size_t i = 0; i < some.size(); ++i) {
      const auto row = [&](std::size_t r) {
        return Vec3(rows[r * stride + i], rows[(r + 1) * stride + i], rows[(r + 2) * stride + i]);
      };
      normals.push_back(row(3).cross(row(6)));
    }
  }
  return normals;
}

double least_turn(const PatchDraft& d, const Sampler& sampler,
                  std::span<const Eigen::Vector2d> at) {
  double cosine = 1;
  for (const Vec3& normal : normals_of(d, sampler, at))
    cosine = std::min(cosine, normal.normalized().dot(d.frame.normal));
  return cosine;
}

PatchShape examine(const PatchDraft& d, const Sampler& sampler, PatchSamples* samples) {
  PatchShape shape =
      examine(d.frame, d.corner.data(), d.triangle.data(), d.control_data(), sampler, samples);
  if (!(d.inward_share > 0)) shape.least_cosine = -1;
  return shape;
}

void take_to_form(const double* corner, const ControlData& control, std::uint32_t form,
                  const Sampler& sampler, double* out) {
  const Kernels<double>& k = kernels<double>();
  const std::uint32_t n = control.sides;
  if ((form & 255u) != kFormTable) return k.to_form(corner, control.reals, form, n, out);
  for (std::uint32_t part = 0; part < n; ++part) {
    sampler.ask(n);
    k.to_table(sampler.tables.domain_of(n), control.reals, control.form, form, n, part, out);
  }
}

bool keeps_direction(const PatchFrame& frame, const ControlData& control, const Sampler& sampler) {
  constexpr std::size_t kAlongNormal = 5;  // the row of n . normal of the base polygon
  const Kernels<double>& k = kernels<double>();
  const std::uint32_t n = control.sides, count = k.probe_coarse(n);
  if (count == 0 || (n == 3 && blends_sides(control.form))) return false;
  thread_local std::vector<double> rows;
  rows.resize(kCutRows * count);
  double axes[kFrameReals];
  frame.store(axes);
  const double *xi = sampler.tables.probes_of(n), *eta = xi + k.probe_reals(n) / 2;
  k.sample(sampler.tables.domain_of(n), control.reals, control.form, axes, n, xi, eta, count,
           rows.data());
  return std::all_of(&rows[kAlongNormal * count], rows.data() + (kAlongNormal + 1) * count,
                     [](double cosine) { return cosine > kGentleCosine; });
}

double least_cosine_closely(const PatchDraft& d, const Sampler& sampler) {
  const std::uint32_t n = d.valence(), levels = kCloser * kernels<double>().probe_levels(n);
  std::vector<Eigen::Vector2d> at;
  at.reserve(n * levels * (levels + 1) / 2);
  for (std::uint32_t side = 0; side < n; ++side) {
    const Eigen::Vector2d start = on_side(n, side, 0), along = on_side(n, side, 1) - start;
    for (double ring = 1; ring <= levels; ++ring) {
      for (double i = 0; i < ring; ++i) at.emplace_back((ring * start + i * along) / levels);
    }
  }
  return least_turn(d, sampler, at);
}

}  // namespace gliss
