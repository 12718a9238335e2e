#include "gliss/surface/names.h"

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

std::optional<Level> find_surface(std::string_view name) {
  const std::string_view fair = "fair";
  const bool is_fair = name.starts_with(fair);
  if (is_fair) name.remove_prefix(fair.size());
  std::optional<Level> level = Level{};
  if (!is_fair) {
    level = find_level(name);
  } else if (!name.empty()) {
    level = name[0] == '-' ? find_level(name.substr(1)) : std::nullopt;
  }
  if (level) level->construction = is_fair ? Construction::kFair : Construction::kPaper;
  return level;
}

std::string no_level(const std::string& name) {
  return "'" + name + "' is none of " + listed(kLevelNames) +
         ", table:1 to table:" + std::to_string(kMostTableCells);
}

}  // namespace gliss
