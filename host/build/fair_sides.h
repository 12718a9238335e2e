// The sides of the fair construction (kernels/fair.h), from a mesh and its vertex normals.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gliss/base/parallel.h"
#include "gliss/build/mesh_frame.h"
#include "gliss/mesh/topology.h"
#include "gliss/surface/instances.h"

namespace gliss {

// Knows the shape operators of the vertices of some faces. A side between two triangles or two
// quads, or of a triangle at a border, is a fair one; any other is that of the paper, so that
// triangles and quads join whatever lies beside them. So is one of a face that lies, with its
// normals, in a plane: there that is straight, and the face stays flat. Any number of threads may
// ask it. Keeps references to the mesh and its topology.
class FairSides {
 public:
  // `faces`: those whose sides will be asked for.
  FairSides(const MeshFrame& frame, const Topology& topology, std::span<const std::uint32_t> faces,
            const ParallelFor& parallel);

  // Writes the sides of faces, one after the other: kFairReals numbers each, in the mesh frame.
  void sides_of(std::span<const std::uint32_t> faces, std::vector<double>& sides) const;

 private:
  void put_corner(std::uint32_t side, double* reals) const;  // position, unit normal
  bool is_flat(std::uint32_t face) const;
  std::uint32_t joined_valence(std::uint32_t side) const;
  double twist_share(std::uint32_t side) const;
  FairEdge<double> edge(std::uint32_t side, std::uint32_t joined) const;
  void find_shapes(std::size_t begin, std::size_t end);
  // Adds the edges that leave vertices_[i]; false: it has no shape that they agree on.
  bool add_edges(std::size_t i, std::vector<FairEdge<double>>& edges) const;
  const FairVertex<double>* shape_of(std::uint32_t vertex) const;

  const MeshFrame frame_;
  const Mesh& mesh_;
  const Topology& topology_;
  std::vector<char> flat_;                  // [face]; empty: not kept
  std::vector<std::uint32_t> vertices_;     // ascending; empty: all
  std::vector<FairVertex<double>> shapes_;  // [vertices_]
  std::vector<char> has_shape_;             // [vertices_]
};

}  // namespace gliss
