// Tables of figures on their way to a file: HDF5 (self-describing), CSV or NumPy's .npy,
// chosen by the file's ending.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "gliss/base/export.h"

namespace gliss {

enum class ColumnType { kFloat64, kFloat32, kUint32, kUint8, kText };
inline constexpr std::size_t kTextBytes = 64;  // that a text of an HDF5 column may have

struct Column {
  std::string name;  // "scp_x"
  ColumnType type = ColumnType::kFloat64;
  std::string unit;  // "m", "N", "rad"; empty: a plain number
  // A name that the column had, which finds it as well: a link in HDF5, a title in .npy, and in CSV
  // the same numbers once more, behind all others.
  std::string old_name{};
};

// One block of rows of one column; every column of an append has the same number of rows.
using ColumnData =
    std::variant<std::span<const double>, std::span<const float>, std::span<const std::uint32_t>,
                 std::span<const std::uint8_t>, std::span<const std::string>>;

// A fact about a whole file: command line, version, mesh hash, units. Written as HDF5
// attributes of the root group; left out of CSV, whose first line is its header, and of .npy.
struct Attribute {
  std::string name;
  std::variant<std::string, double, std::int64_t> value;
};

// For one thread. Memory stays bounded by the blocks appended. Nothing appears under `path` before
// close(): data goes to a temporary file in the same folder, which is synced and renamed; a writer
// destroyed before close() removes it.
class GLISS_EXPORT ResultFile {
 public:
  using TableId = std::size_t;
  virtual ~ResultFile() = default;
  // `table` is a path such as "sweep/depth_2mm/gregory" (an HDF5 group with a 1-D dataset per
  // column). A CSV or .npy file holds one table. Rows are appended in order. expected_rows = 0:
  // unknown.
  virtual TableId add_table(const std::string& table, const std::vector<Column>& columns,
                            const std::vector<Attribute>& attributes = {},
                            std::uint64_t expected_rows = 0) = 0;
  virtual void append(TableId table, std::span<const ColumnData> columns) = 0;
  virtual void set_attribute(const Attribute& attribute) = 0;
  virtual void close() = 0;
};

// .h5 and .hdf5: HDF5, and behind its end a checksum (file_seal.h); .csv: CSV with the fewest
// digits that read back as the same bits (at most 17 for float64, 9 for float32), "-": CSV on
// standard output; .npy: one structured array, texts as bytes (S64). Throws std::runtime_error that
// names the file on any failure (also a full disk: every return value is checked), std::logic_error
// on blocks that do not fit their table and on texts that do not fit a column of HDF5 or .npy.
GLISS_EXPORT std::unique_ptr<ResultFile> create_result_file(const std::string& path);

}  // namespace gliss
