#include "gliss/build/hierarchy.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "gliss/surface/instances.h"
#include "gliss/surface/layout.h"

namespace gliss {
namespace {

struct Range {
  std::uint32_t begin, end;  // of the order
  std::uint32_t node;        // where its nodes begin: a range of m patches owns m - 1 nodes
};

Box box_of(const std::vector<Box>& boxes, const std::vector<std::uint32_t>& order,
           std::uint32_t begin, std::uint32_t end) {
  Box all = boxes[order[begin]];
  for (std::uint32_t i = begin + 1; i < end; ++i) all.hold(boxes[order[i]]);
  return all;
}

// Rounded outward, so that a box in float holds what it held in double.
template <class Real>
void store(const Box& box, Real* at) {
  for (int i = 0; i < 3; ++i) {
    const double slack = 4 * static_cast<double>(std::numeric_limits<Real>::epsilon());
    at[i] = static_cast<Real>(box.low[i] - slack);
    at[3 + i] = static_cast<Real>(box.high[i] + slack);
  }
}

template <class Real>
class Builder {
 public:
  Builder(const std::vector<Box>& boxes, LargeArray<Real>& node, LargeArray<std::uint32_t>& child)
      : boxes_(boxes), order_(boxes.size()), node_(node), child_(child) {
    std::iota(order_.begin(), order_.end(), 0u);
    node_.assign((boxes.size() - 1) * kNodeReals, Real(0));
    child_.assign((boxes.size() - 1) * 2, 0u);
  }

  // Splits ranges level by level until there are enough to share out, then each by itself.
  void run(const ParallelFor& parallel) {
    std::vector<Range> level;  // a single patch needs no node
    if (order_.size() > 1) level.push_back({0, static_cast<std::uint32_t>(order_.size()), 0});
    while (!level.empty() && level.size() < kShared) {
      std::vector<Range> next(2 * level.size());
      parallel(level.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) split(level[i], &next[2 * i]);
      });
      std::erase_if(next, [](const Range& r) { return r.end - r.begin < 2; });
      level = std::move(next);
    }
    parallel(level.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) finish(level[i]);
    });
  }

 private:
  static constexpr std::size_t kShared = 64;

  void split(const Range& range, Range* halves) {
    const auto centre = [&](std::uint32_t patch, int axis) {
      return boxes_[patch].low[axis] + boxes_[patch].high[axis];
    };
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (std::uint32_t i = range.begin; i < range.end; ++i) {
      const Vec3 c = boxes_[order_[i]].low + boxes_[order_[i]].high;
      low = low.cwiseMin(c);
      high = high.cwiseMax(c);
    }
    int axis = 0;
    (high - low).maxCoeff(&axis);
    const std::uint32_t middle = range.begin + (range.end - range.begin) / 2;
    const auto at = [&](std::uint32_t i) {
      return order_.begin() + static_cast<std::ptrdiff_t>(i);
    };
    std::nth_element(at(range.begin), at(middle), at(range.end),
                     [&](std::uint32_t a, std::uint32_t b) {
                       const double ca = centre(a, axis), cb = centre(b, axis);
                       return ca < cb || (ca == cb && a < b);
                     });
    halves[0] = {range.begin, middle, range.node + 1};
    halves[1] = {middle, range.end, range.node + (middle - range.begin)};
    for (int side = 0; side < 2; ++side) {
      const Range& half = halves[side];
      store(box_of(boxes_, order_, half.begin, half.end),
            &node_[range.node * kNodeReals + 6 * side]);
      child_[2 * std::size_t{range.node} + static_cast<std::size_t>(side)] =
          half.end - half.begin == 1 ? order_[half.begin] | kNodeLeaf : half.node;
    }
  }

  void finish(const Range& range) {
    if (range.end - range.begin < 2) return;
    Range halves[2];
    split(range, halves);
    finish(halves[0]);
    finish(halves[1]);
  }

  const std::vector<Box>& boxes_;
  std::vector<std::uint32_t> order_;
  LargeArray<Real>& node_;
  LargeArray<std::uint32_t>& child_;
};

}  // namespace

template <class Real>
void build_hierarchy(const std::vector<Box>& boxes, LargeArray<Real>& node,
                     LargeArray<std::uint32_t>& child, const ParallelFor& parallel) {
  Builder<Real>(boxes, node, child).run(parallel);
}

template void build_hierarchy(const std::vector<Box>&, LargeArray<float>&,
                              LargeArray<std::uint32_t>&, const ParallelFor&);
template void build_hierarchy(const std::vector<Box>&, LargeArray<double>&,
                              LargeArray<std::uint32_t>&, const ParallelFor&);

}  // namespace gliss
