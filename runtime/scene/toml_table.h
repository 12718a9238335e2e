// Tables of a TOML file that know where they stand: every error names file, line and key, and a key
// that nobody asked for is one.
#pragma once

#include <fmt/format.h>

// toml++ asserts that a key begins as one, and only then looks whether it does.
#define TOML_ASSERT(expr) static_assert(true)
#include <toml++/toml.h>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "gliss/base/vector.h"
#include "gliss/surface/names.h"
#include "gliss/thread/clock.h"

namespace gliss {

class TomlTable {
 public:
  // Throws SceneError.
  static TomlTable read(const std::string& path, toml::table& storage);

  // `name` for messages: "object", "device.workspace", or empty at the root.
  TomlTable(const toml::table& table, std::string file, std::string name)
      : table_(table), file_(std::move(file)), name_(std::move(name)) {}

  bool has(const std::string& key);                       // which counts as asking for it
  std::vector<TomlTable> tables(const std::string& key);  // [[key]]; none where it is not there
  std::optional<TomlTable> table(const std::string& key);

  // Sets `value` to the key's value, if the key is there; else it stays as it is.
  void get(const std::string& key, std::string& value);
  void get(const std::string& key, bool& value);
  void get(const std::string& key, int& value, int least, int most);
  // A number in SI, or text with a unit, read by parse_length or the like.
  using Parse = double (*)(std::string_view);
  void get(const std::string& key, double& value, Parse parse = nullptr);
  void get(const std::string& key, Nanoseconds& value);
  void get_positive(const std::string& key, double& value, Parse parse = nullptr);
  void get_point(const std::string& key, Vec3& value);                // three lengths
  void get_points(const std::string& key, std::vector<Vec3>& value);  // a list of them
  template <class Value, std::size_t count>
  void get(const std::string& key, Value& value, const Named<Value> (&names)[count]) {
    std::string text;
    get(key, text);
    if (text.empty()) return;
    const auto found = find_named(names, text);
    if (!found) fail(key, fmt::format("'{}' is not one of {}", text, listed(names)));
    value = *found;
  }

  // Throws where there is a key that nothing asked for.
  void done() const;
  [[noreturn]] void fail(const std::string& key, const std::string& what) const;
  // Does what may throw std::invalid_argument "key: what", which is that key's error then.
  template <class Act>
  void checked(const Act& act) const {
    try {
      act();
    } catch (const std::invalid_argument& error) {
      const std::string text = error.what();
      const auto colon = text.find(": ");
      if (colon == text.npos) fail("", text);
      fail(text.substr(0, colon), text.substr(colon + 2));
    }
  }
  std::string place(const std::string& key) const;  // "scene.toml:3: object.unit"

 private:
  const toml::node* find(const std::string& key);
  std::string name_of(const std::string& key) const;  // "device.workspace"
  double quantity(const std::string& key, const toml::node& node, Parse parse) const;
  Vec3 point(const std::string& key, const toml::node& node) const;

  const toml::table& table_;
  std::string file_, name_;
  std::set<std::string, std::less<>> asked_;
};

}  // namespace gliss
