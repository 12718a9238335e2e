#include "gliss/tables/result_file.h"

#include <fmt/format.h>

#include <filesystem>
#include <stdexcept>

#include "gliss/tables/result_formats.h"

namespace gliss {

std::unique_ptr<ResultFile> create_result_file(const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension().string();
  if (ending == ".h5" || ending == ".hdf5") return create_hdf5_file(path);
  if (ending == ".npy") return create_npy_file(path);
  if (ending == ".csv" || path == "-") return create_csv_file(path);
  throw std::runtime_error(
      fmt::format("cannot write '{}': results are .h5, .hdf5, .npy or .csv files", path));
}

std::size_t block_rows(const std::vector<Column>& columns, std::span<const ColumnData> block) {
  static_assert(std::variant_size_v<ColumnData> == static_cast<std::size_t>(ColumnType::kText) + 1,
                "the variant lists its types in the order of ColumnType");
  if (block.size() != columns.size()) {
    throw std::logic_error(
        fmt::format("a block of {} columns for a table of {}", block.size(), columns.size()));
  }
  const auto rows_of = [](const ColumnData& data) {
    return std::visit([](const auto& values) { return values.size(); }, data);
  };
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (block[c].index() != static_cast<std::size_t>(columns[c].type)) {
      throw std::logic_error(fmt::format("column '{}': a block of another type", columns[c].name));
    }
    if (rows_of(block[c]) != rows_of(block[0])) {
      throw std::logic_error(fmt::format("column '{}' has {} rows, column '{}' {}", columns[c].name,
                                         rows_of(block[c]), columns[0].name, rows_of(block[0])));
    }
  }
  return columns.empty() ? 0 : rows_of(block[0]);
}

}  // namespace gliss
