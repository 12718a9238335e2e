#include "gliss/surface/winding.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "gliss/mesh/solid_angle.h"
#include "gliss/surface/surface_parts.h"

namespace gliss {

namespace {

// How far the own polygon of a piece round a centre is from its face's at most, mesh frame: where
// both cover the same ground, as seen along the face's normal, by how far their corners lie apart
// along it. Else the piece's width.
template <class Real>
double width_of(const Surface<Real>& s, std::uint32_t patch) {
  const std::uint32_t* piece = piece_of(s, patch);
  if (piece == nullptr) return 0;
  const std::uint32_t own = s.side_begin[patch], first = piece[1];
  const Vec3 centre = start_of(s, own + 2);
  std::vector<Vec3> areas;  // of the face's pieces: twice the area long
  for (std::uint32_t p = s.side_patch[first]; p < s.patch_count(); ++p) {
    const std::uint32_t* other = piece_of(s, p);
    if (other == nullptr || other[1] != first) break;
    const std::uint32_t side = s.side_begin[p];
    areas.push_back((start_of(s, side) - centre).cross(start_of(s, side + 1) - centre));
  }
  Vec3 normal = Vec3::Zero();
  for (const Vec3& area : areas) normal += area;
  normal.stableNormalize();
  double low = 0, high = 0;
  bool covers = true;
  for (std::uint32_t k = 0; k < areas.size(); ++k) {
    const double height = normal.dot(start_of(s, first + 3 * k) - centre);
    low = std::min(low, height), high = std::max(high, height);
    covers = covers && areas[k].dot(normal) > 0;
  }
  if (covers) return high - low;
  return (centre - 0.5 * (start_of(s, own) + start_of(s, own + 1))).norm();
}

double double_area(const BaseTriangle& t) { return (t[1] - t[0]).cross(t[2] - t[0]).norm(); }

struct Hole {
  std::uint32_t part;
  std::vector<BaseTriangle> cone;
};

// Goes round the rim of a hole from a side on; empty where the side has a twin, or was seen.
template <class Real>
std::vector<Vec3> rim_from(const Surface<Real>& s, std::uint32_t side, std::vector<char>& seen) {
  std::vector<Vec3> rim;
  while (s.side_twin[side] == kNone && !std::exchange(seen[side], 1)) {
    rim.push_back(start_of(s, side));
    for (side = next_side(s, side); s.side_twin[side] != kNone;)
      side = next_side(s, s.side_twin[side]);
  }
  return rim;
}

// The triangles from a rim to its middle, which face as the surface around does.
std::vector<BaseTriangle> cone_over(const std::vector<Vec3>& rim) {
  const Vec3 middle =
      std::accumulate(rim.begin(), rim.end(), Vec3(Vec3::Zero())) / static_cast<double>(rim.size());
  std::vector<BaseTriangle> cone;
  for (std::size_t i = 0; i < rim.size(); ++i)
    cone.push_back({rim[(i + 1) % rim.size()], rim[i], middle});
  return cone;
}

}  // namespace

template <class Real>
WindingTree::WindingTree(const Surface<Real>& s) {
  close_holes(s);
  if (!counts_any()) return;
  const std::uint32_t patches = s.patch_count(), nodes = patches - 1;
  children_.resize(2 * std::size_t{nodes} + 1);
  gather(s, nodes == 0 ? kNodeLeaf : 0, children_.size() - 1);
  double volume = 0;
  for (const BaseTriangle& t : triangles_) volume += t[0].dot(t[1].cross(t[2]));
  is_room_ = volume < 0;
}

template <class Real>
void WindingTree::close_holes(const Surface<Real>& s) {
  constexpr double kSmall = 0.05;           // of a part's area
  constexpr std::size_t kMostSides = 1024;  // round the holes of a part: each HIP asks them all
  const auto sides = static_cast<std::uint32_t>(s.side_twin.size());
  if (std::find(s.side_twin.begin(), s.side_twin.end(), kNone) == s.side_twin.end()) return;
  DisjointSets parts = parts_of(s);
  std::vector<double> area(s.patch_count(), 0), holes_area(s.patch_count(), 0);  // [part], twice
  std::vector<std::size_t> rim_sides(s.patch_count(), 0);                        // [part]
  for (std::uint32_t p = 0; p < s.patch_count(); ++p) {
    for_polygon_triangles(s, p,
                          [&](const BaseTriangle& t) { area[parts.find(p)] += double_area(t); });
  }
  std::vector<Hole> holes;
  std::vector<char> seen(sides, 0);
  for (std::uint32_t first = 0; first < sides; ++first) {
    const std::vector<Vec3> rim = rim_from(s, first, seen);
    if (rim.empty()) continue;
    const Hole& hole = holes.emplace_back(Hole{parts.find(s.side_patch[first]), cone_over(rim)});
    for (const BaseTriangle& t : hole.cone) holes_area[hole.part] += double_area(t);
    rim_sides[hole.part] += rim.size();
  }
  counted_.resize(s.patch_count());
  for (std::uint32_t p = 0; p < s.patch_count(); ++p) {
    const std::uint32_t part = parts.find(p);
    counted_[p] = holes_area[part] < kSmall * area[part] && rim_sides[part] <= kMostSides;
  }
  for (const Hole& hole : holes) {
    if (!counted_[hole.part]) continue;
    Child c;
    c.begin = static_cast<std::uint32_t>(triangles_.size());
    triangles_.insert(triangles_.end(), hole.cone.begin(), hole.cone.end());
    take(c);
    holes_.push_back(c);
  }
}

// `named`: a node, or with kNodeLeaf a patch. The tree is no deeper than its hierarchy.
template <class Real>
void WindingTree::gather(const Surface<Real>& s, std::uint32_t named, std::size_t child) {
  Child c;
  c.begin = static_cast<std::uint32_t>(triangles_.size());
  c.is_leaf = (named & kNodeLeaf) != 0;
  if (c.is_leaf) {
    const std::uint32_t patch = named & ~kNodeLeaf;
    const Real* numbers = &s.patch[patch * kPatchReals];
    const double sag = static_cast<double>(numbers[kPatchSag] * numbers[kPatchUnscale]);
    const double width = width_of(s, patch);
    c.departure = std::max(sag, width);
    departure_ = std::max(departure_, sag + width);
    const std::uint32_t first = s.side_begin[patch], n = s.valence(patch);
    const Vec3 start = start_of(s, first);
    for (std::uint32_t k = 1; k + 1 < n; ++k)
      c.axis += (start_of(s, first + k) - start).cross(start_of(s, first + k + 1) - start);
    c.axis.stableNormalize();
    c.low = c.high = c.axis.dot(start);
    for (std::uint32_t k = 0; k < n; ++k) {
      const Vec3 corner = start_of(s, first + k);
      c.box.extend(corner);
      c.low = std::min(c.low, c.axis.dot(corner));
      c.high = std::max(c.high, c.axis.dot(corner));
    }
    if (counts(patch))
      for_polygon_triangles(s, patch, [&](const BaseTriangle& t) { triangles_.push_back(t); });
  } else {
    c.node = named;
    for (std::size_t k = 0; k < 2; ++k) {
      const std::size_t below = 2 * std::size_t{named} + k;
      gather(s, s.child[below], below);
      c.box.extend(children_[below].box);
      c.departure = std::max(c.departure, children_[below].departure);
    }
  }
  take(c);
  children_[child] = c;
}

void WindingTree::take(Child& c) {
  c.end = static_cast<std::uint32_t>(triangles_.size());
  for (std::uint32_t i = c.begin; i < c.end; ++i) {
    const BaseTriangle& t = triangles_[i];
    const Vec3 area = (t[1] - t[0]).cross(t[2] - t[0]);
    c.area += area;
    c.size += area.norm();
    c.middle += area.norm() / 3 * (t[0] + t[1] + t[2]);
  }
  if (c.size > 0)
    c.middle /= c.size;
  else if (c.begin < c.end)
    c.middle = triangles_[c.begin][0];
  for (std::uint32_t i = c.begin; i < c.end; ++i) {
    for (const Vec3& corner : triangles_[i])
      c.radius = std::max(c.radius, (corner - c.middle).norm());
  }
}

bool WindingTree::may_be_between(const Vec3& x, double distance) const {
  if (distance > departure_) return false;
  std::array<std::size_t, kHierarchyDepth + 2> open{children_.size() - 1};
  std::size_t left = 1;
  while (left > 0) {
    const Child& c = children_[open[--left]];
    if (c.box.exteriorDistance(x) > c.departure) continue;
    if (c.is_leaf) {
      const double height = c.axis.dot(x);
      if (height < c.low - c.departure || height > c.high + c.departure) continue;
      return true;
    }
    open[left++] = 2 * std::size_t{c.node};
    open[left++] = 2 * std::size_t{c.node} + 1;
  }
  return false;
}

std::optional<double> WindingTree::angle_of_dipole(const Child& c, const Vec3& x) {
  constexpr double kFar = 3;  // radii; then a dipole is off by a hundredth of its angle or so
  const Vec3 away = c.middle - x;
  const double distance = away.norm();
  if (!(distance > kFar * c.radius)) return {};
  return c.area.dot(away) / (2 * distance * distance * distance);
}

double WindingTree::angle_of_triangles(const Child& c, const Vec3& x) const {
  double angle = 0;
  for (std::uint32_t i = c.begin; i < c.end; ++i)
    angle += solid_angle(triangles_[i][0] - x, triangles_[i][1] - x, triangles_[i][2] - x);
  return angle;
}

double WindingTree::number_at(const Vec3& x) const {
  double angle = 0;
  for (const Child& hole : holes_) {
    const auto dipole = angle_of_dipole(hole, x);
    angle += dipole ? *dipole : angle_of_triangles(hole, x);
  }
  std::array<std::size_t, kHierarchyDepth + 2> open{children_.size() - 1};
  std::size_t left = 1;
  while (left > 0) {
    const Child& c = children_[open[--left]];
    if (const auto dipole = angle_of_dipole(c, x)) {
      angle += *dipole;
    } else if (c.is_leaf) {
      angle += angle_of_triangles(c, x);
    } else {
      open[left++] = 2 * std::size_t{c.node};
      open[left++] = 2 * std::size_t{c.node} + 1;
    }
  }
  return angle / (4 * std::numbers::pi);
}

template WindingTree::WindingTree(const Surface<float>&);
template WindingTree::WindingTree(const Surface<double>&);

}  // namespace gliss
