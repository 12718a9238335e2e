// The files that gliss sweep leaves: samples and statistics as tables, and a picture for ParaView.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "host/sweep.h"
#include "tools/result_table.h"
#include "tools/surface_input.h"

namespace gliss::tools {

// HDF5: a group /depth_<d>mm/<method> for each depth and method; CSV: one table with the columns
// depth and method in front. Coordinates are float64 where the cache is in double, forces and
// angles float32.
class SampleFile {
 public:
  SampleFile(const std::string& path, const PatchCache& cache, const SweepOptions& sweep,
             double unit);
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

  SweepPicture(const PatchCache& cache, const SweepOptions& sweep, double unit);
  void add(const SweepBlock& block);
  void write(const std::string& path) const;  // and <path>_mesh.vtp

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

// The distributions of a depth and method, by the names that files and tables give them.
struct NamedHistogram {
  const char *name, *unit;
  Histogram SweepStatistics::*histogram;
};
inline constexpr NamedHistogram kHistograms[] = {{"step", "N", &SweepStatistics::step},
                                                 {"edge_step", "N", &SweepStatistics::edge_step},
                                                 {"angle", "rad", &SweepStatistics::angle},
                                                 {"error", "N", &SweepStatistics::error},
                                                 {"residual", "rad", &SweepStatistics::residual}};

std::string depth_name(double depth);  // "2mm"

}  // namespace gliss::tools
