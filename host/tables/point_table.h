// Points in files, in whatever unit they come: CSV tables, and recordings of the loop in HDF5.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/base/poll.h"
#include "gliss/base/vector.h"
#include "gliss/base/wrench.h"
#include "gliss/tables/csv_reader.h"
#include "gliss/tables/input_table.h"

namespace gliss {

// Points of a table: columns x,y,z in the unit that the file names or else in one that the caller
// knows, or x_mm,y_mm,z_mm in millimetres. Of a recording of the loop, in HDF5: its ticks, in
// metres.
struct PointTable {
  InputTable table;          // the other columns that were asked for; of a recording: none
  double unit = 1;           // m
  std::vector<Vec3> points;  // in `unit`
  // They hold kRotationColumns and kMotionColumns, where they were asked for and are there; of
  // ticks.
  std::vector<Rotation> rotations;
  std::vector<std::chrono::nanoseconds> times;
  std::vector<Vec3> velocities;  // m/s
};

// The same some rows at a time, as far as open_table() does; recordings are held in memory.
class GLISS_EXPORT PointReader {
 public:
  // Takes and throws what read_points() does.
  PointReader(const std::string& path, double unit, const std::vector<std::string>& optional = {},
              const Poll& poll = {});
  std::size_t rows() const { return reader_ ? reader_->rows() : recording_.points.size(); }
  // The rows [begin, end), which the file must have.
  PointTable read(std::size_t begin, std::size_t end);

 private:
  std::string path_;
  double unit_;
  Poll poll_;
  PointTable recording_;
  std::unique_ptr<TableReader> reader_;  // null: a recording
};

// The columns of a rotation: a unit quaternion.
inline const std::vector<std::string> kRotationColumns = {"qw", "qx", "qy", "qz"};
// When a HIP was there (s), and the velocity that its device told (m/s). The time alone will do.
inline const std::vector<std::string> kMotionColumns = {"time", "vx", "vy", "vz"};
// The rotations of a table that was asked for these columns; none where it lacks them all. Throws
// std::runtime_error, which names the file or the row, where some are missing or the length is not
// 1 to a thousandth.
GLISS_EXPORT std::vector<Rotation> rotations_of(const InputTable& table, const Poll& poll = {});

// Throws CsvError or RecordingError; NoFileError or std::system_error (host/files/open_file.h)
// where a CSV file cannot be read.
GLISS_EXPORT PointTable read_points(const std::string& path, double unit,
                                    const std::vector<std::string>& optional = {},
                                    const Poll& poll = {});
// In m. By value, so that a table that is not needed is not copied.
GLISS_EXPORT std::vector<Vec3> points_in_metres(PointTable table);

}  // namespace gliss
