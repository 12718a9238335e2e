// Results in HDF5, read back: columns by their paths, attributes of the whole file.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gliss {

namespace hdf5 {
class Handle;
}

// Everything throws std::runtime_error that names the file.
class Hdf5Reader {
 public:
  // `what` is what the file is taken for, for messages: "a recording".
  Hdf5Reader(const std::string& path, const std::string& what);

  bool has(const std::string& name) const;  // "ticks/x"
  std::size_t rows(const std::string& column) const;
  // A column's entries in every `stride`-th row, from the first.
  std::vector<double> numbers(const std::string& column, std::size_t stride = 1) const;
  std::vector<std::string> texts(const std::string& column) const;
  std::optional<std::string> text_attribute(const std::string& name) const;

 private:
  struct Dataset;
  Dataset open(const std::string& column) const;

  std::string action_;
  std::shared_ptr<const hdf5::Handle> file_;  // shared: what it is remains in one source file
};

}  // namespace gliss
