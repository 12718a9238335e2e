// Ways along the surface of a mesh between its creases, and along the creases. Private to host/.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "gliss/mesh/sectors.h"
#include "gliss/mesh/topology.h"

namespace gliss {

// The surface bulges over the triangles of its faces as their normals ask, and creases are curves.
class SmoothWalk {
 public:
  // All must outlive it.
  SmoothWalk(const Mesh& mesh, const Topology& topology, const Sectors& sectors);

  struct OnFace {
    std::uint32_t triangle = kNone;
    Vec3 position = Vec3::Zero(), normal = Vec3::Zero();
  };
  struct OnCrease {
    std::uint32_t side = kNone;  // the crease lies ahead along it
    double share = 0;            // of its length
    Vec3 position = Vec3::Zero();
    Vec3 along = Vec3::Zero();                       // unit tangent
    Vec3 left = Vec3::Zero(), right = Vec3::Zero();  // normals of both sides, across it
  };

  // At the vertex of a group of corners; its position is that of the vertex.
  OnFace on_face(std::uint32_t group) const;
  // The place on the surface that is nearest to a point, as far as that is found downhill.
  OnFace moved(const OnFace& from, const Vec3& to) const;

  // At the start of a cut side.
  OnCrease on_crease(std::uint32_t side) const;
  // Walks so far along the crease, back where that is negative. It stays on the edges between two
  // corners.
  OnCrease moved(const OnCrease& from, double by) const;

 private:
  using Triangle = std::array<std::uint32_t, 3>;  // corners
  using Shares = std::array<double, 3>;

  const Vec3& position(std::uint32_t corner) const {
    return mesh_.positions[mesh_.corner_vertex[corner]];
  }
  const Vec3& normal(std::uint32_t corner) const {
    return sectors_.normals[sectors_.group[corner]];
  }
  std::uint32_t next(std::uint32_t side) const { return next_side(mesh_, topology_, side); }
  Shares nearest_in(const Triangle& triangle, const Vec3& to) const;
  Vec3 at(const Triangle& triangle, const Shares& shares) const;
  OnFace lifted(std::uint32_t triangle, const Shares& shares) const;
  std::uint32_t side_after(std::uint32_t side) const;
  Vec3 tangent_at(std::uint32_t side) const;
  OnCrease at(std::uint32_t side, double share) const;

  const Mesh& mesh_;
  const Topology& topology_;
  const Sectors& sectors_;
  std::vector<Triangle> triangles_;
  // Triangles at each group of corners: [group + 1], and their numbers.
  std::vector<std::uint32_t> group_begin_, group_triangle_;
};

}  // namespace gliss
