#include "gliss/query/placed_points.h"

#include <algorithm>
#include <utility>

namespace gliss {

namespace {

// From `end` on, past numbers that equal the one before; some may be left.
std::size_t skip_equal(const std::uint32_t* numbers, std::size_t end, std::size_t count) {
  constexpr std::size_t kMany = 16;
  const std::uint32_t number = numbers[end - 1];
  for (; end + kMany <= count; end += kMany) {
    std::uint32_t other = 0;
    for (std::size_t i = 0; i < kMany; ++i) other |= numbers[end + i] ^ number;
    if (other != 0) break;
  }
  return end;
}

}  // namespace

template <class Real>
template <class T>
void PlacedPoints<Real>::take(const PatchCache& cache, const Surface<Real>& s,
                              const PointArrays<T>& points, std::size_t begin, std::size_t count) {
  xi.resize(count), eta.resize(count);
  const auto copy = [&](const Strided<const T>& from, std::vector<Real>& to) {
    if (from.is_dense()) {
      std::copy_n(&from[begin], count, to.begin());
    } else {
      for (std::size_t i = 0; i < count; ++i) to[i] = static_cast<Real>(from[begin + i]);
    }
  };
  copy(points.xi, xi);
  copy(points.eta, eta);
  runs.clear();
  const Strided<const std::uint32_t> face = points.face.from(begin);
  for (std::size_t run = 0, end; run < count; run = end) {
    end = run + 1;
    if (face.is_dense() && end < count && face[end] == face[run])
      end = skip_equal(face.first, end, count);
    while (end < count && face[end] == face[run]) ++end;
    const std::uint32_t patch = cache.face_patch[face[run]];
    if (!is_part(cache, patch)) {
      runs.push_back({patch, static_cast<std::uint32_t>(run), static_cast<std::uint32_t>(end)});
      continue;
    }
    for (std::size_t i = run; i < end; ++i) {
      const PatchPlace place = place_of(cache, s, point_at(points, begin + i));
      xi[i] = static_cast<Real>(place.xi);
      eta[i] = static_cast<Real>(place.eta);
      const auto at = static_cast<std::uint32_t>(i);
      if (i > run && runs.back().patch == place.patch) {
        runs.back().end = at + 1;
      } else {
        runs.push_back({place.patch, at, at + 1});
      }
    }
  }
}

#define GLISS_TAKE(REAL, T)                                                       \
  template void PlacedPoints<REAL>::take(const PatchCache&, const Surface<REAL>&, \
                                         const PointArrays<T>&, std::size_t, std::size_t);
GLISS_TAKE(float, float)
GLISS_TAKE(float, double)
GLISS_TAKE(double, float)
GLISS_TAKE(double, double)

// Lanes that may be idle for one that is not.
constexpr double kIdle = 0.5;

PatchOrder::Kind PatchOrder::judge(const std::vector<PatchRun>& given, std::size_t patch_count,
                                   std::size_t lanes) {
  const std::size_t points = given.empty() ? 0 : given.back().end;
  const auto fills = [&](const std::vector<PatchRun>& of) {
    std::size_t blocks = 0;
    for (const PatchRun& run : of) {
      const std::size_t length = run.end - run.begin;
      blocks += length <= lanes ? 1 : (length + lanes - 1) / lanes;  // to divide takes long
    }
    return static_cast<double>(blocks * lanes) <= (1 + kIdle) * static_cast<double>(points);
  };
  if (fills(given)) return kInRuns;
  if (count_.size() < patch_count) count_.resize(patch_count, 0);
  runs.clear();
  patch.resize(points);
  for (const PatchRun& run : given) {
    for (std::uint32_t i = run.begin; i < run.end; ++i) patch[i] = run.patch;
    std::uint32_t& count = count_[run.patch];
    if (count == 0) runs.push_back({run.patch, 0, 0});
    count += run.end - run.begin;
  }
  std::uint32_t begin = 0;
  for (PatchRun& run : runs) {
    run.begin = begin;
    run.end = begin += std::exchange(count_[run.patch], 0);
  }
  return fills(runs) ? kByPatch : kSparse;
}

void PatchOrder::sort() {
  for (const PatchRun& run : runs) count_[run.patch] = run.begin;
  order.resize(patch.size());
  for (std::uint32_t i = 0; i < patch.size(); ++i) order[count_[patch[i]]++] = i;
  for (const PatchRun& run : runs) count_[run.patch] = 0;
}

}  // namespace gliss
