#include "gliss/tables/input_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include "gliss/base/poll.h"
#include "gliss/tables/csv_reader.h"
#include "gliss/tables/hdf5_reader.h"
#include "gliss/tables/npy_reader.h"

namespace gliss {
namespace {

template <class Column>
const Column* find_in(const std::vector<std::string>& names, const std::vector<Column>& columns,
                      std::string_view name) {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? nullptr : &columns[static_cast<std::size_t>(found - names.begin())];
}

}  // namespace

std::vector<std::vector<std::string>>::const_iterator TableRequest::choose(
    const std::function<bool(const std::string&)>& is_there) const {
  return std::find_if(alternatives.begin(), alternatives.end(), [&](const auto& names) {
    return std::all_of(names.begin(), names.end(), is_there);
  });
}

std::string TableRequest::wanted() const {
  std::vector<std::string> all;
  for (const auto& names : alternatives) all.push_back(fmt::format("{}", fmt::join(names, ",")));
  return fmt::format("{}", fmt::join(all, " or "));
}

const LargeArray<double>* InputTable::find(std::string_view name) const {
  return find_in(names_, values_, name);
}

const std::vector<std::string>* InputTable::find_text(std::string_view name) const {
  return find_in(text_names_, texts_, name);
}

std::string InputTable::unit(std::string_view name) const {
  const std::string* unit = units_.empty() ? nullptr : find_in(names_, units_, name);
  return unit == nullptr ? "" : *unit;
}

std::string InputTable::place(std::size_t row) const {
  if (first_line_ == 0) return fmt::format("{}: row {}", source_, first_row_ + row);
  return fmt::format("{}:{}", source_, first_line_ + first_row_ + row);
}

InputTable InputTable::part(std::size_t begin, std::size_t end) const {
  InputTable part;
  part.rows = end - begin;
  part.alternative = alternative;
  part.source_ = source_;
  part.first_line_ = first_line_;
  part.first_row_ = first_row_ + begin;
  part.names_ = names_;
  part.units_ = units_;
  part.text_names_ = text_names_;
  const auto rows_of = [&](const auto& columns) {
    std::decay_t<decltype(columns)> some;
    for (const auto& column : columns)
      some.emplace_back(column.data() + begin, column.data() + end);
    return some;
  };
  part.values_ = rows_of(values_);
  part.texts_ = rows_of(texts_);
  return part;
}

// Columns of HDF5.
class Hdf5Table final : public TableReader {
 public:
  Hdf5Table(const std::string& path, const TableRequest& request)
      : file_(path, "a table", request.poll), poll_(request.poll) {
    head_.source_ = path;
    const auto is_there = [this](const std::string& name) { return file_.has(name); };
    const auto found = request.choose(is_there);
    if (found == request.alternatives.end() && !request.alternatives.empty()) {
      throw std::runtime_error(
          fmt::format("{}: missing columns: wanted {}", path, request.wanted()));
    }
    if (found != request.alternatives.end()) {
      head_.alternative = static_cast<std::size_t>(found - request.alternatives.begin());
      for (const std::string& name : *found) add(name);
    }
    for (const std::string& name : request.optional) {
      if (is_there(name)) add(name);
    }
    for (const std::string& name : request.texts) {
      if (!is_there(name)) continue;
      head_.text_names_.push_back(name);
      texts_.push_back(file_.texts(name));
      set_rows(name, texts_.back().size());
    }
  }

  std::size_t rows() const override { return head_.rows; }
  std::size_t chunk_rows() const { return chunk_rows_; }  // the most of a column

  InputTable read(std::size_t begin, std::size_t end) override {
    InputTable table = head_;
    table.rows = end - begin;
    table.first_row_ = begin;
    for (const std::string& name : head_.names_) {
      const LargeArray<double>& values = table.values_.emplace_back(numbers(name, begin, end));
      const auto bad = std::find_if_not(values.begin(), values.end(), [&](double x) {
        poll_();
        return std::isfinite(x);
      });
      if (bad != values.end()) {
        throw RecordingError(
            fmt::format("{}: column '{}': {} is not finite",
                        table.place(static_cast<std::size_t>(bad - values.begin())), name, *bad));
      }
    }
    for (const auto& texts : texts_)
      table.texts_.emplace_back(texts.data() + begin, texts.data() + end);
    return table;
  }

 private:
  LargeArray<double> numbers(const std::string& name, std::size_t begin, std::size_t end) const {
    try {
      return file_.numbers(name, begin, end);
    } catch (const std::runtime_error& error) {
      throw RecordingError(error.what());
    }
  }

  void add(const std::string& name) {
    head_.names_.push_back(name);
    head_.units_.push_back(file_.unit(name).value_or(""));
    set_rows(name, file_.rows(name));
    chunk_rows_ = std::max(chunk_rows_, file_.chunk_rows(name));
  }

  void set_rows(const std::string& name, std::size_t rows) {
    if (has_rows_ && rows != head_.rows) {
      throw std::runtime_error(fmt::format("{}: column '{}' has {} rows, others {}", head_.source_,
                                           name, rows, head_.rows));
    }
    has_rows_ = true;
    head_.rows = rows;
  }

  Hdf5Reader file_;
  ItemPoll poll_;
  InputTable head_;                              // all but the values
  std::vector<std::vector<std::string>> texts_;  // whole
  bool has_rows_ = false;
  std::size_t chunk_rows_ = 1;
};

namespace {

constexpr std::size_t kMostChunkRows = 1 << 17;  // that are unpacked for each part again

std::unique_ptr<Hdf5Table> open_hdf5(const std::string& path, const TableRequest& request) {
  try {
    return std::make_unique<Hdf5Table>(path, request);
  } catch (const std::runtime_error& error) {
    throw RecordingError(error.what());
  }
}

// A table that was read as a whole.
class WholeTable final : public TableReader {
 public:
  explicit WholeTable(InputTable table) : table_(std::move(table)) {}
  std::size_t rows() const override { return table_.rows; }
  InputTable read(std::size_t begin, std::size_t end) override { return table_.part(begin, end); }

 private:
  InputTable table_;
};

}  // namespace

bool is_hdf5(const std::string& path) { return path.ends_with(".h5") || path.ends_with(".hdf5"); }

InputTable read_table(const std::string& path, const TableRequest& request) {
  const auto whole = [](TableReader& reader) { return reader.read(0, reader.rows()); };
  if (is_npy(path)) return whole(*open_npy(path, request));
  return is_hdf5(path) ? whole(*open_hdf5(path, request)) : read_csv(path, request);
}

std::unique_ptr<TableReader> open_table(const std::string& path, const TableRequest& request) {
  if (is_npy(path)) return open_npy(path, request);
  if (is_hdf5(path)) {
    auto reader = open_hdf5(path, request);
    if (reader->chunk_rows() <= kMostChunkRows) return reader;
  }
  return std::make_unique<WholeTable>(read_table(path, request));
}

}  // namespace gliss
