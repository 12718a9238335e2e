// What gliss compare --json found: levels, precisions, solvers and backends, and the dense meshes
// that flat or shaded rendering needs in their place; with --picture, surfaces and jumps as well.
#include <fmt/format.h>

#include <algorithm>

#include "tools/cli/words/command_line.h"
#include "tools/report/report_data.h"
#include "tools/report/report_rows.h"

namespace gliss::tools {
namespace {

constexpr char kWriter[] = "gliss compare";

constexpr RowKey kRowKeys[] = {{"surface", Expect::kText},
                               {"level", Expect::kText},
                               {"construction", Expect::kText},
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
    {"target", Expect::kText},           {"target_level", Expect::kText},
    {"target_bytes", Expect::kNumber},   {"target_tick_us", Expect::kNumber},
    {"memory_ratio", Expect::kNumber},   {"time_ratio", Expect::kNumber},
    {"reached", Expect::kTruth}};

constexpr RowKey kPictureKeys[] = {{"construction", Expect::kText, true},
                                   {"points", Expect::kNumber, true},
                                   {"p50_curvature", Expect::kNumber},
                                   {"p99_curvature", Expect::kNumber},
                                   {"max_curvature", Expect::kNumber}};

// An array of a picture: numbers a point.
struct PictureArray {
  const char *name, *type;
  std::size_t numbers;
  bool is_optional = false;  // files of before do not have it
};
constexpr PictureArray kPictureArrays[] = {{"face", "u32", 1},      {"position", "f32", 3},
                                           {"normal", "f32", 3},    {"spot", "f32", 1},
                                           {"curvature", "f32", 1}, {"departure", "f32", 1, true}};

// Bounds of a page: what a file has beyond them is left out.
constexpr std::size_t kMostJumps = 20000;  // of all rows

[[noreturn]] void refuse(const ReportSource& source, const std::string& what) {
  throw InputError(fmt::format("{}: {} is not what {} writes", source.path, what, kWriter));
}

// Files of before 0.2 name a surface by `old` alone.
void name_surface(Json& row, const char* name, const char* old) {
  if (row.is_object() && (!row.contains(name) || row[name].is_null()) && row.contains(old))
    row[name] = row[old];
}

// True if `json` is as many numbers as packed() makes of them.
bool is_packed(const Json& json, const char* type, std::size_t count) {
  if (!json.is_object() || !json.contains(type) || !json[type].is_string()) return false;
  const auto& text = json[type].get_ref<const std::string&>();
  const std::size_t bytes = 4 * count, padding = (3 - bytes % 3) % 3;
  const auto is_digit = [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '+' ||
           c == '/';
  };
  return text.size() == (bytes + padding) / 3 * 4 &&
         std::all_of(text.begin(), text.end() - static_cast<std::ptrdiff_t>(padding), is_digit) &&
         std::all_of(text.end() - static_cast<std::ptrdiff_t>(padding), text.end(),
                     [](char c) { return c == '='; });
}

// The surfaces of the constructions; null where the file has none. Those that do not fit on the
// page are told as `true`.
Json read_picture(const Json& picture, const ReportSource& source) {
  if (!picture.is_array()) return {};
  Json read = read_rows(picture, "picture", kPictureKeys, kWriter, source);
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < read.size(); ++i) {
    const auto points = read[i]["points"].get<double>();
    for (const auto& [name, type, numbers, is_optional] : kPictureArrays) {
      if (is_optional && !picture[i].contains(name)) continue;
      Json array = picture[i].value(name, Json());
      if (!(points >= 1 && points <= 1e6) ||
          !is_packed(array, type, numbers * static_cast<std::size_t>(points)))
        refuse(source, fmt::format("'picture' {}: '{}'", i, name));
      bytes += 4 * numbers * static_cast<std::size_t>(points);
      read[i][name] = std::move(array);
    }
  }
  return bytes <= source.page_bytes ? read : Json(true);
}

// The places where a row's walks jump, the first `most` of them.
Json read_jumps(const Json& jumps, std::size_t most, const std::string& row,
                const ReportSource& source) {
  std::vector<float> position, step;
  std::vector<std::uint32_t> face, lost;
  for (const Json& jump : jumps) {
    if (step.size() == most) break;
    const auto is = [&](const char* key, bool (Json::*type)() const noexcept) {
      return jump.is_object() && jump.contains(key) && (jump[key].*type)();
    };
    const bool has_place = is("position", &Json::is_array) && jump["position"].size() == 3 &&
                           std::all_of(jump["position"].begin(), jump["position"].end(),
                                       [](const Json& x) { return x.is_number(); });
    if (!has_place || !is("face", &Json::is_number_unsigned) || !is("step", &Json::is_number) ||
        !is("lost", &Json::is_boolean))
      refuse(source, fmt::format("{}: 'jumps' {}", row, step.size()));
    for (const Json& x : jump["position"]) position.push_back(x.get<float>());
    face.push_back(jump["face"].get<std::uint32_t>());
    step.push_back(jump["step"].get<float>());
    lost.push_back(jump["lost"].get<bool>());
  }
  return {{"position", packed(position)},
          {"face", packed(face)},
          {"step", packed(step)},
          {"lost", packed(lost)}};
}

}  // namespace

Json read_comparison(const Json& json, const ReportSource& source) {
  Json result = {{"kind", "compare"}, {"origin", Json::object()}};
  if (json.contains("mesh") && json["mesh"].is_string()) result["origin"]["surface"] = json["mesh"];
  if (json.contains("unit") && json["unit"].is_string()) result["origin"]["unit"] = json["unit"];
  for (const char* name : {"stiffness_N_per_m", "command_line"})
    if (json.contains(name)) result["origin"][name] = json[name];
  for (const char* name : {"faces", "recommended", "reason", "walks", "depths_m"})
    result[name] = json.value(name, Json());
  result["rows"] = read_rows(json["rows"], "rows", kRowKeys, kWriter, source);
  name_surface(result["recommended"], "surface", "level");
  for (std::size_t i = 0; i < result["rows"].size(); ++i) {
    name_surface(result["rows"][i], "surface", "level");
    const Json jumps = json["rows"][i].value("jumps", Json());
    if (jumps.is_array())
      result["rows"][i]["jumps"] = read_jumps(jumps, kMostJumps / result["rows"].size(),
                                              fmt::format("'rows' {}", i), source);
  }
  result["picture"] = read_picture(json.value("picture", Json()), source);
  const Json dense = json.value("dense", Json::array());
  result["dense"] =
      dense.is_array() ? read_rows(dense, "dense", kDenseKeys, kWriter, source) : Json::array();
  for (Json& row : result["dense"]) name_surface(row, "target", "target_level");
  source.watch.add(source.bytes);
  return result;
}

}  // namespace gliss::tools
