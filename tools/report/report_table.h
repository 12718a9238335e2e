// Tables of ticks, from CSV or HDF5: paths that gliss trace followed, recordings of gliss run.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "gliss/base/large_array.h"
#include "gliss/base/vector.h"
#include "tools/report/report_source.h"

namespace gliss::tools {

enum class TickTable { kTrace, kRecording };

struct ReportTable {
  TickTable kind{};
  Json origin = Json::object();  // what the file says of itself; CSV: nothing
  std::size_t rows = 0;
  std::map<std::string, LargeArray<double>> numbers;  // those of the optional ones that it has
  std::map<std::string, std::vector<std::string>> texts;

  bool has(const char* name) const { return numbers.count(name) != 0; }
  Vec3 vector(const char* x, const char* y, const char* z, std::size_t row) const {
    return {numbers.at(x)[row], numbers.at(y)[row], numbers.at(z)[row]};
  }
  Vec3 force(std::size_t row) const { return vector("fx", "fy", "fz", row); }
  Vec3 sent(std::size_t row) const { return vector("sent_x", "sent_y", "sent_z", row); }
};

ReportTable read_csv_ticks(const ReportSource& source);
ReportTable read_hdf5_ticks(const Hdf5Reader& file, const ReportSource& source, TickTable kind);

Json trace_result(const ReportTable& table, const ReportSource& source);
Json recording_result(const ReportTable& table, const ReportSource& source);

}  // namespace gliss::tools
