// Finds where the corners of a mesh go when its creases are rounded. Private to host/.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "gliss/mesh/face_room.h"
#include "gliss/mesh/sectors.h"
#include "gliss/mesh/topology.h"

namespace gliss {

// The step of a corner, by a radius of 1.
struct CreaseMove {
  Vec3 step = Vec3::Zero();
  // The corner of the face that the step goes into. `ahead` and `back` are its coordinates along
  // that corner's two edges.
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
// `tried`: the radius by which the corners are placed already.
CreaseRoom room_of_creases(const Mesh& mesh, const CreaseSteps& steps, double tried = 0);

// By how much more the radius may grow until a face meets itself, and that face. The corners are
// placed by the radius `tried`, and the place of a vertex by a step moves by speed_of(vertex, step)
// for each 1 that the radius grows.
template <class SpeedOf>
CreaseRoom time_to_meet(const Mesh& mesh, const CreaseSteps& steps, double tried,
                        const SpeedOf& speed_of) {
  CreaseRoom least{std::numeric_limits<double>::infinity(), 0};
  std::vector<Vec3> moves, places, speeds;
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    places.clear(), speeds.clear();
    for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c) {
      const std::uint32_t vertex = mesh.corner_vertex[c];
      moves.clear();
      steps.append_steps(c, moves);
      for (const Vec3& step : moves) {
        places.push_back(mesh.positions[vertex] + tried * step);
        speeds.push_back(speed_of(vertex, step));
      }
    }
    const double time = room_of(places, speeds, newell_normal(places));
    if (time < least.radius) least = {time, face};
  }
  return least;
}

}  // namespace gliss
