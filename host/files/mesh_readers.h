// Tools that the mesh readers share: a cursor over the words of a text that knows its line, numbers
// without the locale, and the entry point of each format. Private to host/.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

#include "gliss/mesh/mesh.h"
#include "gliss/validate/mesh_report.h"

namespace gliss::detail {

// Each fills an empty mesh whose `source` is set. Reports only what the text alone shows;
// `validate` does the rest. A corner without a normal among others that have one gets kNone.
void read_obj(std::string_view text, Mesh& mesh, Report& report);
void read_off(std::string_view text, Mesh& mesh, Report& report);
void read_ply(std::string_view text, Mesh& mesh, Report& report);
void read_stl(std::string_view text, Mesh& mesh, Report& report);

// True if what follows the head of such a file has no lines. The first 84 bytes are enough.
bool is_binary_off(std::string_view text);
bool is_binary_ply(std::string_view text);
bool is_binary_stl(std::string_view text);

// The whole word as a number in the C notation, whatever the locale; an optional sign is read. What
// is beyond the type becomes its nearest value: an infinity, 0, or the last integer.
std::optional<double> parse_number(std::string_view word);
std::optional<std::int64_t> parse_integer(std::string_view word);

// Takes a number off the front of the bytes; none: they are too few.
template <class T>
std::optional<T> take_number(std::string_view& bytes, std::endian order) {
  if (bytes.size() < sizeof(T)) return std::nullopt;
  std::array<char, sizeof(T)> number;
  std::memcpy(number.data(), bytes.data(), sizeof(T));
  bytes.remove_prefix(sizeof(T));
  if (order != std::endian::native) std::reverse(number.begin(), number.end());
  return std::bit_cast<T>(number);
}

// A word of the file as messages show it: without control characters, and short.
std::string printable(std::string_view word);
std::string quoted(std::string_view word);

// Checks an index that cannot be looked up yet: at least 0, and small enough to be stored.
std::uint32_t checked_index(std::int64_t value, const Mesh& mesh, std::size_t line, Report& report);

// Adds a vertex; line = 0: the file has no lines. One that is not finite is an error, which
// `validate` reports, only where a face has it.
void add_vertex(const Vec3& position, std::size_t line, Mesh& mesh, Report& report);

// Ends the face whose corners have been appended; line = 0: the file has no lines.
void end_face(Mesh& mesh, std::size_t line, Report& report);

// True between the words of a statement.
constexpr bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";  // of UTF-8

// Walks statement by statement (a line with words on it, of any line ending), word by word.
class TextCursor {
 public:
  struct Syntax {
    char comment = '\0';     // from here to the end of the line; '\0': there are none
    bool continued = false;  // a backslash before the line ending joins two lines
  };

  TextCursor(std::string_view text, Syntax syntax, Report& report);

  bool next();              // to the first word of the next statement; false: there is none
  std::string_view word();  // the next word of this statement; empty: there is none
  bool has_word() { return in_statement_ && at_word(); }
  std::size_t line() const { return statement_line_; }   // where the statement starts, 1-based
  std::string_view after_line();                         // what follows the line of this statement
  std::string_view rest() const { return {at_, end_}; }  // what follows the last word

  // From now on the numbers below may stand on a later line, which is the statement then.
  void read_on_over_lines() { over_lines_ = true; }

  // The next word as what it has to be; a bad or missing one fails with `what` in the message.
  double number(std::string_view what);
  std::int64_t integer(std::string_view what);
  Vec3 numbers(std::string_view what);  // three of them
  Vec3 vector(std::string_view what);   // three finite ones
  void end();                           // no word may be left

 private:
  bool at_word();  // skips blanks, comments and joined lines; false: at the end of the statement
  bool at_line_end(const char* at) const { return at != end_ && (*at == '\n' || *at == '\r'); }
  bool at_join(const char* at) const;
  void skip_line_end();
  std::string_view required(std::string_view what);

  const char* at_;
  const char* end_;
  Syntax syntax_;
  Report& report_;
  std::size_t line_ = 1;
  std::size_t statement_line_ = 0;
  bool in_statement_ = false;
  bool over_lines_ = false;
  bool lone_returns_ = false;  // end the lines, without line feeds
};

}  // namespace gliss::detail
