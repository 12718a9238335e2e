// Vertex normals from a quadric that is fitted to the vertices around. Private to host/.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gliss/base/parallel.h"
#include "gliss/mesh/mesh.h"

namespace gliss {

// A unit normal, and how far the vertices around are off the quadric: the root mean square of
// distance over distance to the vertex. Infinity where they do not determine a quadric, and at
// borders and creases, where they lie on one side; the normal is then the one that was given.
struct FittedNormal {
  Vec3 normal;
  double error;
};

// Fits a quadric to each group's neighbours and theirs, over edges between the corners of a group
// ([corner], below `count`), so that nothing beyond a crease counts. `start` [group]: unit normals,
// near those that are looked for.
//
// The quadric is, with d from the vertex and x, y in the plane across the normal n,
//   n.d = a x + b y + c |d|^2 / 2 + p (x^2 - y^2) / 2 + q x y,
// which a sphere is exactly, with p = q = 0. What a surface has besides grows with |d|^3, so the
// weights are 1 / |d|^6. The normal is turned by a and b, and the fit made once more.
std::vector<FittedNormal> fitted_normals(const Mesh& mesh, std::span<const std::uint32_t> group,
                                         std::size_t count, std::span<const Vec3> start,
                                         const ParallelFor& parallel = serial_for);

}  // namespace gliss
