// Sectors: the corners of a vertex between two cuts of it. Which they are, the tangents of the cuts
// and the normals that the sectors have by themselves. Private to host/.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gliss/base/large_array.h"
#include "gliss/mesh/topology.h"

namespace gliss {

inline constexpr double kCollinear = 1e-6;  // sine between tangents that say no normal

// The angle between two vectors, rad.
GLISS_EXPORT double angle_between(const Vec3& a, const Vec3& b);

// The edge of a side, from its start.
Vec3 edge_of(const Mesh& mesh, const Topology& topology, std::uint32_t side);

// The unit normal of a corner: on the side of its face's where it is reflex, its face's where it is
// straight.
Vec3 corner_normal(const Mesh& mesh, const Topology& topology, std::uint32_t corner,
                   const Vec3& face_normal);

// The normal of a face beside one of its sides, of any length: that of the two corners there.
Vec3 normal_beside(const Mesh& mesh, const Topology& topology, std::uint32_t side);
// The same of all sides: [side].
LargeArray<Vec3> normals_beside(const Mesh& mesh, const Topology& topology);

// True if the mesh's own normals at two corners are not the same.
bool normals_differ(const Mesh& mesh, std::uint32_t corner, std::uint32_t other);

// True if both faces at an inner side have the very same normals at its ends: patches of theirs
// meet smoothly there.
GLISS_EXPORT bool shares_normals(const Mesh& mesh, const Topology& topology, std::uint32_t side);

// Corners of one vertex, anticlockwise: sides that start there. Unit tangents of the cuts on both
// sides, which leave the vertex; (0, 0, 0) where a border bounds the sector.
struct Sector {
  std::vector<std::uint32_t> corners;
  Vec3 first, last;
};

struct Sectors {
  std::vector<Sector> cut;           // those of cut vertices, vertex by vertex, anticlockwise
  std::vector<Vec3> tau;             // [side], unit tangent at its start where that is cut, else 0
  std::vector<std::uint32_t> group;  // [corner], its vertex; at cut ones vertices + its sector
  std::vector<Vec3> normals;         // [group], unit length
};

// Cuts vertices along the inner sides that `cuts` marks ([side], 1: at its start): those with two
// or more, and with one at a border; others stay as they are. Two cuts that go on as one curve have
// the tangent of the circle through the vertex and their other ends. Normals of the mesh count at
// vertices that are not cut, and where they differ between sectors; others are made by `weights`.
Sectors cut_sectors(const Mesh& mesh, const Topology& topology, std::span<const std::uint8_t> cuts,
                    NormalWeights weights, const ParallelFor& parallel = serial_for);

// The unit tangent of eq. 8 at an end of an edge whose normal is n; `mean`: n_avg, of any length.
Vec3 tangent_along(const Vec3& edge, const Vec3& normal, const Vec3& mean);

// The length of both end tangents of a cubic between two ends so far apart that is as long as the
// circle with their unit directions.
double arc_length(double chord, const Vec3& start, const Vec3& end);

}  // namespace gliss
