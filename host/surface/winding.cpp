#include "gliss/surface/winding.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "gliss/mesh/solid_angle.h"

namespace gliss {

namespace {

// The width of a patch's own polygon where it is a piece round a centre: so far that is from the
// face's polygon at most. Mesh frame.
template <class Real>
double width_of(const Surface<Real>& s, std::uint32_t patch) {
  if (piece_of(s, patch) == nullptr) return 0;
  const std::uint32_t side = s.side_begin[patch];
  return (start_of(s, side + 2) - 0.5 * (start_of(s, side) + start_of(s, side + 1))).norm();
}

}  // namespace

template <class Real>
WindingTree::WindingTree(const Surface<Real>& s) {
  const std::uint32_t patches = s.patch_count(), nodes = patches - 1;
  children_.resize(2 * std::size_t{nodes} + 1);
  gather(s, nodes == 0 ? kNodeLeaf : 0, children_.size() - 1);
  double volume = 0;
  for (const BaseTriangle& t : triangles_) volume += t[0].dot(t[1].cross(t[2]));
  is_room_ = volume < 0;
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
    c.departure = std::max(sag, width_of(s, patch));
    departure_ = std::max(departure_, sag + width_of(s, patch));
    for (std::uint32_t k = 0; k < s.valence(patch); ++k)
      c.box.extend(start_of(s, s.side_begin[patch] + k));
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
  c.end = static_cast<std::uint32_t>(triangles_.size());
  for (std::uint32_t i = c.begin; i < c.end; ++i) {
    const BaseTriangle& t = triangles_[i];
    const Vec3 area = (t[1] - t[0]).cross(t[2] - t[0]);
    c.area += area;
    c.size += area.norm();
    c.middle += area.norm() / 3 * (t[0] + t[1] + t[2]);
  }
  c.middle = c.size > 0 ? Vec3(c.middle / c.size) : triangles_[c.begin][0];
  for (std::uint32_t i = c.begin; i < c.end; ++i) {
    for (const Vec3& corner : triangles_[i])
      c.radius = std::max(c.radius, (corner - c.middle).norm());
  }
  children_[child] = c;
}

bool WindingTree::may_be_between(const Vec3& x, double distance) const {
  if (distance > departure_) return false;
  std::array<std::size_t, kHierarchyDepth + 2> open{children_.size() - 1};
  std::size_t left = 1;
  while (left > 0) {
    const Child& c = children_[open[--left]];
    if (c.box.exteriorDistance(x) > c.departure) continue;
    if (c.is_leaf) return true;
    open[left++] = 2 * std::size_t{c.node};
    open[left++] = 2 * std::size_t{c.node} + 1;
  }
  return false;
}

double WindingTree::number_at(const Vec3& x) const {
  constexpr double kFar = 3;  // radii; then a dipole is off by a hundredth of its angle or so
  double angle = 0;
  std::array<std::size_t, kHierarchyDepth + 2> open{children_.size() - 1};
  std::size_t left = 1;
  while (left > 0) {
    const Child& c = children_[open[--left]];
    const Vec3 away = c.middle - x;
    const double distance = away.norm();
    if (distance > kFar * c.radius) {
      angle += c.area.dot(away) / (2 * distance * distance * distance);
    } else if (!c.is_leaf) {
      open[left++] = 2 * std::size_t{c.node};
      open[left++] = 2 * std::size_t{c.node} + 1;
    } else {
      for (std::uint32_t i = c.begin; i < c.end; ++i)
        angle += solid_angle(triangles_[i][0] - x, triangles_[i][1] - x, triangles_[i][2] - x);
    }
  }
  return angle / (4 * std::numbers::pi);
}

template WindingTree::WindingTree(const Surface<float>&);
template WindingTree::WindingTree(const Surface<double>&);

}  // namespace gliss
