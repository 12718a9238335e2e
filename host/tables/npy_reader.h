// Tables out of .npy files: structured arrays by the names of their fields, or arrays of two
// dimensions with as many columns as are wanted.
#pragma once

#include <memory>
#include <string>

#include "gliss/base/export.h"
#include "gliss/tables/input_table.h"

namespace gliss {

// True if the file's ending is .npy.
GLISS_EXPORT bool is_npy(const std::string& path);

// Versions 1 to 3, little-endian numbers of 1 to 8 bytes, C or Fortran order. An array
// without names has the columns of the first alternative that has as many. Throws CsvError, which
// names the file, on anything else, on a missing column, on a file that is longer or shorter than
// its header says, and on wanted fields that are no finite number.
GLISS_EXPORT std::unique_ptr<TableReader> open_npy(const std::string& path,
                                                   const TableRequest& request);

}  // namespace gliss
