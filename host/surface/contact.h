// How contacts are searched for, what flags say of one, and a contact as it is kept between ticks.
#pragma once

#include <cstddef>
#include <cstdint>

namespace gliss {

enum class Method { kGregory, kShaded, kFlat };
inline constexpr std::size_t kMethods = 3;
enum class Solver { kNewton, kGaussNewton, kPaper };

// Bits of a contact's flags. kNotBuilt: its patches are not there yet, it is of the base polygons.
// kUnfinished: the search's budget was spent before every point was tried or ruled out.
// kSettling: on its way to where a leap ends (ContactTracker, QueryOptions::settle).
// kSlipping: its point has left the cone of friction and follows (QueryOptions::friction).
inline constexpr std::uint32_t kConverged = 1, kOnBorder = 2, kOnCrease = 4, kNotBuilt = 8,
                               kUnfinished = 16, kSettling = 32, kSlipping = 64;

// True if a contact of these flags is kSettling.
constexpr bool is_settling(std::uint32_t flags) { return (flags & kSettling) != 0; }
// ... kSlipping.
constexpr bool is_slipping(std::uint32_t flags) { return (flags & kSlipping) != 0; }

// The most numbers that a contact has of each kind, with room for more.
inline constexpr std::size_t kContactReals = 16, kContactUints = 8;

// A contact as the kernels see it: local frame of its patch, offsets in the
// mesh frame. Starts free.
template <class Real>
struct RawContact {
  Real reals[kContactReals] = {};
  std::uint32_t uints[kContactUints] = {};
  int evaluations = 0;  // that the query took, or the time of as many
  // Left by a tick for the next one: curvature term and drift, once warm.
  Real warmth[5] = {};
  bool warm = false;
  // Points of other parts that a contact on a seam rests against too: patch, xi, eta.
  std::uint32_t held_count = 0;
  std::uint32_t held_patch[2] = {};
  Real held_at[2][2] = {};
};

}  // namespace gliss
