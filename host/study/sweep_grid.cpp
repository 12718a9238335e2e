#include "gliss/study/sweep_grid.h"

#include <cmath>
#include <numbers>

#include "gliss/study/sweep.h"
#include "gliss/surface/layout.h"

namespace gliss {
namespace {

constexpr std::uint64_t kChunkPoints = 4096;

// Points in rings 1 to r.
std::uint64_t grid_size(std::uint32_t n, std::uint64_t r) { return n * r * (r + 1) / 2; }

}  // namespace

std::uint64_t sample_count(const PatchCache& cache, std::uint32_t rings) {
  std::uint64_t count = 0;
  for (std::uint32_t f = 0; f < cache.mesh_face_count; ++f) {
    if (cache.face_patch[f] != kNone) count += grid_size(cache.face_valence[f], rings);
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
    if (cache.face_patch[f] != kNone) faces_.push_back(f);
  }
  cut_chunks();
  find_twins();
}

// Cuts chunks of as many faces as fit, or of as many rings of one face.
void SweepGrid::cut_chunks() {
  const std::uint32_t all = rings_ + 1;
  std::uint64_t points = 0;
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    const std::uint32_t n = valence(faces_[i]);
    const std::uint64_t size = grid_size(n, rings_);
    if (size > kChunkPoints) {
      for (std::uint32_t first = 1; first < all;) {
        std::uint32_t last = first + 1;
        while (last < all && grid_size(n, last) - grid_size(n, first - 1) <= kChunkPoints) ++last;
        chunks_.push_back({i, i + 1, first, last});
        first = last;
      }
      points = kChunkPoints;
    } else if (chunks_.empty() || points + size > kChunkPoints) {
      chunks_.push_back({i, i + 1, 1, all});
      points = size;
    } else {
      chunks_.back().end = i + 1;
      points += size;
    }
  }
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

std::uint64_t SweepGrid::own_points(const SweepChunk& chunk) const {
  std::uint64_t count = 0;
  for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
    const std::uint32_t n = valence(faces_[i]);
    count += grid_size(n, chunk.last - 1) - grid_size(n, chunk.first - 1);
  }
  return count;
}

}  // namespace gliss
