#include "gliss/mesh/rounding.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <optional>

#include "gliss/base/message.h"
#include "gliss/base/plain_arithmetic.h"
#include "gliss/mesh/arc_mesh.h"
#include "gliss/mesh/face_room.h"
#include "gliss/mesh/sectors.h"

namespace gliss {
namespace {

constexpr double kLeastTurn = std::numbers::pi / 180;  // rad, of an edge that is worth a strip
constexpr double kRoom = 0.99;  // of the radius at which a face has no room left
// Sines and cosines below which a direction is not followed.
constexpr double kLeastSine = 0.25, kLeastCosine = 0.2;

// A length in m, not longer, in three digits.
std::string in_mm(double length) {
  const double digit = std::pow(10.0, std::floor(std::log10(length * 1e3)) - 2);
  char text[32];
  std::snprintf(text, sizeof(text), "%.3g mm", digit * std::floor(length * 1e3 / digit + 1e-6));
  return text;
}

// The step of a corner, by a radius of 1.
struct Move {
  Vec3 step = Vec3::Zero();
  // The corner in whose face the step leads, as so much of its edges ahead and back.
  std::uint32_t corner = 0;
  double ahead = 0, back = 0;
};

// Those of a sector: one, or one beside each of its creases, where its corner `opened` (kNone:
// none) has both.
struct SectorMoves {
  Move first{}, last{};
  std::uint32_t opened = kNone;
  Vec3 between = Vec3::Zero();  // the step of where the lines along both creases meet
};

// The rim of the hole round a vertex: vertices and the middles of the sides between, in turn.
struct Ring {
  std::uint32_t corner;  // one of the vertex that was
  std::vector<std::uint32_t> vertices;
};

class Rounder {
 public:
  Rounder(const Mesh& mesh, const Topology& topology, double radius)
      : mesh_(mesh),
        topology_(topology),
        radius_(radius),
        cuts_(mesh.sharp),
        wide_(mesh.sharp.size(), 0),
        is_beyond_(mesh.sharp.size(), 0) {}

  // The rounded mesh; none where there is nothing to round.
  std::optional<Mesh> round() {
    find_cuts();
    if (s_.cut.empty()) return {};
    for (const Sector& sector : s_.cut) moves_.push_back({.first = move_of(sector)});
    for (std::size_t i = 0; i < s_.cut.size(); ++i) open_reflex(i);
    check_room();
    place_vertices();
    place_middles();
    add_faces();
    add_strips();
    add_corners();
    return rounded_.finish();
  }

 private:
  std::uint32_t next(std::uint32_t side) const { return next_side(mesh_, topology_, side); }
  std::uint32_t prev(std::uint32_t side) const { return prev_side(mesh_, topology_, side); }
  // The corner to the right of an inner side, at its start.
  std::uint32_t right_of(std::uint32_t side) const { return next(topology_.side_twin[side]); }
  Vec3 ahead(std::uint32_t corner) const { return edge_of(mesh_, topology_, corner); }
  Vec3 back(std::uint32_t corner) const { return -edge_of(mesh_, topology_, prev(corner)); }
  const Vec3& normal(std::uint32_t corner) const { return s_.normals[s_.group[corner]]; }
  const Vec3& position(std::uint32_t corner) const {
    return mesh_.positions[mesh_.corner_vertex[corner]];
  }
  std::uint32_t line_of(std::uint32_t face) const {
    return mesh_.face_line.empty() ? 0 : mesh_.face_line[face];
  }
  bool is_cut(std::uint32_t side) const { return !s_.tau[side].isZero(0); }
  // The sector of a corner; kNone where its vertex is not cut.
  std::uint32_t sector_of(std::uint32_t corner) const {
    const auto vertices = static_cast<std::uint32_t>(mesh_.positions.size());
    return s_.group[corner] < vertices ? kNone : s_.group[corner] - vertices;
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
      s_ = cut_sectors(mesh_, topology_, cuts_, NormalWeights::kSmooth);
      for (const Sector& sector : s_.cut) turn_normal(sector);
      is_done = true;
      for (std::uint32_t side = 0; side < cuts_.size(); ++side) {
        if (!is_cut(side)) continue;
        const double theta = angle_between(normal(side), normal(right_of(side)));
        wide_[side] = std::tan(theta / 2);
        if (theta < kLeastTurn) cuts_[side] = 0, is_done = false;
      }
    }
  }

  // A smooth curve's tangent is at right angles to the normals on both of its sides.
  void turn_normal(const Sector& sector) {
    const Vec3& tau = sector.first.isZero(0) ? sector.last : sector.first;
    if (sector.first.cross(sector.last).norm() > kCollinear) return;
    Vec3& n = s_.normals[s_.group[sector.corners.front()]];
    const Vec3 turned = across(tau, n);
    if (turned.norm() > kLeastCosine) n = turned.normalized();
  }

  Move move_of(const Sector& sector) const {
    const std::uint32_t first = sector.corners.front(), last = sector.corners.back();
    const Vec3& n = normal(first);
    const Vec3 a = across(n, sector.first).stableNormalized(),
               b = across(n, sector.last).stableNormalized();
    // Away from the cuts, in the sector.
    const Vec3 from_a = n.cross(a), from_b = b.cross(n);
    if (a.isZero(0)) return along_border(first, ahead(first), from_b, wide_after(last));
    if (b.isZero(0)) return along_border(last, back(last), from_a, wide_[first]);
    // At the distances w_a and w_b from both: w_a = D + d, w_b = D - d, from_a.from_b = c.
    const double c = from_a.dot(from_b), both = 0.5 * (wide_[first] + wide_after(last)),
                 apart = 0.5 * (wide_[first] - wide_after(last));
    const Vec3 step = both * (from_a + from_b) / std::max(1 + c, kCollinear) +
                      apart * (from_a - from_b) / std::max(1 - c, kLeastSine);
    return carried(sector, step, a, from_a);
  }

  // A sector of more than half a turn gets two corners, beside those that the sectors beyond its
  // creases have, so that strips end straight: there the ball goes round the vertex.
  void open_reflex(std::size_t i) {
    const Sector& sector = s_.cut[i];
    const std::uint32_t first = sector.corners.front(), last = sector.corners.back();
    if (sector.first.isZero(0) || sector.last.isZero(0)) return;
    const Vec3& n = normal(first);
    const Vec3 a = across(n, sector.first).stableNormalized(),
               b = across(n, sector.last).stableNormalized();
    if (a.cross(b).dot(n) > -kLeastSine) return;
    // Along the creases, to the corners beyond them.
    const std::uint32_t after = next_around(mesh_, topology_, last);
    const auto beyond = [&](std::uint32_t corner) -> const Vec3& {
      const SectorMoves& m = moves_[sector_of(corner)];
      return m.opened == kNone ? m.first.step : m.between;
    };
    const double along_a = a.dot(beyond(right_of(first))), along_b = b.dot(beyond(after));
    if (!(along_a > kLeastSine * wide_[first] && along_b > kLeastSine * wide_[after])) return;
    SectorMoves& m = moves_[i];
    m.opened = m.first.corner;
    m.between = m.first.step;
    const auto opened = std::find(sector.corners.begin(), sector.corners.end(), m.opened);
    for (auto c = opened + 1; c != sector.corners.end(); ++c) is_beyond_[*c] = 1;
    m.first = {.step = along_a * a + wide_[first] * n.cross(a), .corner = first};
    m.last = {.step = along_b * b + wide_[after] * b.cross(n), .corner = last};
  }

  double wide_after(std::uint32_t last) const { return wide_[next_around(mesh_, topology_, last)]; }

  // At the border a corner stays on it.
  static Move along_border(std::uint32_t corner, const Vec3& border, const Vec3& from,
                           double wide) {
    Move m;
    m.corner = corner;
    const double sine = from.dot(border);
    m.step = sine > kLeastSine * border.norm() ? Vec3(wide / sine * border) : Vec3(wide * from);
    return m;
  }

  // The step within the face that it leads into: x and y span the sector's plane.
  Move carried(const Sector& sector, const Vec3& step, const Vec3& x, const Vec3& y) const {
    const auto angle = [&](const Vec3& v) {
      const double around = std::atan2(v.dot(y), v.dot(x));
      return around < 0 ? around + 2 * std::numbers::pi : around;
    };
    Move m;
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

  void check_room() const {
    double most = std::numeric_limits<double>::infinity();
    std::uint32_t narrowest = 0;
    std::vector<Vec3> corners, steps;
    for (std::uint32_t face = 0; face < mesh_.face_count(); ++face) {
      corners.clear(), steps.clear();
      for (std::uint32_t c = mesh_.face_begin[face]; c < mesh_.face_begin[face + 1]; ++c) {
        const auto add = [&](const Vec3& step) {
          corners.push_back(position(c));
          steps.push_back(step);
        };
        const std::uint32_t sector = sector_of(c);
        if (sector == kNone) {
          add(Vec3::Zero());
          continue;
        }
        const SectorMoves& m = moves_[sector];
        if (m.opened == c || is_beyond_[c] != 0) add(m.last.step);
        if (m.opened == c) add(m.between);
        if (is_beyond_[c] == 0) add(m.first.step);
      }
      const double room = room_of(corners, steps, newell_normal(mesh_, face));
      if (room < most) most = room, narrowest = face;
    }
    if (radius_ <= kRoom * most) return;
    const std::string line =
        line_of(narrowest) == 0 ? "" : detail::message(":", line_of(narrowest));
    throw MeshError(
        detail::message(mesh_.source.empty() ? "mesh" : mesh_.source, line, ": face ", narrowest,
                        ": no room for creases of radius ", in_mm(radius_ * mesh_.unit),
                        " beside it; the largest that fits is ", in_mm(kRoom * most * mesh_.unit)));
  }

  // One vertex or two a sector; the first has the number of the vertex that was cut.
  void place_vertices() {
    rounded_.mesh.source = mesh_.source;
    rounded_.mesh.unit = mesh_.unit;
    rounded_.mesh.positions = mesh_.positions;
    rounded_.mesh.normals.assign(s_.normals.begin(),
                                 s_.normals.end() - static_cast<std::ptrdiff_t>(s_.cut.size()));
    ahead_vertex_ = back_vertex_ = mesh_.corner_vertex;
    std::uint32_t last = kNone;
    for (std::uint32_t i = 0; i < s_.cut.size(); ++i) {
      const std::uint32_t cut = mesh_.corner_vertex[s_.cut[i].corners.front()];
      const std::uint32_t first = place(moves_[i].first, last == cut ? kNone : cut);
      const std::uint32_t second = moves_[i].opened == kNone ? first : place(moves_[i].last, kNone);
      last = cut;
      for (const std::uint32_t c : s_.cut[i].corners) {
        ahead_vertex_[c] = is_beyond_[c] != 0 ? second : first;
        back_vertex_[c] = c == moves_[i].opened ? second : ahead_vertex_[c];
      }
    }
  }

  // Places a vertex of that number, or a new one (kNone). Returns its number. Within a face the
  // normal is between those of its corners, and the point is as far from the plane of the three as
  // an arc with those normals: by half of its projections to their tangent planes (Boubekeur and
  // Alexa 2008, Phong tessellation).
  std::uint32_t place(const Move& m, std::uint32_t vertex) {
    const std::uint32_t corners[] = {m.corner, next(m.corner), prev(m.corner)};
    const double p = radius_ * m.ahead, q = radius_ * m.back, shares[] = {1 - p - q, p, q};
    const Vec3 at = position(m.corner) + radius_ * m.step;
    Vec3 lifted = at;
    for (int i = 0; i < 3 && p + q > 0; ++i)
      lifted -=
          0.5 * shares[i] * normal(corners[i]) * normal(corners[i]).dot(at - position(corners[i]));
    const Vec3 turned = normal(m.corner) + p * (normal(corners[1]) - normal(corners[0])) +
                        q * (normal(corners[2]) - normal(corners[0]));
    if (vertex == kNone) vertex = rounded_.add_vertex({}, {});
    rounded_.mesh.positions[vertex] = lifted;
    rounded_.mesh.normals[vertex] =
        turned.norm() > kLeastSine ? turned.normalized() : normal(m.corner);
    return vertex;
  }

  // The middle of each arc over a crease, and what closes round each cut vertex.
  void place_middles() {
    middle_.assign(cuts_.size(), kNone);
    open_middle_.assign(s_.cut.size(), kNone);
    for (std::uint32_t i = 0, end; i < s_.cut.size(); i = end) {
      const auto first = [&](std::uint32_t k) { return s_.cut[k].corners.front(); };
      const std::uint32_t vertex = mesh_.corner_vertex[first(i)];
      for (end = i; end < s_.cut.size() && mesh_.corner_vertex[first(end)] == vertex;) ++end;
      Ring ring{first(i), {}};
      for (std::uint32_t k = i; k < end; ++k) {
        const Sector& sector = s_.cut[k];
        const std::uint32_t last = sector.corners.back();
        ring.vertices.push_back(ahead_vertex_[first(k)]);
        if (moves_[k].opened != kNone) {
          open_middle_[k] = rounded_.add_middle(ahead_vertex_[first(k)], back_vertex_[last],
                                                -sector.first, sector.last);
          ring.vertices.push_back(open_middle_[k]);
          ring.vertices.push_back(back_vertex_[last]);
        }
        const std::uint32_t crease = next_around(mesh_, topology_, last);
        if (crease == kNone) break;
        // Two strips that join share one arc.
        const bool is_joint = k == i + 1 && end == k + 1 && ring.vertices.size() == 3;
        middle_[crease] = is_joint ? ring.vertices[1]
                                   : rounded_.add_middle(back_vertex_[last], ahead_vertex_[crease]);
        ring.vertices.push_back(middle_[crease]);
      }
      if (ring.vertices.size() <= 4) continue;
      if (ring.vertices.size() % 2 == 1)  // at a border
        ring.vertices.push_back(rounded_.add_middle(ring.vertices.back(), ring.vertices.front()));
      rings_.push_back(std::move(ring));
    }
  }

  // The faces as they were, with two sides more at each corner that was opened.
  void add_faces() {
    std::vector<std::uint32_t> corners;
    for (std::uint32_t face = 0; face < mesh_.face_count(); ++face) {
      corners.clear();
      for (std::uint32_t c = mesh_.face_begin[face]; c < mesh_.face_begin[face + 1]; ++c) {
        if (back_vertex_[c] != ahead_vertex_[c]) {
          corners.push_back(back_vertex_[c]);
          corners.push_back(open_middle_[sector_of(c)]);
        }
        corners.push_back(ahead_vertex_[c]);
      }
      rounded_.add_face(corners, line_of(face));
    }
  }

  // Two faces for each crease that is cut at an end: quads, or triangles where the other is not.
  void add_strips() {
    for (std::uint32_t side = 0; side < cuts_.size(); ++side) {
      const std::uint32_t twin = topology_.side_twin[side];
      if (twin == kNone || twin < side || !(is_cut(side) || is_cut(twin))) continue;
      const std::uint32_t start[] = {ahead_vertex_[side], middle_[side],
                                     back_vertex_[right_of(side)]},
                          end[] = {back_vertex_[next(side)], middle_[twin], ahead_vertex_[twin]};
      const auto at_start = [&](int i) { return is_cut(side) ? start[i] : start[0]; };
      const auto at_end = [&](int i) { return is_cut(twin) ? end[i] : end[0]; };
      const Vec3 to = curve_at(side), from = curve_at(twin);
      for (int i = 0; i < 2; ++i) {
        std::vector<std::uint32_t> corners{at_end(i), at_start(i)};
        if (is_cut(side)) corners.push_back(at_start(i + 1));
        if (is_cut(twin)) corners.push_back(at_end(i + 1));
        rounded_.add_face(corners, line_of(topology_.side_face[side]));
        rounded_.mesh.strips.push_back(
            {mesh_.corner_vertex[side], mesh_.corner_vertex[next(side)]});
      }
      for (int i = 0; i < 3 && !(to.isZero(0) && from.isZero(0)); ++i)
        rounded_.add_arc(at_start(i), at_end(i), to, -from);
    }
  }

  // A quad for each vertex of each ring, round its centre.
  void add_corners() {
    for (const Ring& ring : rings_) {
      const std::uint32_t centre = rounded_.add_centre(ring.vertices);
      const std::uint32_t line = line_of(topology_.side_face[ring.corner]);
      const std::size_t count = ring.vertices.size();
      for (std::size_t i = 0; i < count; i += 2) {
        const std::uint32_t before = ring.vertices[(i + count - 1) % count],
                            after = ring.vertices[i + 1];
        rounded_.add_face(std::array{ring.vertices[i], after, centre, before}, line);
        rounded_.mesh.rounded_corners.push_back(mesh_.corner_vertex[ring.corner]);
        rounded_.add_arc(after, centre);
      }
    }
  }

  // The tangent of a crease at its start where it goes on as a curve there; else (0, 0, 0).
  Vec3 curve_at(std::uint32_t side) const {
    if (!is_cut(side)) return Vec3::Zero();
    const Sector& sector = s_.cut[sector_of(side)];
    return sector.first == -sector.last ? s_.tau[side] : Vec3(Vec3::Zero());
  }

  const Mesh& mesh_;
  const Topology& topology_;
  double radius_;                   // in the mesh's unit
  std::vector<std::uint8_t> cuts_;  // [side], 1: rounded at its start
  std::vector<double> wide_;        // [side], tan(theta / 2) at its start
  Sectors s_;
  std::vector<SectorMoves> moves_;       // [sector]
  std::vector<std::uint8_t> is_beyond_;  // [corner], 1: it is beyond the one that was opened
  // [corner], the vertex from which its face's side ahead leaves, and that in which the one before
  // ends.
  std::vector<std::uint32_t> ahead_vertex_, back_vertex_;
  std::vector<std::uint32_t> middle_;       // [side], the middle of the arc at its cut start
  std::vector<std::uint32_t> open_middle_;  // [sector], that between its two vertices, or kNone
  std::vector<Ring> rings_;
  ArcMesh rounded_;
};

}  // namespace

void round_creases(Mesh& mesh, double radius) {
  const PlainArithmetic plain;
  if (!(radius > 0 && radius < std::numeric_limits<double>::infinity()))
    throw MeshError(mesh.source + ": the radius of creases must be positive and finite");
  if (mesh.sharp.empty()) return;
  const Topology topology = build_topology(mesh);
  if (std::optional<Mesh> rounded = Rounder(mesh, topology, radius / mesh.unit).round()) {
    mesh = std::move(*rounded);
  } else {
    mesh.sharp.clear();
  }
}

}  // namespace gliss
