#include "rival_patches.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "gliss/mesh/topology.h"
#include "gliss/mesh/triangulate.h"

namespace gliss::rivals {
namespace {

struct Corner {
  Vec3 point, normal;
};
using Corners = std::vector<Corner>;  // three or four, anticlockwise

Vec3 flat_at(const Corners& c, const Vec3& l) {
  return l[0] * c[0].point + l[1] * c[1].point + l[2] * c[2].point;
}

// The point is, with q that of the flat triangle and l its barycentric coordinates,
//   (1 - alpha) q + alpha sum l_i pi_i(q),
// pi_i(q) = q - ((q - p_i).n_i) n_i being q on the tangent plane of corner i.
Vec3 phong_at(const Corners& c, const Vec3& l) {
  constexpr double kAlpha = 0.75;
  const Vec3 q = flat_at(c, l);
  Vec3 lifted = Vec3::Zero();
  for (int i = 0; i < 3; ++i) {
    const auto& [p, n] = c[static_cast<std::size_t>(i)];
    lifted += l[i] * (q - (q - p).dot(n) * n);
  }
  return (1 - kAlpha) * q + kAlpha * lifted;
}

// A cubic Bezier triangle. A point at a third of a side, from corner i to j, is put on the tangent
// plane of i: b_ij = (2 p_i + p_j - ((p_j - p_i).n_i) n_i) / 3. With E the mean of these six and V
// that of the corners, the inner one is b_111 = E + (E - V) / 2.
Vec3 pn_at(const Corners& c, const Vec3& l) {
  Vec3 sum = Vec3::Zero(), at = Vec3::Zero();
  for (int i = 0; i < 3; ++i) {
    const auto& [p, n] = c[static_cast<std::size_t>(i)];
    at += l[i] * l[i] * l[i] * p;
    for (const int j : {(i + 1) % 3, (i + 2) % 3}) {
      const Vec3& to = c[static_cast<std::size_t>(j)].point;
      const Vec3 b = (2 * p + to - (to - p).dot(n) * n) / 3;
      at += 3 * l[i] * l[i] * l[j] * b;
      sum += b;
    }
  }
  const Vec3 e = sum / 6, v = flat_at(c, Vec3::Constant(1.0 / 3));
  return at + 6 * l[0] * l[1] * l[2] * (e + (e - v) / 2);
}

// A side is x_0 + t d - t (1 - t) b, at right angles to the normals at its ends: n_0.(d - b) = 0
// and n_1.(d + b) = 0. Of all such b it takes the shortest, a combination of the normals; and none,
// a straight side, where the normals are parallel, which two conditions on one number are.
Vec3 nagata_bend(const Corner& from, const Corner& to) {
  constexpr double kParallel = 3e-6;  // square of their sine: 0.1 degrees
  const Vec3 d = to.point - from.point, &m = from.normal, &n = to.normal;
  const double c = m.dot(n), off = 1 - c * c, at_m = m.dot(d), at_n = -n.dot(d);
  if (off < kParallel) return Vec3::Zero();
  return ((at_m - c * at_n) * m + (at_n - c * at_m) * n) / off;
}

// The quadratic triangle that has these sides: sum l_i p_i - sum l_i l_j b_ij.
Vec3 nagata_at(const Corners& c, const Vec3& l) {
  return flat_at(c, l) - l[0] * l[1] * nagata_bend(c[0], c[1]) -
         l[1] * l[2] * nagata_bend(c[1], c[2]) - l[2] * l[0] * nagata_bend(c[2], c[0]);
}

// The patch of four sides has the terms of two quadratic ones, uuv and uvv besides: it blends
// opposite sides linearly.
Vec3 nagata_square_at(const Corners& c, const Vec2& x) {
  const double u = x[0], v = x[1];
  return (1 - v) * ((1 - u) * c[0].point + u * c[1].point) +
         v * ((1 - u) * c[3].point + u * c[2].point) -
         u * (1 - u) * ((1 - v) * nagata_bend(c[0], c[1]) + v * nagata_bend(c[3], c[2])) -
         v * (1 - v) * ((1 - u) * nagata_bend(c[0], c[3]) + u * nagata_bend(c[1], c[2]));
}

Eigen::Matrix<double, 10, 1> powers(double u, double v) {
  return (Eigen::Matrix<double, 10, 1>() << 1, u, v, u * u, u * v, v * v, u * u * u, u * u * v,
          u * v * v, v * v * v)
      .finished();
}

// Ten points at thirds tell the ten terms.
template <class At>
RivalPatch patch_of(const At& at, bool is_square) {
  Eigen::Matrix<double, 10, 10> known;
  Eigen::Matrix<double, 3, 10> points;
  for (int j = 0, k = 0; j <= 3; ++j) {
    for (int i = 0; i + j <= 3; ++i, ++k) {
      known.col(k) = powers(i / 3.0, j / 3.0);
      points.col(k) = at(Vec2(i / 3.0, j / 3.0));
    }
  }
  return {points * known.inverse(), is_square};
}

RivalPatch patch_of(Rival rival, const Corners& c) {
  if (c.size() == 4) return patch_of([&](const Vec2& x) { return nagata_square_at(c, x); }, true);
  const auto at = rival == Rival::kFlat    ? flat_at
                  : rival == Rival::kPhong ? phong_at
                  : rival == Rival::kPn    ? pn_at
                                           : nagata_at;
  return patch_of([&](const Vec2& x) { return at(c, Vec3(1 - x[0] - x[1], x[0], x[1])); }, false);
}

// The sides of the domains, as outward.x <= most.
struct Side {
  Vec2 outward;
  double most;
};
std::span<const Side> sides_of(bool is_square) {
  static const std::array<Side, 3> triangle{{{Vec2(-1, 0), 0}, {Vec2(0, -1), 0}, {Vec2(1, 1), 1}}};
  static const std::array<Side, 4> square{
      {{Vec2(-1, 0), 0}, {Vec2(0, -1), 0}, {Vec2(1, 0), 1}, {Vec2(0, 1), 1}}};
  return is_square ? std::span<const Side>(square) : triangle;
}

// The step of Newton's method downhill, along a side where that would leave the domain, or none.
Vec2 step_within(std::span<const Side> sides, const Vec2& x, const Vec2& slope,
                 const Eigen::Matrix2d& bend) {
  constexpr double kOn = 1e-12;
  const auto leaves = [&](const Vec2& step) {
    return std::any_of(sides.begin(), sides.end(), [&](const Side& side) {
      return side.outward.dot(x) > side.most - kOn && side.outward.dot(step) > kOn * step.norm();
    });
  };
  const Vec2 freely = -bend.inverse() * slope;
  if (!leaves(freely)) return freely;
  for (const Side& side : sides) {
    if (side.outward.dot(x) <= side.most - kOn) continue;
    const Vec2 along(-side.outward[1], side.outward[0]);
    const Vec2 step = -along.dot(slope) / along.dot(bend * along) * along;
    if (!leaves(step)) return step;
  }
  return Vec2::Zero();
}

// The local nearest point of a patch, downhill from x by Newton's method: by Gauss and Newton's
// where the distance curves the wrong way.
RivalFoot descend(const RivalPatch& patch, const Vec3& place, Vec2 x) {
  constexpr int kSteps = 50;
  constexpr double kEnd = 1e-10;
  const std::span<const Side> sides = sides_of(patch.is_square);
  RivalPatch::Jet jet = patch.jet(x);
  for (int i = 0; i < kSteps; ++i) {
    const Vec3 off = jet.at - place;
    Eigen::Matrix2d bend{{jet.u.dot(jet.u), jet.u.dot(jet.v)},
                         {jet.u.dot(jet.v), jet.v.dot(jet.v)}};
    const Eigen::Matrix2d full = bend + Eigen::Matrix2d{{off.dot(jet.uu), off.dot(jet.uv)},
                                                        {off.dot(jet.uv), off.dot(jet.vv)}};
    if (full(0, 0) > 0 && full.determinant() > 0.01 * bend.determinant()) bend = full;
    Vec2 step = step_within(sides, x, {off.dot(jet.u), off.dot(jet.v)}, bend);
    for (const Side& side : sides) {
      const double out = side.outward.dot(x + step) - side.most;
      if (out > 0) step *= std::max(0.0, 1 - out / side.outward.dot(step));
    }
    RivalPatch::Jet next = patch.jet(x + step);
    for (; (next.at - place).norm() > off.norm() && step.norm() > kEnd; next = patch.jet(x + step))
      step /= 2;
    if ((next.at - place).norm() > off.norm()) break;
    x += step;
    jet = next;
    if (step.norm() <= kEnd) break;
  }
  return {jet.at, (jet.at - place).norm()};
}

}  // namespace

std::vector<Piece> pieces(int rows, bool is_square) {
  std::vector<Piece> all;
  const auto add = [&](const Vec2& a, const Vec2& b, const Vec2& c) {
    all.push_back({{a, b, c}, (a + b + c) / 3, 0.5 / (rows * rows)});
  };
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < rows; ++j) {
      const auto at = [&](int along, int up) { return Vec2(Vec2(i + along, j + up) / rows); };
      if (is_square || i + j < rows) add(at(0, 0), at(1, 0), at(0, 1));
      if (is_square || i + j + 1 < rows) add(at(1, 0), at(1, 1), at(0, 1));
    }
  }
  return all;
}

Vec3 RivalPatch::at(const Vec2& x) const { return terms * powers(x[0], x[1]); }

RivalPatch::Jet RivalPatch::jet(const Vec2& x) const {
  const double u = x[0], v = x[1];
  const auto t = [&](int k) { return terms.col(k); };
  return {at(x),
          t(1) + 2 * u * t(3) + v * t(4) + 3 * u * u * t(6) + 2 * u * v * t(7) + v * v * t(8),
          t(2) + u * t(4) + 2 * v * t(5) + u * u * t(7) + 2 * u * v * t(8) + 3 * v * v * t(9),
          2 * t(3) + 6 * u * t(6) + 2 * v * t(7),
          t(4) + 2 * u * t(7) + 2 * v * t(8),
          2 * t(5) + 2 * u * t(8) + 6 * v * t(9)};
}

RivalSurface::RivalSurface(Rival rival, const Mesh& mesh) {
  constexpr double kCells = 20000, kMore = 1.2;  // of a radius, than to the corners
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    Corners corners;
    std::vector<Vec3> points;
    for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c) {
      points.push_back(mesh.positions[mesh.corner_vertex[c]]);
      corners.push_back({points.back(), mesh.normals[mesh.corner_normal[c]]});
    }
    if (corners.size() == 3 || (corners.size() == 4 && rival == Rival::kNagata)) {
      patches_.push_back(patch_of(rival, corners));
      continue;
    }
    std::vector<std::uint32_t> cut;
    triangulate(points, newell_normal(mesh, face), cut);
    for (std::size_t k = 0; k < cut.size(); k += 3)
      patches_.push_back(
          patch_of(rival, {corners[cut[k]], corners[cut[k + 1]], corners[cut[k + 2]]}));
  }
  const double rows = std::sqrt(kCells / static_cast<double>(patches_.size()));
  for (std::size_t p = 0; p < patches_.size(); ++p) {
    const RivalPatch& patch = patches_[p];
    for (const Piece& piece :
         pieces(static_cast<int>(std::clamp(rows, 2.0, 8.0)), patch.is_square)) {
      Cell cell{p, piece.middle, patch.at(piece.middle), 0};
      for (const Vec2& corner : piece.corners)
        cell.radius = std::max(cell.radius, kMore * (patch.at(corner) - cell.centre).norm());
      cells_.push_back(cell);
    }
  }
}

// A cell is no nearer than its sphere, and the nearest point no farther than the middle of any. A
// walk takes short steps: cells that may be the nearest to a place within `reach` of the one that
// all were asked about are kept.
std::vector<RivalFoot> RivalSurface::nearest(std::span<const Vec3> places) const {
  std::vector<RivalFoot> feet;
  std::vector<std::pair<double, const Cell*>> near;  // no nearer than that
  Vec3 asked = Vec3::Zero();
  double reach = -1;
  for (const Vec3& place : places) {
    const auto to = [&](const Cell& cell) { return (cell.centre - place).norm(); };
    if ((place - asked).norm() > reach) {
      double most = std::numeric_limits<double>::infinity();
      for (const Cell& cell : cells_) most = std::min(most, to(cell));
      asked = place;
      reach = most / 4;
      near.clear();
      for (const Cell& cell : cells_) {
        if (to(cell) - cell.radius <= most + 2 * reach) near.emplace_back(0, &cell);
      }
    }
    for (auto& [least, cell] : near) least = to(*cell) - cell->radius;
    std::sort(near.begin(), near.end());
    RivalFoot best{{}, std::numeric_limits<double>::infinity()};
    for (const auto& [least, cell] : near) {
      if (least > best.distance) break;
      const RivalFoot foot = descend(patches_[cell->patch], place, cell->middle);
      if (foot.distance < best.distance) best = foot;
    }
    feet.push_back(best);
  }
  return feet;
}

}  // namespace gliss::rivals
