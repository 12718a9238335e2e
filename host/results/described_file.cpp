#include "gliss/results/described_file.h"

#include <fmt/format.h>

#include "gliss/results/lengths.h"
#include "gliss/surface/names.h"

namespace gliss {

std::string hash_name(std::uint64_t hash) { return fmt::format("{:016x}", hash); }

void describe_file(ResultFile& file, const PatchCache& cache, const Provenance& from) {
  file.set_attribute({"program", "gliss"});
  file.set_attribute({"version", GLISS_VERSION});
  file.set_attribute({"command_line", from.command_line});
  file.set_attribute({"surface", from.surface});
  file.set_attribute({"mesh_hash", hash_name(cache.mesh_hash)});
  file.set_attribute({"unit", unit_name(from.unit)});
  file.set_attribute({"unit_m", from.unit});
  file.set_attribute({"level", level_name(cache.level)});
  file.set_attribute({"construction", construction_name(cache.level.construction)});
  file.set_attribute({"precision", precision_name(cache.precision())});
  if (from.crease_radius > 0) file.set_attribute({"crease_radius_m", from.crease_radius});
  if (cache.crease_count > 0) file.set_attribute({"creases", std::int64_t{cache.crease_count}});
}

std::unique_ptr<ResultFile> create_described_file(const std::string& path, const PatchCache& cache,
                                                  const Provenance& from) {
  auto file = create_result_file(path);
  describe_file(*file, cache, from);
  return file;
}

}  // namespace gliss
