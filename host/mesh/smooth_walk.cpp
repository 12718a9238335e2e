#include "gliss/mesh/smooth_walk.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gliss/mesh/phong.h"
#include "gliss/mesh/triangulate.h"

namespace gliss {
namespace {

constexpr double kEnd = 1e-6;  // least share of a crease's edge between a place and a corner

}  // namespace

SmoothWalk::SmoothWalk(const Mesh& mesh, const Topology& topology, const Sectors& sectors)
    : mesh_(mesh),
      topology_(topology),
      sectors_(sectors),
      group_begin_(sectors.normals.size() + 1, 0) {
  std::vector<Vec3> corners;
  std::vector<std::uint32_t> cut;
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    corners.clear(), cut.clear();
    const std::uint32_t begin = mesh.face_begin[face];
    for (std::uint32_t c = begin; c < mesh.face_begin[face + 1]; ++c)
      corners.push_back(position(c));
    triangulate(corners, newell_normal(mesh, face), cut);
    for (std::size_t i = 0; i < cut.size(); i += 3)
      triangles_.push_back({begin + cut[i], begin + cut[i + 1], begin + cut[i + 2]});
  }
  for (const Triangle& t : triangles_)
    for (const std::uint32_t c : t) ++group_begin_[sectors.group[c] + 1];
  for (std::size_t g = 1; g < group_begin_.size(); ++g) group_begin_[g] += group_begin_[g - 1];
  group_triangle_.resize(3 * triangles_.size());
  std::vector<std::uint32_t> place(group_begin_.begin(), group_begin_.end() - 1);
  for (std::uint32_t t = 0; t < triangles_.size(); ++t)
    for (const std::uint32_t c : triangles_[t]) group_triangle_[place[sectors.group[c]]++] = t;
}

SmoothWalk::OnFace SmoothWalk::on_face(std::uint32_t group) const {
  const std::uint32_t triangle = group_triangle_[group_begin_[group]];
  for (const std::uint32_t c : triangles_[triangle])
    if (sectors_.group[c] == group) return {triangle, position(c), normal(c)};
  return {};
}

SmoothWalk::OnFace SmoothWalk::moved(const OnFace& from, const Vec3& to) const {
  std::uint32_t best = from.triangle;
  Shares shares = nearest_in(triangles_[best], to);
  double least = (at(triangles_[best], shares) - to).squaredNorm();
  for (bool goes_on = true; goes_on;) {
    goes_on = false;
    for (const std::uint32_t corner : Triangle(triangles_[best])) {
      const std::uint32_t group = sectors_.group[corner];
      for (std::uint32_t i = group_begin_[group]; i < group_begin_[group + 1]; ++i) {
        const Triangle& other = triangles_[group_triangle_[i]];
        const Shares found = nearest_in(other, to);
        const double squared = (at(other, found) - to).squaredNorm();
        if (!(squared < least)) continue;
        best = group_triangle_[i], least = squared, shares = found, goes_on = true;
      }
    }
  }
  return lifted(best, shares);
}

Vec3 SmoothWalk::at(const Triangle& t, const Shares& shares) const {
  return position(t[0]) + shares[1] * (position(t[1]) - position(t[0])) +
         shares[2] * (position(t[2]) - position(t[0]));
}

SmoothWalk::Shares SmoothWalk::nearest_in(const Triangle& t, const Vec3& to) const {
  const Vec3 p = position(t[1]) - position(t[0]), q = position(t[2]) - position(t[0]),
             way = to - position(t[0]), cross = p.cross(q);
  const double squared = cross.squaredNorm();
  if (squared > 0) {
    const double ahead = way.cross(q).dot(cross) / squared,
                 back = p.cross(way).dot(cross) / squared;
    if (ahead >= 0 && back >= 0 && ahead + back <= 1) return {1 - ahead - back, ahead, back};
  }
  Shares best{};
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t l = (k + 1) % 3;
    const Vec3 side = position(t[l]) - position(t[k]);
    const double length = side.squaredNorm();
    const double share =
        length > 0 ? std::clamp((to - position(t[k])).dot(side) / length, 0.0, 1.0) : 0;
    Shares shares{};
    shares[k] = 1 - share, shares[l] = share;
    const double off = (at(t, shares) - to).squaredNorm();
    if (off < least) least = off, best = shares;
  }
  return best;
}

SmoothWalk::OnFace SmoothWalk::lifted(std::uint32_t triangle, const Shares& shares) const {
  const Triangle& t = triangles_[triangle];
  OnFace on{triangle, at(t, shares), Vec3::Zero()};
  const Vec3 flat = on.position;
  for (std::size_t k = 0; k < 3; ++k) {
    on.position -= phong_step(flat - position(t[k]), normal(t[k]), shares[k]);
    on.normal += shares[k] * normal(t[k]);
  }
  on.normal = on.normal.stableNormalized();
  return on;
}

Vec3 SmoothWalk::tangent_at(std::uint32_t side) const {
  const Vec3& tau = sectors_.tau[side];
  return tau.isZero(0) ? edge_of(mesh_, topology_, side).stableNormalized() : tau;
}

SmoothWalk::OnCrease SmoothWalk::at(std::uint32_t side, double share) const {
  const std::uint32_t twin = topology_.side_twin[side];
  const Vec3 edge = edge_of(mesh_, topology_, side), start = tangent_at(side),
             end = -tangent_at(twin);
  const double t = share, r = 1 - t, length = arc_length(edge.norm(), start, end);
  const Vec3 along =
      (6 * r * t * edge + r * (1 - 3 * t) * length * start - t * (2 - 3 * t) * length * end)
          .stableNormalized();
  const auto between = [&](std::uint32_t a, std::uint32_t b) {
    return Vec3(across(along, normal(a) + t * (normal(b) - normal(a))).stableNormalized());
  };
  return {side,
          share,
          position(side) + t * t * (3 - 2 * t) * edge + r * t * length * (r * start - t * end),
          along,
          between(side, next(side)),
          between(next(twin), twin)};
}

SmoothWalk::OnCrease SmoothWalk::on_crease(std::uint32_t side) const { return at(side, 0); }

// The cut side that goes on from the end of one; kNone where none does, or several.
std::uint32_t SmoothWalk::side_after(std::uint32_t side) const {
  const std::uint32_t twin = topology_.side_twin[side];
  std::uint32_t found = kNone;
  for (std::uint32_t other = next_around(mesh_, topology_, twin); other != twin;
       other = next_around(mesh_, topology_, other)) {
    if (other == kNone) return kNone;
    if (sectors_.tau[other].isZero(0)) continue;
    if (found != kNone) return kNone;
    found = other;
  }
  return found;
}

SmoothWalk::OnCrease SmoothWalk::moved(const OnCrease& from, double by) const {
  const bool is_back = by < 0;
  std::uint32_t side = is_back ? topology_.side_twin[from.side] : from.side;
  double share = is_back ? 1 - from.share : from.share, left = std::abs(by);
  for (;;) {
    const double length = edge_of(mesh_, topology_, side).norm();
    if (left <= (1 - share) * length) {
      share += left / length;
      break;
    }
    const std::uint32_t after = side_after(side);
    if (after == kNone) {
      share = 1 - kEnd;
      break;
    }
    left -= (1 - share) * length;
    side = after, share = 0;
  }
  return is_back ? at(topology_.side_twin[side], 1 - share) : at(side, share);
}

}  // namespace gliss
