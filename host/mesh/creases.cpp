#include "gliss/mesh/creases.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "gliss/base/message.h"
#include "gliss/base/plain_arithmetic.h"
#include "gliss/base/units.h"
#include "gliss/mesh/sectors.h"

namespace gliss {
namespace {

// A sector whose creases are less apart than this (their sine) has its normal from them only if it
// is that near to its faces' (cosine); and no corner's own normal may be farther from it than
// kLeastSeen (cosine). Else its inner edges are cut as well.
constexpr double kNarrow = 0.25, kTrusted = 0.8, kLeastSeen = 0.2;

// Finds normals and tangents, vertex by vertex and then edge by edge.
class Sharpener {
 public:
  Sharpener(const Mesh& mesh, const Topology& topology, NormalWeights weights,
            const ParallelFor& parallel)
      : mesh_(mesh), topology_(topology) {
    Sectors sectors = cut_sectors(mesh, topology, mesh.sharp, weights, parallel);
    sectors_ = std::move(sectors.cut);
    tau_ = std::move(sectors.tau);
    group_ = std::move(sectors.group);
    normals_ = std::move(sectors.normals);
  }

  SharpCorners find() {
    // Sectors that are cut on append to the normals, and to no sector before.
    for (const Sector& sector : sectors_) turn_normal(sector);
    std::vector<Vec3> tangents = find_tangents();
    return {std::move(normals_), std::move(tangents), std::move(group_)};
  }

 private:
  Vec3 direction(std::uint32_t side) const {
    return edge_of(mesh_, topology_, side).stableNormalized();
  }

  // Turns the normal of a sector until it is at right angles to the tangents of its creases.
  void turn_normal(const Sector& sector) {
    const std::uint32_t group = group_[sector.corners.front()];
    const std::optional<Vec3> turned = between(sector.first, sector.last, normals_[group]);
    if (turned && sees(*turned, sector)) {
      normals_[group] = *turned;
      return;
    }
    // Each corner by itself.
    Vec3 first = sector.first;
    for (std::size_t i = 0; i < sector.corners.size(); ++i) {
      const std::uint32_t corner = sector.corners[i];
      const bool is_last = i + 1 == sector.corners.size();
      if (!is_last) tau_[sector.corners[i + 1]] = direction(sector.corners[i + 1]);
      const Vec3 last = is_last ? sector.last : tau_[sector.corners[i + 1]];
      const Vec3 own = corner_normal(mesh_, topology_, corner,
                                     newell_normal(mesh_, topology_.side_face[corner]));
      if (i > 0)
        group_[corner] = static_cast<std::uint32_t>(normals_.size()), normals_.emplace_back();
      normals_[group_[corner]] = normal_to(first, last, own);
      first = last;
    }
  }

  bool sees(const Vec3& normal, const Sector& sector) const {
    return std::all_of(sector.corners.begin(), sector.corners.end(), [&](std::uint32_t c) {
      return corner_normal(mesh_, topology_, c, newell_normal(mesh_, topology_.side_face[c]))
                 .dot(normal) >= kLeastSeen;
    });
  }

  // The normal at right angles to both tangents, on the side of `normal`; to one where the other is
  // zero or they are collinear.
  static Vec3 normal_to(const Vec3& first, const Vec3& last, const Vec3& normal) {
    const Vec3 cross = first.cross(last);
    if (cross.norm() > kCollinear)
      return (cross.dot(normal) < 0 ? Vec3(-cross) : cross).normalized();
    const Vec3& tau = first.isZero(0) ? last : first;
    return across(tau, normal).stableNormalized();
  }
  // The same; none where the tangents say too little of it.
  static std::optional<Vec3> between(const Vec3& first, const Vec3& last, const Vec3& normal) {
    const double sine = first.cross(last).norm();
    const Vec3 found = normal_to(first, last, normal);
    if (sine > kCollinear && sine < kNarrow && found.dot(normal) < kTrusted) return {};
    return found;
  }

  // Gives tangents the lengths that a circle with their directions has.
  std::vector<Vec3> find_tangents() const {
    std::vector<Vec3> tangents(2 * mesh_.corner_vertex.size(), Vec3::Zero());
    for (std::uint32_t side = 0; side < topology_.side_twin.size(); ++side) {
      const std::uint32_t twin = topology_.side_twin[side];
      if (twin == kNone || twin < side || (tau_[side].isZero(0) && tau_[twin].isZero(0))) continue;
      const Vec3 edge = edge_of(mesh_, topology_, side);
      const std::uint32_t next = next_side(mesh_, topology_, side),
                          beyond = next_side(mesh_, topology_, twin);
      const Vec3 mean = (normals_[group_[side]] + normals_[group_[next]] + normals_[group_[twin]] +
                         normals_[group_[beyond]])
                            .stableNormalized();
      const Vec3 start =
          tau_[side].isZero(0) ? tangent_along(edge, normals_[group_[side]], mean) : tau_[side];
      const Vec3 end = tau_[twin].isZero(0) ? tangent_along(edge, normals_[group_[twin]], mean)
                                            : Vec3(-tau_[twin]);
      const double length = arc_length(edge.norm(), start, end);
      tangents[2 * side] = length * start;
      tangents[2 * side + 1] = length * end;
      tangents[2 * twin] = -tangents[2 * side + 1];
      tangents[2 * twin + 1] = -tangents[2 * side];
    }
    return tangents;
  }

  const Mesh& mesh_;
  const Topology& topology_;
  std::vector<Sector> sectors_;
  std::vector<Vec3> tau_;             // [side], where it is cut at its start: unit tangent there
  std::vector<std::uint32_t> group_;  // [corner], its normal
  std::vector<Vec3> normals_;
};

// The angles by which the faces beside each inner edge turn, rad, by side; negative elsewhere.
std::vector<double> turns_of(const Mesh& mesh, const Topology& topology) {
  const LargeArray<Vec3> normal = normals_beside(mesh, topology);
  std::vector<double> turns(topology.side_twin.size(), -1);
  for (std::uint32_t side = 0; side < turns.size(); ++side) {
    const std::uint32_t twin = topology.side_twin[side];
    if (twin == kNone || twin < side) continue;
    turns[side] = angle_between(normal[side], normal[twin]);
  }
  return turns;
}

// Counts the ascending numbers that are above x.
std::size_t count_above(const std::vector<double>& ascending, double x) {
  return static_cast<std::size_t>(ascending.end() -
                                  std::upper_bound(ascending.begin(), ascending.end(), x));
}

// Knows how many edges turn by how much, and at how many vertices.
class Turns {
 public:
  static constexpr std::size_t kDegrees = 180;

  // `turns`: turns_of.
  Turns(const Mesh& mesh, const Topology& topology, const std::vector<double>& turns)
      : most_(mesh.positions.size(), -1), next_(most_) {
    for (std::uint32_t side = 0; side < turns.size(); ++side) {
      if (turns[side] < 0) continue;
      const auto degrees = static_cast<std::size_t>(turns[side] * 180 / std::numbers::pi);
      ++below_[std::min(degrees, kDegrees) + 1];
      meet(mesh.corner_vertex[side], turns[side]);
      meet(mesh.corner_vertex[next_side(mesh, topology, side)], turns[side]);
    }
    std::partial_sum(below_.begin(), below_.end(), below_.begin());
  }

  // The number of edges that turn by fewer degrees, up to kDegrees.
  std::size_t below(std::size_t degrees) const { return below_[degrees]; }
  // True if at most a tenth of the vertices of edges that turn by more than `angle`, rad, have only
  // one. Few meshes need to be asked.
  bool go_on(double angle) {
    if (!std::exchange(is_sorted_, true)) {
      std::sort(most_.begin(), most_.end());
      std::sort(next_.begin(), next_.end());
    }
    const std::size_t vertices = count_above(most_, angle);
    return 10 * (vertices - count_above(next_, angle)) <= vertices;
  }

 private:
  void meet(std::uint32_t vertex, double turn) {
    next_[vertex] = std::max(next_[vertex], std::min(most_[vertex], turn));
    most_[vertex] = std::max(most_[vertex], turn);
  }

  std::array<std::size_t, kDegrees + 2> below_{};
  std::vector<double> most_, next_;  // of the edges of a vertex, rad; negative: it has fewer
  bool is_sorted_ = false;
};

// Finds plain_crease_angle from turns_of.
std::optional<double> separating_angle(const Mesh& mesh, const Topology& topology,
                                       const std::vector<double>& turns_of_sides) {
  constexpr std::size_t kDegrees = Turns::kDegrees, kApart = 30, kLeast = 5, kRound = 40;
  Turns turns(mesh, topology, turns_of_sides);
  const std::size_t all = turns.below(kDegrees);
  std::size_t widest = kApart - 1;
  std::optional<double> found;
  for (std::size_t low = kLeast; all > 0 && low <= kRound; ++low) {
    for (std::size_t high = low + widest + 1; high <= kDegrees; ++high) {
      const std::size_t below = turns.below(low), beneath = turns.below(high);
      if (100 * (beneath - below) > all || 50 * (all - beneath) < all || 4 * below < all) continue;
      const double middle = 0.5 * static_cast<double>(low + high) * std::numbers::pi / 180;
      if (!turns.go_on(middle)) continue;
      widest = high - low;
      found = middle;
    }
  }
  return found;
}

// Marks both sides of an edge, or takes the mark away.
void mark(Mesh& mesh, const Topology& topology, std::uint32_t side, bool is_sharp = true) {
  mesh.sharp[side] = mesh.sharp[topology.side_twin[side]] = is_sharp;
}

// Marks the edges of the usual rule (creases.h).
class SharpEdges {
 public:
  // `turns`: turns_of.
  SharpEdges(Mesh& mesh, const Topology& topology, std::vector<double> turns)
      : mesh_(mesh), topology_(topology), turns_(std::move(turns)) {
    for (std::uint32_t side = 0; side < turns_.size(); ++side) {
      if (turns_[side] < 0) continue;
      turns_[topology.side_twin[side]] = turns_[side];
      if (turns_[side] > kSharpTurn * kDegree) mark(mesh, topology, side);
    }
  }

  void find() {
    change_marks([this] { return end_to_lengthen(); }, true);
    change_marks([this] { return end_to_take(); }, false);
    change_marks([this] { return corner_to_cut(); }, true);
  }

 private:
  static constexpr double kDegree = std::numbers::pi / 180;
  static constexpr double kGoesOn = 50 * kDegree, kVaries = 20 * kDegree;
  static constexpr double kStraight = -0.5;  // cosine between two edges of a chain, at most
  static constexpr double kFlat = 2 * kDegree;

  // Marks, or does not, the edge of find() at a vertex without a border, while there is one.
  template <class Find>
  void change_marks(Find find, bool is_sharp) {
    std::vector<std::uint32_t> vertices;
    for (std::uint32_t side = 0; side < mesh_.sharp.size(); ++side) {
      if (mesh_.sharp[side] != 0) vertices.push_back(mesh_.corner_vertex[side]);
    }
    while (!vertices.empty()) {
      const std::uint32_t vertex = vertices.back();
      const std::uint32_t side = find_fan(vertex) ? find() : kNone;
      if (side == kNone) {
        vertices.pop_back();
        continue;
      }
      mark(mesh_, topology_, side, is_sharp);
      vertices.push_back(mesh_.corner_vertex[topology_.side_twin[side]]);
    }
  }

  // Fills fan_ and marked_ with the sides that start at a vertex. False at a border.
  bool find_fan(std::uint32_t vertex) {
    fan_.clear(), marked_.clear();
    const std::uint32_t first = topology_.vertex_side[vertex];
    std::uint32_t side = first;
    do {
      if (topology_.side_twin[side] == kNone) return false;
      fan_.push_back(side);
      if (mesh_.sharp[side] != 0) marked_.push_back(side);
      side = next_around(mesh_, topology_, side);
    } while (side != first);
    return true;
  }

  // The side on which a chain that ends at the vertex goes on, or kNone.
  std::uint32_t end_to_lengthen() const {
    if (marked_.size() != 1) return kNone;
    double best = kStraight;
    std::uint32_t next = kNone;
    for (const std::uint32_t side : fan_) {
      if (mesh_.sharp[side] != 0 || !(turns_[side] > kGoesOn)) continue;
      const double way = cosine(marked_.front(), side);
      if (way < best) best = way, next = side;
    }
    return next;
  }

  // The side of a chain that ends at the vertex, or that goes on there and turns by much less than
  // the one before, or kNone.
  std::uint32_t end_to_take() const {
    if (marked_.size() == 1) return marked_.front();
    if (marked_.size() != 2 || !(cosine(marked_[0], marked_[1]) < kStraight)) return kNone;
    const double first = turns_[marked_[0]], second = turns_[marked_[1]];
    if (!(std::abs(first - second) > kVaries)) return kNone;
    return marked_[first < second ? 0 : 1];
  }

  double cosine(std::uint32_t a, std::uint32_t b) const {
    const Vec3 m = edge_of(mesh_, topology_, a).stableNormalized();
    return m.dot(edge_of(mesh_, topology_, b).stableNormalized());
  }
  // The sharper of two sides.
  std::uint32_t sharper(std::uint32_t a, std::uint32_t b) const {
    return a == kNone || turns_[b] > turns_[a] ? b : a;
  }

  // The side at the vertex that cuts a sector whose two creases form an angle: its normal would be
  // at right angles to both, and so the faces of a frustum would touch its end at each corner. Or
  // the side on which a chain goes on that ends at the corner of a solid, all of whose edges turn
  // much. Or kNone.
  std::uint32_t corner_to_cut() const {
    std::uint32_t best = kNone;
    if (marked_.size() == 1) {
      for (const std::uint32_t side : fan_) {
        if (side == marked_.front()) continue;
        if (!(turns_[side] > kGoesOn)) return kNone;
        best = sharper(best, side);
      }
      return best;
    }
    if (marked_.size() == 2 && cosine(marked_[0], marked_[1]) < kStraight) return kNone;
    for (std::size_t i = 0; i < marked_.size(); ++i) {
      const std::uint32_t end = marked_[(i + 1) % marked_.size()];
      if (cosine(marked_[i], end) < kStraight) continue;
      best = kNone;
      for (std::uint32_t side = next_around(mesh_, topology_, marked_[i]); side != end;
           side = next_around(mesh_, topology_, side))
        best = sharper(best, side);
      if (best != kNone && turns_[best] > kFlat) return best;
    }
    return kNone;
  }

  Mesh& mesh_;
  const Topology& topology_;
  std::vector<double> turns_;  // rad, [side]; negative at borders
  std::vector<std::uint32_t> fan_, marked_;
};

}  // namespace

CreaseRules parse_creases(std::string_view text) {
  constexpr std::string_view kEdges = "edges:";
  if (text == "none") return {.none = true};
  CreaseRules rules;
  while (true) {
    const std::size_t comma = text.find(',');
    const std::string_view word = text.substr(0, comma);
    if (word == "auto") {
      rules.plain = true;
    } else if (word == "normals") {
      rules.normals = true;
    } else if (word == "groups") {
      rules.groups = true;
    } else if (word.starts_with(kEdges) && word.size() > kEdges.size()) {
      rules.edges = word.substr(kEdges.size());
    } else if (word == "none") {
      throw UnitError("creases: 'none' stands alone");
    } else {
      if (word.find_first_of("0123456789") == std::string_view::npos)
        throw UnitError(detail::message("creases: '", word,
                                        "' is not one of an angle, such as 40deg, ",
                                        "auto, normals, groups, edges:FILE and none"));
      const double angle = parse_angle(word);
      if (!(angle >= 0 && angle < std::numbers::pi))
        throw UnitError(detail::message(
            "creases: '", word, "' is not from 0 to below 180deg; a bare number is radians"));
      rules.angle = angle;
    }
    if (comma == std::string_view::npos) return rules;
    text.remove_prefix(comma + 1);
  }
}

std::uint32_t find_inner_edge(const Mesh& mesh, const Topology& topology,
                              const VertexPair& vertices) {
  const auto [a, b] = vertices;
  const std::uint32_t first = a < topology.vertex_side.size() ? topology.vertex_side[a] : kNone;
  for (std::uint32_t side = first; side != kNone;) {
    if (mesh.corner_vertex[next_side(mesh, topology, side)] == b)
      return topology.side_twin[side] == kNone ? kNone : side;
    side = next_around(mesh, topology, side);
    if (side == first) break;
  }
  return kNone;
}

std::optional<double> plain_crease_angle(const Mesh& mesh, const Topology& topology) {
  return separating_angle(mesh, topology, turns_of(mesh, topology));
}

void mark_creases(Mesh& mesh, const Topology& topology, const CreaseRules& rules,
                  std::span<const std::uint32_t> sides) {
  const PlainArithmetic plain;
  if (rules.normals && mesh.normals.empty())
    throw MeshError(mesh.source + ": creases by normals, but the mesh has no normals");
  if (rules.groups && mesh.face_group.empty())
    throw MeshError(mesh.source + ": creases by groups, but the mesh names no smoothing groups");
  mesh.sharp.clear();
  mesh.tangents.clear();
  if (rules.none) return;
  mesh.sharp.assign(mesh.corner_vertex.size(), 0);
  const bool is_usual = rules.are_usual() && sides.empty();
  const bool by_normals = rules.normals || (is_usual && !mesh.normals.empty());
  const double none = std::numbers::pi;  // no edge turns by more
  double least = rules.angle.value_or(none);
  std::vector<double> turns;
  if (rules.angle || rules.plain) turns = turns_of(mesh, topology);
  if (is_usual && !by_normals) SharpEdges(mesh, topology, turns_of(mesh, topology)).find();
  if (rules.plain) least = std::min(least, separating_angle(mesh, topology, turns).value_or(none));
  for (std::uint32_t side = 0; side < topology.side_twin.size(); ++side) {
    const std::uint32_t twin = topology.side_twin[side];
    if (twin == kNone || twin < side) continue;
    const auto differ = [&] {
      return normals_differ(mesh, side, next_side(mesh, topology, twin)) ||
             normals_differ(mesh, next_side(mesh, topology, side), twin);
    };
    const auto apart = [&] {
      const std::uint32_t a = mesh.face_group[topology.side_face[side]],
                          b = mesh.face_group[topology.side_face[twin]];
      return a != b || a == 0;
    };
    if ((!turns.empty() && turns[side] > least) || (by_normals && differ()) ||
        (rules.groups && apart()))
      mark(mesh, topology, side);
  }
  for (const std::uint32_t side : sides) mark(mesh, topology, side);
  if (std::find(mesh.sharp.begin(), mesh.sharp.end(), 1) == mesh.sharp.end()) mesh.sharp.clear();
}

std::vector<VertexPair> crease_edges(const Mesh& mesh, const Topology& topology) {
  std::vector<VertexPair> edges;
  for (std::uint32_t side = 0; side < mesh.sharp.size(); ++side) {
    if (mesh.sharp[side] == 0 || topology.side_twin[side] < side) continue;
    const std::uint32_t a = mesh.corner_vertex[side],
                        b = mesh.corner_vertex[next_side(mesh, topology, side)];
    edges.push_back({std::min(a, b), std::max(a, b)});
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

SharpCorners sharp_corners(const Mesh& mesh, const Topology& topology, NormalWeights weights,
                           const ParallelFor& parallel) {
  return Sharpener(mesh, topology, weights, parallel).find();
}

}  // namespace gliss
