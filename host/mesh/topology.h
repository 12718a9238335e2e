// Finds how the sides of a validated mesh meet: twins, fans, borders, parts; and its vertex
// normals.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/base/parallel.h"
#include "gliss/mesh/mesh.h"

namespace gliss {

// Sides are half-edges: side s runs from corner_vertex[s] to the next corner of its face.
struct Topology {
  std::vector<std::uint32_t> side_face;  // [side]
  std::vector<std::uint32_t> side_twin;  // [side], same edge, other face; kNone: border
  // [vertex], a side that starts there; kNone: unused. On an open fan the one from which
  // next_around meets all others.
  std::vector<std::uint32_t> vertex_side;
  std::uint32_t part_count = 0;  // connected components
  std::uint32_t border_side_count = 0;
};

// Next and previous side of the same face.
GLISS_EXPORT std::uint32_t next_side(const Mesh& mesh, const Topology& topology,
                                     std::uint32_t side);
GLISS_EXPORT std::uint32_t prev_side(const Mesh& mesh, const Topology& topology,
                                     std::uint32_t side);

// The next side that starts at the same vertex, anticlockwise seen from outside; kNone past a
// border.
GLISS_EXPORT std::uint32_t next_around(const Mesh& mesh, const Topology& topology,
                                       std::uint32_t side);

// Requires a validated mesh (manifold edges, consistent orientation).
GLISS_EXPORT Topology build_topology(const Mesh& mesh);

enum class NormalWeights {
  // The mean of the face normals, weighted by the angle of the corner (Thuermer and Wuethrich
  // 1998). A vertex whose mean vanishes gets the normal of its largest face.
  kAngle,
  // The normal of a cubic fitted to the vertices around, where the surface is smooth. It is exact
  // on spheres, started from and kept near the sum of e_1 x e_2 / (|e_1|^2 |e_2|^2) over the
  // corners (Max 1999). Smooth is where a quadric fits, or the corners nearly agree. That of
  // kAngle elsewhere; a blend in between.
  kSmooth
};

// Gives a mesh without normals one unit normal per vertex, and one with creases the normals and
// tangents of creases.h. Leaves others alone. `parallel` runs what quadrics take.
GLISS_EXPORT void add_vertex_normals(Mesh& mesh, NormalWeights weights = NormalWeights::kAngle,
                                     const ParallelFor& parallel = serial_for);
// True if it has nothing to add.
GLISS_EXPORT bool has_vertex_normals(const Mesh& mesh);

// One unit normal per vertex; an unused one gets (0, 0, 1).
GLISS_EXPORT std::vector<Vec3> vertex_normals(const Mesh& mesh,
                                              NormalWeights weights = NormalWeights::kAngle,
                                              const ParallelFor& parallel = serial_for);

// The same where the corners of a vertex may be of several groups, [corner] numbers below `count`.
GLISS_EXPORT std::vector<Vec3> group_normals(const Mesh& mesh, std::span<const std::uint32_t> group,
                                             std::size_t count,
                                             NormalWeights weights = NormalWeights::kAngle,
                                             const ParallelFor& parallel = serial_for);

// Normal of a polygon by Newell's method; length is twice the area of a planar polygon.
GLISS_EXPORT Vec3 newell_normal(const Mesh& mesh, std::size_t face);
Vec3 newell_normal(std::span<const Vec3> corners);

}  // namespace gliss
