// Paths on a surface whose every point is known: straight lines in the domains of faces, across
// edges, along them, through vertices and round them. All end where they began. None crosses a
// border.
#pragma once

#include <deque>

#include "tests/extremes/extreme_surfaces.h"

namespace gliss::test {

struct Leg {
  std::uint32_t face;
  Vec2 from, to;
};
using Legs = std::vector<Leg>;

inline Vec2 on_side_of(const Extreme& e, std::uint32_t side, double t) {
  const std::uint32_t face = e.topology.side_face[side];
  return oracle::on_side<double>(static_cast<int>(e.mesh.valence(face)),
                                 static_cast<int>(side - e.mesh.face_begin[face]), t);
}

// The sides to cross from one face to another, fewest.
inline std::vector<std::uint32_t> way_home(const Extreme& e, std::uint32_t from, std::uint32_t to) {
  std::vector<std::uint32_t> by(e.mesh.face_count(), kNone);  // [face], side towards `to`
  std::deque<std::uint32_t> front{to};
  while (!front.empty() && by[from] == kNone && from != to) {
    const std::uint32_t face = front.front();
    front.pop_front();
    for (std::uint32_t s = e.mesh.face_begin[face]; s < e.mesh.face_begin[face + 1]; ++s) {
      const std::uint32_t twin = e.topology.side_twin[s];
      if (twin == kNone) continue;
      const std::uint32_t next = e.topology.side_face[twin];
      if (next == to || by[next] != kNone) continue;
      by[next] = twin;
      front.push_back(next);
    }
  }
  std::vector<std::uint32_t> sides;
  for (std::uint32_t face = from; face != to;) {
    sides.push_back(by[face]);
    face = e.topology.side_face[e.topology.side_twin[sides.back()]];
  }
  return sides;
}

// Over `faces` faces at random and the shortest way back; within a face that has no neighbour.
inline Legs wander(oracle::Rng& rng, const Extreme& e, int faces) {
  const auto first = static_cast<std::uint32_t>(rng() % e.mesh.face_count());
  std::vector<std::uint32_t> sides;
  std::uint32_t face = first, entered = kNone;
  for (int i = 0; i < faces; ++i) {
    std::vector<std::uint32_t> ways;  // not back, unless there is no other
    for (std::uint32_t s = e.mesh.face_begin[face]; s < e.mesh.face_begin[face + 1]; ++s)
      if (s != entered && e.topology.side_twin[s] != kNone) ways.push_back(s);
    if (ways.empty() && entered == kNone) break;
    const std::uint32_t side = ways.empty() ? entered : ways[rng() % ways.size()];
    sides.push_back(side);
    entered = e.topology.side_twin[side];
    face = e.topology.side_face[entered];
  }
  const std::vector<std::uint32_t> home = way_home(e, face, first);
  sides.insert(sides.end(), home.begin(), home.end());
  const Vec2 start = oracle::random_inside<double>(rng, static_cast<int>(e.mesh.valence(first)));
  Legs legs;
  Vec2 at = start;
  for (const std::uint32_t side : sides) {
    const double t = oracle::uniform(rng, 0.02, 0.98);
    legs.push_back({e.topology.side_face[side], at, on_side_of(e, side, t)});
    at = on_side_of(e, e.topology.side_twin[side], 1 - t);
  }
  if (legs.empty()) {
    const Vec2 there = oracle::random_inside<double>(rng, static_cast<int>(e.mesh.valence(first)));
    legs.push_back({first, start, there});
    at = there;
  }
  legs.push_back({first, at, start});
  return legs;
}

// The sides that start at the vertex where `side` does, anticlockwise; from border to border where
// there is one.
inline std::vector<std::uint32_t> spokes(const Extreme& e, std::uint32_t side) {
  const std::uint32_t first = e.topology.vertex_side[e.mesh.corner_vertex[side]];
  if (e.topology.side_twin[first] == kNone) side = first;
  std::vector<std::uint32_t> all;
  for (std::uint32_t next = side; next != kNone; next = next_around(e.mesh, e.topology, next)) {
    if (!all.empty() && next == side) break;
    all.push_back(next);
  }
  return all;
}

// Round the vertex where a side starts, at a part of the length of its edges; to and fro where a
// border runs through it.
inline Legs round_vertex(const Extreme& e, std::uint32_t side, double part) {
  Legs legs;
  for (const std::uint32_t spoke : spokes(e, side)) {
    const std::uint32_t last = prev_side(e.mesh, e.topology, spoke);
    legs.push_back(
        {e.topology.side_face[spoke], on_side_of(e, spoke, part), on_side_of(e, last, 1 - part)});
  }
  if (e.topology.side_twin[prev_side(e.mesh, e.topology, spokes(e, side).back())] == kNone) {
    for (std::size_t i = legs.size(); i-- > 0;)
      legs.push_back({legs[i].face, legs[i].to, legs[i].from});
  }
  return legs;
}

// To and fro through that vertex, into each of its faces.
inline Legs through_vertex(const Extreme& e, std::uint32_t side) {
  Legs legs;
  for (const std::uint32_t spoke : spokes(e, side)) {
    const std::uint32_t face = e.topology.side_face[spoke];
    const Vec2 corner = on_side_of(e, spoke, 0), middle = 0.2 * corner;
    legs.push_back({face, corner, middle});
    legs.push_back({face, middle, corner});
  }
  return legs;
}

// Along the edges of a face.
inline Legs round_face(const Extreme& e, std::uint32_t face) {
  Legs legs;
  for (std::uint32_t s = e.mesh.face_begin[face]; s < e.mesh.face_begin[face + 1]; ++s)
    legs.push_back({face, on_side_of(e, s, 0), on_side_of(e, s, 1)});
  return legs;
}

// Points `step` apart along the legs, from the very start of each; the first again at the end.
inline std::vector<SurfacePoint> points_along(const Extreme& e, const Legs& legs, double step) {
  std::vector<SurfacePoint> points;
  for (const Leg& leg : legs) {
    const Vec2 way = leg.to - leg.from;
    const auto speed = [&](const SurfacePoint& p) {
      return (p.d_xi * way.x() + p.d_eta * way.y()).norm();
    };
    const auto point = [&](double s) { return at(e.cache, leg.face, leg.from + s * way); };
    for (double s = 0; s < 1;) {
      points.push_back(point(s));
      const double half = s + 0.5 * step / speed(points.back());
      s += step / speed(point(std::min(half, 1.0)));
    }
  }
  points.push_back(points.front());
  return points;
}

}  // namespace gliss::test
