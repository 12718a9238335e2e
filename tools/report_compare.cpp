// What gliss compare --json found: levels, precisions, solvers and backends, and the dense meshes
// that flat or shaded rendering needs in their place.
#include <fmt/format.h>

#include <algorithm>

#include "tools/report_source.h"

namespace gliss::tools {
namespace {

enum class Expect { kText, kNumber, kTruth };

struct Key {
  const char* name;
  Expect type;
};

constexpr Key kRowKeys[] = {{"level", Expect::kText},
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
                            {"max_force_step", Expect::kNumber},
                            {"max_force_error", Expect::kNumber},
                            {"tick_us", Expect::kNumber},
                            {"pareto", Expect::kTruth}};

constexpr Key kDenseKeys[] = {
    {"method", Expect::kText},         {"triangles", Expect::kNumber},
    {"bytes", Expect::kNumber},        {"max_force_step", Expect::kNumber},
    {"tick_us", Expect::kNumber},      {"target_level", Expect::kText},
    {"target_bytes", Expect::kNumber}, {"target_tick_us", Expect::kNumber},
    {"memory_ratio", Expect::kNumber}, {"time_ratio", Expect::kNumber},
    {"reached", Expect::kTruth}};

// Null is "not measured"; levels may be numbers.
bool fits(const Json& value, Expect type) {
  if (value.is_null()) return true;
  if (type == Expect::kNumber) return value.is_number();
  if (type == Expect::kTruth) return value.is_boolean();
  return value.is_string() || value.is_number();
}

template <std::size_t count>
Json read_rows(const Json& rows, const char* list, const Key (&keys)[count],
               const ReportSource& source) {
  Json read = Json::array();
  for (const Json& row : rows) {
    Json& kept = read.emplace_back();
    for (const auto& [name, type] : keys) {
      const auto value = row.is_object() ? row.find(name) : row.end();
      if (!row.is_object() || (value != row.end() && !fits(*value, type))) {
        throw InputError(fmt::format("{}: '{}' {}: '{}' is not what gliss compare writes",
                                     source.path, list, read.size() - 1, name));
      }
      kept[name] = value == row.end() ? Json() : *value;
    }
  }
  return read;
}

}  // namespace

Json read_comparison(const Json& json, const ReportSource& source) {
  Json result = {{"kind", "compare"}, {"origin", Json::object()}};
  if (json.contains("mesh") && json["mesh"].is_string()) result["origin"]["surface"] = json["mesh"];
  for (const char* name : {"faces", "recommended"}) result[name] = json.value(name, Json());
  result["rows"] = read_rows(json["rows"], "rows", kRowKeys, source);
  const Json dense = json.value("dense", Json::array());
  result["dense"] =
      dense.is_array() ? read_rows(dense, "dense", kDenseKeys, source) : Json::array();
  source.watch.add(source.bytes);
  return result;
}

}  // namespace gliss::tools
