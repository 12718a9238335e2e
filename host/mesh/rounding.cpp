#include "gliss/mesh/rounding.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "gliss/base/message.h"
#include "gliss/base/plain_arithmetic.h"
#include "gliss/mesh/arc_mesh.h"
#include "gliss/mesh/crease_spread.h"
#include "gliss/mesh/crease_steps.h"
#include "gliss/mesh/phong.h"
#include "gliss/mesh/sectors.h"

namespace gliss {
namespace {

constexpr double kLeastTurned = 0.25;  // below which a direction is not followed

// A length in m, not longer, in three digits.
std::string in_mm(double length) {
  const double digit = std::pow(10.0, std::floor(std::log10(length * 1e3)) - 2);
  char text[32];
  std::snprintf(text, sizeof(text), "%.3g mm", digit * std::floor(length * 1e3 / digit + 1e-6));
  return text;
}

// The rim of the hole round a vertex: vertices and the middles of the sides between, in turn.
struct Ring {
  std::uint32_t corner;  // one of the vertex that was
  std::vector<std::uint32_t> vertices;
};

class Rounder {
 public:
  // `walk`: over the surface on which corners land, or null: then these are the faces themselves.
  Rounder(const Mesh& mesh, const Topology& topology, const CreaseSteps& steps, double radius,
          const SmoothWalk* walk = nullptr)
      : mesh_(mesh), topology_(topology), steps_(steps), radius_(radius), walk_(walk) {}

  Mesh round() {
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
  const Vec3& normal(std::uint32_t corner) const { return s_.normals[s_.group[corner]]; }
  const Vec3& position(std::uint32_t corner) const {
    return mesh_.positions[mesh_.corner_vertex[corner]];
  }
  std::uint32_t line_of(std::uint32_t face) const {
    return mesh_.face_line.empty() ? 0 : mesh_.face_line[face];
  }
  bool is_cut(std::uint32_t side) const { return steps_.is_cut(side); }

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
      const std::uint32_t first = place(i, steps_.moves[i].first, last == cut ? kNone : cut);
      const std::uint32_t second =
          steps_.moves[i].opened == kNone ? first : place(i, steps_.moves[i].last, kNone);
      last = cut;
      for (const std::uint32_t c : s_.cut[i].corners) {
        ahead_vertex_[c] = steps_.is_beyond[c] != 0 ? second : first;
        back_vertex_[c] = c == steps_.moves[i].opened ? second : ahead_vertex_[c];
      }
    }
  }

  // Places a vertex of that number for a sector, or a new one (kNone). Returns its number. Within a
  // face the normal is between those of its corners, and the point is off their plane as phong.h
  // has it.
  std::uint32_t place(std::uint32_t sector, const CreaseMove& m, std::uint32_t vertex) {
    if (walk_ != nullptr) return place_by_walk(sector, m.step, vertex);
    const std::uint32_t corners[] = {m.corner, next(m.corner), prev(m.corner)};
    const double p = radius_ * m.ahead, q = radius_ * m.back, shares[] = {1 - p - q, p, q};
    const Vec3 at = position(m.corner) + radius_ * m.step;
    Vec3 lifted = at;
    for (int i = 0; i < 3 && p + q > 0; ++i)
      lifted -= phong_step(at - position(corners[i]), normal(corners[i]), shares[i]);
    const Vec3 turned = normal(m.corner) + p * (normal(corners[1]) - normal(corners[0])) +
                        q * (normal(corners[2]) - normal(corners[0]));
    if (vertex == kNone) vertex = rounded_.add_vertex({}, {});
    rounded_.mesh.positions[vertex] = lifted;
    rounded_.mesh.normals[vertex] =
        turned.norm() > kLeastTurned ? turned.normalized() : normal(m.corner);
    return vertex;
  }

  std::uint32_t place_by_walk(std::uint32_t sector, const Vec3& step, std::uint32_t vertex) {
    const std::uint32_t corner = s_.cut[sector].corners.front();
    const SmoothWalk::OnFace on =
        walk_->moved(walk_->on_face(s_.group[corner]), position(corner) + radius_ * step);
    if (vertex == kNone) return rounded_.add_vertex(on.position, on.normal);
    rounded_.mesh.positions[vertex] = on.position;
    rounded_.mesh.normals[vertex] = on.normal;
    return vertex;
  }

  // The middle of each arc over a crease, and what closes round each cut vertex.
  void place_middles() {
    middle_.assign(topology_.side_twin.size(), kNone);
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
        if (steps_.moves[k].opened != kNone) {
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
          corners.push_back(open_middle_[steps_.sector_of(c)]);
        }
        corners.push_back(ahead_vertex_[c]);
      }
      rounded_.add_face(corners, line_of(face));
    }
  }

  // Two faces for each crease that is cut at an end: quads, or triangles where the other is not.
  void add_strips() {
    for (std::uint32_t side = 0; side < topology_.side_twin.size(); ++side) {
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
    const Sector& sector = s_.cut[steps_.sector_of(side)];
    return sector.first == -sector.last ? s_.tau[side] : Vec3(Vec3::Zero());
  }

  const Mesh& mesh_;
  const Topology& topology_;
  const CreaseSteps& steps_;
  const Sectors& s_ = steps_.sectors;
  double radius_;  // in the mesh's unit
  const SmoothWalk* walk_;
  // [corner], the vertex from which its face's side ahead leaves, and that in which the one before
  // ends.
  std::vector<std::uint32_t> ahead_vertex_, back_vertex_;
  std::vector<std::uint32_t> middle_;       // [side], the middle of the arc at its cut start
  std::vector<std::uint32_t> open_middle_;  // [sector], that between its two vertices, or kNone
  std::vector<Ring> rings_;
  ArcMesh rounded_;
};

[[noreturn]] void refuse(const Mesh& mesh, double radius, const CreaseRoom& room) {
  const std::uint32_t number = mesh.face_line.empty() ? 0 : mesh.face_line[room.face];
  const std::string line = number == 0 ? "" : detail::message(":", number);
  throw MeshError(
      detail::message(mesh.source.empty() ? "mesh" : mesh.source, line, ": face ", room.face,
                      ": no room for creases of radius ", in_mm(radius * mesh.unit),
                      " beside it; the largest that fits is ", in_mm(room.radius * mesh.unit)));
}

// Rounds as round_creases does, with the radius in the mesh's unit.
Mesh rounded(const Mesh& mesh, const Topology& topology, const CreaseSteps& steps, double radius,
             const Poll& poll) {
  const CreaseRoom room = room_of_creases(mesh, steps);
  if (radius <= kRoom * room.radius) return Rounder(mesh, topology, steps, radius).round();
  CreaseSpread spread(mesh, topology, steps, room);
  while (radius > spread.fits().radius) {
    poll();
    if (!spread.widen(radius)) refuse(mesh, radius, spread.best());
  }
  return Rounder(spread.mesh(), spread.topology(), spread.steps(), radius, &spread.walk()).round();
}

}  // namespace

void round_creases(Mesh& mesh, double radius, const Poll& poll) {
  const PlainArithmetic plain;
  if (!(radius > 0 && radius < std::numeric_limits<double>::infinity()))
    throw MeshError(mesh.source + ": the radius of creases must be positive and finite");
  if (mesh.sharp.empty()) return;
  const Topology topology = build_topology(mesh);
  const CreaseSteps steps = find_crease_steps(mesh, topology);
  if (steps.moves.empty()) {
    mesh.sharp.clear();
  } else {
    mesh = rounded(mesh, topology, steps, radius / mesh.unit, poll);
  }
}

}  // namespace gliss
