// Finished parts of a sweep in a folder, so that a sweep that was stopped or killed at whatever
// moment goes on where it was.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/base/stopwatch.h"
#include "gliss/study/sweep.h"

namespace gliss {

// Contents of a part, or of the beginning of one that took long: statistics [depth][method] of its
// first chunks, and their blocks where samples are kept.
struct SweepPart {
  std::vector<SweepStatistics> statistics;
  std::vector<SweepBlock> blocks;
  std::size_t chunks = 0;
  // Chunks behind these that were under way, and what was found of their first HIPs, in the sweep's
  // own form: reals[HIP][method][kContactReals], of which the last are whole numbers from 0 on.
  std::size_t begun = 0;
  std::vector<double> contacts;
  static constexpr std::size_t kContactReals = 11, kContactCounts = 7;  // where those begin
};

// Who else may work in the folder meanwhile.
enum class PartsAccess {
  kAlone,   // nobody: for a sweep that removes the parts in the end
  kShared,  // whoever shares it: for shards
};

// A part is a file of its own that is there as a whole or not at all, with a checksum. Its name
// says of which sweep it is: cache, options and the revision of the numbers
// (gliss/surface/revision.h). What is of another sweep, or damaged, is never read, and what is of
// another stays. Engine, threads and output are no matter. Failures of files throw
// std::system_error.
class GLISS_EXPORT SweepParts {
 public:
  // Creates the folder where it is not there, for this user alone. Throws std::runtime_error where
  // another process works in it that does not share it, and where others could leave parts: in what
  // is no folder but a link to one, and in folders that belong to another user or that all may
  // write to. `samples`: parts keep blocks besides statistics. `patience`: seconds of work after
  // which a part is saved though it is not whole. The cache must outlive the parts.
  SweepParts(const std::string& folder, const PatchCache& cache, const SweepOptions& options,
             bool samples, double patience = 3, PartsAccess access = PartsAccess::kAlone);
  SweepParts(const std::string&, const PatchCache&&, const SweepOptions&, bool, double patience = 3,
             PartsAccess access = PartsAccess::kAlone) = delete;
  // Removes the folder if it is empty, was made by a sweep and is not shared.
  ~SweepParts();
  SweepParts(const SweepParts&) = delete;
  SweepParts& operator=(const SweepParts&) = delete;

  const std::string& folder() const { return folder_; }
  std::uint64_t hash() const { return hash_; }  // of the sweep: surface, options and numbers
  std::uint64_t surface_hash() const { return surface_hash_; }
  bool keeps_samples() const { return samples_; }
  std::size_t kept() const { return kept_; }        // parts that are there, as far as is known
  std::size_t foreign() const { return foreign_; }  // files of other sweeps
  const std::vector<std::string>& damaged() const { return damaged_; }  // files met so far
  // True if the part is there by now and whole, by its head alone.
  bool is_whole(std::size_t part) const;
  std::size_t whole() const;  // how many are

  // Those of a part that is whole, without its samples; none where it is not.
  std::vector<SweepStatistics> statistics(std::size_t part) const;

  // Nothing where the part is not there or cannot be used. Then, and where it is not whole, it is
  // under way: blocks are added, those that were loaded first, and it is saved. What a part holds
  // is within range, but need not be finite.
  std::optional<SweepPart> load(std::size_t part);
  // Removes a part that was loaded and turned out to be damaged.
  void discard(std::size_t part);
  void add(const SweepBlock& block);
  // True if nothing was loaded or saved for longer than the patience.
  bool is_due() const { return clock_.seconds() - saved_ > patience_; }
  // Saves the part under way: all that was added, `chunks` in number, and the contacts of those
  // that are begun, if there are any.
  void save(std::size_t part, const std::vector<SweepStatistics>& statistics, std::size_t chunks,
            std::size_t begun = 0, std::span<const double> contacts = {});

  // Removes all parts of this sweep: its result is safe elsewhere. Where the folder is shared they
  // stay, and it is false, unless nobody else has it by now.
  bool remove();

  // Leaves a mark in the folder, looks for it, and removes it: for processes that must know whether
  // their folders of one name are one folder.
  void leave_mark(std::uint64_t mark) const;
  bool has_mark(std::uint64_t mark) const;
  void remove_mark(std::uint64_t mark) const;

 private:
  void open_folder();
  bool open_once();
  std::optional<SweepPart> read(std::size_t part) const;
  bool is_in_range(const std::vector<SweepStatistics>& statistics) const;
  bool is_in_range(const SweepPart& part) const;
  std::string path_of(std::size_t part) const;
  std::string path_of_mark(std::uint64_t mark) const;
  [[noreturn]] void fail(const char* action) const;
  [[noreturn]] void refuse(const char* why) const;

  const PatchCache& cache_;
  std::uint64_t hash_ = 0, surface_hash_ = 0;
  std::string folder_, key_;  // the hash, which the names of its files begin with
  PartsAccess access_;
  bool samples_, made_ = false;
  int lock_ = -1;
  std::vector<double> depths_;
  std::vector<Method> methods_;
  double patience_;
  Stopwatch clock_;
  std::atomic<double> saved_ = 0;  // s, when a part was saved or loaded last
  std::size_t kept_ = 0, foreign_ = 0;
  std::vector<std::string> damaged_;
  std::string file_;       // the part under way
  bool is_there_ = false;  // its file
};

}  // namespace gliss
