// Results as .npy: NumPy's own format, one structured array with a field a column.
#include <fmt/format.h>

#include <bit>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <system_error>

#include "gliss/files/atomic_file.h"
#include "gliss/tables/npy_format.h"
#include "gliss/tables/result_formats.h"

namespace gliss {
namespace {

static_assert(std::endian::native == std::endian::little, "fields are written as they lie");

const char* descr_of(ColumnType type) {
  switch (type) {
    case ColumnType::kFloat64:
      return "<f8";
    case ColumnType::kFloat32:
      return "<f4";
    case ColumnType::kUint32:
      return "<u4";
    case ColumnType::kUint8:
      return "|u1";
    case ColumnType::kText:
      break;
  }
  static_assert(kTextBytes == 64);
  return "|S64";
}

class NpyFile final : public ResultFile {
 public:
  explicit NpyFile(const std::string& path)
      : file_(path), stream_(std::fopen(file_.temporary_path().c_str(), "r+b"), &std::fclose) {
    check(stream_ != nullptr);
  }

  TableId add_table(const std::string& table, const std::vector<Column>& columns,
                    const std::vector<Attribute>&, std::uint64_t) override {
    if (!columns_.empty()) {
      throw std::runtime_error(fmt::format(
          "cannot add table '{}' to '{}': a .npy file holds one, use .h5", table, file_.path()));
    }
    columns_ = columns;
    write_header();
    return 0;
  }

  void append(TableId, std::span<const ColumnData> block) override {
    const std::size_t rows = block_rows(columns_, block);
    bytes_.clear();
    for (std::size_t row = 0; row < rows; ++row) {
      for (const ColumnData& data : block)
        std::visit([&](const auto& values) { put(values[row]); }, data);
    }
    check(std::fwrite(bytes_.data(), 1, bytes_.size(), stream_.get()) == bytes_.size());
    rows_ += rows;
  }

  void set_attribute(const Attribute&) override {}

  void close() override {
    check(std::fseek(stream_.get(), 0, SEEK_SET) == 0);
    write_header();  // as long as it was, with the number of rows
    check(std::fclose(stream_.release()) == 0);
    file_.commit();
  }

 private:
  void check(bool is_done) const {
    if (is_done) return;
    throw std::system_error(errno, std::generic_category(),
                            fmt::format("cannot write '{}'", file_.path()));
  }

  void write_header() {
    std::string fields;
    for (const Column& column : columns_) {
      const std::string name = column.old_name.empty()
                                   ? fmt::format("'{}'", column.name)
                                   : fmt::format("('{}', '{}')", column.old_name, column.name);
      fields += fmt::format("({}, '{}'), ", name, descr_of(column.type));
    }
    const std::string header = npy::header_of(fmt::format(
        "{{'descr': [{}], 'fortran_order': False, 'shape': ({:>20},), }}", fields, rows_));
    check(std::fwrite(header.data(), 1, header.size(), stream_.get()) == header.size());
  }

  template <class Number>
  void put(Number value) {
    const auto* from = reinterpret_cast<const char*>(&value);
    bytes_.insert(bytes_.end(), from, from + sizeof value);
  }
  void put(const std::string& text) {
    if (text.size() > kTextBytes)
      throw std::logic_error(fmt::format("'{}' is longer than {} bytes", text, kTextBytes));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
    bytes_.resize(bytes_.size() + kTextBytes - text.size(), '\0');
  }

  AtomicFile file_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream_;
  std::vector<Column> columns_;
  std::vector<char> bytes_;
  std::uint64_t rows_ = 0;
};

}  // namespace

std::unique_ptr<ResultFile> create_npy_file(const std::string& path) {
  return std::make_unique<NpyFile>(path);
}

}  // namespace gliss
