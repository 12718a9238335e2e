#include "gliss/tables/npy_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>

#include "gliss/base/poll.h"
#include "gliss/files/open_file.h"
#include "gliss/tables/csv_reader.h"
#include "gliss/tables/npy_format.h"

namespace gliss {
namespace {

// A number of an array: "<f8", "<i4", "|u1". kind 0: none that is read.
struct NumberType {
  char kind = 0;
  std::size_t bytes = 0;
};

struct Field {
  std::string name;  // empty: an array without names
  std::string descr;
  NumberType type;
  std::size_t offset = 0, stride = 0;  // of a row's number, from the first byte of the data
};

// Reads the literal of Python that a header is: as much of it as NumPy writes.
class HeaderParser {
 public:
  explicit HeaderParser(std::string_view text) : rest_(text) {}

  std::vector<Field> fields;
  bool is_fortran = false;
  std::vector<std::uint64_t> shape;

  // False where it is no such header.
  bool parse() {
    if (!take('{')) return false;
    while (!take('}')) {
      const auto key = text();
      if (!key || !take(':')) return false;
      const bool is_read = *key == "descr"           ? read_descr()
                           : *key == "fortran_order" ? read_order()
                           : *key == "shape"         ? read_shape()
                                                     : false;
      if (!is_read) return false;
      take(',');
    }
    return !fields.empty();
  }

 private:
  void skip() { rest_.remove_prefix(std::min(rest_.find_first_not_of(" \n"), rest_.size())); }
  bool take(char c) { return take(std::string_view(&c, 1)); }
  bool take(std::string_view word) {
    skip();
    if (!rest_.starts_with(word)) return false;
    rest_.remove_prefix(word.size());
    return true;
  }
  std::optional<std::string> text() {
    skip();
    if (rest_.empty() || (rest_[0] != '\'' && rest_[0] != '"')) return {};
    const std::size_t end = rest_.find(rest_[0], 1);
    if (end == rest_.npos) return {};
    std::string found(rest_.substr(1, end - 1));
    rest_.remove_prefix(end + 1);
    return found;
  }
  bool add_field(std::string name, const std::optional<std::string>& descr) {
    if (!descr) return false;
    fields.push_back({std::move(name), *descr, {}, 0, 0});
    return true;
  }
  // A name, or a title that NumPy finds the field by as well, and the name.
  std::optional<std::string> field_name() {
    if (!take('(')) return text();
    if (!text() || !take(',')) return {};
    const auto name = text();
    return take(')') ? name : std::nullopt;
  }
  bool read_descr() {
    if (!take('[')) return add_field("", text());
    while (!take(']')) {
      if (!take('(')) return false;
      const auto name = field_name();
      if (!name || name->empty() || !take(',') || !add_field(*name, text())) return false;
      if (!take(')')) return false;  // a third word is the shape of fields that are arrays
      take(',');
    }
    return true;
  }
  bool read_order() {
    is_fortran = take("True");
    return is_fortran || take("False");
  }
  bool read_shape() {
    if (!take('(')) return false;
    while (!take(')')) {
      skip();
      std::uint64_t count = 0;
      const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), count);
      if (error != std::errc()) return false;
      rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
      shape.push_back(count);
      take(',');
    }
    return true;
  }

  std::string_view rest_;
};

// The bytes of a field of a type that is known, numbers or not; 0: unknown.
std::size_t size_of(const std::string& descr) {
  std::size_t count = 0;
  if (descr.size() < 3 ||
      std::from_chars(&descr[2], descr.data() + descr.size(), count).ec != std::errc())
    return 0;
  constexpr std::size_t kMost = 1 << 20;
  if (count > kMost || std::string_view("<|=>").find(descr[0]) == std::string_view::npos) return 0;
  return descr[1] == 'U'                                                       ? 4 * count
         : std::string_view("fiubSV").find(descr[1]) != std::string_view::npos ? count
                                                                               : 0;
}

NumberType number_type(const std::string& descr) {
  const std::size_t bytes = size_of(descr);
  if (descr.size() != 3 || descr[0] == '>') return {};
  const bool is_float = descr[1] == 'f' && (bytes == 4 || bytes == 8),
             is_whole =
                 (descr[1] == 'i' || descr[1] == 'u') && std::has_single_bit(bytes) && bytes <= 8;
  return is_float || is_whole ? NumberType{descr[1], bytes} : NumberType{};
}

template <class Number>
double number_at(const char* from) {
  Number number;
  std::memcpy(&number, from, sizeof number);
  return static_cast<double>(number);
}

double number_at(const char* from, NumberType type) {
  const bool is_signed = type.kind == 'i';
  if (type.kind == 'f') return type.bytes == 8 ? number_at<double>(from) : number_at<float>(from);
  switch (type.bytes) {
    case 1:
      return is_signed ? number_at<std::int8_t>(from) : number_at<std::uint8_t>(from);
    case 2:
      return is_signed ? number_at<std::int16_t>(from) : number_at<std::uint16_t>(from);
    case 4:
      return is_signed ? number_at<std::int32_t>(from) : number_at<std::uint32_t>(from);
    default:
      return is_signed ? number_at<std::int64_t>(from) : number_at<std::uint64_t>(from);
  }
}

}  // namespace

class NpyTable final : public TableReader {
 public:
  NpyTable(const std::string& path, const TableRequest& request)
      : path_(path), poll_(request.poll), file_(path) {
    head_.source_ = path;
    file_.check();
    find_fields(request);
    const auto is_there = [&](const std::string& name) { return find(name) != nullptr; };
    const auto found = request.choose(is_there);
    if (found == request.alternatives.end() && !request.alternatives.empty())
      refuse(fmt::format("missing columns: wanted {}", request.wanted()));
    if (found != request.alternatives.end()) {
      head_.alternative = static_cast<std::size_t>(found - request.alternatives.begin());
      for (const std::string& name : *found) add(name);
    }
    for (const std::string& name : request.optional) {
      if (is_there(name)) add(name);
    }
  }

  std::size_t rows() const override { return head_.rows; }

  InputTable read(std::size_t begin, std::size_t end) override {
    InputTable table = head_;
    table.rows = end - begin;
    table.first_row_ = begin;
    for (const std::string& name : head_.names_) read(name, begin, table);
    return table;
  }

 private:
  [[noreturn]] void refuse(const std::string& why) const {
    throw CsvError(fmt::format("{}: {}", path_, why));
  }

  // Names all fields and says where they lie.
  void find_fields(const TableRequest& request) {
    constexpr std::size_t kShort = 10, kLong = 12;
    std::string start(kLong, '\0');
    if (file_.read_at(0, start.data(), kLong) < kLong || !start.starts_with(npy::kMagic))
      refuse("not an .npy file");
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(start[i]); };
    const bool is_short = byte(6) == 1;
    if (!is_short && byte(6) != 2 && byte(6) != 3) refuse("a version of .npy that is not known");
    std::size_t length = byte(8) | byte(9) << 8;
    if (!is_short)
      length |= static_cast<std::size_t>(byte(10)) << 16 | static_cast<std::size_t>(byte(11)) << 24;
    const std::size_t begin = is_short ? kShort : kLong;
    if (length > file_.size() - begin) refuse("the file ends within its header");
    std::string text(length, '\0');
    read_whole(begin, text);
    HeaderParser header(text);
    if (!header.parse())
      refuse("a header that NumPy does not write, or fields that are not numbers");
    begin_ = begin + length;
    place(header, request);
  }

  void place(HeaderParser& header, const TableRequest& request) {
    fields_ = std::move(header.fields);
    const bool is_plain = fields_.front().name.empty();
    if (header.shape.size() != (is_plain ? 2u : 1u))
      refuse(is_plain ? "an array without names must have two dimensions"
                      : "a structured array must have one dimension");
    head_.rows = header.shape[0];
    if (is_plain) name_columns(header.shape[1], request);
    std::size_t width = 0;
    for (Field& field : fields_) {
      const std::size_t bytes = size_of(field.descr);
      if (bytes == 0) refuse(fmt::format("'{}' is a type that is not read", field.descr));
      field.type = number_type(field.descr);
      field.offset = width;
      width += bytes;
    }
    const std::uint64_t data = file_.size() - begin_;
    if (head_.rows > data || data % width != 0 || data / width != head_.rows)
      refuse(fmt::format("its header says {} rows of {} bytes, and {} bytes follow", head_.rows,
                         width, data));
    for (Field& field : fields_) {
      const bool by_column = header.is_fortran && is_plain;
      field.stride = by_column ? field.type.bytes : width;
      if (by_column) field.offset *= head_.rows;
      field.offset += begin_;
    }
  }

  // Gives the columns of an array without names those of the first alternative that has as many.
  void name_columns(std::uint64_t columns, const TableRequest& request) {
    for (const auto& names : request.alternatives) {
      if (names.size() != columns) continue;
      const Field any = fields_.front();
      fields_.assign(names.size(), any);
      for (std::size_t i = 0; i < names.size(); ++i) fields_[i].name = names[i];
      return;
    }
    refuse(
        fmt::format("an array of {} columns without names; wanted {}", columns, request.wanted()));
  }

  const Field* find(const std::string& name) const {
    for (const Field& field : fields_) {
      if (field.name == name) return &field;
    }
    return nullptr;
  }

  void add(const std::string& name) {
    const Field& field = *find(name);
    if (field.type.kind == 0)
      refuse(fmt::format("column '{}': '{}' is not a type of little-endian numbers", name,
                         field.descr));
    head_.names_.push_back(name);
  }

  // Reads the rows of a table from `begin` on, some at a time.
  void read(const std::string& name, std::size_t begin, InputTable& table) {
    constexpr std::size_t kBlock = 1 << 20;  // bytes, about
    const Field& field = *find(name);
    const std::size_t most = std::max<std::size_t>(kBlock / field.stride, 1);
    LargeArray<double>& values = table.values_.emplace_back();
    values.reserve(table.rows);
    std::string bytes;
    while (values.size() < table.rows) {
      const std::size_t done = values.size(), count = std::min(most, table.rows - done);
      bytes.resize((count - 1) * field.stride + field.type.bytes);
      read_whole(field.offset + (begin + done) * field.stride, bytes);
      for (std::size_t row = 0; row < count; ++row) {
        poll_();
        values.push_back(number_at(&bytes[row * field.stride], field.type));
        if (!std::isfinite(values.back()))
          throw CsvError(fmt::format("{}: column '{}': {} is not finite", table.place(done + row),
                                     name, values.back()));
      }
    }
  }

  void read_whole(std::uint64_t at, std::string& bytes) {
    if (file_.read_at(at, bytes.data(), bytes.size()) < bytes.size())
      refuse("it became shorter while it was read");
  }

  const std::string path_;
  ItemPoll poll_;
  OpenFile file_;
  std::size_t begin_ = 0;  // of the data
  std::vector<Field> fields_;
  InputTable head_;  // all but the values
};

bool is_npy(const std::string& path) { return path.ends_with(".npy"); }

std::unique_ptr<TableReader> open_npy(const std::string& path, const TableRequest& request) {
  return std::make_unique<NpyTable>(path, request);
}

}  // namespace gliss
