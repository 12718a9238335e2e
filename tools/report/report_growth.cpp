// Reads what bench/growth.py measured: time and memory over the size of sweeps and of meshes.
#include <fmt/format.h>

#include "tools/cli/words/command_line.h"
#include "tools/report/report_rows.h"

namespace gliss::tools {
namespace {

constexpr RowKey kSweepKeys[] = {{"samples", Expect::kPositive, true},
                                 {"seconds", Expect::kPositive, true},
                                 {"ns_per_sample", Expect::kPositive, true},
                                 {"peak_bytes", Expect::kPositive, true}};

constexpr RowKey kMeshKeys[] = {{"polygons", Expect::kPositive, true},
                                {"bake_seconds", Expect::kPositive, true},
                                {"us_per_polygon", Expect::kPositive, true},
                                {"peak_bytes", Expect::kPositive, true},
                                {"cache_bytes", Expect::kPositive, true},
                                {"load_seconds", Expect::kPositive},  // too short to tell
                                {"read_new_seconds", Expect::kPositive},
                                {"read_seconds", Expect::kPositive}};

}  // namespace

Json read_growth(const Json& growth, const ReportSource& source) {
  Json result = {{"kind", "growth"}, {"origin", Json::object()}};
  for (const char* name : {"machine", "gliss", "backend", "precision"}) {
    if (growth.contains(name) && growth[name].is_string()) result["origin"][name] = growth[name];
  }
  const auto read = [&](const char* list, std::span<const RowKey> keys) {
    const std::string path = fmt::format("growth/{}", list);
    if (!growth.contains(list) || !growth[list].is_array())
      throw InputError(fmt::format("{}: '{}' is not a list", source.path, path));
    result[list] = read_rows(growth[list], path.c_str(), keys, "bench/growth.py", source);
  };
  read("sweeps", kSweepKeys);
  read("meshes", kMeshKeys);
  source.watch.add(source.bytes);
  return result;
}

}  // namespace gliss::tools
