#include "gliss/tables/csv_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "gliss/files/line_reader.h"

namespace gliss {
namespace {

constexpr std::size_t kIgnored = static_cast<std::size_t>(-1);

std::string_view trim(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

class CsvParser {
 public:
  CsvParser(const std::string& path, const TableRequest& request) : lines_(path, request.poll) {
    table_.source_ = path;
    read_header();
    choose_columns(request);
  }

  InputTable read() {
    bool blank = false;
    while (lines_.next(line_)) {
      if (trim(line_).empty()) {
        blank = true;
        continue;
      }
      if (blank) fail("a blank line before this row");
      if (table_.rows++ == 0) table_.first_line_ = lines_.line_number();
      read_row();
      if (table_.rows == 1000) reserve();
    }
    return std::move(table_);
  }

 private:
  void read_header() {
    do {
      if (!lines_.next(line_)) fail("no header");
      if (lines_.line_number() == 1 && line_.starts_with("\xEF\xBB\xBF")) line_.remove_prefix(3);
    } while (trim(line_).empty() || line_.starts_with('#'));
    for (bool more = true; more;) header_.emplace_back(cut_field(more));
  }

  void choose_columns(const TableRequest& request) {
    const auto found =
        request.choose([this](const std::string& name) { return contains(header_, name); });
    const auto& alternatives = request.alternatives;
    if (found == alternatives.end() && !alternatives.empty()) {
      fail(fmt::format("missing columns: wanted {}; the header has {}{}", request.wanted(),
                       fmt::join(header_, ","), header_hint()));
    }
    std::vector<std::string> wanted = request.optional;
    if (found != alternatives.end()) {
      table_.alternative = static_cast<std::size_t>(found - alternatives.begin());
      wanted.insert(wanted.end(), found->begin(), found->end());
    }
    choose(wanted, slots_, table_.names_);
    choose(request.texts, text_slots_, table_.text_names_);
    table_.values_.resize(table_.names_.size());
    table_.texts_.resize(table_.text_names_.size());
  }

  // Returns the cure of a first line that is no header.
  std::string header_hint() const {
    const auto is_number = [](const std::string& name) {
      double value = 0;
      return std::from_chars(name.data(), name.data() + name.size(), value).ec == std::errc();
    };
    if (std::all_of(header_.begin(), header_.end(), is_number))
      return ": the first line names the columns";
    const bool other = header_.size() == 1 && header_[0].find_first_of("; \t") != std::string::npos;
    return other ? ": commas part the columns, and decimals follow a point" : "";
  }

  void choose(const std::vector<std::string>& wanted, std::vector<std::size_t>& slots,
              std::vector<std::string>& names) const {
    for (const std::string& name : header_) {
      slots.push_back(contains(wanted, name) ? names.size() : kIgnored);
      if (slots.back() == kIgnored) continue;
      if (contains(names, name)) fail(fmt::format("two columns are named '{}'", name));
      names.push_back(name);
    }
  }

  void read_row() {
    std::size_t count = 0;
    for (bool more = true; more; ++count) {
      const std::string_view field = cut_field(more);
      if (count < slots_.size() && slots_[count] != kIgnored) {
        table_.values_[slots_[count]].push_back(parse(field, count));
      }
      if (count < text_slots_.size() && text_slots_[count] != kIgnored) {
        table_.texts_[text_slots_[count]].emplace_back(field);
      }
    }
    if (count != header_.size()) {
      fail(fmt::format("{} fields, the header has {}", count, header_.size()));
    }
  }

  // Cuts the next field off line_; `more` says whether a comma followed it.
  std::string_view cut_field(bool& more) {
    const auto start = line_.find_first_not_of(" \t");
    if (start != std::string_view::npos && line_[start] == '"') return cut_quoted(start + 1, more);
    const auto comma = line_.find(',');
    more = comma != std::string_view::npos;
    const std::string_view field = trim(line_.substr(0, comma));
    line_.remove_prefix(more ? comma + 1 : line_.size());
    return field;
  }

  // Doubled quotes stay doubled: no number and no wanted name has any.
  std::string_view cut_quoted(std::size_t begin, bool& more) {
    auto end = line_.find('"', begin);
    while (end != std::string_view::npos && line_.substr(end + 1).starts_with('"')) {
      end = line_.find('"', end + 2);
    }
    if (end == std::string_view::npos) fail("a quoted field does not end on its line");
    const std::string_view field = trim(line_.substr(begin, end - begin));
    line_.remove_prefix(end + 1);
    const auto next = line_.find_first_not_of(" \t");
    more = next != std::string_view::npos;
    if (more && line_[next] != ',') fail("text behind a quoted field");
    line_.remove_prefix(more ? next + 1 : line_.size());
    return field;
  }

  double parse(std::string_view field, std::size_t column) const {
    std::string_view digits = field;
    if (digits.starts_with('+') && !digits.starts_with("+-")) digits.remove_prefix(1);
    const char* end = digits.data() + digits.size();
    double value = 0;
    const auto [stop, error] = std::from_chars(digits.data(), end, value);
    const bool number = stop == end && error != std::errc::invalid_argument;
    if (number && error == std::errc() && std::isfinite(value)) return value;
    const char* problem = !number                ? "is not a number"
                          : error == std::errc() ? "is not finite"
                                                 : "is beyond the range of double";
    fail(fmt::format("column '{}': '{}' {}", header_[column], field.substr(0, 40), problem));
  }

  // From the length of the rows so far: growth by doubling would need half as much again.
  void reserve() {
    const double rows_per_byte =
        static_cast<double>(table_.rows) / static_cast<double>(lines_.bytes_read());
    const double rows = 1.05 * static_cast<double>(lines_.file_size()) * rows_per_byte;
    for (auto& values : table_.values_) values.reserve(static_cast<std::size_t>(rows));
    for (auto& texts : table_.texts_) texts.reserve(static_cast<std::size_t>(rows));
  }

  [[noreturn]] void fail(const std::string& problem) const {
    throw CsvError(fmt::format("{}:{}: {}", table_.source_, lines_.line_number(), problem));
  }

  LineReader lines_;
  InputTable table_;
  std::string_view line_;                        // what is left of the line at hand
  std::vector<std::string> header_;              // [column]
  std::vector<std::size_t> slots_, text_slots_;  // [column], into the table, or kIgnored
};

InputTable read_csv(const std::string& path, const TableRequest& request) {
  return CsvParser(path, request).read();
}

}  // namespace gliss
