// The files that gliss sweep leaves: samples and statistics as tables, and a picture for ParaView.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "gliss/base/units.h"
#include "gliss/results/described_file.h"
#include "gliss/sweep/sweep.h"
#include "gliss/tables/plain_file.h"
#include "gliss/tables/table_columns.h"

namespace gliss {

// HDF5: a group /depth_<d>mm/<method> for each depth and method; CSV: one table with the columns
// depth and method in front. Coordinates are float64 where the cache is in double, forces and
// angles float32.
class SampleFile {
 public:
  SampleFile(const std::string& path, const PatchCache& cache, const SweepOptions& sweep,
             const Provenance& from);
  // HDF5 whose samples have their places from the beginning. They may come in any order of parts.
  static SampleFile create_plain(const std::string& path, const PatchCache& cache,
                                 const SweepOptions& sweep, const Provenance& from,
                                 const BlockHashes& hashes);
  // One that another process creates, and shares by the same access. `unit` is that of its
  // coordinates, in m.
  static SampleFile join(const std::string& temporary, const std::string& path,
                         const PatchCache& cache, const SweepOptions& sweep, double unit,
                         const Hdf5Access& access);

  void add(const SweepBlock& block);
  void close(const SweepResult& result);  // adds the statistics

  // Shares a plain file with those that join. From now on, as where it is joined, samples wait for
  // write(), which the thread that opened the file has to call after each part. All leave() and
  // close() it together.
  void share(const Hdf5Access& access);
  void write();
  void leave();
  const std::string& temporary_path() const { return plain_->temporary_path(); }

 private:
  SampleFile(std::unique_ptr<ResultFile> file, PlainFile* plain, bool single,
             const PatchCache& cache, const SweepOptions& sweep, double unit);
  void add_statistics(const SweepResult& result);

  const SweepOptions& sweep_;
  bool single_;  // one table for all
  TableColumns<SweepBlock> columns_;
  std::unique_ptr<ResultFile> file_;
  PlainFile* plain_;  // the same, where it is one
  bool waits_ = false;
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

}  // namespace gliss
