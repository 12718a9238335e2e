#include "gliss/surface/names.h"

#include <charconv>

#include "gliss/surface/layout.h"

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
  const std::size_t dash = name.find('-');
  const auto named = find_named(kConstructionNames, name.substr(0, dash));
  const Construction construction = named.value_or(Construction::kPaper);
  if (named && dash == name.npos) return Level{.construction = construction};
  std::optional<Level> level = find_level(named ? name.substr(dash + 1) : name);
  if (level) level->construction = construction;
  return level;
}

std::string no_level(const std::string& name) {
  return "'" + name + "' is not one of " + listed(kLevelNames) +
         ", table:1 to table:" + std::to_string(kMostTableCells);
}

std::string no_surface(const std::string& name) {
  return "'" + name +
         "' is not one of fair, paper, shaded, flat, fair-LEVEL and paper-LEVEL, where LEVEL is "
         "ribbon, bezier, table or table:N";
}

const char* form_name(std::uint32_t form) {
  if (form == kFormSextic) return "sextic";
  if (form == kFormCurved) return "curved";
  return name_of(kLevelNames, static_cast<Level::Kind>(form & kFormMask));
}

}  // namespace gliss
