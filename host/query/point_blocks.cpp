#include "gliss/query/point_blocks.h"

#include <algorithm>
#include <numeric>

namespace gliss {

constexpr std::size_t kLeastRun = 32;  // points of a patch in a row that need no sorting

template <class Real>
void block_points(const PatchCache& cache, const Surface<Real>& s,
                  std::span<const DomainPoint> points, std::size_t lanes,
                  PointBlocks<Real>& blocks) {
  blocks.lanes = lanes;
  blocks.patch.clear();
  blocks.xi.clear();
  blocks.eta.clear();
  blocks.slot.resize(points.size());
  blocks.patch_of.resize(points.size());
  thread_local std::vector<PatchPlace> places;
  places.resize(points.size());
  std::size_t runs = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    places[i] = place_of(cache, s, points[i]);
    runs += i == 0 || places[i].patch != places[i - 1].patch;
  }
  thread_local std::vector<std::uint32_t> order;
  order.resize(points.size());
  std::iota(order.begin(), order.end(), 0u);
  // Neighbours of one valence take the same way through a kernel.
  if (kLeastRun * runs > points.size()) {
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      const std::uint32_t p = places[a].patch, q = places[b].patch, m = s.valence(p),
                          n = s.valence(q);
      return m != n ? m < n : p < q;
    });
  }
  std::size_t filled = lanes;  // of the last block
  for (const std::uint32_t i : order) {
    const PatchPlace& place = places[i];
    const auto xi = static_cast<Real>(place.xi), eta = static_cast<Real>(place.eta);
    if (filled == lanes || blocks.patch.back() != place.patch) {
      blocks.patch.push_back(place.patch);
      blocks.xi.resize(blocks.slots(), xi);
      blocks.eta.resize(blocks.slots(), eta);
      filled = 0;
    }
    const std::size_t slot = blocks.slots() - lanes + filled++;
    blocks.xi[slot] = xi;
    blocks.eta[slot] = eta;
    blocks.patch_of[i] = place.patch;
    blocks.slot[i] = static_cast<std::uint32_t>(slot);
  }
}

template void block_points(const PatchCache&, const Surface<float>&, std::span<const DomainPoint>,
                           std::size_t, PointBlocks<float>&);
template void block_points(const PatchCache&, const Surface<double>&, std::span<const DomainPoint>,
                           std::size_t, PointBlocks<double>&);

}  // namespace gliss
