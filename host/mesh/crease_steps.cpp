#include "gliss/mesh/crease_steps.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace gliss {
namespace {

constexpr double kLeastTurn = std::numbers::pi / 180;  // rad, of an edge that is worth a strip
// Sines and cosines below which a direction is not followed.
constexpr double kLeastSine = 0.25, kLeastCosine = 0.2;

class StepFinder {
 public:
  StepFinder(const Mesh& mesh, const Topology& topology)
      : mesh_(mesh), topology_(topology), cuts_(mesh.sharp) {
    steps_.wide.assign(mesh.sharp.size(), 0);
    steps_.is_beyond.assign(mesh.sharp.size(), 0);
  }

  CreaseSteps find() {
    find_cuts();
    for (const Sector& sector : steps_.sectors.cut)
      steps_.moves.push_back({.first = move_of(sector)});
    for (std::size_t i = 0; i < steps_.sectors.cut.size(); ++i) open_reflex(i);
    return std::move(steps_);
  }

 private:
  std::uint32_t next(std::uint32_t side) const { return next_side(mesh_, topology_, side); }
  // The corner to the right of an inner side, at its start.
  std::uint32_t right_of(std::uint32_t side) const { return next(topology_.side_twin[side]); }
  Vec3 ahead(std::uint32_t corner) const { return edge_of(mesh_, topology_, corner); }
  Vec3 back(std::uint32_t corner) const {
    return -edge_of(mesh_, topology_, prev_side(mesh_, topology_, corner));
  }
  const Vec3& normal(std::uint32_t corner) const {
    return steps_.sectors.normals[steps_.sectors.group[corner]];
  }

  // The creases that are rounded at their starts, and how far from them the ball touches the faces.
  void find_cuts() {
    for (std::uint32_t side = 0; side < cuts_.size(); ++side) {
      const std::uint32_t twin = topology_.side_twin[side];
      if (twin == kNone || angle_between(normal_beside(mesh_, topology_, side),
                                         normal_beside(mesh_, topology_, twin)) < kLeastTurn)
        cuts_[side] = 0;
    }
    for (bool is_done = false; !is_done;) {
      steps_.sectors = cut_sectors(mesh_, topology_, cuts_, NormalWeights::kSmooth);
      for (const Sector& sector : steps_.sectors.cut) turn_normal(sector);
      is_done = true;
      for (std::uint32_t side = 0; side < cuts_.size(); ++side) {
        if (!steps_.is_cut(side)) continue;
        const double theta = angle_between(normal(side), normal(right_of(side)));
        steps_.wide[side] = std::tan(theta / 2);
        if (theta < kLeastTurn) cuts_[side] = 0, is_done = false;
      }
    }
  }

  // A smooth curve's tangent is at right angles to the normals on both of its sides.
  void turn_normal(const Sector& sector) {
    const Vec3& tau = sector.first.isZero(0) ? sector.last : sector.first;
    if (sector.first.cross(sector.last).norm() > kCollinear) return;
    Vec3& n = steps_.sectors.normals[steps_.sectors.group[sector.corners.front()]];
    const Vec3 turned = across(tau, n);
    if (turned.norm() > kLeastCosine) n = turned.normalized();
  }

  CreaseMove move_of(const Sector& sector) const {
    const std::uint32_t first = sector.corners.front(), last = sector.corners.back();
    const Vec3& n = normal(first);
    const Vec3 a = across(n, sector.first).stableNormalized(),
               b = across(n, sector.last).stableNormalized();
    // Away from the cuts, in the sector.
    const Vec3 from_a = n.cross(a), from_b = b.cross(n);
    if (a.isZero(0)) return along_border(first, ahead(first), from_b, wide_after(last));
    if (b.isZero(0)) return along_border(last, back(last), from_a, steps_.wide[first]);
    // At the distances w_a and w_b from both: w_a = D + d, w_b = D - d, from_a.from_b = c.
    const double c = from_a.dot(from_b), both = 0.5 * (steps_.wide[first] + wide_after(last)),
                 apart = 0.5 * (steps_.wide[first] - wide_after(last));
    const Vec3 step = both * (from_a + from_b) / std::max(1 + c, kCollinear) +
                      apart * (from_a - from_b) / std::max(1 - c, kLeastSine);
    return carried(sector, step, a, from_a);
  }

  // A sector of more than half a turn gets two corners, beside those that the sectors beyond its
  // creases have, so that strips end straight: there the ball goes round the vertex.
  void open_reflex(std::size_t i) {
    const Sector& sector = steps_.sectors.cut[i];
    const std::uint32_t first = sector.corners.front(), last = sector.corners.back();
    if (sector.first.isZero(0) || sector.last.isZero(0)) return;
    const Vec3& n = normal(first);
    const Vec3 a = across(n, sector.first).stableNormalized(),
               b = across(n, sector.last).stableNormalized();
    if (a.cross(b).dot(n) > -kLeastSine) return;
    // Along the creases, to the corners beyond them.
    const std::uint32_t after = next_around(mesh_, topology_, last);
    const auto beyond = [&](std::uint32_t corner) -> const Vec3& {
      const SectorMoves& m = steps_.moves[steps_.sector_of(corner)];
      return m.opened == kNone ? m.first.step : m.between;
    };
    const double along_a = a.dot(beyond(right_of(first))), along_b = b.dot(beyond(after));
    if (!(along_a > kLeastSine * steps_.wide[first] && along_b > kLeastSine * steps_.wide[after]))
      return;
    SectorMoves& m = steps_.moves[i];
    m.opened = m.first.corner;
    m.between = m.first.step;
    const auto opened = std::find(sector.corners.begin(), sector.corners.end(), m.opened);
    for (auto c = opened + 1; c != sector.corners.end(); ++c) steps_.is_beyond[*c] = 1;
    m.first = {.step = along_a * a + steps_.wide[first] * n.cross(a), .corner = first};
    m.last = {.step = along_b * b + steps_.wide[after] * b.cross(n), .corner = last};
  }

  double wide_after(std::uint32_t last) const {
    return steps_.wide[next_around(mesh_, topology_, last)];
  }

  // At the border a corner stays on it.
  static CreaseMove along_border(std::uint32_t corner, const Vec3& border, const Vec3& from,
                                 double wide) {
    CreaseMove m;
    m.corner = corner;
    const double sine = from.dot(border);
    m.step = sine > kLeastSine * border.norm() ? Vec3(wide / sine * border) : Vec3(wide * from);
    return m;
  }

  // The step within the face that it leads into: x and y span the sector's plane.
  CreaseMove carried(const Sector& sector, const Vec3& step, const Vec3& x, const Vec3& y) const {
    const auto angle = [&](const Vec3& v) {
      const double around = std::atan2(v.dot(y), v.dot(x));
      return around < 0 ? around + 2 * std::numbers::pi : around;
    };
    CreaseMove m;
    const auto into =
        std::find_if(sector.corners.begin(), sector.corners.end() - 1,
                     [&](std::uint32_t c) { return angle(step) <= angle(back(c)) + kCollinear; });
    m.corner = *into;
    const Vec3 face = corner_normal(mesh_, topology_, m.corner,
                                    newell_normal(mesh_, topology_.side_face[m.corner]));
    const Vec3 &n = normal(m.corner), p = ahead(m.corner), q = back(m.corner);
    m.step = step;
    if (face.dot(n) > kLeastCosine) m.step -= n * (face.dot(step) / face.dot(n));
    const Vec3 cross = p.cross(q);
    if (!(cross.norm() > kCollinear * p.norm() * q.norm())) return m;
    m.ahead = std::max(0.0, m.step.cross(q).dot(cross) / cross.squaredNorm());
    m.back = std::max(0.0, p.cross(m.step).dot(cross) / cross.squaredNorm());
    return m;
  }

  const Mesh& mesh_;
  const Topology& topology_;
  std::vector<std::uint8_t> cuts_;  // [side], 1: rounded at its start
  CreaseSteps steps_;
};

}  // namespace

std::uint32_t CreaseSteps::sector_of(std::uint32_t corner) const {
  const std::size_t vertices = sectors.normals.size() - sectors.cut.size();
  const std::uint32_t group = sectors.group[corner];
  return group < vertices ? kNone : static_cast<std::uint32_t>(group - vertices);
}

Vec3 CreaseSteps::step_of(std::uint32_t corner) const {
  const std::uint32_t sector = sector_of(corner);
  if (sector == kNone) return Vec3::Zero();
  return (is_beyond[corner] != 0 ? moves[sector].last : moves[sector].first).step;
}

Vec3 CreaseSteps::step_into(std::uint32_t corner) const {
  const std::uint32_t sector = sector_of(corner);
  return sector != kNone && moves[sector].opened == corner ? moves[sector].last.step
                                                           : step_of(corner);
}

void CreaseSteps::append_steps(std::uint32_t corner, std::vector<Vec3>& steps) const {
  const std::uint32_t sector = sector_of(corner);
  if (sector != kNone && moves[sector].opened == corner) {
    steps.push_back(moves[sector].last.step);
    steps.push_back(moves[sector].between);
  }
  steps.push_back(step_of(corner));
}

CreaseSteps find_crease_steps(const Mesh& mesh, const Topology& topology) {
  return StepFinder(mesh, topology).find();
}

CreaseRoom room_of_creases(const Mesh& mesh, const CreaseSteps& steps, double tried) {
  const CreaseRoom more =
      time_to_meet(mesh, steps, tried, [](std::uint32_t, const Vec3& step) { return step; });
  return {tried + more.radius, more.face};
}

}  // namespace gliss
