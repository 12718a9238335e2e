// HDF5 files whose rows have their places from the beginning, so that many processes can write one.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "gliss/tables/result_file.h"

namespace gliss {

// Sets how HDF5 opens a file: a file access property list, which is a hid_t.
using Hdf5Access = std::function<void(std::int64_t list)>;

// Columns lie contiguously, uncompressed, each as long as its table is expected to be. One process
// creates the file, and others join it. Bytes depend on what is written and where, and on where
// reopen() is called, but not on who wrote which rows in what order.
class PlainFile : public ResultFile {
 public:
  // Lets the next append() begin with this row. Rows that are never written are zeros.
  virtual void seek(TableId table, std::uint64_t row) = 0;
  // Closes the file as it is, and opens it again, with `access` if there is one. Where that is
  // MPI-IO all processes have to call it, or join: and in the end, before anything but append() and
  // seek(), reopen() or close(). Until then a file that is destroyed stays open: closing it would
  // wait for the others, of which one may have failed.
  virtual void reopen(const Hdf5Access& access = nullptr) = 0;
  virtual const std::string& temporary_path() const = 0;  // of the file until it is closed
};

// Finds the hashes of all blocks of a file (file_seal.h).
using BlockHashes = std::function<std::vector<std::uint64_t>(const std::string& path)>;

// Creates a file as create_result_file does. Tables need their expected_rows, and are added before
// their rows; close() seals the file by `hashes`.
std::unique_ptr<PlainFile> create_plain_file(const std::string& path, const BlockHashes& hashes);
// Opens the temporary of a file that another process creates under `path`. Here add_table() names
// tables that are there, in the same order; attributes are the other's matter, and so is what
// follows close().
std::unique_ptr<PlainFile> join_plain_file(const std::string& temporary, const std::string& path,
                                           const Hdf5Access& access);

}  // namespace gliss
