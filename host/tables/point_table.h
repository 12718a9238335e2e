// Points in files, in whatever unit they come: CSV tables, and recordings of the loop in HDF5.
#pragma once

#include <string>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/base/vector.h"
#include "gliss/tables/csv_reader.h"

namespace gliss {

// what() names the file.
struct GLISS_EXPORT RecordingError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Points of a file. CSV: columns x,y,z in a unit that the caller knows, or x_mm,y_mm,z_mm in
// millimetres; of .h5 or .hdf5, the table "ticks", in metres.
struct PointTable {
  CsvTable table;            // the other columns that were asked for; of HDF5: none
  double unit = 1;           // m
  std::vector<Vec3> points;  // in `unit`
};

// Throws CsvError or RecordingError; NoFileError or std::system_error (host/files/open_file.h)
// where a CSV file cannot be read. `poll` is asked many times a second, and what it throws ends the
// reading.
GLISS_EXPORT PointTable read_points(const std::string& path, double unit,
                                    const std::vector<std::string>& optional = {},
                                    const std::function<void()>& poll = nullptr);
// In m. By value, so that a table that is not needed is not copied.
GLISS_EXPORT std::vector<Vec3> points_in_metres(PointTable table);

}  // namespace gliss
