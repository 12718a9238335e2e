// Vertex normals from polynomials that are fitted to the vertices around. Private to host/.
#pragma once

#include <algorithm>
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

// Fits a polynomial to each group's neighbours and theirs, over edges between the corners of a
// group ([corner], of start.size()), so that nothing beyond a crease counts. `start` [group]: unit
// normals, near those that are looked for.
//
// It is, with d from the vertex and x, y in the plane across the normal n,
//   n.d = a x + b y + c |d|^2 / 2 + p (x^2 - y^2) / 2 + q x y + a cubic form in x and y,
// which a sphere is exactly, with p = q = 0. First without the cubic form, a quadric: what a
// surface has besides grows with |d|^3, so the weights are 1 / |d|^6. The normal is turned by a and
// b, and the fit made once more. Then with it (Cazals and Pouget 2005, "Estimating differential
// quantities using polynomial fitting of osculating jets"; cubic forms make normals of third
// order), where that fits better for its number of coefficients: neighbours count by the square of
// the cosine that their normals make with the vertex's, so that nothing on the far side of a thin
// tube counts.
std::vector<FittedNormal> fitted_normals(const Mesh& mesh, std::span<const std::uint32_t> group,
                                         std::span<const Vec3> start,
                                         const ParallelFor& parallel = serial_for);

// Rises from 0 at `none` to 1 at `all`, smoothly.
inline double share_between(double none, double all, double value) {
  const double x = std::clamp((value - none) / (all - none), 0.0, 1.0);
  return x * x * (3 - 2 * x);
}

inline Vec3 blend(const Vec3& from, const Vec3& to, double share) {
  return (from + share * (to - from)).stableNormalized();
}

}  // namespace gliss
