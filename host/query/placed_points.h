// Points of any faces as the kernels take them, and the order in which they do.
#pragma once

#include <cstdint>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/query/frames.h"

namespace gliss {

// Distance between rows of `count` results (kernels/arguments.h).
constexpr std::size_t row_stride(std::size_t count) { return count + 16; }

// Places [begin, end) in an order hold points of one patch.
struct PatchRun {
  std::uint32_t patch, begin, end;
};

// Points in the domains of their patches. Keeps its arrays for the next ones, as PatchOrder does:
// one set a thread.
template <class Real>
struct PlacedPoints {
  std::vector<Real> xi, eta;
  std::vector<PatchRun> runs;  // in the order of the points

  template <class T>
  GLISS_EXPORT void take(const PatchCache& cache, const Surface<Real>& s,
                         const PointArrays<T>& points, std::size_t begin, std::size_t count);
};

// The order of points by patch.
struct GLISS_EXPORT PatchOrder {
  enum Kind {
    kInRuns,  // needs none: those of a patch lie together
    kByPatch,
    kSparse  // fills no lanes either: patches have too few points
  };
  std::vector<std::uint32_t> patch;  // [point]; not of kInRuns
  std::vector<PatchRun> runs;        // in that order; not of kInRuns
  std::vector<std::uint32_t> order;  // [place], which point; after sort()

  Kind judge(const std::vector<PatchRun>& given, std::size_t lanes);
  void sort();  // what was judged

 private:
  std::vector<std::uint32_t> run_of_;  // [point], in `runs`
  std::vector<std::uint32_t> next_;    // [run], place of its next point while sorting
};

}  // namespace gliss
