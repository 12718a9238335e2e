// Tables as commands fill them: a column at a time, from anything indexed by row.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/tables/result_file.h"

namespace gliss {

// Columns under construction: add({"x", "y", "z"}, ColumnType::kFloat64, "mm").
class GLISS_EXPORT Columns {
 public:
  Columns& add(std::initializer_list<const char*> names, ColumnType type = ColumnType::kFloat64,
               const std::string& unit = "");
  // The last column has been called so. A column that is added by that name later takes it.
  Columns& was(const char* old_name);
  const std::vector<Column>& list() const { return columns_; }
  std::size_t place_of(std::string_view name) const;  // in the list, which has it

 private:
  std::vector<Column> columns_;
};

// Rows of a table in memory.
class GLISS_EXPORT TableRows {
 public:
  explicit TableRows(const Columns& columns);

  // Appends get(0) ... get(rows - 1) to the next column, from the first on, round and round.
  template <class Get>
  void fill(std::size_t rows, Get get) {
    std::visit(
        [&](auto& values) {
          using Value = typename std::decay_t<decltype(values)>::value_type;
          const std::size_t old = values.size();
          values.resize(old + rows);
          for (std::size_t i = 0; i < rows; ++i) {
            // A column of text is filled with text, one of numbers with numbers.
            if constexpr (std::is_convertible_v<decltype(get(i)), std::string> ==
                          std::is_same_v<Value, std::string>) {
              values[old + i] = static_cast<Value>(get(i));
            }
          }
        },
        columns_[next_]);
    next_ = (next_ + 1) % columns_.size();
  }

  // The next three columns from vectors.
  template <class Get>
  void fill_vectors(std::size_t rows, Get get) {
    for (int axis = 0; axis < 3; ++axis) {
      fill(rows, [&](std::size_t i) { return get(i)[axis]; });
    }
  }

  std::size_t rows() const;
  // The rows [begin, end) of all columns; lasts until the next change.
  std::vector<ColumnData> block(std::size_t begin, std::size_t end) const;
  void clear();

  // Appends all columns of numbers, one behind the other, as they lie in memory; and takes so many
  // rows from there: false, and no rows, where these are not all that `bytes` holds.
  void put(std::string& bytes) const;
  bool take(std::string_view bytes, std::size_t rows);

 private:
  using Values = std::variant<std::vector<double>, std::vector<float>, std::vector<std::uint32_t>,
                              std::vector<std::uint8_t>, std::vector<std::string>>;

  std::vector<Values> columns_;
  std::size_t next_ = 0;
};

// Rows that wait for the next write(). The file must outlive the table.
class GLISS_EXPORT ResultTable : public TableRows {
 public:
  ResultTable(ResultFile& file, const std::string& name, const Columns& columns,
              const std::vector<Attribute>& attributes = {}, std::uint64_t expected_rows = 0);

  ResultFile::TableId id() const { return id_; }
  void write();  // all that was filled in
  // Writes rows [begin, end) of others with these columns.
  void append(const TableRows& rows, std::size_t begin, std::size_t end);

 private:
  ResultFile& file_;
  ResultFile::TableId id_;
};

}  // namespace gliss
