// Finished parts of a sweep in a folder. Private to Gliss.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/sweep/part_folder.h"
#include "gliss/sweep/sweep.h"

namespace gliss {

// Contents of a part: statistics [depth][method], and blocks [chunk][depth][method] where samples
// are kept.
struct SweepPart {
  std::vector<SweepStatistics> statistics;
  std::vector<SweepBlock> blocks;
};

// The parts of a sweep. Their hash is of the cache and the options: engine, threads and output are
// no matter.
class GLISS_EXPORT SweepParts : public PartFolder {
 public:
  // `samples`: parts keep blocks as well as statistics. The cache must outlive the parts.
  SweepParts(const std::string& folder, const PatchCache& cache, const SweepOptions& options,
             bool samples, PartsAccess access = PartsAccess::kAlone);
  SweepParts(const std::string&, const PatchCache&&, const SweepOptions&, bool,
             PartsAccess access = PartsAccess::kAlone) = delete;

  std::uint64_t surface_hash() const { return surface_hash_; }
  bool keeps_samples() const { return samples_; }

  // Those of a part, without its samples; none where it is not there.
  std::vector<SweepStatistics> statistics(std::size_t part) const;

  // Nothing where the part is not there or cannot be used. Then it is under way: blocks are added,
  // and it is saved. What a part holds is within range, but need not be finite.
  std::optional<SweepPart> load(std::size_t part);
  void add(const SweepBlock& block);
  // Saves the part under way: all that was added.
  void save(std::size_t part, const std::vector<SweepStatistics>& statistics);

 private:
  SweepParts(const std::string& folder, std::uint64_t surface, const PatchCache& cache,
             const SweepOptions& options, bool samples, PartsAccess access);
  std::optional<SweepPart> parse(const PartFile& file) const;
  bool is_in_range(const std::vector<SweepStatistics>& statistics) const;
  bool is_in_range(const SweepPart& part) const;

  const PatchCache& cache_;
  std::uint64_t surface_hash_;
  bool samples_;
  std::vector<double> depths_;
  std::vector<Method> methods_;
  PartFile file_;  // the part under way
};

// The number of parts of a sweep.
GLISS_EXPORT std::size_t part_count(const PatchCache& cache, const SweepOptions& options);

// Does the parts that `source` names, unless they are there, keeps all of them in `parts`, and goes
// no further: a sweep() with these parts takes them from there. Shards do so at the same time, in
// whatever processes, and may do a part twice. Progress counts all samples that stand before what
// is done in the order of the grid, whoever did them. The statistics are of the parts done here.
// The source may wait, with a sink, until others have done a part. One that names every part makes
// it a sweep(); of others the sink has the blocks of the parts that they name.
GLISS_EXPORT SweepResult sweep_parts(const PatchCache& cache, const Engine& engine,
                                     const SweepOptions& options, const PartSource& source,
                                     SweepParts& parts, const SweepProgress& progress = nullptr,
                                     const SweepSink& sink = nullptr);

// The statistics of a sweep whose parts are all there, put together in their order. Throws
// std::runtime_error that names the folder where one is not; their samples are not looked at.
GLISS_EXPORT SweepResult kept_statistics(const PatchCache& cache, const SweepOptions& options,
                                         const SweepParts& parts,
                                         const SweepProgress& progress = nullptr);

}  // namespace gliss
