// Files of results that say where they come from.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "gliss/surface/patch_cache.h"
#include "gliss/tables/result_file.h"

namespace gliss {

struct Provenance {
  std::string command_line;  // that makes the file
  std::string surface;       // path of the mesh or the cache
  double unit = 1;           // m, of coordinates in the file
  double crease_radius = 0;  // m; 0: creases are not rounded
};

std::string hash_name(std::uint64_t hash);

// Lets a file say where it comes from: command line, version, mesh, unit of coordinates, precision.
void describe_file(ResultFile& file, const PatchCache& cache, const Provenance& from);
std::unique_ptr<ResultFile> create_described_file(const std::string& path, const PatchCache& cache,
                                                  const Provenance& from);

}  // namespace gliss
