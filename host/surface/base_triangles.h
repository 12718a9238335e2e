// The triangles of the base polygons.
#pragma once

#include <array>

#include "gliss/base/vector.h"
#include "gliss/surface/layout.h"
#include "gliss/surface/surface.h"

namespace gliss {

using BaseTriangle = std::array<Vec3, 3>;

// A place in a patch's local frame, mesh frame.
template <class Real>
Vec3 from_local(const Surface<Real>& s, std::uint32_t patch, const Vec3& local) {
  const Real* numbers = &s.patch[patch * kPatchReals];
  return vector_at(numbers + kPatchOrigin) + static_cast<double>(numbers[kPatchUnscale]) * local;
}

// The place where a side starts, mesh frame.
template <class Real>
Vec3 start_of(const Surface<Real>& s, std::uint32_t side) {
  return from_local(s, s.side_patch[side], vector_at(&s.corner[6 * std::size_t{side}]));
}

// The surface's normal where a side starts.
template <class Real>
Vec3 normal_at_start(const Surface<Real>& s, std::uint32_t side) {
  return vector_at(&s.corner[6 * std::size_t{side} + 3]);
}

// True if the surface has the same normals beyond a side, at both its ends. False at a border.
template <class Real>
bool is_smooth_across(const Surface<Real>& s, std::uint32_t side) {
  const std::uint32_t twin = s.side_twin[side];
  return twin != kNone && normal_at_start(s, side) == normal_at_start(s, next_side(s, twin)) &&
         normal_at_start(s, next_side(s, side)) == normal_at_start(s, twin);
}

// The words of a patch's first triangle: a piece of its face's polygon (FAN_PIECE), or none.
template <class Real>
const std::uint32_t* piece_of(const Surface<Real>& s, std::uint32_t patch) {
  const std::uint32_t* words = &s.triangle[3 * (s.side_begin[patch] - 2 * std::size_t{patch})];
  return (words[0] & kFanPiece) != 0 ? words : nullptr;
}
// Corner k of a piece, as the face numbers its corners.
inline std::uint32_t piece_corner(const std::uint32_t* piece, std::uint32_t k) {
  return piece[0] >> k * kFanBits & kFanCorner;
}

// Calls visit(triangle) for each of a patch's base polygon, mesh frame, seen from x.
template <class Real, class Visit>
void for_base_triangles(const Surface<Real>& s, std::uint32_t patch, const Vec3& x, Visit visit) {
  const std::uint32_t first = s.side_begin[patch];
  const std::uint32_t* corners = &s.triangle[3 * (first - 2 * std::size_t{patch})];
  const bool in_fan = (corners[0] & kFanPiece) != 0;  // its own is 0 1 2
  for (std::uint32_t t = 0; t + 2 < s.valence(patch); ++t) {
    BaseTriangle triangle;
    for (std::uint32_t k = 0; k < 3; ++k)
      triangle[k] = start_of(s, first + (in_fan ? k : corners[3 * t + k])) - x;
    visit(triangle);
  }
}

// Calls visit(triangle) for each that a patch holds of its face's polygon, mesh frame: those of its
// base polygon, or its piece.
template <class Real, class Visit>
void for_polygon_triangles(const Surface<Real>& s, std::uint32_t patch, Visit visit) {
  const std::uint32_t* piece = piece_of(s, patch);
  if (piece == nullptr) return for_base_triangles(s, patch, Vec3::Zero(), visit);
  BaseTriangle triangle;  // corner k of the face is where side 0 of its patch k starts
  for (std::uint32_t k = 0; k < 3; ++k)
    triangle[k] = start_of(s, piece[1] + 3 * piece_corner(piece, k));
  visit(triangle);
}

}  // namespace gliss
