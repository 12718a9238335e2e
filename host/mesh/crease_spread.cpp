#include "gliss/mesh/crease_spread.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <queue>
#include <utility>

namespace gliss {
namespace {

constexpr double kTry = 0.8;   // of the radius that has room: where it is looked who is in the way
constexpr double kStep = 0.5;  // of the time until faces meet
constexpr double kReach = 8;   // steps from a crease within which vertices make way
constexpr double kFlat = 15 * std::numbers::pi / 180;  // rad, between triangles of one plane
constexpr double kBend = 20 * std::numbers::pi / 180;  // rad, at a crease's vertex that stays
constexpr double kGain = 1.01;                         // of the room, that counts as such
constexpr int kMostIdle = 10;                          // steps without it
constexpr int kSweeps = 60;
constexpr double kLeastSpan = 1e-9;  // of what is divided by, for slivers

// The tangent of half of the angle between two vectors; bounded near half a turn.
double half_tangent(const Vec3& a, const Vec3& b) {
  const double lengths = a.norm() * b.norm(), cosine = a.dot(b);
  return a.cross(b).norm() / std::max(lengths + cosine, kLeastSpan * lengths);
}

double cotangent(const Vec3& a, const Vec3& b) {
  const double sine = a.cross(b).norm();
  return a.dot(b) / std::max(sine, kLeastSpan * a.norm() * b.norm());
}

}  // namespace

CreaseSpread::CreaseSpread(const Mesh& mesh, const Topology& topology, const CreaseSteps& steps,
                           const CreaseRoom& room)
    : walk_(mesh, topology, steps.sectors),
      mesh_(mesh),
      topology_(topology),
      steps_(steps),
      room_(room),
      best_{kRoom * room.radius, room.face},
      on_face_(mesh.positions.size()),
      on_crease_(mesh.positions.size()),
      vertex_ahead_(mesh.positions.size(), kNone) {
  mesh_.normals.clear(), mesh_.corner_normal.clear();
  for (std::uint32_t side = 0; side < topology.side_twin.size(); ++side) {
    const std::uint32_t vertex = vertex_of(side);
    if (!steps.is_cut(side) || vertex_ahead_[vertex] != kNone) continue;
    vertex_ahead_[vertex] = vertex_of(next(side));
    on_crease_[vertex] = walk_.on_crease(side);
  }
  place_corners();
  inverted_count_ = inverted_count();
}

bool CreaseSpread::widen(double radius) {
  if (idle_ > kMostIdle) return false;
  tried_ = std::max(tried_, std::min(tried_ + kTry * (room_.radius - tried_), fits().radius));
  place_corners();
  find_kinds();
  if (flip_all()) {
    topology_ = build_topology(mesh_);
  } else {
    slide_along();
    follow();
    const double left = time_to_meet(mesh_, steps_, tried_, [&](std::uint32_t v, const Vec3& step) {
                          return speed_of(v, step);
                        }).radius;
    const double most = std::min({kStep * left, kRoom * (tried_ + left) - tried_, tried_});
    const double time = std::max(0.0, std::min(most, radius - tried_));
    move(time);
    tried_ += time;
    place_corners();
  }
  list_sectors();
  if (inverted_count() > inverted_count_) return false;
  room_ = room_of_creases(mesh_, steps_, tried_);
  const CreaseRoom now = fits();
  idle_ = now.radius > kGain * best_.radius ? 0 : idle_ + 1;
  if (now.radius > best_.radius) best_ = now;
  return true;
}

// Counts the triangles that are turned over where their corners are placed.
std::size_t CreaseSpread::inverted_count() const {
  std::size_t count = 0;
  for (std::uint32_t face = 0; face < mesh_.face_count(); ++face) {
    if (mesh_.valence(face) != 3) continue;
    const std::uint32_t c = mesh_.face_begin[face];
    if (is_opened(c) || is_opened(c + 1) || is_opened(c + 2)) continue;
    const Vec3 area = (place_[c + 1] - place_[c]).cross(place_[c + 2] - place_[c]);
    if (!(area.dot(normal(c) + normal(c + 1) + normal(c + 2)) > 0)) ++count;
  }
  return count;
}

// Lists the corners of sectors again after triangles were flipped.
void CreaseSpread::list_sectors() {
  for (std::uint32_t first = 0; first < mesh_.corner_vertex.size(); ++first) {
    const std::uint32_t sector = steps_.sector_of(first);
    if (sector == kNone || !(steps_.is_cut(first) || topology_.side_twin[first] == kNone)) continue;
    std::vector<std::uint32_t>& corners = steps_.sectors.cut[sector].corners;
    corners.clear();
    std::uint32_t corner = first;
    do {
      corners.push_back(corner);
      corner = next_around(mesh_, topology_, corner);
    } while (corner != kNone && !steps_.is_cut(corner));
  }
}

// Puts each corner where it is with the radius that is tried; an opened one at the middle of its
// places.
void CreaseSpread::place_corners() {
  place_.resize(mesh_.corner_vertex.size());
  for (std::uint32_t c = 0; c < place_.size(); ++c) {
    const Vec3 step = is_opened(c) ? steps_.moves[steps_.sector_of(c)].between : steps_.step_of(c);
    place_[c] = position(c) + tried_ * step;
  }
}

// Finds the vertices that may move: those within the reach of a step from a crease, or along it
// from a corner.
void CreaseSpread::find_kinds() {
  kind_.assign(mesh_.positions.size(), Kind::kFixed);
  crease_ahead_.assign(mesh_.positions.size(), kNone);
  crease_back_ = crease_ahead_;
  is_corner_.assign(mesh_.positions.size(), 0);
  const auto reach_of = [&](std::uint32_t vertex) {
    double longest = 0;
    for_each_corner(
        vertex, [&](std::uint32_t c) { longest = std::max(longest, steps_.step_of(c).norm()); });
    return kReach * tried_ * longest;
  };
  std::vector<double> along(mesh_.positions.size(), 0), across(along);
  for (std::uint32_t v = 0; v < kind_.size(); ++v) {
    if (vertex_ahead_[v] == kNone) continue;
    across[v] = reach_of(v);
    if (!passes(v)) along[v] = across[v], is_corner_[v] = 1;
  }
  spread_reach(along, true);
  spread_reach(across, false);
  for (std::uint32_t v = 0; v < kind_.size(); ++v) {
    if (vertex_ahead_[v] != kNone) {
      if (along[v] > 0 && passes(v)) kind_[v] = Kind::kSlides;
    } else if (across[v] > 0 && is_smooth(v)) {
      kind_[v] = Kind::kFree;
      if (on_face_[v].triangle == kNone) on_face_[v] = walk_.on_face(v);
    }
  }
}

template <class Visit>
void CreaseSpread::for_each_corner(std::uint32_t vertex, Visit visit) const {
  const std::uint32_t first = topology_.vertex_side[vertex];
  for (std::uint32_t side = first; side != kNone;) {
    visit(side);
    side = next_around(mesh_, topology_, side);
    if (side == first) return;
  }
}

// True if no crease and no border is at a vertex.
bool CreaseSpread::is_smooth(std::uint32_t vertex) const {
  bool smooth = topology_.vertex_side[vertex] != kNone;
  for_each_corner(vertex, [&](std::uint32_t c) {
    smooth = smooth && topology_.side_twin[c] != kNone && topology_.side_twin[prev(c)] != kNone &&
             !mesh_.is_crease(c);
  });
  return smooth;
}

// True if a crease goes on through a vertex, and bends by little. Finds its side ahead.
bool CreaseSpread::passes(std::uint32_t vertex) {
  std::uint32_t ahead = kNone, back = kNone;
  bool passes = true;
  for_each_corner(vertex, [&](std::uint32_t c) {
    if (topology_.side_twin[c] == kNone || topology_.side_twin[prev(c)] == kNone) passes = false;
    if (!steps_.is_cut(c)) return;
    std::uint32_t& side = vertex_of(next(c)) == vertex_ahead_[vertex] ? ahead : back;
    if (side != kNone) passes = false;
    side = c;
  });
  if (!passes || ahead == kNone || back == kNone) return false;
  crease_ahead_[vertex] = ahead, crease_back_[vertex] = back;
  return angle_between(edge_of(mesh_, topology_, ahead), -edge_of(mesh_, topology_, back)) < kBend;
}

// Gives each vertex what is left of the reaches of others, less the length of the way.
void CreaseSpread::spread_reach(std::vector<double>& reach, bool on_creases) const {
  std::priority_queue<std::pair<double, std::uint32_t>> open;
  for (std::uint32_t v = 0; v < reach.size(); ++v)
    if (reach[v] > 0) open.push({reach[v], v});
  while (!open.empty()) {
    const auto [left, vertex] = open.top();
    open.pop();
    if (left < reach[vertex]) continue;
    for_each_corner(vertex, [&, left = left](std::uint32_t c) {
      if (on_creases && !mesh_.is_crease(c)) return;
      const std::uint32_t other = vertex_of(next(c));
      const double rest = left - edge_of(mesh_, topology_, c).norm();
      if (rest > reach[other]) reach[other] = rest, open.push({rest, other});
    });
  }
}

// Cuts pairs of triangles along their other diagonal until they are Delaunay's, as they are placed.
// Returns true if any was not.
bool CreaseSpread::flip_all() {
  bool any = false, goes_on = true;
  for (int pass = 0; pass < kSweeps && goes_on; ++pass) {
    goes_on = false;
    for (std::uint32_t side = 0; side < topology_.side_twin.size(); ++side) {
      if (!flips(side)) continue;
      flip(side);
      any = goes_on = true;
    }
  }
  return any;
}

// True if the triangles on both sides of an edge, which are nearly of one plane, are Delaunay's
// with the other diagonal.
bool CreaseSpread::flips(std::uint32_t side) const {
  const std::uint32_t twin = topology_.side_twin[side];
  if (twin == kNone || twin < side || mesh_.is_crease(side)) return false;
  if (mesh_.valence(topology_.side_face[side]) != 3 ||
      mesh_.valence(topology_.side_face[twin]) != 3)
    return false;
  const std::uint32_t corners[] = {side, next(side), prev(side), twin, next(twin), prev(twin)};
  if (is_in_opened(side) || is_in_opened(twin)) return false;
  if (std::none_of(std::begin(corners), std::end(corners), [&](std::uint32_t c) {
        return steps_.sector_of(c) != kNone || kind_[vertex_of(c)] != Kind::kFixed;
      }))
    return false;
  const Vec3 &a = place_[side], &b = place_[twin], &c = place_[corners[2]], &d = place_[corners[5]];
  if (!(cotangent(a - c, b - c) + cotangent(a - d, b - d) < -kLeastSpan)) return false;
  const Vec3 one = (b - a).cross(c - a), other = (a - b).cross(d - b), both = one + other;
  if (angle_between(one, other) > kFlat) return false;
  // An opened corner leaves its first place to the second triangle.
  const Vec3 first_c = first_place(corners[2]), first_d = first_place(corners[5]);
  return (b - first_d).cross(c - first_d).dot(both) > 0 &&
         (a - first_c).cross(d - first_c).dot(both) > 0 &&
         !are_joined(corners[2], vertex_of(corners[5]));
}

// The place where the side ahead of a corner leaves.
Vec3 CreaseSpread::first_place(std::uint32_t corner) const {
  return position(corner) + tried_ * steps_.step_of(corner);
}

// True if it becomes three places.
bool CreaseSpread::is_opened(std::uint32_t corner) const {
  const std::uint32_t sector = steps_.sector_of(corner);
  return sector != kNone && steps_.moves[sector].opened == corner;
}

// True if any corner of its sector is opened.
bool CreaseSpread::is_in_opened(std::uint32_t corner) const {
  const std::uint32_t sector = steps_.sector_of(corner);
  return sector != kNone && steps_.moves[sector].opened != kNone;
}

// True if an edge runs from the start of a side, within a smooth region, to that vertex.
bool CreaseSpread::are_joined(std::uint32_t side, std::uint32_t vertex) const {
  for (std::uint32_t s = side; s != kNone;) {
    if (vertex_of(next(s)) == vertex || vertex_of(prev(s)) == vertex) return true;
    s = next_around(mesh_, topology_, s);
    if (s == side) return false;
  }
  for (std::uint32_t s = side; topology_.side_twin[s] != kNone;) {
    s = right_of(s);
    if (vertex_of(next(s)) == vertex || vertex_of(prev(s)) == vertex) return true;
  }
  return false;
}

// Makes triangles d b c and c a d of a b c and b a d.
void CreaseSpread::flip(std::uint32_t side) {
  const std::uint32_t twin = topology_.side_twin[side], c = prev(side), d = prev(twin);
  const auto put = [&](std::uint32_t to, std::uint32_t from) {
    mesh_.corner_vertex[to] = mesh_.corner_vertex[from];
    mesh_.sharp[to] = mesh_.sharp[from];
    place_[to] = first_place(from);
    steps_.sectors.group[to] = steps_.sectors.group[from];
    steps_.sectors.tau[to] = steps_.sectors.tau[from];
    steps_.wide[to] = steps_.wide[from];
    steps_.is_beyond[to] = steps_.is_beyond[from];
    const std::uint32_t beyond = topology_.side_twin[from];
    topology_.side_twin[to] = beyond;
    if (beyond != kNone) topology_.side_twin[beyond] = to;
  };
  put(side, d), put(twin, c);
  mesh_.sharp[c] = mesh_.sharp[d] = 0;
  steps_.sectors.tau[c] = steps_.sectors.tau[d] = Vec3::Zero();
  topology_.side_twin[c] = d, topology_.side_twin[d] = c;
}

// The shorter of both places of a crease's edge.
double CreaseSpread::length_of(std::uint32_t side) const {
  const Vec3 edge = edge_of(mesh_, topology_, side);
  return edge.norm() + tried_ * std::min(0.0, stretch_of(side));
}

// The length by which the shorter of both places of a crease's edge grows, by a radius of 1.
double CreaseSpread::stretch_of(std::uint32_t side) const {
  const Vec3 along = edge_of(mesh_, topology_, side).stableNormalized();
  return std::min(
      along.dot(steps_.step_into(next(side)) - steps_.step_of(side)),
      along.dot(steps_.step_of(topology_.side_twin[side]) - steps_.step_into(right_of(side))));
}

// Gives vertices on creases their speeds: what a corner takes from the edges beside it is taken
// from others too, in proportion to their lengths.
void CreaseSpread::slide_along() {
  slide_.resize(mesh_.positions.size(), 0);  // as before, to begin with
  const auto slides = [&](std::uint32_t v) { return kind_[v] == Kind::kSlides; };
  // The way along a side of the vertex at its end, and what a corner there takes.
  const auto pull = [&](std::uint32_t side) {
    const std::uint32_t end = vertex_of(next(side));
    if (crease_ahead_[end] == kNone || !slides(end))
      return is_corner_[end] != 0 ? stretch_of(side) : 0.0;
    return vertex_ahead_[end] == vertex_of(side) ? -slide_[end] : slide_[end];
  };
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (std::uint32_t v = 0; v < kind_.size(); ++v) {
      if (!slides(v)) continue;
      const std::uint32_t ahead = crease_ahead_[v], back = crease_back_[v];
      const double to = 1 / length_of(ahead), from = 1 / length_of(back);
      slide_[v] = (pull(ahead) * to - pull(back) * from) / (to + from);
    }
  }
}

// Adds what draws a free vertex: the places of the other corners of each of its faces. Weights are
// those of mean value coordinates (Floater 2003) over the distance: what comes near counts most.
void CreaseSpread::add_pulls(std::uint32_t vertex, std::vector<Pull>& pulls) const {
  std::vector<Vec3> steps;
  for_each_corner(vertex, [&](std::uint32_t c) {
    Vec3 before = Vec3::Zero();
    for (std::uint32_t other = next(c); other != c; other = next(other)) {
      steps.clear();
      steps_.append_steps(other, steps);
      for (const Vec3& step : steps) {
        const Vec3 way = position(other) + tried_ * step - position(c);
        if (!before.isZero(0)) {
          const double half = half_tangent(before, way);
          pulls.back().weight += half / before.squaredNorm();
          pulls.push_back({vertex_of(other), step, half / way.squaredNorm()});
        } else {
          pulls.push_back({vertex_of(other), step, 0});
        }
        before = way;
      }
    }
  });
}

// Gives vertices of smooth regions their speeds: each goes as those around it do in the mean.
void CreaseSpread::follow() {
  std::vector<Pull> pulls;
  std::vector<std::pair<std::uint32_t, std::size_t>> free;  // vertices, ends of their pulls
  for (std::uint32_t v = 0; v < kind_.size(); ++v) {
    if (kind_[v] != Kind::kFree) continue;
    add_pulls(v, pulls);
    free.emplace_back(v, pulls.size());
  }
  speed_.resize(mesh_.positions.size(), Vec3::Zero());  // as before, to begin with
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    std::size_t i = 0;
    for (const auto& [v, end] : free) {
      Vec3 sum = Vec3::Zero();
      double weights = 0;
      for (; i < end; ++i) {
        sum += pulls[i].weight * speed_of(pulls[i].vertex, pulls[i].step);
        weights += pulls[i].weight;
      }
      speed_[v] = sum / weights;
    }
  }
}

// The speed of a place that a vertex has with that step.
Vec3 CreaseSpread::speed_of(std::uint32_t vertex, const Vec3& step) const {
  return kind_[vertex] == Kind::kFree ? speed_[vertex] : Vec3(step + slide_of(vertex));
}

// The speed at which a vertex slides along its crease.
Vec3 CreaseSpread::slide_of(std::uint32_t vertex) const {
  if (kind_[vertex] != Kind::kSlides) return Vec3::Zero();
  return slide_[vertex] * steps_.sectors.tau[crease_ahead_[vertex]];
}

// Moves vertices as far as their speeds take them while the radius grows by so much.
void CreaseSpread::move(double time) {
  for (std::uint32_t v = 0; v < kind_.size(); ++v) {
    if (kind_[v] == Kind::kFree) {
      on_face_[v] = walk_.moved(on_face_[v], mesh_.positions[v] + time * speed_[v]);
      mesh_.positions[v] = on_face_[v].position;
      steps_.sectors.normals[v] = on_face_[v].normal;
    } else if (kind_[v] == Kind::kSlides) {
      on_crease_[v] = walk_.moved(on_crease_[v], time * slide_[v]);
      put_on_crease(v);
    }
  }
}

// Gives a vertex its place on its crease, and both sectors there their normals and steps.
void CreaseSpread::put_on_crease(std::uint32_t vertex) {
  const SmoothWalk::OnCrease& on = on_crease_[vertex];
  const std::uint32_t sides[] = {crease_ahead_[vertex], crease_back_[vertex]};
  const double wide = std::tan(angle_between(on.left, on.right) / 2);
  mesh_.positions[vertex] = on.position;
  for (const bool is_right : {false, true}) {
    const std::uint32_t side = sides[is_right ? 1 : 0], number = steps_.sector_of(side);
    const Vec3 along = is_right ? Vec3(-on.along) : on.along, &n = is_right ? on.right : on.left;
    Sector& sector = steps_.sectors.cut[number];
    steps_.sectors.tau[side] = sector.first = along;
    sector.last = -along;
    steps_.sectors.normals[steps_.sectors.group[side]] = n;
    steps_.wide[side] = wide;
    steps_.moves[number].first.step = wide * n.cross(along);
  }
}

}  // namespace gliss
