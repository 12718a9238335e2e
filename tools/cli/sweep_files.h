// The files that gliss sweep leaves: samples and statistics as tables, and a picture for ParaView.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "gliss/base/units.h"
#include "gliss/study/sweep.h"
#include "gliss/tables/result_table.h"
#include "tools/cli/described_file.h"

namespace gliss::tools {

// HDF5: a group /depth_<d>mm/<method> for each depth and method; CSV: one table with the columns
// depth and method in front. Coordinates are float64 where the cache is in double, forces and
// angles float32.
class SampleFile {
 public:
  SampleFile(const std::string& path, const PatchCache& cache, const SweepOptions& sweep,
             const Provenance& from);
  void add(const SweepBlock& block);
  void close(const SweepResult& result);  // adds the statistics

 private:
  void add_statistics(const SweepResult& result);

  const SweepOptions& sweep_;
  UnitChange length_;
  double unit_;
  bool single_;  // one table for all
  std::unique_ptr<ResultFile> file_;
  std::vector<ResultTable> tables_;  // [depth][method]
};

// HIPs of the first depth with the force of each method, thinned to what a picture needs, and the
// base polygons beside them.
class SweepPicture {
 public:
  static constexpr std::uint64_t kMostPoints = 1'000'000;
  static constexpr std::string_view kEnding = ".vtp";

  SweepPicture(const PatchCache& cache, const SweepOptions& sweep, double unit);
  void add(const SweepBlock& block);
  void write(const std::string& path) const;              // "a.vtp", and mesh_path() beside it
  static std::string mesh_path(const std::string& path);  // "a_mesh.vtp"

 private:
  void write_mesh(const std::string& path) const;

  const PatchCache& cache_;
  const SweepOptions& sweep_;
  UnitChange length_;
  std::uint64_t stride_;
  std::vector<Vec3> hips_;
  std::vector<std::vector<float>> forces_;  // [method][hip][3]
  std::vector<std::uint64_t> seen_;         // [method]
};

}  // namespace gliss::tools
