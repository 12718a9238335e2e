#include "host/names.h"

#include <fmt/format.h>

#include <charconv>

namespace gliss {

std::optional<Level> find_level(std::string_view name) {
  const std::size_t colon = name.find(':');
  const auto kind = find_named(kLevelNames, name.substr(0, colon));
  if (!kind) return std::nullopt;
  Level level{*kind, *kind == Level::kTable ? kTableCells : 0};
  if (colon == name.npos) return level;
  const char *begin = name.data() + colon + 1, *end = name.data() + name.size();
  const auto [stop, error] = std::from_chars(begin, end, level.cells);
  if (level.kind != Level::kTable || error != std::errc() || stop != end || level.cells < 1 ||
      level.cells > kMostTableCells)
    return std::nullopt;
  return level;
}

std::string no_level(const std::string& name) {
  return fmt::format("'{}' is none of {}, table:1 to table:{}", name, listed(kLevelNames),
                     kMostTableCells);
}

}  // namespace gliss
