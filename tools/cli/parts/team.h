// Processes that share one piece of work.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "gliss/sweep/part_folder.h"
#include "gliss/tables/plain_file.h"

namespace gliss::tools {

// The members that do the parts of some work together: the ranks of gliss-mpi. All of them call the
// same functions in the same order; those that wait for others answer Ctrl-C with the exception
// Interrupted.
class Team {
 public:
  virtual ~Team() = default;
  virtual std::size_t size() const = 0;
  virtual std::size_t rank() const = 0;       // 0 is the one that writes the result
  virtual std::size_t next_part() const = 0;  // each number once, to whoever asks first
  virtual int threads() const = 0;            // that this member can keep busy
  // The texts of all members, by rank, once all have come here.
  virtual std::vector<std::string> gather(const std::string& text) const = 0;
  // Adds up those of all members, which have as many; all have the sums then.
  virtual void sum(std::vector<std::uint64_t>& values) const = 0;
  virtual std::string name_of(std::size_t rank) const = 0;  // "rank 2 on node17"
  // Lets others have their numbers of parts. To be called several times a second.
  virtual void answer() const = 0;
  // Lets all members open an HDF5 file together; empty where they cannot.
  virtual Hdf5Access hdf5_access() const = 0;
};

// Throws InputError, in all members, where a text differs from that of rank 0.
void agree(const Team& team, const std::string& what, const std::string& text,
           const std::string& cure);
// Throws InputError, in all members, where one of them has another folder of that name.
void agree_on_folder(const Team& team, const PartFolder& parts);
std::uint64_t sum(const Team& team, std::uint64_t value);               // of all members
std::string text_of_rank_0(const Team& team, const std::string& text);  // of any length

// Shares the temporary of a file that rank 0 creates: its path. Throws InputError, in all members,
// where one of them does not see it.
std::string shared_path(const Team& team, const std::string& temporary);
// Finds the hashes of all blocks of a file that rank 0 names, each member its share of them.
std::vector<std::uint64_t> shared_hashes(const Team& team, const std::string& path);

}  // namespace gliss::tools
