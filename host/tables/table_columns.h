// Tables as lists of columns, each with a name, a unit and what gets its values.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "gliss/tables/result_table.h"

namespace gliss {

// The columns of a table whose rows come from a Source. A column gets its values by one of these:
// get(source, i); get(source), an array of all; or get(source[i]). The latter two may be pointers
// to members.
template <class Source>
class TableColumns {
 public:
  template <class Get>
  TableColumns& add(const char* name, ColumnType type, const std::string& unit, Get get) {
    columns_.add({name}, type, unit);
    fills_.push_back([get](TableRows& table, const Source& source, std::size_t rows) {
      with(get, source, [&](const auto& value) { table.fill(rows, value); });
    });
    return *this;
  }

  // Three columns of a vector.
  template <class Get>
  TableColumns& add_vector(const std::array<const char*, 3>& names, ColumnType type,
                           const std::string& unit, Get get) {
    for (const char* name : names) columns_.add({name}, type, unit);
    fills_.push_back([get](TableRows& table, const Source& source, std::size_t rows) {
      with(get, source, [&](const auto& value) { table.fill_vectors(rows, value); });
    });
    return *this;
  }

  // As Columns has it.
  TableColumns& was(const char* old_name) {
    columns_.was(old_name);
    return *this;
  }

  const Columns& columns() const { return columns_; }

  // Appends so many rows to a table of these columns.
  void fill(TableRows& table, const Source& source, std::size_t rows) const {
    for (const auto& fill : fills_) fill(table, source, rows);
  }

 private:
  // Calls fill(value), where value(i) is that of row i.
  template <class Get, class Fill>
  static void with(const Get& get, const Source& source, const Fill& fill) {
    if constexpr (std::is_invocable_v<const Get&, const Source&, std::size_t>) {
      fill([&](std::size_t i) -> decltype(auto) { return get(source, i); });
    } else if constexpr (std::is_invocable_v<const Get&, const Source&>) {
      const auto& values = std::invoke(get, source);
      fill([&](std::size_t i) -> decltype(auto) { return values[i]; });
    } else {
      fill([&](std::size_t i) -> decltype(auto) { return std::invoke(get, source[i]); });
    }
  }

  Columns columns_;
  std::vector<std::function<void(TableRows&, const Source&, std::size_t)>> fills_;
};

// Writes a table of these columns as a whole.
template <class Source>
void write_table(ResultFile& file, const std::string& name, const TableColumns<Source>& columns,
                 const Source& source, std::size_t rows) {
  ResultTable table(file, name, columns.columns(), {}, rows);
  columns.fill(table, source, rows);
  table.write();
}

}  // namespace gliss
