#include "gliss/query/placed_points.h"

#include <algorithm>

#include "gliss/base/hash_index.h"

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
    const std::uint32_t patch = cache.first_patch(face[run]);
    if (!is_piece_of_face(cache, patch)) {
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

PatchOrder::Kind PatchOrder::judge(const std::vector<PatchRun>& given, std::size_t lanes) {
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
  runs.clear();
  patch.resize(points), run_of_.resize(points);
  HashIndex index(given.size());  // numbers of patches are dense, and their own hash
  for (const PatchRun& run : given) {
    const auto new_run = static_cast<std::uint32_t>(runs.size());
    const std::uint32_t at = index.find_or_insert(
        new_run, run.patch,
        [&](std::uint32_t held, std::uint32_t) { return runs[held].patch == run.patch; });
    if (at == new_run) runs.push_back({run.patch, 0, 0});
    runs[at].end += run.end - run.begin;
    std::fill(&patch[run.begin], &patch[run.begin] + (run.end - run.begin), run.patch);
    std::fill(&run_of_[run.begin], &run_of_[run.begin] + (run.end - run.begin), at);
  }
  std::uint32_t begin = 0;
  for (PatchRun& run : runs) {
    run.begin = begin;
    begin = run.end += begin;
  }
  return fills(runs) ? kByPatch : kSparse;
}

void PatchOrder::sort() {
  next_.clear();
  for (const PatchRun& run : runs) next_.push_back(run.begin);
  order.resize(patch.size());
  for (std::uint32_t i = 0; i < patch.size(); ++i) order[next_[run_of_[i]]++] = i;
}

}  // namespace gliss
