#include "gliss/build/complete_mesh.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "gliss/base/plain_arithmetic.h"
#include "gliss/build/face_rays.h"
#include "gliss/build/flat_regions.h"
#include "gliss/mesh/sectors.h"

namespace gliss {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kBulge = 4.0 / 27;   // the most of t (1 - t)^2
constexpr double kShare = 16.0 / 81;  // of a length, that a bulge may have
constexpr double kMargin = 1e-9;      // of a bulge
constexpr double kLeastSeen = 0.5;    // cosine between a corner and a normal that was turned
constexpr std::size_t kGrain = 256;

struct Tangents {
  Vec3 start, end;
};
// The bulges of both ends of a side.
struct Ends {
  double start = 0, end = 0;
};

// Finds what bulges too much, and how much it may.
class Bulges {
 public:
  Bulges(Mesh& mesh, const Topology& topology, const ParallelFor& parallel)
      : mesh_(mesh),
        topology_(topology),
        parallel_(parallel),
        width_(mesh.positions.size(), kInfinity),
        room_(mesh.positions.size(), kInfinity),
        seen_(mesh.face_count(), 0) {
    find_widths();
  }

  void turn_normals();
  void shorten_tangents();
  void limit_middles();

 private:
  // An edge of a sector, from its vertex.
  struct Edge {
    Vec3 direction;
    double length;
    double lean;  // sine that needs no turn
  };
  // The faces round a vertex, between two creases or all round.
  struct Surroundings {
    std::vector<Edge> edges;
    std::vector<Vec3> ring;      // vertices of the faces, from there
    std::vector<Vec3> normals;   // of the corners
    std::vector<double> size;    // of the faces, from there
    Vec3 crease = Vec3::Zero();  // tangent of one, if there is any
    bool is_open = false;        // it ends at a border or a crease
    bool is_fixed = false;       // by two creases
  };

  const Vec3& position(std::uint32_t corner) const {
    return mesh_.positions[mesh_.corner_vertex[corner]];
  }
  const Vec3& normal(std::uint32_t corner) const {
    return mesh_.normals[mesh_.corner_normal[corner]];
  }
  std::uint32_t next(std::uint32_t side) const { return next_side(mesh_, topology_, side); }

  template <class Body>
  void for_faces(Body body) const {
    parallel_(mesh_.face_count(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (auto f = static_cast<std::uint32_t>(begin); f < end; ++f) body(f);
    });
  }

  double extent_across(std::uint32_t side) const;
  void find_widths();
  template <class Bulge>
  std::vector<Ends> bulges_of(Bulge bulge) const;
  bool find_rooms(const std::vector<Ends>& bulges);
  double width(std::uint32_t side, std::uint32_t corner) const;
  double most(std::uint32_t side, std::uint32_t corner) const;
  bool is_wide(double bulge, std::uint32_t side, std::uint32_t corner) const {
    return bulge > most(side, corner) * (1 + kMargin);
  }
  double radius_over(std::uint32_t side) const;
  double most_lean(std::uint32_t side, std::uint32_t corner) const;
  Ends lean_bulges(std::uint32_t side) const;
  Ends tangent_bulges(std::uint32_t side, const Tangents& t) const;
  std::optional<Tangents> tangents(std::uint32_t side) const;
  Surroundings surroundings(const std::vector<std::uint32_t>& corners) const;
  static std::optional<Vec3> turned(const Vec3& normal, const Surroundings& around);
  bool shorten(std::uint32_t side, std::vector<Vec3>& tangents) const;

  Mesh& mesh_;
  const Topology& topology_;
  const ParallelFor& parallel_;
  std::vector<double> width_;  // [vertex], least of its faces
  std::vector<double> room_;   // [vertex], least of its faces; infinity: none within what they saw
  std::vector<double> seen_;   // [face], how far rays have gone
  std::optional<FaceRays> rays_;
};

// The extent of a side's face across the side.
double Bulges::extent_across(std::uint32_t side) const {
  const Vec3 along = edge_of(mesh_, topology_, side).stableNormalized();
  const std::uint32_t face = topology_.side_face[side];
  double farthest = 0;
  for (std::uint32_t c = mesh_.face_begin[face]; c < mesh_.face_begin[face + 1]; ++c)
    farthest = std::max(farthest, (position(c) - position(side)).cross(along).norm());
  return farthest;
}

// The width of a face is the least over its sides of its extent across that side.
void Bulges::find_widths() {
  std::vector<double> width(mesh_.face_count());
  for_faces([&](std::uint32_t f) {
    double least = kInfinity;
    for (std::uint32_t s = mesh_.face_begin[f]; s < mesh_.face_begin[f + 1]; ++s)
      least = std::min(least, extent_across(s));
    width[f] = least;
  });
  for (std::uint32_t c = 0; c < mesh_.corner_vertex.size(); ++c) {
    double& least = width_[mesh_.corner_vertex[c]];
    least = std::min(least, width[topology_.side_face[c]]);
  }
}

// [side], bulge(side).
template <class Bulge>
std::vector<Ends> Bulges::bulges_of(Bulge bulge) const {
  std::vector<Ends> bulges(mesh_.corner_vertex.size());
  for_faces([&](std::uint32_t f) {
    for (std::uint32_t s = mesh_.face_begin[f]; s < mesh_.face_begin[f + 1]; ++s)
      bulges[s] = bulge(s);
  });
  return bulges;
}

// Finds the rooms of vertices where the end of a side needs them. False where none does.
bool Bulges::find_rooms(const std::vector<Ends>& bulges) {
  std::vector<double> need(mesh_.corner_vertex.size(), 0);  // [corner], of both its sides
  for_faces([&](std::uint32_t f) {
    for (std::uint32_t c = mesh_.face_begin[f]; c < mesh_.face_begin[f + 1]; ++c) {
      const std::uint32_t before = prev_side(mesh_, topology_, c);
      const double starts = bulges[c].start / kShare, ends = bulges[before].end / kShare;
      if (starts > width(c, c)) need[c] = starts;
      if (ends > width(before, c)) need[c] = std::max(need[c], ends);
    }
  });
  std::vector<double> reach(mesh_.positions.size(), 0);  // [vertex]
  bool any = false;
  for (std::uint32_t c = 0; c < need.size(); ++c) {
    double& most = reach[mesh_.corner_vertex[c]];
    most = std::max(most, need[c]);
    any = any || need[c] > 0;
  }
  if (!any) return false;
  if (!rays_) rays_.emplace(mesh_, parallel_);
  std::vector<double> room(mesh_.face_count(), kInfinity);
  for_faces([&](std::uint32_t f) {
    double most = 0;
    for (std::uint32_t c = mesh_.face_begin[f]; c < mesh_.face_begin[f + 1]; ++c)
      most = std::max(most, reach[mesh_.corner_vertex[c]]);
    if (!(most > seen_[f])) return;
    seen_[f] = (1 + kMargin) * most;
    room[f] = rays_->room(f, seen_[f]);
  });
  for (std::uint32_t c = 0; c < need.size(); ++c) {
    double& least = room_[mesh_.corner_vertex[c]];
    least = std::min(least, room[topology_.side_face[c]]);
  }
  return true;
}

// The width that the end of a side has at one of its corners.
double Bulges::width(std::uint32_t side, std::uint32_t corner) const {
  return std::min(width_[mesh_.corner_vertex[corner]], edge_of(mesh_, topology_, side).norm());
}

// The bulge that the end of a side may have at one of its corners.
double Bulges::most(std::uint32_t side, std::uint32_t corner) const {
  return kShare * std::max(width(side, corner), room_[mesh_.corner_vertex[corner]]);
}

// The radius by which the faces at a side bend over it; infinity where they do not.
double Bulges::radius_over(std::uint32_t side) const {
  const std::uint32_t twin = topology_.side_twin[side];
  if (twin == kNone || mesh_.is_crease(side)) return kInfinity;
  const double extent = extent_across(side) + extent_across(twin);
  const Vec3 one = newell_normal(mesh_, topology_.side_face[side]),
             other = newell_normal(mesh_, topology_.side_face[twin]);
  return extent / 2 / std::atan2(one.cross(other).norm(), one.dot(other));
}

// The bulge that needs no turn of the normal: a rim is as thick as it is round.
double Bulges::most_lean(std::uint32_t side, std::uint32_t corner) const {
  const double room = room_[mesh_.corner_vertex[corner]];
  return kShare * std::max(width(side, corner), std::min(room, 2 * radius_over(side)));
}

// The bulges of tangents as long as the side, at right angles to the normals of its corners.
Ends Bulges::lean_bulges(std::uint32_t side) const {
  if (mesh_.has_tangents(side)) return {};
  const Vec3 edge = edge_of(mesh_, topology_, side);
  return {kBulge * std::abs(normal(side).dot(edge)),
          kBulge * std::abs(normal(next(side)).dot(edge))};
}

Ends Bulges::tangent_bulges(std::uint32_t side, const Tangents& t) const {
  const Vec3 direction = edge_of(mesh_, topology_, side).stableNormalized();
  return {kBulge * t.start.cross(direction).norm(), kBulge * t.end.cross(direction).norm()};
}

// The tangents of a side, of its own or of eq. 8; none where they are to stay.
std::optional<Tangents> Bulges::tangents(std::uint32_t side) const {
  if (mesh_.has_tangents(side)) {
    if (mesh_.sharp.empty()) return {};
    return Tangents{mesh_.tangents[2 * std::size_t{side}],
                    mesh_.tangents[2 * std::size_t{side} + 1]};
  }
  const std::uint32_t end = next(side), twin = topology_.side_twin[side];
  const Vec3 edge = edge_of(mesh_, topology_, side);
  Vec3 mean = normal(side) + normal(end);
  if (twin != kNone) mean += normal(twin) + normal(next(twin));
  Tangents t{tangent_along(edge, normal(side), mean), tangent_along(edge, normal(end), mean)};
  const double length = arc_length(edge.norm(), t.start, t.end);
  t.start *= length, t.end *= length;
  return t;
}

Bulges::Surroundings Bulges::surroundings(const std::vector<std::uint32_t>& corners) const {
  Surroundings around;
  for (const std::uint32_t c : corners) {
    const std::uint32_t face = topology_.side_face[c], before = prev_side(mesh_, topology_, c);
    around.normals.push_back(corner_normal(mesh_, topology_, c, newell_normal(mesh_, face)));
    double size = 0;
    for (std::uint32_t s = mesh_.face_begin[face]; s < mesh_.face_begin[face + 1]; ++s) {
      if (mesh_.corner_vertex[s] == mesh_.corner_vertex[c]) continue;
      around.ring.push_back(position(s) - position(c));
      size = std::max(size, around.ring.back().norm());
    }
    around.size.push_back(size);
    for (const std::uint32_t side : {c, before}) {
      const Vec3 edge = (side == c ? 1 : -1) * edge_of(mesh_, topology_, side);
      if (topology_.side_twin[side] == kNone) around.is_open = true;
      if (mesh_.is_crease(side)) {
        const Vec3& own = mesh_.tangents[2 * std::size_t{side} + (side == c ? 0 : 1)];
        const Vec3 tangent = own.stableNormalized();
        if (around.crease.isZero(0)) around.crease = tangent;
        around.is_fixed = around.is_fixed || around.crease.cross(tangent).norm() > 1e-3;
        around.is_open = true;
      } else {
        const double length = edge.norm();
        around.edges.push_back({edge.stableNormalized(), length,
                                std::min(1.0, most_lean(side, c) / (kBulge * length))});
      }
    }
  }
  return around;
}

// A normal that leans less to long edges, if that is better.
std::optional<Vec3> Bulges::turned(const Vec3& normal, const Surroundings& around) {
  constexpr int kRounds = 8;
  if (around.is_fixed) return {};
  Vec3 n = normal;
  const bool has_crease = !around.crease.isZero(0);
  const double least_reach = !around.is_open ? 0 : has_crease ? 0.05 : 1e-3;  // of the length
  bool has_moved = true;
  for (int round = 0; round < kRounds && has_moved; ++round) {
    has_moved = false;
    for (const Edge& e : around.edges) {
      if (std::abs(normal.dot(e.direction)) <= e.lean) continue;
      const double lean = n.dot(e.direction);
      const Vec3 away = (e.direction - lean * n).stableNormalized();
      double reach = 0;
      for (const Vec3& p : around.ring) reach = std::max(reach, -away.dot(p));
      if (reach < least_reach * e.length) continue;
      const double most = std::min(1.5, reach / e.length),
                   angle = std::asin(std::clamp(lean, -1.0, 1.0));
      if (!(std::abs(angle) > most * (1 + kMargin))) continue;
      Vec3 step = std::tan(std::copysign(most, angle) - angle) * away;
      step -= around.crease * around.crease.dot(step);
      n = (n + step).stableNormalized();
      has_moved = true;
    }
  }
  // A normal costs what the face that leans most leans to it; infinity where it sees a corner too
  // little.
  const auto cost = [&](const Vec3& m) {
    double most = 0;
    for (std::size_t i = 0; i < around.normals.size(); ++i) {
      const Vec3& own = around.normals[i];
      if (own.dot(m) < std::min(kLeastSeen, own.dot(normal))) return kInfinity;
      most = std::max(most, around.size[i] * own.cross(m).norm());
    }
    return most;
  };
  std::optional<Vec3> best;
  double least = cost(normal) * (1 - kMargin);
  for (const double share : {0.25, 0.5, 0.75, 1.0}) {
    const Vec3 m = (normal + share * (n - normal)).stableNormalized();
    if (const double here = cost(m); here <= least) least = here, best = m;
  }
  return best;
}

void Bulges::turn_normals() {
  const std::vector<Ends> bulges =
      bulges_of([this](std::uint32_t side) { return lean_bulges(side); });
  if (!find_rooms(bulges)) return;
  const auto is_wide = [this](double bulge, std::uint32_t side, std::uint32_t corner) {
    return bulge > kShare * width(side, corner) * (1 + kMargin) &&
           bulge > most_lean(side, corner) * (1 + kMargin);
  };
  std::vector<std::uint32_t> place(mesh_.normals.size(), kNone);  // [normal], among those to turn
  std::vector<std::vector<std::uint32_t>> corners;
  for (std::uint32_t c = 0; c < mesh_.corner_vertex.size(); ++c) {
    const std::uint32_t before = prev_side(mesh_, topology_, c);
    if (place[mesh_.corner_normal[c]] != kNone ||
        !(is_wide(bulges[c].start, c, c) || is_wide(bulges[before].end, before, c)))
      continue;
    place[mesh_.corner_normal[c]] = static_cast<std::uint32_t>(corners.size());
    corners.emplace_back();
  }
  for (std::uint32_t c = 0; c < mesh_.corner_vertex.size(); ++c) {
    const std::uint32_t at = place[mesh_.corner_normal[c]];
    if (at != kNone) corners[at].push_back(c);
  }
  parallel_(corners.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Vec3& n = mesh_.normals[mesh_.corner_normal[corners[i].front()]];
      if (const auto better = turned(n, surroundings(corners[i]))) n = *better;
    }
  });
}

// True if an edge bulged too much; `tangents` has shorter ones for both its sides.
bool Bulges::shorten(std::uint32_t side, std::vector<Vec3>& all) const {
  std::optional<Tangents> t = tangents(side);
  if (!t) return false;
  const Ends bulges = tangent_bulges(side, *t);
  bool is_shortened = false;
  const auto limit = [&](Vec3& tangent, double bulge, std::uint32_t corner) {
    if (!is_wide(bulge, side, corner)) return;
    tangent *= most(side, corner) / bulge;
    is_shortened = true;
  };
  limit(t->start, bulges.start, side);
  limit(t->end, bulges.end, next(side));
  if (!is_shortened) return false;
  const auto put = [&](std::uint32_t s, const Vec3& start, const Vec3& end) {
    all[2 * std::size_t{s}] = start;
    all[2 * std::size_t{s} + 1] = end;
  };
  put(side, t->start, t->end);
  if (const std::uint32_t twin = topology_.side_twin[side]; twin != kNone)
    put(twin, -t->end, -t->start);
  return true;
}

void Bulges::shorten_tangents() {
  const auto bulges = [this](std::uint32_t side) {
    const std::optional<Tangents> t = tangents(side);
    return t ? tangent_bulges(side, *t) : Ends{};
  };
  if (!find_rooms(bulges_of(bulges))) return;
  std::vector<Vec3> all = mesh_.tangents;
  all.resize(2 * mesh_.corner_vertex.size(), Vec3::Zero());
  std::atomic<bool> any = false;
  for_faces([&](std::uint32_t f) {
    for (std::uint32_t s = mesh_.face_begin[f]; s < mesh_.face_begin[f + 1]; ++s) {
      if (topology_.side_twin[s] != kNone && topology_.side_twin[s] < s) continue;
      if (shorten(s, all)) any = true;
    }
  });
  if (any) mesh_.tangents = std::move(all);
}

void Bulges::limit_middles() {
  std::vector<double> width(mesh_.face_count(), kInfinity), rise(mesh_.face_count(), 0);
  std::atomic<bool> any = false;
  for_faces([&](std::uint32_t f) {
    Vec3 middle = Vec3::Zero();
    for (std::uint32_t c = mesh_.face_begin[f]; c < mesh_.face_begin[f + 1]; ++c) {
      middle += position(c) / mesh_.valence(f);
      width[f] = std::min(width[f], width_[mesh_.corner_vertex[c]]);
    }
    // A patch rises less, mostly by far, than the tangent planes at its corners.
    for (std::uint32_t c = mesh_.face_begin[f]; c < mesh_.face_begin[f + 1]; ++c)
      rise[f] = std::max(rise[f], std::abs(normal(c).dot(middle - position(c))));
    if (rise[f] > width[f] / 3) any = true;
  });
  if (!any) return;
  if (!rays_) rays_.emplace(mesh_, parallel_);
  mesh_.most_sag.assign(mesh_.face_count(), kInfinity);
  for_faces([&](std::uint32_t f) {
    if (rise[f] > width[f] / 3)
      mesh_.most_sag[f] = std::max(width[f], rays_->room(f, 3 * rise[f])) / 3;
  });
}

}  // namespace

Topology complete_mesh(Mesh& mesh, Construction construction, const ParallelFor& parallel) {
  const PlainArithmetic plain;
  const bool made = mesh.normals.empty();
  add_vertex_normals(mesh, normal_weights(construction), parallel);
  Topology topology = build_topology(mesh);
  mesh.most_sag.clear();
  if (made) keep_flat_regions(mesh, topology, parallel);
  Bulges bulges(mesh, topology, parallel);
  if (made) bulges.turn_normals();
  bulges.shorten_tangents();
  bulges.limit_middles();
  return topology;
}

}  // namespace gliss
