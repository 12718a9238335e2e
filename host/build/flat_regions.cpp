#include "gliss/build/flat_regions.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "gliss/mesh/mesh_edges.h"

namespace gliss {
namespace {

constexpr double kFlat = 1e-5;       // rad
constexpr double kFarLarger = 8;     // in area
constexpr double kLeastAlike = 0.5;  // cosine between the region's normal and a face's

// The two largest regions at a normal.
struct Rivals {
  std::uint32_t region = kNone;
  double area = 0, next_area = 0;
  bool is_kept = true;  // false: at a crease, or a face turns away too far

  void add(std::uint32_t other, double its_area) {
    if (other == region) return;
    if (its_area > area) {
      next_area = area;
      region = other, area = its_area;
    } else {
      next_area = std::max(next_area, its_area);
    }
  }
};

bool is_planar(const Mesh& mesh, std::uint32_t face, const Vec3& normal) {
  const Vec3& origin = mesh.positions[mesh.corner_vertex[mesh.face_begin[face]]];
  for (std::uint32_t c = mesh.face_begin[face] + 1; c < mesh.face_begin[face + 1]; ++c) {
    const Vec3 way = mesh.positions[mesh.corner_vertex[c]] - origin;
    if (std::abs(way.dot(normal)) > kFlat * way.norm() * normal.norm()) return false;
  }
  return true;
}

}  // namespace

void keep_flat_regions(Mesh& mesh, const Topology& topology, const ParallelFor& parallel) {
  constexpr std::size_t kGrain = 1024;
  const std::size_t faces = mesh.face_count();
  std::vector<Vec3> normal(faces);  // twice the area long
  std::vector<char> planar(faces);
  parallel(faces, kGrain, [&](std::size_t begin, std::size_t end) {
    for (auto f = static_cast<std::uint32_t>(begin); f < end; ++f) {
      normal[f] = newell_normal(mesh, f);
      planar[f] = mesh.valence(f) == 3 || is_planar(mesh, f, normal[f]);
    }
  });
  DisjointSets sets(faces);
  std::vector<double> area(faces, 0);              // [first face of a region]
  std::vector<std::uint32_t> triangles(faces, 0);  // that it would take
  for (std::uint32_t side = 0; side < mesh.corner_vertex.size(); ++side) {
    const std::uint32_t twin = topology.side_twin[side];
    if (twin == kNone || twin < side || mesh.is_crease(side)) continue;
    const std::uint32_t face = topology.side_face[side], beyond = topology.side_face[twin];
    const Vec3 &one = normal[face], &other = normal[beyond];
    if (planar[face] && planar[beyond] && one.dot(other) > 0 &&
        one.cross(other).norm() <= kFlat * one.norm() * other.norm())
      sets.unite(face, beyond);
  }
  for (std::uint32_t f = 0; f < faces; ++f) {
    area[sets.find(f)] += normal[f].norm() / 2;
    if (planar[f]) triangles[sets.find(f)] += mesh.valence(f) - 2;
  }
  std::vector<Rivals> rivals(mesh.normals.size());
  for (std::uint32_t c = 0; c < mesh.corner_vertex.size(); ++c) {
    const std::uint32_t region = sets.find(topology.side_face[c]);
    rivals[mesh.corner_normal[c]].add(region, area[region]);
  }
  for (std::uint32_t c = 0; c < mesh.corner_vertex.size(); ++c) {
    Rivals& r = rivals[mesh.corner_normal[c]];
    const Vec3 &one = normal[r.region], &other = normal[topology.side_face[c]];
    r.is_kept = r.is_kept && triangles[r.region] > 1 && r.area > kFarLarger * r.next_area &&
                one.dot(other) >= kLeastAlike * one.norm() * other.norm() && !mesh.is_crease(c) &&
                !mesh.is_crease(prev_side(mesh, topology, c));
  }
  for (std::size_t i = 0; i < rivals.size(); ++i) {
    if (rivals[i].is_kept && rivals[i].area > 0)
      mesh.normals[i] = normal[rivals[i].region].normalized();
  }
}

}  // namespace gliss
