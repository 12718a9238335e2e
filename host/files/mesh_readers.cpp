#include "gliss/files/mesh_readers.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

namespace gliss::detail {
namespace {

// from_chars takes no plus sign; "+-1" stays malformed.
std::string_view without_plus(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  return word;
}

template <class T>
std::from_chars_result parse(std::string_view word, T& value) {
  return std::from_chars(word.data(), word.data() + word.size(), value);
}

// The nearest double of a number beyond its range: an overflow or an underflow, by the place of its
// first digit against the point.
double nearest_double(std::string_view word) {
  const std::size_t end = std::min(word.find_first_of("eE"), word.size());
  const std::string_view digits = word.substr(0, end);
  const auto point = static_cast<std::int64_t>(std::min(digits.find('.'), end));
  const auto first = static_cast<std::int64_t>(digits.find_first_of("123456789"));
  const std::int64_t exponent =
      end < word.size() ? parse_integer(word.substr(end + 1)).value_or(0) : 0;
  const double size = exponent > first - point ? std::numeric_limits<double>::infinity() : 0;
  return word.starts_with('-') ? -size : size;
}

}  // namespace

std::optional<double> parse_number(std::string_view word) {
  word = without_plus(word);
  double value = 0;
  const std::from_chars_result result = parse(word, value);
  if (result.ec == std::errc::invalid_argument || result.ptr != word.data() + word.size()) {
    return std::nullopt;
  }
  return result.ec == std::errc() ? value : nearest_double(word);
}

std::optional<std::int64_t> parse_integer(std::string_view word) {
  word = without_plus(word);
  std::int64_t value = 0;
  const std::from_chars_result result = parse(word, value);
  if (result.ec == std::errc::invalid_argument || result.ptr != word.data() + word.size()) {
    return std::nullopt;
  }
  using Limits = std::numeric_limits<std::int64_t>;
  if (result.ec != std::errc()) return word.starts_with('-') ? Limits::min() : Limits::max();
  return value;
}

std::string printable(std::string_view word) {
  constexpr std::size_t kLongest = 40;
  std::string text;
  for (const char c : word.substr(0, kLongest)) {
    if (c >= ' ' && c <= '~') {
      text += c;
    } else {
      text += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    }
  }
  return word.size() > kLongest ? text + "..." : text;
}

std::string quoted(std::string_view word) { return "'" + printable(word) + "'"; }

std::uint32_t checked_index(std::int64_t value, const Mesh& mesh, std::size_t line,
                            Report& report) {
  if (value < 0 || value >= static_cast<std::int64_t>(kNone)) {
    report.fail("vertex-index",
                {.face = static_cast<std::uint32_t>(mesh.face_count()), .line = line},
                "vertex index {} is out of range", value);
  }
  return static_cast<std::uint32_t>(value);
}

void add_vertex(const Vec3& position, std::size_t line, Mesh& mesh, Report& report) {
  const auto vertex = static_cast<std::uint32_t>(mesh.positions.size());
  if (!position.allFinite()) report.vertex_line[vertex] = line;
  mesh.positions.push_back(position);
}

void end_face(Mesh& mesh, std::size_t line, Report& report) {
  if (mesh.corner_vertex.size() >= kNone || line >= kNone) {
    report.fail("too-large", {.line = line}, "more than {} corners or lines", kNone - 1);
  }
  mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corner_vertex.size()));
  if (line) mesh.face_line.push_back(static_cast<std::uint32_t>(line));
}

TextCursor::TextCursor(std::string_view text, Syntax syntax, Report& report)
    : at_(text.data()), end_(text.data() + text.size()), syntax_(syntax), report_(report) {
  if (text.starts_with(kByteOrderMark)) at_ += kByteOrderMark.size();
}

bool TextCursor::at_join(const char* at) const {
  return syntax_.continued && *at == '\\' && at_line_end(at + 1);
}

void TextCursor::skip_line_end() {
  if (at_ == end_) return;
  const bool two = *at_ == '\r' && at_ + 1 != end_ && at_[1] == '\n';
  lone_returns_ = *at_ == '\r' && !two;
  at_ += two ? 2 : 1;
  ++line_;
  report_.poll();
}

bool TextCursor::at_word() {
  for (;;) {
    while (at_ != end_ && is_blank(*at_)) ++at_;
    if (at_ == end_ || at_line_end(at_)) return false;
    if (syntax_.comment && *at_ == syntax_.comment) {
      // A comment never joins the next line: that could swallow a face.
      while (at_ != end_ && !at_line_end(at_)) ++at_;
      return false;
    }
    if (!at_join(at_)) return true;
    ++at_;
    skip_line_end();
  }
}

std::string_view TextCursor::word() {
  report_.poll();
  if (!at_word()) return {};
  const char* const begin = at_;
  while (at_ != end_ && !is_blank(*at_) && !at_line_end(at_) && !at_join(at_) &&
         !(syntax_.comment && *at_ == syntax_.comment)) {
    ++at_;
  }
  return {begin, static_cast<std::size_t>(at_ - begin)};
}

bool TextCursor::next() {
  while (in_statement_ && !word().empty()) {
  }
  in_statement_ = false;
  while (!at_word()) {
    if (at_ == end_) return false;
    skip_line_end();
  }
  statement_line_ = line_;
  return in_statement_ = true;
}

std::string_view TextCursor::after_line() {
  while (!word().empty()) {
  }
  if (lone_returns_ && at_ != end_ && *at_ == '\r') {
    ++at_;  // a line feed after it belongs to what follows
  } else {
    skip_line_end();
  }
  return {at_, static_cast<std::size_t>(end_ - at_)};
}

std::string_view TextCursor::required(std::string_view what) {
  std::string_view found = word();
  if (found.empty() && over_lines_ && next()) found = word();
  if (found.empty()) report_.fail("syntax", {.line = line()}, "{} is missing", what);
  return found;
}

double TextCursor::number(std::string_view what) {
  const std::string_view found = required(what);
  const std::optional<double> value = parse_number(found);
  if (!value) {
    const bool comma = found.find(',') != found.npos;
    report_.fail("syntax", {.line = line()}, "{} {} is not a number{}", what, quoted(found),
                 comma ? ": decimals follow a point, not a comma" : "");
  }
  return *value;
}

std::int64_t TextCursor::integer(std::string_view what) {
  const std::string_view found = required(what);
  const std::optional<std::int64_t> value = parse_integer(found);
  if (!value)
    report_.fail("syntax", {.line = line()}, "{} {} is not an integer", what, quoted(found));
  return *value;
}

Vec3 TextCursor::numbers(std::string_view what) {
  Vec3 value;
  for (double& coordinate : value) coordinate = number(what);
  return value;
}

Vec3 TextCursor::vector(std::string_view what) {
  const Vec3 value = numbers(what);
  for (const double coordinate : value) {
    if (!std::isfinite(coordinate)) {
      report_.fail("non-finite", {.line = line()}, "{} is not finite ({})", what, coordinate);
    }
  }
  return value;
}

void TextCursor::end() {
  const std::string_view found = word();
  if (!found.empty()) report_.fail("extra-data", {.line = line()}, "unexpected {}", quoted(found));
}

}  // namespace gliss::detail
