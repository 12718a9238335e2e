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

// The columns of contacts: their type, name and place in a Contact (query.h).
#define GLISS_CONTACT_COLUMNS(COLUMN)                \
  COLUMN(Strided<bool>, touching, touching)          \
  COLUMN(Strided<std::uint32_t>, face, at.face)      \
  COLUMN(Strided<T>, xi, at.xi)                      \
  COLUMN(Strided<T>, eta, at.eta)                    \
  COLUMN(StridedVectors<T>, scp, scp)                \
  COLUMN(StridedVectors<T>, normal, normal)          \
  COLUMN(StridedVectors<T>, push, push)              \
  COLUMN(Strided<T>, distance, distance)             \
  COLUMN(Strided<T>, residual_angle, residual_angle) \
  COLUMN(Strided<int>, iterations, iterations)       \
  COLUMN(Strided<int>, crossings, crossings)         \
  COLUMN(Strided<std::uint32_t>, flags, flags)       \
  COLUMN(Strided<T>, clear, clear)

// Contact as arrays.
template <class T>
struct ContactArrays {
#define GLISS_COLUMN_MEMBER(Type, name, place) Type name{};
  GLISS_CONTACT_COLUMNS(GLISS_COLUMN_MEMBER)

  ContactArrays from(std::size_t i) const {
    ContactArrays rest;
#define GLISS_COLUMN_FROM(Type, name, place) rest.name = name.from(i);
    GLISS_CONTACT_COLUMNS(GLISS_COLUMN_FROM)
    return rest;
  }
};

}  // namespace gliss
