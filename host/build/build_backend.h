// A backend computes the patches of a build: the host's threads, or OpenCL.
#pragma once

#include <cstddef>
#include <functional>

#include "gliss/base/export.h"
#include "gliss/base/parallel.h"
#include "gliss/base/poll.h"

namespace gliss {

struct PatchBatch;

// Computes what of a batch is to be computed.
using BatchBuilder = std::function<void(PatchBatch&, const ParallelFor&)>;

// Builds them with the machine's best lanes.
GLISS_EXPORT void build_patches(PatchBatch& batch, const ParallelFor& parallel);

// The backend that a build runs on.
struct BuildBackend {
  ParallelFor parallel = serial_for;
  BatchBuilder build = build_patches;
  // Faces in a batch at most: bounds what is held in addition to the cache. Batches that take long
  // are smaller, and the cache is the same.
  std::size_t chunk = 8192;
  // Told now and then how many of the faces are examined, from the thread that builds.
  std::function<void(std::size_t faces)> progress = [](std::size_t) {};
  Poll poll = {};
};

}  // namespace gliss
