// Tells of a loop in gliss run, while it runs and after.
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "gliss/loop/loop.h"
#include "gliss/query/force_statistics.h"
#include "gliss/results/json.h"

namespace gliss::tools {

// Figures of ticks as they come out of the loop's queue.
class RunReport {
 public:
  static constexpr std::size_t kTrips = 10;      // told in full
  static constexpr std::size_t kTripTicks = 50;  // that led to one

  void add(const LoopTick& tick);
  // "1.000 kHz  depth 2.00 mm  force 1.00 N  missed 0  p99 3.2 us  run", of the ticks since the
  // last call.
  std::string live_line();

  const ForceStatistics& rendered() const { return rendered_; }
  const ForceStatistics& sent() const { return sent_; }
  bool begins_inside() const { return begins_inside_; }      // the first tick was in contact
  double largest_torque() const { return largest_torque_; }  // N m, as sent
  // The largest depth in each object of Tracker::objects(), m, over ticks in which that object
  // pushed most. Ends with the last object that was touched.
  const std::vector<double>& deepest() const { return deepest_; }
  Json trips_json() const;  // each with the ticks that led to it

 private:
  struct Trip {
    GuardReason reason;
    std::deque<LoopTick> ticks;  // up to it
  };
  ForceStatistics rendered_, sent_;  // sent: in contact while it is not zero
  bool begins_inside_ = false;
  double largest_torque_ = 0;
  std::vector<double> deepest_;
  std::deque<LoopTick> last_;  // kTripTicks
  std::vector<Trip> trips_;
  DurationHistogram compute_;  // since the last line
  std::uint64_t missed_ = 0;
  Nanoseconds line_at_{};
};

}  // namespace gliss::tools
