#include "gliss/tables/result_table.h"

namespace gliss {

Columns& Columns::add(std::initializer_list<const char*> names, ColumnType type,
                      const std::string& unit) {
  for (const char* name : names) columns_.push_back({name, type, unit});
  return *this;
}

ResultTable::ResultTable(ResultFile& file, const std::string& name, const Columns& columns,
                         const std::vector<Attribute>& attributes, std::uint64_t expected_rows)
    : file_(file), id_(file.add_table(name, columns.list(), attributes, expected_rows)) {
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

std::size_t ResultTable::rows() const {
  return std::visit([](const auto& values) { return values.size(); }, columns_.front());
}

void ResultTable::write() {
  std::vector<ColumnData> block;
  for (const Values& column : columns_) {
    std::visit(
        [&](const auto& values) {
          using Value = typename std::decay_t<decltype(values)>::value_type;
          block.emplace_back(std::span<const Value>(values));
        },
        column);
  }
  file_.append(id_, block);
  for (Values& column : columns_) std::visit([](auto& values) { values.clear(); }, column);
}

}  // namespace gliss
