// Numbers and words out of a table that somebody made: only the columns that a caller wants are
// parsed and kept.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/base/large_array.h"
#include "gliss/base/poll.h"

namespace gliss {

// An error of an HDF5 file; what() names it.
struct GLISS_EXPORT RecordingError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// read_table("points.csv", {.alternatives = {{"x", "y", "z"}, {"x_mm", "y_mm", "z_mm"}}})
struct TableRequest {
  // The first of which the file has all columns is read.
  std::vector<std::vector<std::string>> alternatives;
  std::vector<std::string> optional = {};  // read as well where the file has them
  std::vector<std::string> texts = {};     // likewise, as they stand there
  Poll poll = {};

  // The alternative whose columns are all there; end() where none is.
  std::vector<std::vector<std::string>>::const_iterator choose(
      const std::function<bool(const std::string&)>& is_there) const;
  std::string wanted() const;  // "x,y,z or x_mm,y_mm,z_mm"
};

class GLISS_EXPORT InputTable {
 public:
  std::size_t rows = 0;
  std::size_t alternative = 0;  // index of the one that was read

  // Null where the column was not asked for or is an optional one that the file lacks.
  const LargeArray<double>* find(std::string_view name) const;
  const std::vector<std::string>* find_text(std::string_view name) const;
  // The unit of a column, "mm"; empty where the file names none, as no CSV does.
  std::string unit(std::string_view name) const;
  // "points.csv:17" or "points.h5: row 17" (from 0), for messages about a value.
  std::string place(std::size_t row) const;
  // The rows [begin, end).
  InputTable part(std::size_t begin, std::size_t end) const;

 private:
  friend class CsvParser;
  friend class NpyTable;
  friend class Hdf5Table;
  std::string source_;
  std::size_t first_line_ = 0;  // 0: the file has no lines
  std::size_t first_row_ = 0;   // of what was read
  std::vector<std::string> names_, units_;
  std::vector<LargeArray<double>> values_;
  std::vector<std::string> text_names_;
  std::vector<std::vector<std::string>> texts_;
};

// A table that is read some rows at a time.
class GLISS_EXPORT TableReader {
 public:
  virtual ~TableReader() = default;
  virtual std::size_t rows() const = 0;
  // The rows [begin, end), which it must have. Throws as read_table().
  virtual InputTable read(std::size_t begin, std::size_t end) = 0;
};

// True if the file's ending is that of HDF5: .h5 or .hdf5.
GLISS_EXPORT bool is_hdf5(const std::string& path);
// Reads .h5 and .hdf5 as HDF5, with columns as `gliss` writes them: a dataset each, of the file's
// root; .npy as NumPy's arrays (npy_reader.h); all else as CSV (csv_reader.h). Throws CsvError or
// RecordingError on a missing column and on wanted numbers that are not finite, and what they throw
// where a file cannot be read.
GLISS_EXPORT InputTable read_table(const std::string& path, const TableRequest& request);
// The same some rows at a time: HDF5 and .npy come from the file then, and CSV, whose rows are
// found by reading all, is held in memory; so is HDF5 in chunks of over 131,072 rows, which would
// be unpacked time and again. For one thread.
GLISS_EXPORT std::unique_ptr<TableReader> open_table(const std::string& path,
                                                     const TableRequest& request);

}  // namespace gliss
