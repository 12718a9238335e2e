// The words for choices, on command lines and in files.
#pragma once

#include <iterator>
#include <optional>
#include <string>
#include <string_view>

#include "host/kernels.h"
#include "host/patch_cache.h"

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

// "table:8" is a table of other than the usual number of cells.
inline std::string level_name(const Level& level) {
  const std::string name = name_of(kLevelNames, level.kind);
  return level.kind == Level::kTable && level.cells != kTableCells
             ? name + ":" + std::to_string(level.cells)
             : name;
}
std::optional<Level> find_level(std::string_view name);
std::string no_level(const std::string& name);  // why there is none of that name

inline const char* method_name(Method method) { return name_of(kMethodNames, method); }
inline const char* precision_name(Precision precision) {
  return name_of(kPrecisionNames, precision);
}

}  // namespace gliss
