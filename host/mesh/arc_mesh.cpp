#include "gliss/mesh/arc_mesh.h"

#include <algorithm>
#include <utility>

#include "gliss/mesh/mesh_edges.h"
#include "gliss/mesh/sectors.h"

namespace gliss {
namespace {

constexpr double kLean = 1.0 / 64;  // of add_arc

}  // namespace

std::uint32_t ArcMesh::add_vertex(const Vec3& position, const Vec3& normal) {
  mesh.positions.push_back(position);
  mesh.normals.push_back(normal);
  return static_cast<std::uint32_t>(mesh.positions.size() - 1);
}

std::uint32_t ArcMesh::add_middle(std::uint32_t a, std::uint32_t b, const Vec3& first,
                                  const Vec3& last) {
  const Arc arc = arc_of(a, b, first, last);
  const Vec3 &p = mesh.positions[a], &q = mesh.positions[b];
  const Vec3 along = (6 * (q - p) - arc.start - arc.end).stableNormalized();
  const Vec3 at = 0.5 * (p + q) + 0.125 * (arc.start - arc.end),
             turned = across(along, mesh.normals[a] + mesh.normals[b]);
  const std::uint32_t middle = add_vertex(at, turned.stableNormalized());
  add_arc(a, middle, arc.start, along);
  add_arc(middle, b, along, arc.end);
  return middle;
}

// Its normal is blended from those of the ring (Coons). Between two points q and c of an arc
// (c - q).(n_q + n_c) = 0: so it is on a sphere between any two, and on a torus across and along it
// from the middles of the ring. The centre has the least squares of it.
std::uint32_t ArcMesh::add_centre(std::span<const std::uint32_t> ring) {
  Vec3 at = Vec3::Zero(), turned = Vec3::Zero();
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const double share = (i % 2 == 0 ? -2.0 : 4.0) / static_cast<double>(ring.size());
    at += share * mesh.positions[ring[i]];
    turned += share * mesh.normals[ring[i]];
  }
  turned = turned.stableNormalized();
  constexpr double kLoose = 1e-4;  // share of the blend of positions, where arcs leave it open
  Eigen::Matrix3d sum = kLoose * static_cast<double>(ring.size()) * Eigen::Matrix3d::Identity();
  Vec3 right = Vec3::Zero();
  for (std::size_t i = 1; i < ring.size(); i += 2) {
    const Vec3 m = 0.5 * (mesh.normals[ring[i]] + turned);
    sum += m * m.transpose();
    right += m * m.dot(mesh.positions[ring[i]] - at);
  }
  return add_vertex(at + sum.ldlt().solve(right), turned);
}

ArcMesh::Arc ArcMesh::arc_of(std::uint32_t a, std::uint32_t b, const Vec3& first,
                             const Vec3& last) const {
  const Vec3 edge = mesh.positions[b] - mesh.positions[a];
  const Vec3 &n = mesh.normals[a], &m = mesh.normals[b];
  const auto direction = [&](const Vec3& wanted, const Vec3& normal) {
    const Vec3 own = tangent_along(edge, normal, n + m);
    if (wanted.isZero(0)) return own;
    return Vec3((across(normal, wanted).stableNormalized() + kLean * own).stableNormalized());
  };
  const Vec3 start = direction(first, n), end = direction(last, m);
  const double length = arc_length(edge.norm(), start, end);
  return {{a, b}, length * start, length * end};
}

void ArcMesh::add_arc(std::uint32_t a, std::uint32_t b, const Vec3& first, const Vec3& last) {
  const Arc arc = arc_of(a, b, first, last);
  arcs_.push_back(arc);
  arcs_.push_back({{b, a}, -arc.end, -arc.start});
}

void ArcMesh::add_face(std::span<const std::uint32_t> vertices, std::uint32_t line) {
  mesh.corner_vertex.insert(mesh.corner_vertex.end(), vertices.begin(), vertices.end());
  mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corner_vertex.size()));
  if (line != 0) mesh.face_line.push_back(line);
}

Mesh ArcMesh::finish() {
  const auto is_before = [](const Arc& a, const std::array<std::uint32_t, 2>& ends) {
    return a.ends < ends;
  };
  std::sort(arcs_.begin(), arcs_.end(),
            [&](const Arc& a, const Arc& b) { return is_before(a, b.ends); });
  mesh.corner_normal = mesh.corner_vertex;
  mesh.tangents.assign(2 * mesh.corner_vertex.size(), Vec3::Zero());
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    for (std::uint32_t s = mesh.face_begin[face]; s < mesh.face_begin[face + 1]; ++s) {
      const std::array ends{mesh.corner_vertex[s], mesh.corner_vertex[next_corner(mesh, face, s)]};
      const auto arc = std::lower_bound(arcs_.begin(), arcs_.end(), ends, is_before);
      if (arc == arcs_.end() || arc->ends != ends) continue;
      mesh.tangents[2 * s] = arc->start;
      mesh.tangents[2 * s + 1] = arc->end;
    }
  }
  return std::move(mesh);
}

}  // namespace gliss
