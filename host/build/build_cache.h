// From a mesh to its patch cache.
#pragma once

#include <cstdint>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/build/build_backend.h"
#include "gliss/build/complete_mesh.h"
#include "gliss/mesh/mesh.h"
#include "gliss/mesh/topology.h"
#include "gliss/surface/patch_cache.h"

namespace gliss {

struct BuildOptions {
  Precision precision = Precision::kDouble;
  Level level{};
  bool tame = true;  // false: folded patches are found and flagged, and kept as they are
  std::vector<std::uint32_t> faces{};  // only these, each once, ascending; empty: all
  // A cache of the same mesh, or none: what it says of the whole mesh (frame, hash, valences) is
  // shared with it. So a few faces are built at the price of these alone, however large the mesh
  // is.
  const PatchCache* like = nullptr;
};

// Findings of a build, by face.
struct BuildReport {
  std::uint32_t folded = 0;  // the exact patch's normal turns against its face somewhere
  // A ribbon vanishes: an edge parallel to a normal, or opposed end normals.
  std::uint32_t degenerate = 0;
  std::uint32_t eased = 0, split = 0, bent = 0;
  std::vector<std::uint32_t> flagged_faces;  // folded or degenerate, ascending
};

// Builds all patches, or those of options.faces. The mesh must be validated; it is completed
// (complete_mesh). Throws MeshError.
GLISS_EXPORT PatchCache build_cache(const Mesh& mesh, const BuildOptions& options = {},
                                    BuildReport* report = nullptr,
                                    const BuildBackend& backend = {});

// The same of a mesh that is completed, with its topology, for builds of many regions.
GLISS_EXPORT PatchCache build_cache(const Mesh& mesh, const Topology& topology,
                                    const BuildOptions& options, BuildReport* report = nullptr,
                                    const BuildBackend& backend = {});

// Base polygons alone, for searches with the flat and shaded methods: no patch is built and none
// may be evaluated. Throws MeshError for a mesh without faces.
GLISS_EXPORT PatchCache build_base(const Mesh& mesh, const Topology& topology, Precision precision,
                                   const BuildBackend& backend = {});

}  // namespace gliss
