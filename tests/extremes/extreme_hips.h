// HIPs where nearest points are hard: exactly on edges, vertices and poles, where many points are
// equally near, inside folds, very far away.
#pragma once

#include "tests/extremes/extreme_surfaces.h"

namespace gliss::test {

using oracle::Rng, oracle::uniform;

SurfacePoint random_site(Rng& rng, const Extreme& e);

// At t along a side.
SurfacePoint site_on_side(const Extreme& e, std::uint32_t side, double t);

std::uint32_t random_side(Rng& rng, const Extreme& e);

// Exactly there, a little above or beneath, or anywhere along the normal; off it by little or none.
Vec3 along_normal(Rng& rng, const Extreme& e, const SurfacePoint& p);

Vec3 on_the_surface(Rng& rng, const Extreme& e);

Vec3 over_an_edge(Rng& rng, const Extreme& e);

Vec3 over_a_vertex(Rng& rng, const Extreme& e);

// Beyond a side of a border, or its corner, by up to a size; above or beneath it.
Vec3 past_a_border(Rng& rng, const Extreme& e);

// A HIP over a pole of the two meshes with poles: their last two vertices.
Vec3 over_a_pole(Rng& rng, const Extreme& e);

// Equally near to two points: the centre of the largest ball that touches the surface at a point
// and holds none (shrinking balls, Ma et al. 2012). Inside or outside.
Vec3 on_the_medial_axis(Rng& rng, const Extreme& e);

// A HIP where the distance to all points around is stationary to the second order.
Vec3 at_a_centre_of_curvature(Rng& rng, const Extreme& e);

Vec3 inside_a_fold(Rng& rng, const Extreme& e);

template <int kExponent>
Vec3 far_outside(Rng& rng, const Extreme& e) {
  const double most = std::pow(10, kExponent);
  const double sizes = kExponent == 1 ? uniform(rng, 1, most) : uniform(rng, 0.1, 1) * most;
  return e.middle() + sizes * e.size * oracle::random_unit(rng);
}

}  // namespace gliss::test
