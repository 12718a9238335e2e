#include "host/patch_draft.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <numbers>
#include <numeric>

#include "host/kernels.h"
#include "host/triangulate.h"

namespace gliss {
namespace {

// A patch whose normal stays within 84 degrees of its polygon's neither folds nor nearly does.
constexpr double kSafeTurn = 0.1;
constexpr std::uint32_t kMaxFan = 64;  // faces of more sides are not cut from their centre: slivers
constexpr double kProbe = 1e-5;        // step of the differences that curvature is taken from

// Where patches of a valence are examined: rings of a fan from the centre to the sides, and beside
// each point two more for differences. Ring r of L has n r points.
struct Probes {
  std::vector<double> domain, xi, eta;  // xi, eta: [3][count]
  std::size_t count = 0;
  std::uint32_t levels = 0;
};

Probes make_probes(std::uint32_t n) {
  Probes p;
  const Kernels<double>& k = kernels<double>();
  p.domain.resize(k.domain_reals(n));
  k.fill_domain(n, p.domain.data());
  p.levels = n <= 8 ? 8 : n <= 32 ? 6 : n <= 128 ? 4 : 2;
  std::vector<double> x{0.0}, y{0.0};
  const double shrink = 1 - 2 * kProbe;  // keeps the neighbours inside
  for (std::uint32_t ring = 1; ring <= p.levels; ++ring) {
    for (std::uint32_t i = 0; i < n * ring; ++i) {
      const double a = 2 * std::numbers::pi * (i / ring) / n,
                   b = 2 * std::numbers::pi * (i / ring + 1) / n;
      const double t = static_cast<double>(i % ring) / ring, r = shrink * ring / p.levels;
      x.push_back(r * ((1 - t) * std::cos(a) + t * std::cos(b)));
      y.push_back(r * ((1 - t) * std::sin(a) + t * std::sin(b)));
    }
  }
  p.count = x.size();
  for (int shift = 0; shift < 3; ++shift) {
    for (std::size_t i = 0; i < p.count; ++i) {
      p.xi.push_back(x[i] + (shift == 1 ? kProbe : 0));
      p.eta.push_back(y[i] + (shift == 2 ? kProbe : 0));
    }
  }
  return p;
}

const Probes& probes_of(std::uint32_t n) {
  static std::mutex mutex;
  static std::map<std::uint32_t, Probes> all;
  const std::lock_guard lock(mutex);
  const auto found = all.find(n);
  return found != all.end() ? found->second : all.emplace(n, make_probes(n)).first->second;
}

// Largest |principal curvature| at a point from its derivatives and those of its unit normal
// (Weingarten).
double largest_curvature(const Vec3& gx, const Vec3& gy, const Vec3& nx, const Vec3& ny) {
  const double e = gx.dot(gx), f = gx.dot(gy), g = gy.dot(gy);
  const double l = -gx.dot(nx), m = -0.5 * (gx.dot(ny) + gy.dot(nx)), n = -gy.dot(ny);
  const double det = e * g - f * f;
  if (!(det > 0)) return std::numeric_limits<double>::infinity();
  const double mean = (e * n - 2 * f * m + g * l) / (2 * det), gauss = (l * n - m * m) / det;
  return std::abs(mean) + std::sqrt(std::max(0.0, mean * mean - gauss));
}

// Widens both boxes of a shape by a point.
void include(const PatchDraft& d, const Vec3& p, PatchShape& shape) {
  const Vec3 along(p.dot(d.tangent), p.dot(d.normal.cross(d.tangent)), p.dot(d.normal));
  shape.box.low = shape.box.low.cwiseMin(p);
  shape.box.high = shape.box.high.cwiseMax(p);
  shape.low = shape.low.cwiseMin(along);
  shape.high = shape.high.cwiseMax(along);
}

// Frame, base polygon and exact control data; not yet examined.
PatchDraft build_draft(const FaceCorners& face, std::vector<std::uint32_t> face_corner) {
  PatchDraft d;
  d.face_corner = std::move(face_corner);
  const std::size_t n = d.face_corner.size();
  std::vector<Vec3> position;
  Box box{face.position[d.face_corner[0]], face.position[d.face_corner[0]]};
  for (const std::uint32_t c : d.face_corner) {
    position.push_back(face.position[c]);
    box.low = box.low.cwiseMin(position.back());
    box.high = box.high.cwiseMax(position.back());
  }
  d.origin = (0.5 * (box.low + box.high)).cast<float>().cast<double>();
  int exponent = 0;
  std::frexp((box.high - box.low).maxCoeff(), &exponent);
  d.scale = std::ldexp(1.0, 1 - exponent);
  d.normal = Vec3::Zero();
  for (std::size_t k = 0; k < n; ++k) {
    position[k] = (position[k] - d.origin) * d.scale;
    const Vec3& normal = face.normal[d.face_corner[k]];
    d.corner.insert(d.corner.end(), {position[k].x(), position[k].y(), position[k].z(), normal.x(),
                                     normal.y(), normal.z()});
  }
  for (std::size_t k = 0; k < n; ++k) d.normal += position[k].cross(position[(k + 1) % n]);
  triangulate(position, d.normal, d.triangle);
  // The polygon's area vanishes: any direction that its vertex normals agree on.
  if (!(d.normal.norm() > 0)) d.normal = face.normal[d.face_corner[0]];
  d.normal.normalize();
  d.tangent = (position[1] - position[0]).cross(d.normal);
  d.tangent = (d.tangent.norm() > 0 ? d.tangent : d.normal.unitOrthogonal()).normalized();
  d.control.resize(n * kSideReals);
  d.soundness = kernels<double>().build_patch(d.corner.data(), static_cast<std::uint32_t>(n),
                                              d.control.data());
  return d;
}

// The same boundary, with cross tangents shortened until the patch no longer folds; else the best
// of them.
PatchDraft ease(const PatchDraft& draft) {
  PatchDraft best = draft;
  for (const double amount : {0.25, 0.5, 0.75, 0.9}) {
    if (best.shape.turn > kSafeTurn) break;
    PatchDraft d = draft;
    if (d.kind == PatchKind::kExact) d.kind = PatchKind::kEased;
    kernels<double>().ease_patch(d.control.data(), static_cast<std::uint32_t>(d.face_corner.size()),
                                 amount);
    d.shape = examine(d);
    if (d.shape.turn > best.shape.turn) best = std::move(d);
  }
  return best;
}

// The same boundary curves, with cross tangents in the plane of the polygon, shorter and shorter:
// without any, a corner interpolator is the sum of its two curves.
PatchDraft bend(const PatchDraft& draft) {
  PatchDraft best;
  for (const double length : {1.0, 0.5, 0.0}) {
    PatchDraft d = draft;
    d.kind = PatchKind::kBent;
    d.soundness = 1;
    const auto n = static_cast<std::uint32_t>(d.face_corner.size());
    for (std::size_t k = 0; k < n; ++k) {
      for (const std::size_t at : {kSideLength, kSideLength + 1})
        d.control[k * kSideReals + at] *= length;
    }
    kernels<double>().bend_patch(d.control.data(), n, d.normal.data());
    d.shape = examine(d);
    if (best.control.empty() || d.shape.turn > best.shape.turn) best = std::move(d);
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
                              std::uint32_t face_valence, bool bent) {
  std::vector<PatchDraft> parts;
  for (const auto& t : triangles) {
    PatchDraft d = build_draft(face, {t[0], t[1], t[2]});
    if (bent) {
      straighten_cuts(d, face_valence);
      d = bend(d);
    } else {
      d.kind = PatchKind::kSplit;
      d.shape = examine(d);
      if (is_degenerate(d)) d.shape.turn = -1;
      d = ease(d);
    }
    parts.push_back(std::move(d));
  }
  return parts;
}

// The face with a centre as its last corner: places and normals to try.
std::vector<FaceCorners> with_centres(const FaceCorners& face, const PatchDraft& exact) {
  Vec3 centroid = Vec3::Zero(), normal = Vec3::Zero();
  for (const Vec3& p : face.position) centroid += p / static_cast<double>(face.position.size());
  for (const Vec3& m : face.normal) normal += m;
  double at[9];
  const double zero = 0;
  const auto n = static_cast<std::uint32_t>(face.position.size());
  kernels<double>().evaluate(probes_of(n).domain.data(), exact.control.data(), n, &zero, &zero, 1,
                             1, at);
  const Vec3 middle = exact.origin + Vec3(at[0], at[1], at[2]) / exact.scale;
  std::vector<FaceCorners> all;
  for (const Vec3& p : {middle, Vec3(0.5 * (middle + centroid)), centroid}) {
    for (const Vec3& m : {normal, exact.normal}) {
      if (!p.allFinite() || !(m.norm() > 0.1)) continue;
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
bool keeps_normals(const PatchDraft& d) {
  const auto n = static_cast<std::uint32_t>(d.face_corner.size());
  const std::uint32_t steps = n > 32 ? 2 : 8;
  std::vector<double> xi, eta;
  for (std::uint32_t side = 0; side < n; ++side) {
    const double a = 2 * std::numbers::pi * side / n, b = 2 * std::numbers::pi * (side + 1) / n;
    for (std::uint32_t i = 0; i < steps; ++i) {
      const double t = (i + 0.5) / steps, shrink = 1 - kProbe;
      xi.push_back(shrink * ((1 - t) * std::cos(a) + t * std::cos(b)));
      eta.push_back(shrink * ((1 - t) * std::sin(a) + t * std::sin(b)));
    }
  }
  const std::size_t count = xi.size();
  std::vector<double> rows(9 * count);
  kernels<double>().evaluate(probes_of(n).domain.data(), d.control.data(), n, xi.data(), eta.data(),
                             count, count, rows.data());
  for (std::size_t i = 0; i < count; ++i) {
    double normal[3];
    kernels<double>().side_normal(&d.control[i / steps * kSideReals],
                                  (static_cast<double>(i % steps) + 0.5) / steps, normal);
    const auto row = [&](std::size_t r) {
      return Vec3(rows[r * count + i], rows[(r + 1) * count + i], rows[(r + 2) * count + i]);
    };
    if (!(row(3).cross(row(6)).dot(Vec3(normal[0], normal[1], normal[2])) > 0)) return false;
  }
  return true;
}

// The least of all patches; as bad as can be where boundary normals are promised and not kept.
double worst_turn(const std::vector<PatchDraft>& drafts) {
  double turn = 1;
  for (const PatchDraft& d : drafts) {
    turn = std::min(turn, d.kind == PatchKind::kBent || keeps_normals(d) ? d.shape.turn : -1);
  }
  return turn;
}

}  // namespace

PatchDraft draft_exact(const FaceCorners& face) {
  std::vector<std::uint32_t> all(face.position.size());
  std::iota(all.begin(), all.end(), 0u);
  return build_draft(face, std::move(all));
}

PatchShape base_shape(const PatchDraft& d) {
  const Vec3 most = Vec3::Constant(std::numeric_limits<double>::infinity());
  PatchShape shape;
  shape.box = {most, -most};
  shape.low = most;
  shape.high = -most;
  shape.bend.setZero();
  for (std::size_t k = 0; k < d.corner.size(); k += 6)
    include(d, Vec3(d.corner[k], d.corner[k + 1], d.corner[k + 2]), shape);
  return shape;
}

PatchShape examine(const PatchDraft& d) {
  const std::uint32_t n = static_cast<std::uint32_t>(d.corner.size() / 6);
  const Probes& probes = probes_of(n);
  const std::size_t count = probes.count, all = 3 * count;
  thread_local std::vector<double> rows;
  rows.resize(9 * all);
  kernels<double>().evaluate(probes.domain.data(), d.control.data(), n, probes.xi.data(),
                             probes.eta.data(), all, all, rows.data());
  const auto triple = [&](int row, std::size_t i) {
    const std::size_t r = static_cast<std::size_t>(row) * all;
    return Vec3(rows[r + i], rows[r + all + i], rows[r + 2 * all + i]);
  };
  // A surface of this one patch, for distances to its base polygon.
  thread_local Surface<double> base;
  base.side_begin = {0, n};
  base.corner = d.corner;
  base.triangle = d.triangle;

  PatchShape shape = base_shape(d);
  double curvature = 0, stretch2 = 0;
  bool finite = true;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 p = triple(0, i), gx = triple(3, i), gy = triple(6, i);
    const Vec3 normal = gx.cross(gy).normalized();
    const Vec3 nx =
        (triple(3, count + i).cross(triple(6, count + i)).normalized() - normal) / kProbe;
    const Vec3 ny =
        (triple(3, 2 * count + i).cross(triple(6, 2 * count + i)).normalized() - normal) / kProbe;
    finite = finite && p.allFinite() && normal.allFinite();
    include(d, p, shape);
    if (i == 0) shape.bend = -Vec3(gx.dot(nx), 0.5 * (gx.dot(ny) + gy.dot(nx)), gy.dot(ny));
    shape.turn = std::min(shape.turn, normal.dot(d.normal));
    curvature = std::max(curvature, largest_curvature(gx, gy, nx, ny));
    stretch2 = std::max({stretch2, gx.squaredNorm(), gy.squaredNorm()});
    shape.sag = std::max(shape.sag, kernels<double>().polygon_distance2(base, 0, p.data()));
  }
  shape.rho_min = curvature > 0 ? 1 / curvature : std::numeric_limits<double>::infinity();
  // Between samples the patch leaves their triangles by at most (spacing)^2 curvature / 8; half as
  // much again for curvature between samples.
  const double spacing2 = stretch2 / (probes.levels * probes.levels);
  const double slack =
      std::min(spacing2 * curvature * (1.5 / 8), std::sqrt(spacing2)) + 1e-4 * std::sqrt(stretch2);
  shape.sag = std::sqrt(shape.sag) + slack;
  shape.box.low.array() -= slack;
  shape.box.high.array() += slack;
  shape.low.array() -= slack;
  shape.high.array() += slack;
  if (!shape.bend.allFinite()) shape.bend.setZero();
  if (!finite) shape.turn = -1;
  return shape;
}

std::vector<PatchDraft> draft_tamer(const FaceCorners& face, PatchDraft exact) {
  if (is_degenerate(exact)) exact.shape.turn = -1;
  const std::uint32_t n = static_cast<std::uint32_t>(exact.face_corner.size());
  std::vector<FaceCorners> fans;
  if (n <= kMaxFan) fans = with_centres(face, exact);
  std::vector<std::array<std::uint32_t, 3>> fan, ears;
  for (std::uint32_t k = 0; k < n; ++k) fan.push_back({k, (k + 1) % n, n});
  for (std::size_t t = 0; t < exact.triangle.size(); t += 3) {
    ears.push_back({exact.triangle[t], exact.triangle[t + 1], exact.triangle[t + 2]});
  }
  std::vector<PatchDraft> best;
  const auto offer = [&](std::vector<PatchDraft> other) {
    if (best.empty() || worst_turn(other) > worst_turn(best)) best = std::move(other);
    return worst_turn(best) > kSafeTurn;
  };
  // With the boundary normals as they are, if that gives a surface without a fold; without them
  // otherwise.
  for (const bool bent : {false, true}) {
    best.clear();
    if (offer({bent ? bend(exact) : ease(exact)})) return best;
    for (const FaceCorners& f : fans) {
      if (offer(split(f, fan, n, bent))) return best;
    }
    if (n > 3 && offer(split(face, ears, n, bent))) return best;
  }
  return best;
}

}  // namespace gliss
