// The domain of a patch: the regular polygon of its sides, with corners at distance 1.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "gliss/base/vector.h"

namespace gliss {

// A point of a patch's domain. Vector2d's alignment follows the flags of who includes it.
using DomainVec = Eigen::Matrix<double, 2, 1, Eigen::DontAlign>;

// The point at t of side k of the domain of n sides.
inline DomainVec on_side(std::uint32_t n, std::uint32_t k, double t) {
  const double a = 2 * std::numbers::pi * k / n, b = 2 * std::numbers::pi * ((k + 1) % n) / n;
  return {(1 - t) * std::cos(a) + t * std::cos(b), (1 - t) * std::sin(a) + t * std::sin(b)};
}

}  // namespace gliss
