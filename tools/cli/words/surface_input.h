// Input of commands: a mesh or a cache, and points in whatever unit they come.
#pragma once

#include <string>
#include <vector>

#include "gliss/base/units.h"
#include "gliss/build/build_cache.h"
#include "gliss/results/described_file.h"
#include "gliss/results/lengths.h"
#include "gliss/tables/point_table.h"
#include "gliss/tables/result_table.h"
#include "gliss/validate/validate.h"
#include "tools/cli/words/command.h"

namespace gliss::tools {

// Reads, repairs and rounds creases; what was repaired is said on stderr. `tells_of_creases`: says
// as well what tell_creases does.
Mesh read_mesh(const SurfaceOptions& options, bool tells_of_creases = false);

// The mesh of the options, repaired, with its creases marked, not rounded; appends what was found.
Mesh load_mesh(const SurfaceOptions& options, std::vector<Finding>& findings);

// "removed faces 3,7, those behind have moved up", or "" where none is.
std::string removed_text(const Mesh& mesh);

// Points of a file, with further columns where it has them; as read_points(), with progress.
PointTable read_hips(const SurfaceOptions& options, const std::string& path,
                     const std::vector<std::string>& further = {});

// The same some rows at a time.
PointReader open_hips(const SurfaceOptions& options, const std::string& path,
                      const std::vector<std::string>& further = {});

// --keep LIST: columns of numbers that go from the table that is read to the one that is written.
void add_keep_option(Command& command, std::vector<std::string>& names);
// Throws InputError for the first that the table has not.
void check_kept(const std::vector<std::string>& names, const InputTable& table,
                const std::string& path);

// Rounds the marked creases where the options say so.
void round_creases(const SurfaceOptions& options, Mesh& mesh);

// Says how many creases the usual rule marks, or by which angle `--crease auto` does or would.
void tell_creases(const SurfaceOptions& options, const Mesh& mesh);

// Builds with progress, and ends by Ctrl-C. `faces` empty: all.
PatchCache build(const Mesh& mesh, const SurfaceOptions& options, const Engine& engine,
                 BuildOptions build_options = {}, BuildReport* report = nullptr);
std::string built_text(const BuildReport& report);  // "folded 1, degenerate 0; eased 1, ..."
Json built_json(const BuildReport& report);         // the same five counts

// True if the surface is a cache, or is meant as one.
bool is_cache(const SurfaceOptions& options);
// Throws CacheError where it is not of the wanted precision, InputError where creases are asked
// for.
PatchCache read_cache(const SurfaceOptions& options);

// The mesh of a cache. Throws InputError, with what else to do, where the cache does not keep it.
Mesh mesh_of(const SurfaceOptions& options, const PatchCache& cache, const std::string& cure);
// HIPs `depth` (m) beneath the surface, a thousandth of its diagonal apart, in the mesh's unit.
// Throws InputError where no edge can be crossed.
std::vector<Vec3> own_path(const Mesh& mesh, const Topology& topology, const PatchCache& cache,
                           double depth, int ticks);

// A cache as it is, a mesh built. Throws CacheError where a cache is not of the wanted precision.
PatchCache open_surface(const SurfaceOptions& options, const Engine& engine);

// The same of a command.
Provenance provenance_of(const SurfaceOptions& options);
std::unique_ptr<ResultFile> create_described_file(const std::string& path, const PatchCache& cache,
                                                  const SurfaceOptions& options);

}  // namespace gliss::tools
