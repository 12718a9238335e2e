// The chunks of a sweep's grid: found by their numbers, they are those that a walk over all faces
// cuts.
#include "gliss/sweep/sweep_grid.h"

#include <gtest/gtest.h>

#include <tuple>
#include <utility>

#include "gliss/generate/generate.h"
#include "gliss/sweep/sweep.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

// Chunks have as many faces as 4,096 points hold, or as many rings of one, but at least one.
std::vector<SweepChunk> walked(const SweepGrid& grid, std::size_t faces) {
  constexpr std::uint64_t kMost = 4096;
  const std::uint32_t end = grid.rings() + 1;
  std::vector<SweepChunk> chunks;
  std::uint64_t room = 0;
  for (std::size_t i = 0; i < faces; ++i) {
    const std::uint64_t n = grid.valence(grid.face(i)), size = n * end * (end - 1) / 2;
    if (size <= kMost) {
      if (size > std::exchange(room, room - size)) {
        chunks.push_back({i, i, 1, end});
        room = kMost - size;
      }
      chunks.back().end = i + 1;
      continue;
    }
    room = 0;
    for (std::uint32_t first = 1, last = 1; first < end; first = last) {
      std::uint64_t points = n * last++;
      while (last < end && points + n * last <= kMost) points += n * last++;
      chunks.push_back({i, i + 1, first, last});
    }
  }
  return chunks;
}

TEST(SweepGrid, finds_chunks_by_their_numbers) {
  const PatchCache cache = test::cache_of(goldberg(2).mesh);  // pentagons and hexagons
  for (const std::uint32_t rings : {1, 5, 36, 37, 40, 41, 100, 400, 1000}) {
    const SweepGrid grid(cache, rings);
    const std::vector<SweepChunk> chunks = walked(grid, cache.mesh_face_count);
    ASSERT_EQ(grid.chunk_count(), chunks.size()) << rings;
    std::uint64_t before = 0;
    for (std::size_t c = 0; c < chunks.size(); ++c) {
      const SweepChunk chunk = grid.chunk(c);
      ASSERT_EQ(std::tie(chunk.begin, chunk.end, chunk.first, chunk.last),
                std::tie(chunks[c].begin, chunks[c].end, chunks[c].first, chunks[c].last))
          << rings << " rings, chunk " << c;
      ASSERT_EQ(grid.points_before(c), before);
      for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
        for (std::uint32_t r = chunk.first; r < chunk.last; ++r)
          before += std::uint64_t{r} * grid.valence(grid.face(i));
      }
    }
    EXPECT_EQ(grid.points_before(chunks.size()), sample_count(cache, rings));
  }
}

}  // namespace
}  // namespace gliss
