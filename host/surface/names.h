// The words for choices, on command lines and in files.
#pragma once

#include <cstdint>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>

#include "gliss/base/export.h"
#include "gliss/surface/contact.h"
#include "gliss/surface/patch_cache.h"

namespace gliss {

template <class Value>
struct Named {
  const char* name;
  Value value;
};

inline constexpr Named<Method> kMethodNames[] = {
    {"gregory", Method::kGregory}, {"shaded", Method::kShaded}, {"flat", Method::kFlat}};
inline constexpr Named<Solver> kSolverNames[] = {
    {"newton", Solver::kNewton}, {"gauss-newton", Solver::kGaussNewton}, {"paper", Solver::kPaper}};
inline constexpr Named<Precision> kPrecisionNames[] = {{"float", Precision::kFloat},
                                                       {"double", Precision::kDouble}};

template <class Value, std::size_t count>
std::optional<Value> find_named(const Named<Value> (&names)[count], std::string_view wanted) {
  for (const auto& [name, value] : names) {
    if (name == wanted) return value;
  }
  return std::nullopt;
}

// "newton, gauss-newton, paper"
template <class Value, std::size_t count>
std::string listed(const Named<Value> (&names)[count]) {
  std::string list;
  for (const auto& [name, value] : names) list += (list.empty() ? "" : ", ") + std::string(name);
  return list;
}

template <class Value, std::size_t count>
const char* name_of(const Named<Value> (&names)[count], Value wanted) {
  for (const auto& [name, value] : names) {
    if (value == wanted) return name;
  }
  return "?";
}

inline constexpr Named<Level::Kind> kLevelNames[] = {{"exact", Level::kExact},
                                                     {"ribbon", Level::kRibbon},
                                                     {"bezier", Level::kBezier},
                                                     {"table", Level::kTable}};

inline constexpr Named<Construction> kConstructionNames[] = {{"paper", Construction::kPaper},
                                                             {"fair", Construction::kFair}};

inline constexpr Named<PatchKind> kPatchKindNames[] = {{"exact", PatchKind::kPlain},
                                                       {"eased", PatchKind::kEased},
                                                       {"split", PatchKind::kSplit},
                                                       {"bent", PatchKind::kBent}};

inline const char* construction_name(Construction construction) {
  return name_of(kConstructionNames, construction);
}

// "table:8" is a table of other than the usual number of cells.
inline std::string level_name(const Level& level) {
  const std::string name = name_of(kLevelNames, level.kind);
  return level.kind == Level::kTable && level.cells != kTableCells
             ? name + ":" + std::to_string(level.cells)
             : name;
}
// The same with its construction: the paper's goes without saying, as "exact"; "fair",
// "fair-table:8".
inline std::string surface_name(const Level& level) {
  if (level.construction == Construction::kPaper) return level_name(level);
  const std::string name = name_of(kConstructionNames, level.construction);
  return level.kind == Level::kExact ? name : name + "-" + level_name(level);
}
// "paper", "paper-ribbon", "fair-table:8": both constructions by their names, for tables of both.
inline std::string full_surface_name(const Level& level) {
  const std::string name = construction_name(level.construction);
  return level.kind == Level::kExact ? name : name + "-" + level_name(level);
}
// The level of a construction, each as it is chosen or else exact and fair.
inline Level chosen_level(const std::optional<Level>& level,
                          const std::optional<Construction>& construction) {
  Level chosen = level.value_or(Level{});
  chosen.construction = construction.value_or(chosen.construction);
  return chosen;
}
// By either of its names.
GLISS_EXPORT std::optional<Level> find_surface(std::string_view name);
GLISS_EXPORT std::optional<Level> find_level(std::string_view name);
// Returns why no level or surface has that name.
GLISS_EXPORT std::string no_level(const std::string& name);
GLISS_EXPORT std::string no_surface(const std::string& name);

// "bezier", "sextic", "curved": the form that a patch is kept in, as Surface has it.
GLISS_EXPORT const char* form_name(std::uint32_t form);

inline const char* method_name(Method method) { return name_of(kMethodNames, method); }
inline const char* precision_name(Precision precision) {
  return name_of(kPrecisionNames, precision);
}

}  // namespace gliss
