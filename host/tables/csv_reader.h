// Numbers and words out of CSV files: a header, then rows; only the columns that a caller wants are
// parsed and kept.
#pragma once

#include <cstddef>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "gliss/base/export.h"

namespace gliss {

// what() names the file, the line and the column.
struct GLISS_EXPORT CsvError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// read_csv("points.csv", {.alternatives = {{"x", "y", "z"}, {"x_mm", "y_mm", "z_mm"}}, .optional =
// {"step"}})
struct CsvRequest {
  // The first of which the file has all columns is read.
  std::vector<std::vector<std::string>> alternatives;
  std::vector<std::string> optional = {};  // read as well where the file has them
  std::vector<std::string> texts = {};     // likewise, as they stand there
  // Asked many times a second, on the thread that reads; what it throws ends the reading.
  std::function<void()> poll = nullptr;
};

class GLISS_EXPORT CsvTable {
 public:
  std::size_t rows = 0;
  std::size_t alternative = 0;  // index of the one that was read

  // Null where the column was not asked for or is an optional one that the file lacks.
  const std::vector<double>* find(std::string_view name) const;
  const std::vector<std::string>* find_text(std::string_view name) const;
  std::string place(std::size_t row) const;  // "points.csv:17", for messages about a value

 private:
  friend class CsvParser;
  std::string source_;
  std::size_t first_line_ = 0;
  std::vector<std::string> names_;
  std::vector<std::vector<double>> values_;
  std::vector<std::string> text_names_;
  std::vector<std::vector<std::string>> texts_;
};

// Accepts CRLF, a byte order mark, '#' lines above the header, spaces round fields, fields in
// double quotes (on one line) and blank lines at the end. Columns that nobody wants may hold
// anything. Throws CsvError on a missing column, a number of fields other than the header's, and
// wanted fields that are no finite number.
GLISS_EXPORT CsvTable read_csv(const std::string& path, const CsvRequest& request);

}  // namespace gliss
