// Results as HDF5: a group a table, in it a 1-D dataset a column with its unit as attribute:
// extendible, or plain, of a size and at a place that never change.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "gliss/files/atomic_file.h"
#include "gliss/tables/file_seal.h"
#include "gliss/tables/hdf5_handle.h"
#include "gliss/tables/hdf5_types.h"
#include "gliss/tables/plain_file.h"
#include "gliss/tables/result_formats.h"

namespace gliss {
namespace {

using hdf5::Handle;

// Measured: chunks of 65,536 rows compress no better and write a third slower.
constexpr hsize_t kChunkRows = 16384;

// A compact one is no more than a ResultFile.
class Hdf5File final : public PlainFile {
 public:
  // Plain with `hashes`.
  explicit Hdf5File(const std::string& path, BlockHashes hashes = nullptr)
      : output_(path),
        action_(action_of(path)),
        temporary_(output_->temporary_path()),
        hashes_(std::move(hashes)) {
    spare_exit();
    hdf5::Quiet quiet;
    const Handle creation = hdf5::properties(H5P_FILE_CREATE);
    check(H5Pset_obj_track_times(creation, false));
    check(H5Pset_link_creation_order(creation, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED));
    file_ = {H5Fcreate(temporary_.c_str(), H5F_ACC_TRUNC, creation, access_by(nullptr)), H5Fclose,
             action_};
  }

  // Joined.
  Hdf5File(const std::string& temporary, const std::string& path, const Hdf5Access& access)
      : action_(action_of(path)), temporary_(temporary) {
    spare_exit();
    hdf5::Quiet quiet;
    open(access);
  }

  ~Hdf5File() override {
    hdf5::Quiet quiet;
    if (is_shared_) {
      for (Handle& dataset : datasets_) dataset.release();
      file_.release();
      return;
    }
    // Emptied first: on a full disk closing now has room for what HDF5 still wants to write.
    if (output_) (void)!truncate(temporary_.c_str(), 0);
    datasets_.clear();
    file_ = {};
  }

  TableId add_table(const std::string& name, const std::vector<Column>& columns,
                    const std::vector<Attribute>& attributes,
                    std::uint64_t expected_rows) override {
    hdf5::Quiet quiet;
    tables_.push_back({name.empty() ? "/" : name, columns, 0, 0});
    Table& table = tables_.back();
    if (!output_) return tables_.size() - 1;  // the other process has made it
    close_datasets();
    const Handle group = open_or_create_group(name);
    for (const Attribute& attribute : attributes) hdf5::write_attribute(group, attribute, action_);
    if (!is_plain())
      table.chunk = expected_rows ? std::min<hsize_t>(expected_rows, kChunkRows) : kChunkRows;
    for (const Column& column : columns) add_column(group, column, table.chunk, expected_rows);
    return tables_.size() - 1;
  }

  void append(TableId id, std::span<const ColumnData> block) override {
    hdf5::Quiet quiet;
    Table& table = tables_.at(id);
    const hsize_t rows = block_rows(table.columns, block);
    if (rows == 0) return;
    open_datasets(id);
    const hsize_t total = table.rows + rows;
    if (is_plain()) {
      for (std::size_t c = 0; c < block.size(); ++c)
        write_block(datasets_[c], table, table.columns[c].type, rows, block[c]);
      table.rows = total;
      if (output_) output_->start_sync();
      return;
    }
    // Chunks that are full go to disk, so that a full disk is noticed now. Those of a column lie
    // together, behind the indexes of all columns, which the first rows make.
    const bool full = total / table.chunk > table.rows / table.chunk;
    for (std::size_t c = 0; c < block.size(); ++c) {
      check(H5Dset_extent(datasets_[c], &total));
      write_block(datasets_[c], table, table.columns[c].type, rows, block[c]);
      if (full && table.rows > 0) check(H5Dflush(datasets_[c]));
    }
    table.rows = total;
    if (!full) return;
    check(H5Fflush(file_, H5F_SCOPE_GLOBAL));
    output_->start_sync();
  }

  void seek(TableId id, std::uint64_t row) override { tables_.at(id).rows = row; }

  void set_attribute(const Attribute& attribute) override {
    hdf5::Quiet quiet;
    if (output_) hdf5::write_attribute(file_, attribute, action_);
  }

  void reopen(const Hdf5Access& access) override {
    hdf5::Quiet quiet;
    close_file();
    open(access);
  }

  const std::string& temporary_path() const override { return temporary_; }

  void close() override {
    hdf5::Quiet quiet;
    close_file();
    if (!output_) return;
    if (hashes_)
      append_seal(temporary_, output_->path(), hashes_(temporary_));
    else
      append_seal(temporary_, output_->path());
    output_->commit();
  }

 private:
  struct Table {
    std::string name;
    std::vector<Column> columns;
    hsize_t rows;   // before the next one
    hsize_t chunk;  // 0: plain
  };

  static std::string action_of(const std::string& path) {
    return fmt::format("cannot write '{}'", path);
  }
  // At exit HDF5 crashes on a file that it could not close, in place of our message and exit code.
  // It has to be told before it is used.
  static void spare_exit() { H5dont_atexit(); }
  bool is_plain() const { return hashes_ || !output_; }

  Handle access_by(const Hdf5Access& access) const {
    // The temporary is ours alone: its lock would only fail on network shares without locks.
    Handle list = hdf5::properties(H5P_FILE_ACCESS);
    check(H5Pset_file_locking(list, false, true));
    check(H5Pset_fclose_degree(list, H5F_CLOSE_STRONG));
    if (access) access(list);
    return list;
  }

  void open(const Hdf5Access& access) {
    file_ = {H5Fopen(temporary_.c_str(), H5F_ACC_RDWR, access_by(access)), H5Fclose, action_};
    is_shared_ = access != nullptr;
  }

  void close_file() {
    close_datasets();
    // Flushed first: a file whose close fails can be closed no more, one whose flush fails can.
    check(H5Fflush(file_, H5F_SCOPE_GLOBAL));
    file_.close(action_);
    is_shared_ = false;
  }

  template <class Result>
  Result check(Result result) const {
    return hdf5::check(result, action_);
  }

  Handle open_or_create_group(const std::string& name) const {
    if (name.empty()) return {H5Gopen2(file_, "/", H5P_DEFAULT), H5Gclose, action_};
    // The parent of another table.
    const hid_t existing = H5Gopen2(file_, name.c_str(), H5P_DEFAULT);
    if (existing >= 0) return {existing, H5Gclose, action_};
    const Handle links = hdf5::properties(H5P_LINK_CREATE),
                 creation = hdf5::properties(H5P_GROUP_CREATE);
    check(H5Pset_create_intermediate_group(links, 1));
    check(H5Pset_obj_track_times(creation, false));
    check(H5Pset_link_creation_order(creation, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED));
    return {H5Gcreate2(file_, name.c_str(), links, creation, H5P_DEFAULT), H5Gclose, action_};
  }

  void add_column(hid_t group, const Column& column, hsize_t chunk, hsize_t rows) const {
    const hsize_t size = chunk > 0 ? 0 : rows, most = chunk > 0 ? H5S_UNLIMITED : rows;
    const Handle space(H5Screate_simple(1, &size, &most), H5Sclose, action_);
    const Handle creation = hdf5::properties(H5P_DATASET_CREATE);
    if (chunk > 0) {
      check(H5Pset_chunk(creation, 1, &chunk));
    } else {
      check(H5Pset_alloc_time(creation, H5D_ALLOC_TIME_EARLY));
      check(H5Pset_fill_time(creation, H5D_FILL_TIME_NEVER));
    }
    check(H5Pset_obj_track_times(creation, false));
    if (chunk > 0 && hdf5::representation(column.type).compressed) {
      check(H5Pset_shuffle(creation));
      check(H5Pset_deflate(creation, 1));
    }
    const Handle dataset(
        H5Dcreate2(group, column.name.c_str(), hdf5::representation(column.type).in_file, space,
                   H5P_DEFAULT, creation, H5P_DEFAULT),
        H5Dclose, fmt::format("{}: column '{}'", action_, column.name));
    if (!column.unit.empty()) hdf5::write_attribute(dataset, {"unit", column.unit}, action_);
    if (!column.old_name.empty())
      check(H5Lcreate_hard(group, column.name.c_str(), group, column.old_name.c_str(), H5P_DEFAULT,
                           H5P_DEFAULT));
  }

  // Only the table at hand is open: an open dataset holds a chunk in memory, and tables may be
  // thousands.
  void open_datasets(TableId id) {
    if (open_table_ == id && !datasets_.empty()) return;
    close_datasets();
    const Handle group(H5Gopen2(file_, tables_[id].name.c_str(), H5P_DEFAULT), H5Gclose, action_);
    for (const Column& column : tables_[id].columns) {
      datasets_.emplace_back(H5Dopen2(group, column.name.c_str(), H5P_DEFAULT), H5Dclose, action_);
    }
    open_table_ = id;
  }

  void close_datasets() {
    for (Handle& dataset : datasets_) dataset.close(action_);
    datasets_.clear();
  }

  void write_block(hid_t dataset, const Table& table, ColumnType type, hsize_t rows,
                   const ColumnData& data) const {
    std::string texts;
    const void* values =
        std::visit([](const auto& span) -> const void* { return span.data(); }, data);
    if (type == ColumnType::kText) {
      for (const std::string& text : std::get<std::span<const std::string>>(data)) {
        if (text.size() > kTextBytes)
          throw std::logic_error(fmt::format("{}: a text of over {} bytes", action_, kTextBytes));
        texts.append(text).append(kTextBytes - text.size(), '\0');
      }
      values = texts.data();
    }
    write_rows(dataset, table, hdf5::representation(type), rows, static_cast<const char*>(values));
  }

  // Writes rows behind those that the table has. A whole chunk that is in the file as it is in
  // memory goes there at once: HDF5 would fill one of its own with zeros, and copy it there.
  void write_rows(hid_t dataset, const Table& table, const hdf5::Representation& type, hsize_t rows,
                  const char* values) const {
    const hsize_t total = table.rows + rows;
    const bool as_is = table.chunk > 0 && table.rows > 0 && !type.compressed &&
                       check(H5Tequal(type.in_file, type.in_memory)) > 0;
    for (hsize_t begin = table.rows, end; begin < total; begin = end) {
      end = as_is ? std::min(total, (begin / table.chunk + 1) * table.chunk) : total;
      const hsize_t count = end - begin, bytes = count * H5Tget_size(type.in_memory);
      if (as_is && count == table.chunk) {
        check(H5Dwrite_chunk(dataset, H5P_DEFAULT, 0, &begin, bytes, values));
      } else {
        const Handle memory(H5Screate_simple(1, &count, nullptr), H5Sclose, action_);
        const Handle space(H5Dget_space(dataset), H5Sclose, action_);
        check(H5Sselect_hyperslab(space, H5S_SELECT_SET, &begin, nullptr, &count, nullptr));
        check(H5Dwrite(dataset, type.in_memory, memory, space, H5P_DEFAULT, values));
      }
      values += bytes;
    }
  }

  // First in, last out: removes the temporary after HDF5 has closed it. Another's, where joined.
  std::optional<AtomicFile> output_;
  std::string action_, temporary_;
  BlockHashes hashes_;
  Handle file_;
  bool is_shared_ = false;  // by MPI-IO, until it is closed
  std::vector<Table> tables_;
  std::vector<Handle> datasets_;  // of open_table_, one a column
  TableId open_table_ = 0;
};

}  // namespace

std::unique_ptr<ResultFile> create_hdf5_file(const std::string& path) {
  return std::make_unique<Hdf5File>(path);
}

std::unique_ptr<PlainFile> create_plain_file(const std::string& path, const BlockHashes& hashes) {
  return std::make_unique<Hdf5File>(path, hashes);
}

std::unique_ptr<PlainFile> join_plain_file(const std::string& temporary, const std::string& path,
                                           const Hdf5Access& access) {
  return std::make_unique<Hdf5File>(temporary, path, access);
}

}  // namespace gliss
