#include "gliss/tables/result_table.h"

#include <algorithm>

namespace gliss {

Columns& Columns::add(std::initializer_list<const char*> names, ColumnType type,
                      const std::string& unit) {
  for (const char* name : names) {
    for (Column& column : columns_) {
      if (column.old_name == name) column.old_name.clear();
    }
    columns_.push_back({name, type, unit, ""});
  }
  return *this;
}

Columns& Columns::was(const char* old_name) {
  columns_.back().old_name = old_name;
  return *this;
}

std::size_t Columns::place_of(std::string_view name) const {
  const auto is_it = [&](const Column& column) { return column.name == name; };
  return static_cast<std::size_t>(std::find_if(columns_.begin(), columns_.end(), is_it) -
                                  columns_.begin());
}

TableRows::TableRows(const Columns& columns) {
  for (const Column& column : columns.list()) {
    switch (column.type) {
      case ColumnType::kFloat64:
        columns_.emplace_back(std::in_place_type<std::vector<double>>);
        break;
      case ColumnType::kFloat32:
        columns_.emplace_back(std::in_place_type<std::vector<float>>);
        break;
      case ColumnType::kUint32:
        columns_.emplace_back(std::in_place_type<std::vector<std::uint32_t>>);
        break;
      case ColumnType::kUint8:
        columns_.emplace_back(std::in_place_type<std::vector<std::uint8_t>>);
        break;
      case ColumnType::kText:
        columns_.emplace_back(std::in_place_type<std::vector<std::string>>);
        break;
    }
  }
}

std::size_t TableRows::rows() const {
  return std::visit([](const auto& values) { return values.size(); }, columns_.front());
}

std::vector<ColumnData> TableRows::block(std::size_t begin, std::size_t end) const {
  std::vector<ColumnData> block;
  for (const Values& column : columns_) {
    std::visit(
        [&](const auto& values) {
          using Value = typename std::decay_t<decltype(values)>::value_type;
          block.emplace_back(std::span<const Value>(values).subspan(begin, end - begin));
        },
        column);
  }
  return block;
}

void TableRows::clear() {
  for (Values& column : columns_) std::visit([](auto& values) { values.clear(); }, column);
}

void TableRows::put(std::string& bytes) const {
  for (const Values& column : columns_) {
    std::visit(
        [&](const auto& values) {
          using Value = typename std::decay_t<decltype(values)>::value_type;
          if constexpr (std::is_arithmetic_v<Value>)
            bytes.append(reinterpret_cast<const char*>(values.data()),
                         values.size() * sizeof(Value));
        },
        column);
  }
}

bool TableRows::take(std::string_view bytes, std::size_t rows) {
  clear();
  const auto each = [&](const auto& f) {
    for (Values& column : columns_) {
      std::visit(
          [&](auto& values) {
            using Value = typename std::decay_t<decltype(values)>::value_type;
            if constexpr (std::is_arithmetic_v<Value>) f(values, sizeof(Value));
          },
          column);
    }
  };
  std::size_t row_bytes = 0;
  each([&](auto&, std::size_t size) { row_bytes += size; });
  if (rows > bytes.size() / row_bytes || bytes.size() != rows * row_bytes) return false;
  each([&](auto& values, std::size_t size) {
    values.resize(rows);
    bytes.copy(reinterpret_cast<char*>(values.data()), rows * size);
    bytes.remove_prefix(rows * size);
  });
  return true;
}

ResultTable::ResultTable(ResultFile& file, const std::string& name, const Columns& columns,
                         const std::vector<Attribute>& attributes, std::uint64_t expected_rows)
    : TableRows(columns),
      file_(file),
      id_(file.add_table(name, columns.list(), attributes, expected_rows)) {}

void ResultTable::write() {
  append(*this, 0, rows());
  clear();
}

void ResultTable::append(const TableRows& rows, std::size_t begin, std::size_t end) {
  file_.append(id_, rows.block(begin, end));
}

}  // namespace gliss
