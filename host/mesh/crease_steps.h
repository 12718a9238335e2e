// Where the corners of a mesh go when its creases are rounded. Private to host/.
#pragma once

#include <cstdint>
#include <vector>

#include "gliss/mesh/sectors.h"
#include "gliss/mesh/topology.h"

namespace gliss {

// The step of a corner, by a radius of 1.
struct CreaseMove {
  Vec3 step = Vec3::Zero();
  // The corner in whose face the step leads, as so much of its edges ahead and back.
  std::uint32_t corner = 0;
  double ahead = 0, back = 0;
};

// Those of a sector: one, or one beside each of its creases, where its corner `opened` (kNone:
// none) has both.
struct SectorMoves {
  CreaseMove first{}, last{};
  std::uint32_t opened = kNone;
  Vec3 between = Vec3::Zero();  // the step of where the lines along both creases meet
};

// The rounding of a mesh's marked creases by a radius of 1, as far as it is the same for each
// radius.
struct CreaseSteps {
  Sectors sectors;                      // normals are those of rounding
  std::vector<double> wide;             // [side], tan(theta / 2) at its start
  std::vector<SectorMoves> moves;       // [sector]
  std::vector<std::uint8_t> is_beyond;  // [corner], 1: it is beyond the one that was opened

  bool is_cut(std::uint32_t side) const { return !sectors.tau[side].isZero(0); }
  // The sector of a corner; kNone where its vertex is not cut.
  std::uint32_t sector_of(std::uint32_t corner) const;
  // The steps of the places where the side ahead of a corner leaves, and where the one before ends:
  // they are one but for a corner that was opened.
  Vec3 step_of(std::uint32_t corner) const;
  Vec3 step_into(std::uint32_t corner) const;
  // Appends the steps of all places that a corner becomes, on the way round its face.
  void append_steps(std::uint32_t corner, std::vector<Vec3>& steps) const;
};

CreaseSteps find_crease_steps(const Mesh& mesh, const Topology& topology);

inline constexpr double kRoom = 0.99;  // of the radius at which a face has no room left

// The least radius at which a face meets itself, and that face; infinite where no corner moves.
struct CreaseRoom {
  double radius;
  std::uint32_t face;
};
CreaseRoom room_of_creases(const Mesh& mesh, const CreaseSteps& steps);

}  // namespace gliss
