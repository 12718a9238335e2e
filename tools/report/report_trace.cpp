// A path that gliss trace followed: by how much the force changes from tick to tick, for each
// method (Figures 1 and 11).
#include <algorithm>
#include <cmath>
#include <limits>

#include "gliss/query/force_statistics.h"
#include "tools/cli/words/command_line.h"
#include "tools/report/report_data.h"
#include "tools/report/report_table.h"

namespace gliss::tools {
namespace {

constexpr std::size_t kMostBars = 20000;  // a method
constexpr std::size_t kBarBytes = 8 * 4;
constexpr std::size_t kLargest = 3;

// How deep HIPs are beneath their contacts at most, in the unit of the file; null where it does not
// say.
Json deepest(const ReportTable& table, const std::vector<std::size_t>& rows) {
  if (!table.has("scp_x") || !table.has("scp_y") || !table.has("scp_z")) return {};
  double most = 0;
  for (const std::size_t row : rows) {
    if (table.texts.at("state")[row] != "contact") continue;
    most = std::max(
        most,
        (table.vector("scp_x", "scp_y", "scp_z", row) - table.vector("x", "y", "z", row)).norm());
  }
  return most;
}

Json method_result(const ReportTable& table, const std::string& method,
                   const std::vector<std::size_t>& rows, std::size_t most) {
  const auto touching = [&](std::size_t tick) {
    return table.texts.at("state")[rows[tick]] == "contact";
  };
  const auto force = [&](std::size_t tick) { return table.force(rows[tick]); };
  ForceStatistics statistics;
  std::vector<double> change(rows.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t tick = 0; tick < rows.size(); ++tick) {
    const double step = statistics.add(touching(tick), force(tick));
    if (std::isfinite(step)) change[tick] = step;
  }
  const auto bars = extremes(rows.size(), most, [&](std::size_t tick) { return change[tick]; });
  const auto column = [&](const std::string& name) {
    return
        [&values = table.numbers.at(name), &rows](std::size_t tick) { return values[rows[tick]]; };
  };

  auto largest = bars;  // the largest steps are among them
  const auto end = largest.begin() + static_cast<std::ptrdiff_t>(std::min(kLargest, bars.size()));
  std::partial_sort(largest.begin(), end, largest.end(),
                    [&](std::size_t a, std::size_t b) { return change[a] > change[b]; });
  Json peaks = Json::array();
  for (auto tick = largest.begin(); tick != end; ++tick)
    peaks.push_back({{"step", column("step")(*tick)}, {"change", change[*tick]}});

  Json json = {
      {"method", method},
      {"ticks", statistics.ticks},
      {"in_contact", statistics.touching},
      {"mean_change", statistics.mean_step},
      {"jumps_per_100k", statistics.jumps_per_100k()},
      {"lost_per_100k", statistics.lost_per_100k()},
      {"unsound", statistics.unsound},
      {"largest_force", statistics.largest_force},
      {"deepest", deepest(table, rows)},
      {"largest", peaks},
      {"step", packed_at<float>(bars, column("step"))},
      {"change", packed_at<float>(bars, [&](std::size_t tick) { return change[tick]; })},
      {"force", packed_at<float>(bars, [&](std::size_t tick) { return force(tick).norm(); })},
      {"x", packed_at<float>(bars, column("x"))},
      {"y", packed_at<float>(bars, column("y"))},
      {"z", packed_at<float>(bars, column("z"))},
      {"patch", packed_at<std::uint32_t>(bars, column("patch"))}};
  if (table.has("cone_share")) json["cone_share"] = packed_at<float>(bars, column("cone_share"));
  return json;
}

}  // namespace

Json trace_result(const ReportTable& table, const ReportSource& source) {
  const auto& methods = table.texts.at("method");
  std::map<std::string, std::vector<std::size_t>> rows;  // of each method
  for (std::size_t row = 0; row < table.rows; ++row) rows[methods[row]].push_back(row);
  if (rows.empty()) throw InputError(source.path + ": a trace without a tick");
  const std::size_t most =
      std::min<std::size_t>(kMostBars, source.page_bytes / (kBarBytes * rows.size()));
  Json json = {{"kind", "trace"}, {"origin", table.origin}};
  const auto& steps = table.numbers.at("step");
  const auto [first, last] = std::minmax_element(steps.begin(), steps.end());
  json["first_step"] = *first;
  json["last_step"] = *last;
  for (const auto& [method, of_method] : rows) {
    json["methods"].push_back(method_result(table, method, of_method, most));
  }
  return json;
}

}  // namespace gliss::tools
