// Parts that intersect or touch, and parts within others: contact takes closed ones as a union.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <unordered_set>

#include "gliss/build/hierarchy.h"
#include "gliss/build/overlaps.h"
#include "gliss/mesh/mesh_edges.h"
#include "gliss/mesh/solid_angle.h"
#include "gliss/mesh/topology.h"
#include "gliss/mesh/triangulate.h"
#include "gliss/validate/validate_steps.h"

namespace gliss {
namespace {

using Triangle = std::array<Vec3, 3>;

// On which side of the plane of a, b, c a point lies: 0 where rounding could decide.
int side_of(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x) {
  const Vec3 u = a - x, v = b - x, w = c - x;
  const double volume = u.dot(v.cross(w));
  const double most = u.cwiseAbs().dot(Vec3(std::abs(v.y() * w.z()) + std::abs(v.z() * w.y()),
                                            std::abs(v.z() * w.x()) + std::abs(v.x() * w.z()),
                                            std::abs(v.x() * w.y()) + std::abs(v.y() * w.x())));
  return std::abs(volume) <= 1e-14 * most ? 0 : volume > 0 ? 1 : -1;
}

// True if a segment that does not lie in the triangle's plane meets it.
bool pierces(const Vec3& from, const Vec3& to, const Triangle& t) {
  const int begin = side_of(t[0], t[1], t[2], from), end = side_of(t[0], t[1], t[2], to);
  if (begin == end || begin * end > 0) return false;
  int sum = 0, sides = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const int side = side_of(from, t[k], t[(k + 1) % 3], to);
    sum += side;
    sides += side != 0;
  }
  return std::abs(sum) == sides;
}

bool meet(const Triangle& a, const Triangle& b) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (pierces(a[k], a[(k + 1) % 3], b) || pierces(b[k], b[(k + 1) % 3], a)) return true;
  }
  return false;
}

class PartPairs {
 public:
  PartPairs(const Mesh& mesh, Report& report) : mesh_(mesh), report_(report) {}

  void warn() {
    if (!number_parts()) return;
    find_boxes();
    warn_of_intersections();
    if (met_.size() < kMostPairs) warn_of_insides();
  }

 private:
  // False where there is nothing to compare.
  bool number_parts() {
    const std::vector<std::uint32_t> side_face = side_faces(mesh_),
                                     other = pair_sides(mesh_, side_face);
    DisjointSets sets(mesh_.face_count());
    for (std::uint32_t side = 0; side < other.size(); ++side) {
      if (other[side] != kNone) sets.unite(side_face[side], side_face[other[side]]);
    }
    part_.resize(mesh_.face_count());
    for (std::uint32_t face = 0; face < part_.size(); ++face) {
      const std::uint32_t first = sets.find(face);
      if (first == face) {
        part_[face] = static_cast<std::uint32_t>(first_face_.size());
        first_face_.push_back(face);
      } else {
        part_[face] = part_[first];
      }
    }
    closed_.assign(first_face_.size(), 1);
    for (std::uint32_t side = 0; side < other.size(); ++side) {
      if (other[side] == kNone) closed_[part_[side_face[side]]] = 0;
    }
    return first_face_.size() > 1 && std::find(closed_.begin(), closed_.end(), 1) != closed_.end();
  }

  void find_boxes() {
    for (std::uint32_t face = 0; face < part_.size(); ++face) {
      report_.poll();
      Box box{corner(mesh_.face_begin[face]), corner(mesh_.face_begin[face])};
      for (std::uint32_t c = mesh_.face_begin[face]; c < mesh_.face_begin[face + 1]; ++c) {
        box.low = box.low.cwiseMin(corner(c));
        box.high = box.high.cwiseMax(corner(c));
      }
      boxes_.push_back(box);
    }
    for (const std::uint32_t face : first_face_) part_boxes_.push_back(boxes_[face]);
    for (std::uint32_t face = 0; face < part_.size(); ++face) {
      Box& box = part_boxes_[part_[face]];
      box.low = box.low.cwiseMin(boxes_[face].low);
      box.high = box.high.cwiseMax(boxes_[face].high);
    }
  }
  const Vec3& corner(std::uint32_t c) const { return mesh_.positions[mesh_.corner_vertex[c]]; }

  template <class Visit>
  void for_triangles(std::uint32_t face, Visit visit) const {
    std::vector<Vec3> corners;
    for (std::uint32_t c = mesh_.face_begin[face]; c < mesh_.face_begin[face + 1]; ++c)
      corners.push_back(corner(c));
    std::vector<std::uint32_t> triangles;
    triangulate(corners, newell_normal(mesh_, face), triangles);
    for (std::size_t t = 0; t < triangles.size(); t += 3)
      visit(Triangle{corners[triangles[t]], corners[triangles[t + 1]], corners[triangles[t + 2]]});
  }

  static std::uint64_t key(std::uint32_t a, std::uint32_t b) {
    return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
  }

  void warn_of_intersections() {
    LargeArray<double> node;
    LargeArray<std::uint32_t> child;
    build_hierarchy(boxes_, node, child, serial_for);
    std::uint32_t face = kNone, other = kNone;  // of the pair that is named
    Overlaps<double>(node, child, part_)
        .for_each(
            [&](std::uint32_t a, std::uint32_t b) {
              report_.poll();
              return (!closed_[a] && !closed_[b]) || met_.contains(key(a, b));
            },
            [&](std::uint32_t a, std::uint32_t b) {
              report_.poll();
              if (!faces_meet(a, b)) return true;
              met_.insert(key(part_[a], part_[b]));
              if (std::min(a, b) < face) {
                face = std::min(a, b);
                other = std::max(a, b);
              }
              return met_.size() < kMostPairs;
            });
    if (met_.empty()) return;
    report_
        .add(Severity::kWarning, "parts-intersect", {.face = face},
             "meets face {} of another part ({} pairs of parts{})", report_.number_of(other),
             met_.size(), met_.size() < kMostPairs ? "" : " or more; no others are looked for")
        .count = met_.size();
  }
  bool faces_meet(std::uint32_t a, std::uint32_t b) const {
    bool found = false;
    for_triangles(a, [&](const Triangle& s) {
      for_triangles(b, [&](const Triangle& t) { found = found || meet(s, t); });
    });
    return found;
  }

  void warn_of_insides() {
    std::vector<std::vector<std::uint32_t>> faces(first_face_.size());
    for (std::uint32_t face = 0; face < part_.size(); ++face) faces[part_[face]].push_back(face);
    LargeArray<double> node;
    LargeArray<std::uint32_t> child;
    build_hierarchy(part_boxes_, node, child, serial_for);
    const std::vector<std::uint32_t> all_alike(part_boxes_.size(), 0);
    const Overlaps<double> around(node, child, all_alike);
    std::size_t inside = 0;
    std::uint32_t first = kNone, outer = kNone;
    for (std::uint32_t part = 0; part < first_face_.size(); ++part) {
      const Vec3& x = corner(mesh_.face_begin[first_face_[part]]);
      bool is_inside = false;
      around.for_each_at(x, [&](std::uint32_t other) {
        if (is_inside || other == part || !closed_[other] || met_.contains(key(part, other)))
          return;
        if (!winds_round(faces[other], x)) return;
        is_inside = true;
        if (inside++ > 0) return;
        first = first_face_[part];
        outer = first_face_[other];
      });
    }
    if (inside == 0) return;
    report_
        .add(Severity::kWarning, "part-inside-part", {.face = first},
             "belongs to a part that lies within that of face {} ({} parts)",
             report_.number_of(outer), inside)
        .count = inside;
  }
  bool winds_round(const std::vector<std::uint32_t>& faces, const Vec3& x) const {
    double angle = 0;
    for (const std::uint32_t face : faces) {
      report_.poll();
      for_triangles(face,
                    [&](const Triangle& t) { angle += solid_angle(t[0] - x, t[1] - x, t[2] - x); });
    }
    return std::abs(angle) > 2 * std::numbers::pi;
  }

  static constexpr std::size_t kMostPairs = 100'000;  // that are looked for

  const Mesh& mesh_;
  Report& report_;
  std::vector<std::uint32_t> part_;        // [face]
  std::vector<std::uint32_t> first_face_;  // [part]
  std::vector<char> closed_;               // [part]
  std::vector<Box> boxes_, part_boxes_;    // [face], [part]
  std::unordered_set<std::uint64_t> met_;  // pairs of parts
};

}  // namespace

void warn_of_parts(const Mesh& mesh, Report& report) { PartPairs(mesh, report).warn(); }

}  // namespace gliss
