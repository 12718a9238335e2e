// Ticks on their way out of the loop: a queue that the loop never waits for, and the file that
// another thread writes from it.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/loop/loop.h"
#include "gliss/tables/result_table.h"

namespace gliss {

// From one thread to one other.
class GLISS_EXPORT TickQueue {
 public:
  explicit TickQueue(std::size_t capacity = 16384);
  ~TickQueue();

  // False where it is full: the tick is lost, and counted.
  bool add(const LoopTick& tick) noexcept;
  bool full() const noexcept;  // asked by the thread that adds
  // All that is there, instead of what `ticks` held.
  void take(std::vector<LoopTick>& ticks);
  std::uint64_t lost() const { return lost_.load(std::memory_order_relaxed); }

 private:
  struct Queue;
  std::unique_ptr<Queue> queue_;
  std::atomic<std::uint64_t> lost_{0};
};

// A recording is the table "ticks" of a result file (host/tables/result_file.h), a row each, in SI
// units. x,y,z are the positions as read and fx,fy,fz the forces as rendered, so that a
// recording is a path for a replay and for `gliss trace`.
class GLISS_EXPORT RecordingFile {
 public:
  // `turns`: with the orientation of a device that has one, and the torques.
  RecordingFile(const std::string& path, const std::vector<Attribute>& attributes,
                bool turns = false);
  void write(const std::vector<LoopTick>& ticks);
  // A table "histograms/`name`" of its own. Not in CSV, which holds one table.
  void add_histogram(const std::string& name, const DurationHistogram& durations);
  void close();  // nothing appears under `path` before

 private:
  bool many_tables_, turns_;
  std::unique_ptr<ResultFile> file_;
  ResultTable table_;
};

}  // namespace gliss
