// Many points and contacts as arrays, in float or double whatever the cache's precision. What is
// not asked for, a null column, is not computed. Arrays that are written must not overlap others.
#pragma once

#include <cstdint>

#include "gliss/base/strided.h"

namespace gliss {

// Points of faces' patches: DomainPoint (query.h) as arrays.
template <class T>
struct PointArrays {
  std::size_t count = 0;
  Strided<const std::uint32_t> face{};
  Strided<const T> xi{}, eta{};
};

// SurfacePoint (query.h) as arrays: G, its derivatives, and the outward unit normal.
template <class T>
struct SurfaceArrays {
  StridedVectors<T> position{}, d_xi{}, d_eta{};  // mesh's unit
  StridedVectors<T> normal{};

  SurfaceArrays from(std::size_t i) const {
    return {position.from(i), d_xi.from(i), d_eta.from(i), normal.from(i)};
  }
};

// HIPs, mesh's unit.
template <class T>
struct HipArrays {
  std::size_t count = 0;
  StridedVectors<const T> position{};
};

// Contact (query.h) as arrays.
template <class T>
struct ContactArrays {
  Strided<bool> touching{};
  Strided<std::uint32_t> face{};
  Strided<T> xi{}, eta{};
  StridedVectors<T> scp{}, normal{}, push{};
  Strided<T> distance{}, residual_angle{};
  Strided<int> iterations{}, crossings{};
  Strided<std::uint32_t> flags{};
  Strided<T> clear{};

  ContactArrays from(std::size_t i) const {
    return {touching.from(i),   face.from(i),      xi.from(i),
            eta.from(i),        scp.from(i),       normal.from(i),
            push.from(i),       distance.from(i),  residual_angle.from(i),
            iterations.from(i), crossings.from(i), flags.from(i),
            clear.from(i)};
  }
};

}  // namespace gliss
