// Vectors, boxes, and the index of nothing.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>

namespace gliss {

using Vec3 = Eigen::Vector3d;
// Eigen never aligns it, whatever the flags of a library and its user.
static_assert(sizeof(Vec3) == 3 * sizeof(double) && alignof(Vec3) == alignof(double));

// The vector of three numbers, in either precision, each `stride` behind the one before.
template <class Real>
Vec3 vector_at(const Real* at, std::size_t stride = 1) {
  return {static_cast<double>(at[0]), static_cast<double>(at[stride]),
          static_cast<double>(at[2 * stride])};
}

// The part of v at right angles to a unit axis.
inline Vec3 across(const Vec3& axis, const Vec3& v) { return v - axis * axis.dot(v); }

// Axis-aligned box.
struct Box {
  Vec3 low, high;

  bool contains(const Vec3& x) const {
    return (low.array() <= x.array()).all() && (x.array() <= high.array()).all();
  }
  // True if some point lies in both.
  bool meets(const Box& other) const {
    return (low.array() <= other.high.array()).all() && (other.low.array() <= high.array()).all();
  }
  // Widens it until it contains a point, or another box.
  void hold(const Vec3& x) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  void hold(const Box& other) {
    low = low.cwiseMin(other.low);
    high = high.cwiseMax(other.high);
  }
};

inline constexpr std::uint32_t kNone = 0xFFFFFFFFu;

}  // namespace gliss
