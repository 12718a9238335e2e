#include "gliss/mesh/topology.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "gliss/base/plain_arithmetic.h"
#include "gliss/mesh/creases.h"
#include "gliss/mesh/fitted_normals.h"
#include "gliss/mesh/mesh_edges.h"

namespace gliss {
namespace {

// Interior angle of a corner, beyond pi where the corner is reflex. atan2 is good for any size and
// for the flattest and the sharpest of angles, where acos is not.
double corner_angle(const Mesh& mesh, std::uint32_t face, std::uint32_t corner,
                    const Vec3& face_normal) {
  const auto position = [&](std::uint32_t c) -> const Vec3& {
    return mesh.positions[mesh.corner_vertex[c]];
  };
  const Vec3 ahead = position(next_corner(mesh, face, corner)) - position(corner);
  const Vec3 back = position(prev_corner(mesh, face, corner)) - position(corner);
  const Vec3 cross = ahead.cross(back);
  const double angle = std::atan2(cross.norm(), ahead.dot(back));
  return cross.dot(face_normal) < 0 ? 2 * std::numbers::pi - angle : angle;
}

std::uint32_t count_parts(const Topology& topology, std::size_t face_count) {
  DisjointSets parts(face_count);
  auto count = static_cast<std::uint32_t>(face_count);
  for (std::uint32_t side = 0; side < topology.side_twin.size(); ++side) {
    const std::uint32_t twin = topology.side_twin[side];
    if (twin != kNone && twin > side &&
        parts.unite(topology.side_face[side], topology.side_face[twin])) {
      --count;
    }
  }
  return count;
}

}  // namespace

std::uint32_t next_side(const Mesh& mesh, const Topology& topology, std::uint32_t side) {
  return next_corner(mesh, topology.side_face[side], side);
}

std::uint32_t prev_side(const Mesh& mesh, const Topology& topology, std::uint32_t side) {
  return prev_corner(mesh, topology.side_face[side], side);
}

std::uint32_t next_around(const Mesh& mesh, const Topology& topology, std::uint32_t side) {
  return topology.side_twin[prev_side(mesh, topology, side)];
}

Topology build_topology(const Mesh& mesh) {
  Topology topology;
  topology.side_face = side_faces(mesh);
  topology.side_twin = pair_sides(mesh, topology.side_face);
  topology.vertex_side.assign(mesh.positions.size(), kNone);
  for (std::uint32_t side = 0; side < topology.side_twin.size(); ++side) {
    const std::uint32_t twin = topology.side_twin[side];
    std::uint32_t& first = topology.vertex_side[mesh.corner_vertex[side]];
    assert(twin == kNone || mesh.corner_vertex[twin] != mesh.corner_vertex[side]);
    // On an open fan the side with nothing to its right is where going left starts.
    if (twin == kNone || first == kNone) first = side;
    if (twin == kNone) ++topology.border_side_count;
  }
  topology.part_count = count_parts(topology, mesh.face_count());
  return topology;
}

namespace {

template <class At>
Vec3 newell_of(std::size_t corners, const At& at) {
  // Crossing from the first corner keeps the digits of a small face far from the origin.
  const Vec3& origin = at(0);
  Vec3 normal = Vec3::Zero();
  Vec3 last = at(1) - origin;
  for (std::size_t i = 2; i < corners; ++i) {
    const Vec3 here = at(i) - origin;
    normal += last.cross(here);
    last = here;
  }
  return normal;
}

}  // namespace

Vec3 newell_normal(const Mesh& mesh, std::size_t face) {
  const std::uint32_t* corners = &mesh.corner_vertex[mesh.face_begin[face]];
  return newell_of(mesh.valence(face),
                   [&](std::size_t i) -> const Vec3& { return mesh.positions[corners[i]]; });
}

Vec3 newell_normal(std::span<const Vec3> corners) {
  return newell_of(corners.size(), [&](std::size_t i) -> const Vec3& { return corners[i]; });
}

namespace {

// [corner], which of `count` normals it takes part in.
using Groups = std::span<const std::uint32_t>;

std::vector<Vec3> angle_normals(const Mesh& mesh, Groups group, std::size_t count) {
  constexpr double kVanishing = 1e-9;  // of the sum of angles
  std::vector<Vec3> normals(count, Vec3::Zero());
  std::vector<double> angles(count, 0);
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    const Vec3 normal = newell_normal(mesh, face).stableNormalized();
    for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c) {
      const double angle = corner_angle(mesh, face, c, normal);
      normals[group[c]] += angle * normal;
      angles[group[c]] += angle;
    }
  }

  std::vector<std::uint32_t> vanished;
  for (std::uint32_t v = 0; v < normals.size(); ++v) {
    const double length = normals[v].norm();
    if (length > kVanishing * angles[v]) {
      normals[v] /= length;
    } else {
      normals[v] = Vec3::Zero();
      vanished.push_back(v);
    }
  }
  if (vanished.empty()) return normals;

  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    const Vec3 normal = newell_normal(mesh, face);
    for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c) {
      const std::uint32_t v = group[c];
      const bool empty = std::binary_search(vanished.begin(), vanished.end(), v);
      if (empty && normal.squaredNorm() > normals[v].squaredNorm()) normals[v] = normal;
    }
  }
  for (const std::uint32_t v : vanished) {
    normals[v] = normals[v].isZero(0) ? Vec3::UnitZ() : normals[v].stableNormalized();
  }
  return normals;
}

// Calls f(group, ahead, back) for every corner, with its edges away from the vertex.
template <class F>
void for_corners(const Mesh& mesh, Groups group, F f) {
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c) {
      const Vec3& at = mesh.positions[mesh.corner_vertex[c]];
      f(group[c], Vec3(mesh.positions[mesh.corner_vertex[next_corner(mesh, face, c)]] - at),
        Vec3(mesh.positions[mesh.corner_vertex[prev_corner(mesh, face, c)]] - at));
    }
  }
}

// The sums of e_1 x e_2 / (|e_1|^2 |e_2|^2) over the corners of a group, unit length (Max 1999).
std::vector<Vec3> max_normals(const Mesh& mesh, Groups group, std::size_t count) {
  std::vector<Vec3> normals(count, Vec3::Zero());
  for_corners(mesh, group, [&](std::uint32_t g, const Vec3& ahead, const Vec3& back) {
    const Vec3 normal =
        ahead.stableNormalized().cross(back.stableNormalized()) / (ahead.norm() * back.norm());
    if (normal.allFinite()) normals[g] += normal;
  });
  for (Vec3& n : normals) n = n.stableNormalized();
  return normals;
}

// Turns Max's normals to those of polynomials through the vertices around. Returns how far each
// fit was believed, 0 to 1.
std::vector<double> turn_to_fits(const Mesh& mesh, Groups group,
                                 std::span<const FittedNormal> fitted, std::vector<Vec3>& normals) {
  std::vector<double> spread(normals.size(), 0);  // of a group's corners
  for_corners(mesh, group, [&](std::uint32_t g, const Vec3& ahead, const Vec3& back) {
    spread[g] = std::max(spread[g], (ahead.cross(back).stableNormalized() - normals[g]).norm());
  });
  std::vector<double> believed(normals.size(), 1);
  for (std::size_t g = 0; g < normals.size(); ++g) {
    const double turn = (fitted[g].normal - normals[g]).norm();
    if (turn == 0) continue;
    // Far from the corners lie only fits to too few vertices or noise. Where the corners
    // agree the surface is flat, whatever comes farther off.
    believed[g] = share_between(0.35, 0.18, turn);
    normals[g] = blend(normals[g], fitted[g].normal, believed[g] * std::min(1.0, spread[g] / turn));
  }
  return believed;
}

// Moves normals towards the fitted ones, where quadrics fit.
void smooth_normals(const Mesh& mesh, Groups group, std::vector<Vec3>& normals,
                    const ParallelFor& parallel) {
  std::vector<Vec3> smooth = max_normals(mesh, group, normals.size());
  const std::vector<FittedNormal> fitted = fitted_normals(mesh, group, smooth, parallel);
  const std::vector<double> believed = turn_to_fits(mesh, group, fitted, smooth);
  std::vector<double> agreed(normals.size(), 1), seen(normals.size(), 1);  // least cosines
  for_corners(mesh, group, [&](std::uint32_t g, const Vec3& ahead, const Vec3& back) {
    const Vec3 corner = ahead.cross(back).stableNormalized();
    seen[g] = std::min(seen[g], corner.dot(smooth[g]));
    agreed[g] = std::min({agreed[g], corner.dot(normals[g]), seen[g]});
  });
  // Across an edge of a right angle between squares the vertices around are off by 0.25.
  for (std::size_t g = 0; g < normals.size(); ++g) {
    const double fits = believed[g] * share_between(0.25, 0.15, fitted[g].error);
    const double share =
        std::max(share_between(0.80, 0.95, agreed[g]), fits * share_between(0.1, 0.3, seen[g]));
    if (share > 0) normals[g] = blend(normals[g], smooth[g], share);
  }
}

}  // namespace

std::vector<Vec3> group_normals(const Mesh& mesh, std::span<const std::uint32_t> group,
                                std::size_t count, NormalWeights weights,
                                const ParallelFor& parallel) {
  const PlainArithmetic plain;
  std::vector<Vec3> normals = angle_normals(mesh, group, count);
  if (weights == NormalWeights::kSmooth) smooth_normals(mesh, group, normals, parallel);
  return normals;
}

std::vector<Vec3> vertex_normals(const Mesh& mesh, NormalWeights weights,
                                 const ParallelFor& parallel) {
  return group_normals(mesh, mesh.corner_vertex, mesh.positions.size(), weights, parallel);
}

bool has_vertex_normals(const Mesh& mesh) {
  return !mesh.normals.empty() && (mesh.sharp.empty() || !mesh.tangents.empty());
}

void add_vertex_normals(Mesh& mesh, NormalWeights weights, const ParallelFor& parallel) {
  if (has_vertex_normals(mesh)) return;
  if (!mesh.sharp.empty()) {
    SharpCorners corners = sharp_corners(mesh, build_topology(mesh), weights, parallel);
    mesh.normals = std::move(corners.normals);
    mesh.corner_normal = std::move(corners.corner_normal);
    mesh.tangents = std::move(corners.tangents);
  } else {
    mesh.normals = vertex_normals(mesh, weights, parallel);
    mesh.corner_normal = mesh.corner_vertex;
  }
}

}  // namespace gliss
