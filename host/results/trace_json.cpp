#include "gliss/results/trace_json.h"

#include "gliss/surface/names.h"

namespace gliss {

Json json_of(const TraceStatistics& s) {
  return {{"method", method_name(s.method)},
          {"largest_step_N", s.largest_step},
          {"jumps_per_100k", s.jumps_per_100k()},
          {"lost_per_100k", s.lost_per_100k()},
          {"unsound", s.unsound},
          {"mean_step_N", s.mean_step},
          {"largest_force_N", s.largest_force},
          {"ticks", s.ticks},
          {"in_contact", s.touching},
          {"entries", s.entries},
          {"settling", s.settling},
          {"net_work_J", s.work.net},
          {"gross_work_J", s.work.gross},
          {"loop_gain", number(s.loop_gain.gain)},
          {"loop_gain_error", number(s.loop_gain.error)}};
}

}  // namespace gliss
