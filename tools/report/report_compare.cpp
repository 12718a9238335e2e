// What gliss compare --json found: levels, precisions, solvers and backends, and the dense meshes
// that flat or shaded rendering needs in their place.
#include "tools/report/report_rows.h"

namespace gliss::tools {
namespace {

constexpr char kWriter[] = "gliss compare";

constexpr RowKey kRowKeys[] = {{"level", Expect::kText},
                               {"precision", Expect::kText},
                               {"solver", Expect::kText},
                               {"backend", Expect::kText},
                               {"bytes_per_patch", Expect::kNumber},
                               {"build_per_s", Expect::kNumber},
                               {"eval_per_s", Expect::kNumber},
                               {"track_per_s", Expect::kNumber},
                               {"max_distance", Expect::kNumber},
                               {"p99_distance", Expect::kNumber},
                               {"max_normal_gap_deg", Expect::kNumber},
                               {"p99_normal_gap_deg", Expect::kNumber},
                               {"max_force_step", Expect::kNumber},
                               {"p99_force_step", Expect::kNumber},
                               {"walk_max_force_step", Expect::kNumber},
                               {"jumps_per_100k", Expect::kNumber},
                               {"lost_per_100k", Expect::kNumber},
                               {"settling_share", Expect::kNumber},
                               {"loop_gain", Expect::kNumber},
                               {"unsound", Expect::kNumber},
                               {"max_force_error", Expect::kNumber},
                               {"p99_force_error", Expect::kNumber},
                               {"tick_us", Expect::kNumber},
                               {"pareto", Expect::kTruth}};

constexpr RowKey kDenseKeys[] = {
    {"method", Expect::kText},           {"triangles", Expect::kNumber},
    {"bytes", Expect::kNumber},          {"max_force_step", Expect::kNumber},
    {"p99_force_step", Expect::kNumber}, {"jumps_per_100k", Expect::kNumber},
    {"lost_per_100k", Expect::kNumber},  {"tick_us", Expect::kNumber},
    {"target_level", Expect::kText},     {"target_bytes", Expect::kNumber},
    {"target_tick_us", Expect::kNumber}, {"memory_ratio", Expect::kNumber},
    {"time_ratio", Expect::kNumber},     {"reached", Expect::kTruth}};

}  // namespace

Json read_comparison(const Json& json, const ReportSource& source) {
  Json result = {{"kind", "compare"}, {"origin", Json::object()}};
  if (json.contains("mesh") && json["mesh"].is_string()) result["origin"]["surface"] = json["mesh"];
  for (const char* name : {"faces", "recommended", "walks"})
    result[name] = json.value(name, Json());
  result["rows"] = read_rows(json["rows"], "rows", kRowKeys, kWriter, source);
  const Json dense = json.value("dense", Json::array());
  result["dense"] =
      dense.is_array() ? read_rows(dense, "dense", kDenseKeys, kWriter, source) : Json::array();
  source.watch.add(source.bytes);
  return result;
}

}  // namespace gliss::tools
