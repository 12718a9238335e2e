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
  constexpr std::string_view kFair = "fair", kFairLevel = "fair-";
  if (name == kFair) return Level{.construction = Construction::kFair};
  const bool is_fair = name.starts_with(kFairLevel);
  std::optional<Level> level = find_level(is_fair ? name.substr(kFairLevel.size()) : name);
  if (level) level->construction = is_fair ? Construction::kFair : Construction::kPaper;
  return level;
}

std::string no_level(const std::string& name) {
  return "'" + name + "' is none of " + listed(kLevelNames) +
         ", table:1 to table:" + std::to_string(kMostTableCells);
}

}  // namespace gliss
