#include "tools/report/report_table.h"

#include <fmt/format.h>

#include "gliss/tables/csv_reader.h"
#include "tools/cli/words/command_line.h"

namespace gliss::tools {
namespace {

struct WantedColumns {
  std::vector<std::string> numbers, optional, texts;
};

const WantedColumns& wanted(TickTable kind) {
  static const WantedColumns of_trace{{"step", "x", "y", "z", "fx", "fy", "fz", "patch"},
                                      {"scp_x", "scp_y", "scp_z", "cone_share"},
                                      {"method", "state"}};
  static const WantedColumns of_recording{
      {"time", "lateness", "compute", "missed", "fx", "fy", "fz", "sent_x", "sent_y", "sent_z"},
      {"distance"},
      {"state", "guard", "reason"}};
  return kind == TickTable::kTrace ? of_trace : of_recording;
}

}  // namespace

ReportTable read_csv_ticks(const ReportSource& source) {
  const auto &trace = wanted(TickTable::kTrace), &recording = wanted(TickTable::kRecording);
  std::vector<std::string> optional = trace.optional;
  optional.insert(optional.end(), recording.optional.begin(), recording.optional.end());
  const InputTable csv =
      gliss::read_csv(source.path, {.alternatives = {trace.numbers, recording.numbers},
                                    .optional = optional,
                                    .texts = {"method", "state", "guard", "reason"},
                                    .poll = stop_if_interrupted});
  ReportTable table;
  table.kind = csv.alternative == 0 ? TickTable::kTrace : TickTable::kRecording;
  table.rows = csv.rows;
  const WantedColumns& columns = wanted(table.kind);
  for (const std::string& name : columns.numbers) table.numbers[name] = *csv.find(name);
  for (const std::string& name : columns.optional) {
    if (const auto* numbers = csv.find(name)) table.numbers[name] = *numbers;
  }
  for (const std::string& name : columns.texts) {
    const auto* texts = csv.find_text(name);
    if (texts == nullptr) throw CsvError(fmt::format("{}: no column '{}'", source.path, name));
    table.texts[name] = *texts;
  }
  source.watch.add(source.bytes);
  return table;
}

ReportTable read_hdf5_ticks(const Hdf5Reader& file, const ReportSource& source, TickTable kind) {
  const std::string group = kind == TickTable::kTrace ? "" : "ticks/";
  const WantedColumns& columns = wanted(kind);
  const std::uint64_t share = source.bytes / (columns.numbers.size() + columns.texts.size());
  ReportTable table;
  table.kind = kind;
  table.origin = provenance(file, source);
  table.rows = file.rows(group + columns.numbers.front());
  const auto read = [&](const std::string& name, auto& into, const auto& get) {
    into = get(group + name);
    if (into.size() != table.rows) {
      throw InputError(fmt::format("{}: column '{}{}' has {} rows, '{}{}' {}", source.path, group,
                                   name, into.size(), group, columns.numbers.front(), table.rows));
    }
    source.watch.add(share);
  };
  const auto read_numbers = [&](const std::string& name) {
    read(name, table.numbers[name], [&](const std::string& path) { return file.numbers(path); });
  };
  for (const std::string& name : columns.numbers) read_numbers(name);
  for (const std::string& name : columns.optional) {
    if (file.has(group + name)) read_numbers(name);
  }
  for (const std::string& name : columns.texts) {
    read(name, table.texts[name], [&](const std::string& path) { return file.texts(path); });
  }
  return table;
}

}  // namespace gliss::tools
