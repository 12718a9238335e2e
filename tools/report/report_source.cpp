#include "tools/report/report_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "gliss/files/open_file.h"
#include "tools/cli/words/command_line.h"
#include "tools/report/report_table.h"

namespace gliss::tools {
namespace {

constexpr char kWhat[] = "a result of gliss trace, sweep, compare or run";

constexpr std::uint64_t kLargestJson = 1 << 26;  // bytes

[[noreturn]] void refuse(const ReportSource& source, const std::string& why) {
  throw InputError(fmt::format("'{}' is not {}: {}", source.path, kWhat, why));
}

Json read_hdf5(const ReportSource& source) {
  try {
    const Hdf5Reader file(source.path, kWhat, stop_if_interrupted);
    // What it lacks of its kind is named where it is looked for.
    if (file.has("statistics")) return read_sweep(file, source);
    const bool recording = file.has("ticks");
    if (!recording && !file.has("method") && !file.has("fx"))
      refuse(source, "HDF5 without 'statistics', 'ticks', 'method' and 'fx'");
    const ReportTable table =
        read_hdf5_ticks(file, source, recording ? TickTable::kRecording : TickTable::kTrace);
    return recording ? recording_result(table, source) : trace_result(table, source);
  } catch (const InputError&) {
    throw;
  } catch (const std::runtime_error& error) {  // HDF5's: a damaged file, or a foreign one
    throw InputError(error.what());
  }
}

Json read_json(const ReportSource& source) {
  OpenFile file(source.path);
  if (file.size() > kLargestJson)
    refuse(source, fmt::format("JSON of over {} bytes", kLargestJson));
  const auto poll = [](int, Json::parse_event_t, Json&) {
    stop_if_interrupted();
    return true;
  };
  const Json json = Json::parse(file.read_all(), poll, false);
  if (json.is_discarded()) refuse(source, "JSON that is damaged");
  const auto holds = [&](const char* key, bool (Json::*is)() const noexcept) {
    return json.contains(key) && (json[key].*is)();
  };
  if (holds("rows", &Json::is_array)) return read_comparison(json, source);
  if (holds("histograms", &Json::is_object) || holds("guards", &Json::is_object))
    return read_run_report(json, source);
  refuse(source, "JSON without a list 'rows' (gliss compare) and 'guards' (gliss run)");
}

Json read_csv(const ReportSource& source) {
  const ReportTable table = read_csv_ticks(source);
  return table.kind == TickTable::kTrace ? trace_result(table, source)
                                         : recording_result(table, source);
}

}  // namespace

Json provenance(const Hdf5Reader& file, const ReportSource& source) {
  Json origin = Json::object();
  for (const char* name :
       {"surface", "mesh_hash", "unit", "precision", "scene", "device", "command_line"}) {
    if (const auto text = file.text_attribute(name)) origin[name] = *text;
  }
  constexpr char kStiffness[] = "stiffness_N_per_m";
  if (const auto stiffness = file.number_attribute(kStiffness)) origin[kStiffness] = *stiffness;
  if (const auto text = file.text_attribute("objects")) {
    const Json objects = Json::parse(*text, nullptr, false);  // of very many, the text is cut
    if (!objects.is_discarded()) origin["objects"] = read_objects(objects, source);
  }
  return origin;
}

Json read_result(const ReportSource& source) {
  OpenFile file(source.path);
  if (file.descriptor() < 0) refuse(source, file.why());
  std::string start(4096, '\0');
  start.resize(file.read(start.data(), start.size()));
  if (start.empty()) refuse(source, "it is empty");
  if (start.starts_with("\x89HDF\r\n\x1a\n")) return read_hdf5(source);
  if (start[std::min(start.find_first_not_of(" \t\r\n"), start.size() - 1)] == '{')
    return read_json(source);
  if (start.find("fx") != start.npos && start.find(',') != start.npos) return read_csv(source);
  refuse(source, "neither HDF5 nor JSON nor a table of forces in CSV");
}

}  // namespace gliss::tools
