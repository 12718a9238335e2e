// The file of a loop's ticks, written by another thread.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/loop/loop.h"
#include "gliss/tables/result_table.h"

namespace gliss {

// A recording is the table "ticks" of a result file (gliss/tables/result_file.h), a row each, in SI
// units. x,y,z are the positions as read and fx,fy,fz the forces as rendered, so that a
// recording is a path for a replay and for `gliss trace`.
class GLISS_EXPORT RecordingFile {
 public:
  // `has_orientation`: with the orientation of a device that has one, and the torques.
  RecordingFile(const std::string& path, const std::vector<Attribute>& attributes,
                bool has_orientation = false);
  void write(const std::vector<LoopTick>& ticks);
  // A table "histograms/`name`" of its own. Not in CSV, which holds one table.
  void add_histogram(const std::string& name, const DurationHistogram& durations);
  void close();  // nothing appears under `path` before

 private:
  bool many_tables_, has_orientation_;
  std::unique_ptr<ResultFile> file_;
  ResultTable table_;
};

}  // namespace gliss
