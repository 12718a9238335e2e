// A mesh in the mesh frame of its cache: origin removed, scaled by a power of two into [-1, 1].
#pragma once

#include "gliss/mesh/mesh.h"

namespace gliss {

// Keeps a reference to the mesh.
struct MeshFrame {
  const Mesh& mesh;
  Vec3 origin;   // in the mesh's unit
  double scale;  // mesh-frame length of one unit

  // Position and unit normal of the corner at which a side starts.
  Vec3 position(std::uint32_t side) const {
    return (mesh.positions[mesh.corner_vertex[side]] - origin) * scale;
  }
  Vec3 normal(std::uint32_t side) const {
    return mesh.normals[mesh.corner_normal[side]].normalized();
  }
  // Mesh::tangents of a side, at its start (0) or end (1).
  Vec3 tangent(std::uint32_t side, std::uint32_t end) const {
    return mesh.tangents[2 * side + end] * scale;
  }
};

}  // namespace gliss
