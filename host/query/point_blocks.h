// Points of any patches, sorted into blocks of as many points of one patch as are evaluated at
// once.
#pragma once

#include <span>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/query/frames.h"

namespace gliss {

// Distance between rows of `count` results (kernels/arguments.h).
inline constexpr std::size_t row_stride(std::size_t count) { return count + 16; }

template <class Real>
struct PointBlocks {
  std::size_t lanes = 1;                // points in a block
  std::vector<std::uint32_t> patch;     // [block]
  std::vector<Real> xi, eta;            // [block][lanes]; what is over in a block repeats its first
  std::vector<std::uint32_t> patch_of;  // [point]
  std::vector<std::uint32_t> slot;      // [point], where it lies in xi and eta

  std::size_t slots() const { return patch.size() * lanes; }
};

template <class Real>
GLISS_EXPORT void block_points(const PatchCache& cache, const Surface<Real>& s,
                               std::span<const DomainPoint> points, std::size_t lanes,
                               PointBlocks<Real>& blocks);

}  // namespace gliss
