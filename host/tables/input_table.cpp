#include "gliss/tables/input_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

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
  if (first_line_ == 0) return fmt::format("{}: row {}", source_, row);
  return fmt::format("{}:{}", source_, first_line_ + row);
}

// Fills a table from HDF5.
class TableColumns {
 public:
  TableColumns(const std::string& path, const TableRequest& request)
      : file_(path, "a table", request.poll) {
    table_.source_ = path;
    const auto is_there = [this](const std::string& name) { return file_.has(name); };
    const auto found = request.choose(is_there);
    if (found == request.alternatives.end() && !request.alternatives.empty()) {
      throw std::runtime_error(
          fmt::format("{}: missing columns: wanted {}", path, request.wanted()));
    }
    if (found != request.alternatives.end()) {
      table_.alternative = static_cast<std::size_t>(found - request.alternatives.begin());
      for (const std::string& name : *found) add(name);
    }
    for (const std::string& name : request.optional) {
      if (is_there(name)) add(name);
    }
    for (const std::string& name : request.texts) {
      if (!is_there(name)) continue;
      table_.text_names_.push_back(name);
      table_.texts_.push_back(file_.texts(name));
      set_rows(name, table_.texts_.back().size());
    }
  }

  InputTable take() { return std::move(table_); }

 private:
  void add(const std::string& name) {
    table_.names_.push_back(name);
    table_.units_.push_back(file_.unit(name).value_or(""));
    const LargeArray<double>& values = table_.values_.emplace_back(file_.numbers(name));
    set_rows(name, values.size());
    const auto bad =
        std::find_if_not(values.begin(), values.end(), [](double x) { return std::isfinite(x); });
    if (bad != values.end()) {
      throw std::runtime_error(
          fmt::format("{}: column '{}': {} is not finite",
                      table_.place(static_cast<std::size_t>(bad - values.begin())), name, *bad));
    }
  }

  void set_rows(const std::string& name, std::size_t rows) {
    if (has_rows_ && rows != table_.rows) {
      throw std::runtime_error(fmt::format("{}: column '{}' has {} rows, others {}", table_.source_,
                                           name, rows, table_.rows));
    }
    has_rows_ = true;
    table_.rows = rows;
  }

  Hdf5Reader file_;
  InputTable table_;
  bool has_rows_ = false;
};

bool is_hdf5(const std::string& path) { return path.ends_with(".h5") || path.ends_with(".hdf5"); }

InputTable read_table(const std::string& path, const TableRequest& request) {
  if (is_npy(path)) return read_npy(path, request);
  if (!is_hdf5(path)) return read_csv(path, request);
  try {
    return TableColumns(path, request).take();
  } catch (const std::runtime_error& error) {
    throw RecordingError(error.what());
  }
}

}  // namespace gliss
