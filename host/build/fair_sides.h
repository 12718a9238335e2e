// The sides of the fair construction (kernels/fair.h), from a mesh and its vertex normals.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gliss/base/large_array.h"
#include "gliss/base/parallel.h"
#include "gliss/build/mesh_frame.h"
#include "gliss/mesh/topology.h"
#include "gliss/surface/instances.h"

namespace gliss {

// Knows the shape operators of the vertices of some faces. A side between two triangles or two
// quads, or of a triangle at a border, is a fair one; any other is that of the paper, so that
// triangles and quads join whatever lies beside them. Any number of threads may ask it. Keeps
// references to the mesh and its topology.
class FairSides {
 public:
  // `faces`: those whose sides will be asked for.
  FairSides(const MeshFrame& frame, const Topology& topology, std::span<const std::uint32_t> faces,
            const ParallelFor& parallel);

  // Writes the sides of a face: kFairReals numbers each, in the mesh frame.
  void sides_of(std::uint32_t face, std::vector<double>& sides) const;

 private:
  struct End {
    double reals[6];  // position, unit normal
  };

  End corner(std::uint32_t side) const;
  std::uint32_t joined_valence(std::uint32_t side) const;
  void find_turns(const ParallelFor& parallel);
  Vec3 find_turn(std::uint32_t side) const;
  FairEdge<double> edge(std::uint32_t side, std::uint32_t joined, const End& end) const;
  bool find_shape(std::size_t i);  // false: none that its sides agree on
  const FairVertex<double>* shape_of(std::uint32_t vertex) const;

  const MeshFrame frame_;
  const Mesh& mesh_;
  const Topology& topology_;
  // [side], the turn of an edge between two triangles, at the lesser of its sides; empty: not kept.
  LargeArray<Vec3> turn_;
  std::vector<std::uint32_t> vertices_;     // ascending; empty: all
  std::vector<FairVertex<double>> shapes_;  // [vertices_]
  std::vector<char> has_shape_;             // [vertices_]
};

}  // namespace gliss
