#include "tools/report/report_rows.h"
#include "tools/cli/words/command_line.h"

#include <fmt/format.h>

namespace gliss::tools {
namespace {

// Levels, which are texts, may be numbers.
bool fits(const Json& value, const RowKey& key) {
  if (value.is_null()) return !key.needed;
  switch (key.type) {
    case Expect::kText:
      return value.is_string() || value.is_number();
    case Expect::kNumber:
      return value.is_number();
    case Expect::kTruth:
      return value.is_boolean();
  }
  return false;
}

}  // namespace

Json read_rows(const Json& rows, const char* list, std::span<const RowKey> keys, const char* writer,
               const ReportSource& source) {
  Json read = Json::array();
  for (const Json& row : rows) {
    Json& kept = read.emplace_back();
    for (const RowKey& key : keys) {
      Json value = row.is_object() ? row.value(key.name, Json()) : Json();
      if (!row.is_object() || !fits(value, key)) {
        throw InputError(fmt::format("{}: '{}' {}: '{}' is not what {} writes", source.path, list,
                                     read.size() - 1, key.name, writer));
      }
      kept[key.name] = std::move(value);
    }
  }
  return read;
}

}  // namespace gliss::tools
