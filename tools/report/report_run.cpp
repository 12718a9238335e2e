// Reads what gliss run left: its report, or a recording of its ticks.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "gliss/loop/loop.h"
#include "gliss/query/force_statistics.h"
#include "tools/cli/words/command_line.h"
#include "tools/cli/words/timing_text.h"
#include "tools/report/report_data.h"
#include "tools/report/report_rows.h"
#include "tools/report/report_table.h"

namespace gliss::tools {
namespace {

constexpr std::size_t kMostTicks = 40000;
constexpr std::size_t kTickBytes = 3 * 4;

Nanoseconds nanoseconds(double seconds) {
  return Nanoseconds(static_cast<std::int64_t>(std::llround(seconds * 1e9)));
}

constexpr RowKey kObjectKeys[] = {{"mesh", Expect::kText, true},
                                  {"stiffness_N_per_m", Expect::kNumber, true}};

// In metres; null where the recording does not say.
Json deepest(const ReportTable& table) {
  if (!table.has("distance")) return {};
  double most = 0;
  for (std::size_t row = 0; row < table.rows; ++row) {
    if (table.texts.at("state")[row] == "contact")
      most = std::max(most, -table.numbers.at("distance")[row]);
  }
  return most;
}

GuardReason guard_reason(const std::string& name) {
  for (int i = 0; i < kGuardReasons; ++i) {
    const auto reason = static_cast<GuardReason>(i);
    if (name == guard_reason_name(reason)) return reason;
  }
  return GuardReason::kNone;
}

Json figures_of(const ReportTable& table) {
  ForceStatistics of_rendered, of_sent;
  TickRecord record;
  for (std::size_t row = 0; row < table.rows; ++row) {
    const Vec3 force = table.force(row), given = table.sent(row);
    if (force.allFinite()) of_rendered.add(table.texts.at("state")[row] == "contact", force);
    of_sent.add(given != Vec3::Zero(), given);
    const auto number = [&](const char* name) { return table.numbers.at(name)[row]; };
    record.add({nanoseconds(number("lateness")), nanoseconds(number("compute")),
                tick_error(guard_reason(table.texts.at("reason")[row]))},
               static_cast<std::uint64_t>(std::min(std::max(0.0, number("missed")), 1e15)));
  }
  return {{"ticks", table.rows},
          {"missed", record.missed()},
          {"success_rate", record.success()},
          {"largest_force_step", of_rendered.largest_step},
          {"jumps_per_100k", of_rendered.jumps_per_100k()},
          {"lost_per_100k", of_rendered.lost_per_100k()},
          {"unsound", of_rendered.unsound + of_sent.unsound},
          {"mean_force_step", of_rendered.mean_step},
          {"largest_force", of_rendered.largest_force},
          {"in_contact", of_rendered.touching},
          {"entries", of_rendered.entries},
          {"deepest_m", deepest(table)},
          {"largest_sent_step", of_sent.largest_step},
          {"sent_jumps_per_100k", of_sent.jumps_per_100k()},
          {"sent_lost_per_100k", of_sent.lost_per_100k()},
          {"largest_sent_force", of_sent.largest_force},
          {"wake", json_of(record.lateness())},
          {"compute", json_of(record.compute())},
          {"histograms", histograms_json(record)}};
}

// The ticks at the extremes of either force, of which both are shown.
std::vector<std::size_t> shown_ticks(const ReportTable& table, std::size_t most) {
  const auto of_rendered = extremes(table.rows, most / 2,
                                    [&](std::size_t row) { return table.force(row).norm(); }),
             of_sent = extremes(table.rows, most / 2,
                                [&](std::size_t row) { return table.sent(row).norm(); });
  std::vector<std::size_t> both;
  std::set_union(of_sent.begin(), of_sent.end(), of_rendered.begin(), of_rendered.end(),
                 std::back_inserter(both));
  return both;
}

}  // namespace

Json read_objects(const Json& objects, const ReportSource& source) {
  return read_rows(objects, "objects", kObjectKeys, "gliss run", source);
}

Json read_run_report(const Json& json, const ReportSource& source) {
  const Json histograms = json.value("histograms", Json());
  for (const char* name : {"wake", "compute"}) {
    if (histograms.is_null()) break;  // gliss run --json has none
    const auto bins = histograms.find(name);
    const auto is_bin = [](const Json& bin) {
      return bin.is_array() && bin.size() == 2 && bin[0].is_number() && bin[1].is_number();
    };
    if (bins == histograms.end() || !bins->is_array() ||
        !std::all_of(bins->begin(), bins->end(), is_bin)) {
      throw InputError(
          fmt::format("{}: 'histograms/{}' is not a list of [longest, count]", source.path, name));
    }
  }
  source.watch.add(source.bytes);
  Json origin = Json::object();
  for (const char* name : {"command_line", "scene", "device"}) {
    if (json.contains(name) && json[name].is_string()) origin[name] = json[name];
  }
  if (json.contains("objects")) origin["objects"] = read_objects(json["objects"], source);
  return {{"kind", "run"}, {"origin", origin}, {"figures", json}};
}

Json recording_result(const ReportTable& table, const ReportSource& source) {
  const std::vector<std::size_t> shown =
      shown_ticks(table, std::min<std::size_t>(kMostTicks, source.page_bytes / kTickBytes));
  const auto& time = table.numbers.at("time");
  return {
      {"kind", "recording"},
      {"origin", table.origin},
      {"figures", figures_of(table)},
      {"shown", shown.size()},
      {"time", packed_at<float>(shown, [&](std::size_t row) { return time[row]; })},
      {"rendered",
       packed_at<float>(shown, [&](std::size_t row) { return table.force(row).norm(); })},
      {"sent", packed_at<float>(shown, [&](std::size_t row) { return table.sent(row).norm(); })}};
}

}  // namespace gliss::tools
