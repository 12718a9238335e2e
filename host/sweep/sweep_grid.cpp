#include "gliss/sweep/sweep_grid.h"

#include <cmath>
#include <iterator>
#include <numbers>

#include "gliss/surface/layout.h"
#include "gliss/sweep/sweep.h"

namespace gliss {
namespace {

// A chunk has as many whole faces, or as many rings of one large face, as fit, but at least one.
constexpr std::uint64_t kChunkPoints = 4096;

// Points in rings 1 to r.
std::uint64_t grid_size(std::uint32_t n, std::uint64_t r) { return n * r * (r + 1) / 2; }

}  // namespace

std::uint64_t sample_count(const PatchCache& cache, std::uint32_t rings) {
  std::uint64_t count = 0;
  for (std::uint32_t f = 0; f < cache.mesh_face_count; ++f) {
    if (cache.first_patch(f) != kNone) count += grid_size(cache.face_valence[f], rings);
  }
  return count;
}

std::uint32_t rings_for(const PatchCache& cache, std::uint64_t samples) {
  std::uint32_t rings = 1;
  while (sample_count(cache, rings) < samples) ++rings;
  return rings;
}

SweepGrid::SweepGrid(const PatchCache& cache, std::uint32_t rings) : cache_(cache), rings_(rings) {
  require_patches(cache);
  for (std::uint32_t f = 0; f < cache.mesh_face_count; ++f) {
    if (cache.first_patch(f) != kNone) faces_.push_back(f);
  }
  group_faces();
  find_twins();
}

bool SweepGrid::is_large(std::uint32_t valence) const {
  return grid_size(valence, rings_) > kChunkPoints;
}

SweepGrid::Cut SweepGrid::cut_of(std::uint32_t valence) const {
  Cut cut{{1}};
  for (std::uint32_t last = 1; last <= rings_;) {
    const std::uint32_t first = last++;
    while (last <= rings_ &&
           grid_size(valence, last) - grid_size(valence, first - 1) <= kChunkPoints) {
      ++last;
    }
    if (last == first + 1) break;  // so it is for all that follow
    cut.first.push_back(last);
  }
  return cut;
}

std::uint32_t SweepGrid::Cut::ring(std::size_t chunk) const {
  if (chunk < first.size()) return first[chunk];
  return first.back() + static_cast<std::uint32_t>(chunk - first.size() + 1);
}

void SweepGrid::group_faces() {
  std::size_t chunk = 0;
  std::uint64_t points = 0, room = 0;  // in the last group
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    const std::uint32_t n = valence(faces_[i]);
    const std::uint64_t size = grid_size(n, rings_);
    if (size > room) groups_.push_back({i, chunk, points});
    if (is_large(n)) {
      if (!cuts_.contains(n)) cuts_.emplace(n, cut_of(n));
      const std::vector<std::uint32_t>& first = cuts_.at(n).first;
      chunk += first.size() - 1 + (rings_ + 1 - first.back());
      room = 0;
    } else if (size > room) {
      ++chunk;
      room = kChunkPoints - size;
    } else {
      room -= size;
    }
    points += size;
  }
  groups_.push_back({faces_.size(), chunk, points});
}

const SweepGrid::Group& SweepGrid::group_of(std::size_t chunk) const {
  return *std::prev(std::upper_bound(groups_.begin(), groups_.end(), chunk,
                                     [](std::size_t c, const Group& g) { return c < g.chunk; }));
}

SweepChunk SweepGrid::chunk(std::size_t number) const {
  const Group& group = group_of(number);
  const std::uint32_t all = rings_ + 1, n = valence(faces_[group.face]);
  if (!is_large(n)) return {group.face, (&group)[1].face, 1, all};
  const Cut& cut = cuts_.at(n);
  const std::size_t i = number - group.chunk;
  return {group.face, group.face + 1, cut.ring(i), std::min(cut.ring(i + 1), all)};
}

std::uint64_t SweepGrid::points_before(std::size_t number) const {
  const Group& group = group_of(number);
  if (number == group.chunk) return group.points;
  const std::uint32_t n = valence(faces_[group.face]);
  return group.points + grid_size(n, cuts_.at(n).ring(number - group.chunk) - 1);
}

void SweepGrid::find_twins() {
  side_begin_.assign(cache_.mesh_face_count + 1, 0);
  for (std::uint32_t f = 0; f < cache_.mesh_face_count; ++f)
    side_begin_[f + 1] = side_begin_[f] + valence(f);
  twin_.resize(side_begin_.back());
  std::visit(
      [&](const auto& s) {
        for (std::uint32_t side = 0; side < s.side_patch.size(); ++side) {
          const std::uint32_t twin = s.side_twin[side];
          if (twin == kNone || !is_outer_side(cache_, s, side)) continue;
          const std::uint32_t face = cache_.patch_face[s.side_patch[side]];
          const std::uint32_t other = cache_.patch_face[s.side_patch[twin]];
          twin_[side_begin_[face] + cache_.corner_of_face[side]] = {other,
                                                                    cache_.corner_of_face[twin]};
        }
      },
      cache_.surface);
}

void SweepGrid::add_sector(std::uint32_t face, std::uint32_t r, std::uint32_t k,
                           std::vector<DomainPoint>& points) const {
  const std::uint32_t n = valence(face);
  const double radius = (r - 0.5) / rings_;
  const double a = 2 * std::numbers::pi * k / n, b = 2 * std::numbers::pi * (k + 1) / n;
  const double ax = std::cos(a), ay = std::sin(a), bx = std::cos(b), by = std::sin(b);
  for (std::uint32_t i = 0; i < r; ++i) {
    const double t = (i + 0.5) / r;
    points.push_back({face, radius * ((1 - t) * ax + t * bx), radius * ((1 - t) * ay + t * by)});
  }
}

void SweepGrid::add_points(const SweepChunk& chunk, std::vector<DomainPoint>& points) const {
  for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
    for (std::uint32_t r = chunk.first; r <= last_ring(chunk); ++r) {
      for (std::uint32_t k = 0; k < valence(faces_[i]); ++k) add_sector(faces_[i], r, k, points);
    }
    if (!has_neighbours(chunk)) continue;
    for_each_neighbour(faces_[i], [&](std::uint32_t k) {
      const FaceSide& twin = twin_[side_begin_[faces_[i]] + k];
      add_sector(twin.face, rings_, twin.side, points);
    });
  }
}

void SweepGrid::add_own_points(const SweepChunk& chunk, std::vector<DomainPoint>& points) const {
  for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
    for (std::uint32_t r = chunk.first; r < chunk.last; ++r) {
      for (std::uint32_t k = 0; k < valence(faces_[i]); ++k) add_sector(faces_[i], r, k, points);
    }
  }
}

}  // namespace gliss
