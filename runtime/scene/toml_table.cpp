#include "gliss/scene/toml_table.h"

#include <algorithm>
#include <cmath>

#include "gliss/base/units.h"
#include "gliss/files/open_file.h"
#include "gliss/mesh/mesh.h"
#include "gliss/scene/scene.h"

namespace gliss {
namespace {

constexpr std::uint64_t kLargestScene = 1 << 26;  // bytes

// In one line, whatever of the file it quotes.
[[noreturn]] void refuse(std::string what) {
  std::replace_if(
      what.begin(), what.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  throw SceneError(what);
}

}  // namespace

TomlTable TomlTable::read(const std::string& path, toml::table& storage) {
  OpenFile file(path);
  if (file.size() > kLargestScene)
    refuse(fmt::format("{}: over {} bytes; put long paths into a CSV file", path, kLargestScene));
  LargeArray<char> text;
  try {
    text = file.read_all();
  } catch (const std::runtime_error&) {
    refuse(fmt::format("{}: cannot be read: {}", path, file.why()));
  }
  try {
    storage = toml::parse(std::string_view(text.data(), text.size()));
  } catch (const toml::parse_error& error) {
    refuse(fmt::format("{}:{}: {}", path, error.source().begin.line, error.description()));
  }
  return {storage, path, ""};
}

std::string TomlTable::place(const std::string& key) const {
  const toml::node* node = table_.get(key);
  const auto line = (node != nullptr ? *node : table_).source().begin.line;
  return fmt::format("{}:{}: {}{}{}", file_, line > 0 ? line : 1, name_,
                     name_.empty() || key.empty() ? "" : ".", key);
}

void TomlTable::fail(const std::string& key, const std::string& what) const {
  refuse(fmt::format("{}: {}", place(key), what));
}

void TomlTable::done() const {
  for (const auto& [key, node] : table_) {
    if (asked_.contains(key.str())) continue;
    fail(std::string(key.str()),
         fmt::format("there is no such key; there are {}", fmt::join(asked_, ", ")));
  }
}

const toml::node* TomlTable::find(const std::string& key) {
  asked_.insert(key);
  return table_.get(key);
}

bool TomlTable::has(const std::string& key) { return find(key) != nullptr; }

std::string TomlTable::name_of(const std::string& key) const {
  return name_.empty() ? key : name_ + "." + key;
}

std::vector<TomlTable> TomlTable::tables(const std::string& key) {
  std::vector<TomlTable> found;
  const toml::node* node = find(key);
  if (node == nullptr) return found;
  if (!node->is_array_of_tables()) fail(key, fmt::format("write [[{}]], once for each", key));
  for (const toml::node& element : *node->as_array())
    found.emplace_back(*element.as_table(), file_, name_of(key));
  return found;
}

std::optional<TomlTable> TomlTable::table(const std::string& key) {
  const toml::node* node = find(key);
  if (node == nullptr) return std::nullopt;
  if (!node->is_table()) fail(key, fmt::format("must be a table: [{}]", key));
  return TomlTable(*node->as_table(), file_, name_of(key));
}

void TomlTable::get(const std::string& key, std::string& value) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  if (!node->is_string() || node->as_string()->get().empty()) fail(key, "must be text");
  value = node->as_string()->get();
}

void TomlTable::get(const std::string& key, bool& value) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  if (!node->is_boolean()) fail(key, "must be true or false");
  value = node->as_boolean()->get();
}

void TomlTable::get(const std::string& key, int& value, int least, int most) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  const auto number = node->is_integer() ? node->as_integer()->get() : least - std::int64_t{1};
  if (number < least || number > most)
    fail(key, fmt::format("must be a whole number from {} to {}", least, most));
  value = static_cast<int>(number);
}

void TomlTable::get(const std::string& key, double& value, Parse parse) {
  if (const toml::node* node = find(key)) value = quantity(key, *node, parse);
}

void TomlTable::get_positive(const std::string& key, double& value, Parse parse) {
  get(key, value, parse);
  if (has(key) && !(value > 0)) fail(key, "must be positive");
}

void TomlTable::get(const std::string& key, Nanoseconds& value) {
  double seconds = 0;
  get(key, seconds, parse_time);
  if (!has(key)) return;
  if (!(std::abs(seconds) <= 1e6)) fail(key, "is not a time a loop could keep");
  value = Nanoseconds(std::llround(seconds * 1e9));
}

void TomlTable::get_point(const std::string& key, Vec3& value) {
  if (const toml::node* node = find(key)) value = point(key, *node);
}

void TomlTable::get_points(const std::string& key, std::vector<Vec3>& value) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  if (!node->is_array()) fail(key, "must be a list of points");
  value.clear();
  for (const toml::node& element : *node->as_array()) value.push_back(point(key, element));
}

double TomlTable::quantity(const std::string& key, const toml::node& node, Parse parse) const {
  double value = std::nan("");
  if (const auto* text = node.as_string(); text != nullptr && parse != nullptr) {
    try {
      value = parse(text->get());
    } catch (const UnitError& error) {
      fail(key, error.what());
    }
  } else if (const auto number = node.value<double>(); number && node.is_number()) {
    value = *number;
  }
  if (!std::isfinite(value))
    fail(key, parse != nullptr ? "must be a number (SI), or text with a unit" : "must be a number");
  if (std::abs(value) > kMostCoordinate) fail(key, fmt::format("is beyond {}", kMostCoordinate));
  return value;
}

Vec3 TomlTable::point(const std::string& key, const toml::node& node) const {
  const toml::array* list = node.as_array();
  if (list == nullptr || list->size() != 3) fail(key, "a point is three lengths: [x, y, z]");
  Vec3 point;
  for (int axis = 0; axis < 3; ++axis) {
    point[axis] = quantity(key, *list->get(static_cast<std::size_t>(axis)), parse_length);
  }
  return point;
}

}  // namespace gliss
