// Hands that press into a mesh anywhere, slide on there, leave it and rest outside: what walks at
// one depth never do. A contact that goes on then is a fault.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/base/parallel.h"
#include "gliss/mesh/topology.h"
#include "gliss/walk/held_outside.h"

namespace gliss {

struct LeavingOptions {
  std::size_t hands = 40;
  std::size_t rest = 200;  // ticks that a hand rests at its end, 1 ms each
  std::uint64_t seed = 1;
};

// The HIPs of each hand, one a tick, in the mesh's unit. With D the diagonal of the mesh's bounding
// box, sizes are about evenly spread by their logarithm.
// - A hand begins 0.02 D above the mesh, over a place chosen by area. It presses in along the
// normal
//   or up to 63 degrees aslant, by 0.0005 to 0.2 D; one in eight by any share of the way to the far
//   side, and one in eight right through. Three in ten go exactly centrally: from any place or a
//   vertex towards the middle of the box, from a vertex along its normal, or through that middle
//   along an axis.
// - Most slide on from there for 10 to 400 ticks, half a D at most, along a way across the press
//   that turns slowly.
// - It leaves straight back, on through, or in any direction, until it is outside of the base mesh
//   by 0.0001 to 0.1 D or of the whole box, and rests there.
// The speed of each of the three ways is 5e-5 to 2e-2 D a tick: 5 to 2,000 mm/s for a mesh of 100
// mm at 1 kHz. A way takes 3,000 ticks at most; longer ones are quicker. Deterministic by the seed,
// on any number of threads; the hands of fewer are the first of those of more. The mesh must have
// vertex normals.
GLISS_EXPORT std::vector<std::vector<Vec3>> leaving_paths(const Mesh& mesh,
                                                          const Topology& topology,
                                                          const LeavingOptions& options,
                                                          const ParallelFor& parallel = serial_for);

// Counts what a tracker of its own holds of each hand.
GLISS_EXPORT HeldContacts feel_leaving(const PatchCache& cache, const QueryOptions& options,
                                       std::span<const std::vector<Vec3>> hands,
                                       const ParallelFor& parallel = serial_for);

}  // namespace gliss
