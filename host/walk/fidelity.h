// Measures what levels are compared by: how far one surface is from another, how smooth it is
// across edges, and how it feels along a path. Lengths in the mesh's unit.
#pragma once

#include <optional>
#include <span>

#include "gliss/base/export.h"
#include "gliss/base/poll.h"
#include "gliss/mesh/creases.h"
#include "gliss/mesh/topology.h"
#include "gliss/query/force_statistics.h"
#include "gliss/query/query.h"

namespace gliss {

// HIPs `depth` beneath the surface, about `step` apart: over face after face, mostly straight on.
// They go outside where a crease's other side is nearer than `depth`, and in again where it is not:
// within the solid a contact would stay on the side that it came from, deeper and deeper. No border
// is crossed, and no place is entered where a hand would be deeper, as in a part that overlaps. A
// path that can go nowhere goes to and fro. Deterministic. Throws std::invalid_argument where no
// face can be left, and where no hand gets so deep.
GLISS_EXPORT std::vector<Vec3> path_over(const Mesh& mesh, const Topology& topology,
                                         const PatchCache& cache, double depth, double step,
                                         std::size_t count, const Poll& poll = {});

// Points of all faces, about `count`, in the order of faces.
GLISS_EXPORT std::vector<DomainPoint> spread_points(const PatchCache& cache, std::size_t count);

// A value that is not finite ranks above all others.
struct Distances {
  double largest = 0, p99 = 0;
};
GLISS_EXPORT Distances distances_of(std::vector<double> distances);

// Angles between the normals on both sides of an edge (rad) that a contact with this method meets:
// of the patches, of the blended vertex normals (shaded), of the base polygons (flat). Edges whose
// sides have unlike vertex normals, and those of bent patches, are creases and left out.
GLISS_EXPORT Distances normal_gaps(const Mesh& mesh, const Topology& topology,
                                   const PatchCache& cache, Method method);

// The edges, by their vertices, across which the surface is not smooth though no crease was
// declared there: a face has a bent patch, or the faces have unlike normals. The mesh has normals,
// and the cache is of all its faces.
GLISS_EXPORT std::vector<VertexPair> rough_edges(const Mesh& mesh, const Topology& topology,
                                                 const PatchCache& cache);

// A path, tick by tick.
struct FeltPath {
  ForceStatistics force;     // stiffness 1 N per unit of length
  double p99_step = 0;       // of the steps of `force`
  Distances error;           // |push - reference|
  double median_tick = 0;    // s
  std::vector<Vec3> push{};  // [tick]
};
// `depth` of the path. `reference`: pushes to compare with, or empty. `poll` is called every 256
// ticks, and may end it by throwing.
GLISS_EXPORT FeltPath feel_path(const PatchCache& cache, const QueryOptions& options,
                                std::span<const Vec3> path, double depth,
                                std::span<const Vec3> reference, const Poll& poll = {});

}  // namespace gliss
