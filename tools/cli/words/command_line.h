// The command line as the commands describe it. CLI11 stays behind it, in one file: it takes
// seconds to compile.
#pragma once

#include <charconv>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace gliss::tools {

struct InputError : std::runtime_error {  // exit code 2
  using std::runtime_error::runtime_error;
};

// The words of an option that stand for a value, and how they are asked for.
struct OptionText {
  std::string name;  // "--depth", "-o,--output", "MESH"
  std::string type;  // "LIST"
  std::string description;
  bool required = false;
};

class Command {
 public:
  using Read = std::function<void(const std::string& text)>;

  explicit Command(const std::string& description, const std::string& name);
  ~Command();
  Command(const Command&) = delete;
  Command& operator=(const Command&) = delete;

  // The commands below this one, of which one must be given; they live as long as it.
  Command& add_command(const std::string& name, const std::string& description);
  void set_footer(const std::string& text);
  void set_version(const std::string& text);
  void on_run(std::function<void()> run);

  // `read` may throw InputError and its like.
  void option(const OptionText& text, const Read& read);
  void option(const OptionText& text, std::string& value);
  void option(const OptionText& text, int& value, int least, int most);
  void option(const OptionText& text, double& value, double least, double most);
  void list(const OptionText& text, const Read& read);  // one word or more, each read by itself
  void flag(const std::string& name, bool& value, const std::string& description);
  void exclude(const std::string& name, const std::string& other);

  // Reads the words and runs the command that they name; prints help and version. Throws InputError
  // where the words make no sense, and whatever the command throws.
  void run(int count, const char* const* words);

 private:
  struct Implementation;
  explicit Command(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

// The number that a whole text is; `name` is what it belongs to.
template <class Number>
Number parse_number(const std::string& name, const std::string& text) {
  Number number{};
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (text.empty() || error != std::errc() || stop != end) {
    throw InputError(name + ": '" + text + "' is not a number that fits");
  }
  return number;
}

std::vector<std::string> split(const std::string& text, char separator);

}  // namespace gliss::tools
