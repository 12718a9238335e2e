// Tables out of CSV files: a header, then rows.
#pragma once

#include <stdexcept>
#include <string>

#include "gliss/base/export.h"
#include "gliss/tables/input_table.h"

namespace gliss {

// what() names the file, the line and the column.
struct GLISS_EXPORT CsvError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Accepts CRLF, a byte order mark, '#' lines above the header, spaces round fields, fields in
// double quotes (on one line) and blank lines at the end. Columns that nobody wants may hold
// anything. Throws CsvError on a missing column, a number of fields other than the header's, and
// wanted fields that are no finite number.
GLISS_EXPORT InputTable read_csv(const std::string& path, const TableRequest& request);

}  // namespace gliss
