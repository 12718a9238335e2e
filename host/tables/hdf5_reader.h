// Results in HDF5, read back: columns by their paths, attributes of the whole file.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gliss/base/large_array.h"
#include "gliss/base/poll.h"

namespace gliss {

namespace hdf5 {
class Handle;
}

// Everything throws std::runtime_error that names the file. Nothing of another file is read: links,
// raw data and virtual columns that lead there are refused. So are more rows than are stored, and
// columns that unpack to far more than the file has.
class Hdf5Reader {
 public:
  // `what` is what the file is taken for, for messages: "a recording".
  Hdf5Reader(const std::string& path, const std::string& what, Poll poll = {});

  bool has(const std::string& name) const;  // "ticks/x"
  std::size_t rows(const std::string& column) const;
  // Rows that are unpacked together; 1 where they lie in the file as they are.
  std::size_t chunk_rows(const std::string& column) const;
  // A column's entries in every `stride`-th row, from the first; in the rows [begin, end), which it
  // must have.
  LargeArray<double> numbers(const std::string& column, std::size_t stride = 1) const;
  LargeArray<double> numbers(const std::string& column, std::size_t begin, std::size_t end) const;
  // Texts of a fixed length alone: of others, which HDF5 cannot read safely, a column is refused
  // and an attribute is taken for none.
  std::vector<std::string> texts(const std::string& column) const;
  std::optional<std::string> text_attribute(const std::string& name) const;
  std::optional<double> number_attribute(const std::string& name) const;
  // The text of a column's attribute "unit".
  std::optional<std::string> unit(const std::string& column) const;

 private:
  struct Dataset;
  Dataset open(const std::string& column) const;
  LargeArray<double> read(const Dataset& dataset, std::uint64_t begin, std::uint64_t end,
                          std::uint64_t stride) const;
  void check_size(Dataset& dataset) const;
  std::optional<std::string> text_attribute(const hdf5::Handle& of, const std::string& name) const;
  std::uint64_t most_bytes() const;
  void poll() const;

  std::string action_;
  Poll poll_;
  std::uint64_t file_bytes_ = 0;
  std::shared_ptr<const hdf5::Handle> file_;  // shared: what it is remains in one source file
};

}  // namespace gliss
