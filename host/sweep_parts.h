// Finished parts of a sweep in a folder, so that a sweep that was stopped or killed at whatever
// moment goes on where it was.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/sweep.h"

namespace gliss {

// A part is a file of its own that is there as a whole or not at all, with a checksum. Its name
// says of which sweep it is: cache, options and version of Gliss. What is of another sweep, or
// damaged, is never read, and what is of another stays. Engine, threads and output are no matter.
// Failures of files throw std::system_error.
class SweepParts {
 public:
  // Creates the folder where it is not there. Throws std::runtime_error where another process works
  // in it. `samples`: parts keep blocks besides statistics.
  SweepParts(const std::string& folder, const PatchCache& cache, const SweepOptions& options,
             bool samples);
  ~SweepParts();  // removes the folder if it is empty
  SweepParts(const SweepParts&) = delete;
  SweepParts& operator=(const SweepParts&) = delete;

  const std::string& folder() const { return folder_; }
  std::size_t kept() const { return kept_; }        // parts that are there, sound or not
  std::size_t foreign() const { return foreign_; }  // files of other sweeps
  const std::vector<std::string>& damaged() const { return damaged_; }  // files met so far

  // Hands over the blocks of a part, and its statistics [depth][method]. False where it is not
  // there or damaged: then it is under way, blocks are added, and it is saved.
  bool load(std::size_t part, std::vector<SweepStatistics>& statistics, const SweepSink& sink);
  void add(const SweepBlock& block);
  void save(std::size_t part, const std::vector<SweepStatistics>& statistics);

  void remove();  // all parts of this sweep: its result is safe elsewhere

 private:
  void begin();
  std::string path_of(std::size_t part) const;
  [[noreturn]] void fail(const char* action) const;

  std::string folder_, key_;  // of the sweep, which the names of its files begin with
  bool samples_;
  int lock_ = -1;
  std::size_t depths_, methods_, kept_ = 0, foreign_ = 0;
  std::vector<std::string> damaged_;
  std::string file_;  // the part under way
};

}  // namespace gliss
