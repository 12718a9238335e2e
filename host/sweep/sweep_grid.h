// The points that a sweep samples: rings of points on every face, cut into chunks that are the same
// whatever computes them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <vector>

#include "gliss/query/query.h"
#include "gliss/surface/patch_cache.h"

namespace gliss {

// Some faces [begin, end) of the grid's list, their rings [first, last): whole faces, or some rings
// of one large face.
struct SweepChunk {
  std::size_t begin, end;
  std::uint32_t first, last;
};

// Ring r = 1 ... rings of a face has r points in each sector, at (r - 1/2) / rings of the way to
// the side; so a side and its twin have the same number of points beside them, in opposite order.
// Memory is that of some numbers a face, however many rings there are.
class SweepGrid {
 public:
  SweepGrid(const PatchCache& cache, std::uint32_t rings);

  std::uint32_t rings() const { return rings_; }
  std::size_t chunk_count() const { return groups_.back().chunk; }
  SweepChunk chunk(std::size_t number) const;
  // The points that chunks [0, number) sample themselves; all of them for chunk_count().
  std::uint64_t points_before(std::size_t number) const;
  std::uint32_t face(std::size_t i) const { return faces_[i]; }
  std::uint32_t valence(std::uint32_t face) const { return cache_.face_valence[face]; }
  // The points of a chunk's faces, in this order: its rings, one ring more unless they end with the
  // last, else `rings` points of every neighbour with a higher number, along their edge.
  void add_points(const SweepChunk& chunk, std::vector<DomainPoint>& points) const;
  // Adds those that the chunk itself samples: without the further ring and neighbours.
  void add_own_points(const SweepChunk& chunk, std::vector<DomainPoint>& points) const;
  std::uint32_t last_ring(const SweepChunk& chunk) const { return std::min(chunk.last, rings_); }
  bool has_neighbours(const SweepChunk& chunk) const { return chunk.last > rings_; }
  // Calls visit(side) for the sides of a face with such neighbours.
  template <class Visit>
  void for_each_neighbour(std::uint32_t face, Visit visit) const {
    for (std::uint32_t k = 0; k < valence(face); ++k) {
      const FaceSide& twin = twin_[side_begin_[face] + k];
      if (twin.face != kNone && twin.face > face) visit(k);
    }
  }

 private:
  // Sides of whole faces: the outer sides of their patches.
  struct FaceSide {
    std::uint32_t face = kNone, side = 0;
  };
  // Faces from `face` on, up to those of the next group: one chunk of whole faces, or one large
  // face of many.
  struct Group {
    std::size_t face, chunk;  // the first of them
    std::uint64_t points;     // before it
  };
  // How large faces of a valence are cut: chunk i begins with ring first[i], and each behind these
  // has one ring.
  struct Cut {
    std::vector<std::uint32_t> first;
    std::uint32_t ring(std::size_t chunk) const;
  };
  bool is_large(std::uint32_t valence) const;
  Cut cut_of(std::uint32_t valence) const;
  void group_faces();
  const Group& group_of(std::size_t chunk) const;
  void find_twins();
  void add_sector(std::uint32_t face, std::uint32_t r, std::uint32_t k,
                  std::vector<DomainPoint>& points) const;

  const PatchCache& cache_;
  std::uint32_t rings_;
  std::vector<std::uint32_t> faces_;
  std::vector<Group> groups_;            // and the end
  std::map<std::uint32_t, Cut> cuts_;    // by valence
  std::vector<std::size_t> side_begin_;  // [face + 1]
  std::vector<FaceSide> twin_;           // [face side]
};

}  // namespace gliss
