#include "tools/cli/words/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <deque>
#include <sstream>
#include <utility>

#include "gliss/base/units.h"

namespace gliss::tools {
namespace {

// The name that messages use: the last of "-o,--output".
std::string spoken(const OptionText& text) { return split(text.name, ',').back(); }

template <class Number>
Command::Read read_number(const OptionText& text, Number& value, Number least, Number most) {
  return [name = spoken(text), &value, least, most](const std::string& word) {
    value = parse_number<Number>(name, word);
    if (value >= least && value <= most) return;  // NaN is not
    throw InputError(fmt::format("{}: {} is not between {} and {}", name, word, least, most));
  };
}

// The letters to change, add or leave out between two words (Levenshtein).
std::size_t edits_between(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j < row.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i);
    for (std::size_t j = 1; j < row.size(); ++j) {
      const std::size_t changed = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = std::exchange(row[j], std::min({row[j] + 1, row[j - 1] + 1, changed}));
    }
  }
  return row.back();
}

// The command that the words have come to.
const CLI::App& innermost(const CLI::App& program) {
  const CLI::App* app = &program;
  while (!app->get_subcommands().empty()) app = app->get_subcommands().back();
  return *app;
}

// "gliss generate"
std::string whole_name(const CLI::App& app) {
  const CLI::App* const parent = app.get_parent();
  return parent == nullptr ? app.get_name() : whole_name(*parent) + " " + app.get_name();
}

// "mm", "2mm", "N/mm"
bool ends_in_unit(const std::string& word) {
  if (word.empty() || std::isalpha(static_cast<unsigned char>(word.back())) == 0) return false;
  for (const auto parse : {parse_length, parse_stiffness, parse_time, parse_angle}) {
    try {
      parse("1" + word);
      return true;
    } catch (const UnitError&) {
    }
  }
  return false;
}

// What CLI11 says of words that are missing behind an option, or of an option that is there twice.
std::string mismatch_text(const std::string& text) {
  const std::string name = text.substr(0, text.find(':'));
  if (text.ends_with(" missing")) return name + " wants a value behind it";
  if (text.find(": At Most ") != text.npos) return name + " is there more than once";
  return text;
}

// Of the first word that no option and no argument takes.
std::string superfluous_word(const CLI::App& program) {
  const std::string word = program.remaining(true).front();
  const std::string cure =
      ends_in_unit(word) ? "a number and its unit are one word, as 2mm, and a list has commas and "
                           "no spaces, as 2mm,4mm"
                         : whole_name(innermost(program)) + " --help says which words it takes";
  return fmt::format("'{}' is a word too many; {}", word, cure);
}

// "; gliss trace has it" for an option of other commands; "" where none has it.
std::string owners_of(const CLI::App& program, const std::string& option) {
  std::vector<std::string> owners;
  for (const CLI::App* command : program.get_subcommands(nullptr))
    if (command->get_option_no_throw(option) != nullptr) owners.push_back(whole_name(*command));
  if (owners.empty()) return "";
  return fmt::format("; {} {} it", fmt::join(owners, ", "), owners.size() == 1 ? "has" : "have");
}

// "there is no option '--deph'; did you mean --depth?" for the first word that looks like an option
// but is not one; "" where there is no such word.
std::string unknown_option(const CLI::App& program) {
  constexpr std::size_t kNear = 3;
  const CLI::App* app = &innermost(program);
  for (const std::string& word : program.remaining(true)) {
    if (!word.starts_with("-") || word == "-" || word == "--") continue;
    const std::string name = word.substr(0, word.find('='));
    std::string nearest;
    std::size_t least = kNear;
    for (const CLI::Option* option : app->get_options()) {
      const std::string other = option->get_name();
      const std::size_t edits = edits_between(name, other);
      if (edits < least) least = edits, nearest = other;
    }
    return fmt::format(
        "there is no option '{}'{}", name,
        nearest.empty() ? owners_of(program, name) : fmt::format("; did you mean {}?", nearest));
  }
  return "";
}

// Lists commands by the first line of what they do; their own help has the rest.
class BriefFormatter : public CLI::Formatter {
 public:
  std::string make_subcommand(const CLI::App* command) const override {
    std::ostringstream out;
    CLI::detail::format_help(out, command->get_name(), split(command->get_description(), '\n')[0],
                             get_column_width());
    return out.str();
  }
};

}  // namespace

struct Command::Implementation {
  CLI::App* app = nullptr;
  std::unique_ptr<CLI::App> own;  // of the program
  std::deque<std::unique_ptr<Command>> commands;
};

Command::Command(const std::string& description, const std::string& name)
    : implementation_(std::make_unique<Implementation>()) {
  implementation_->own = std::make_unique<CLI::App>(description, name);
  implementation_->app = implementation_->own.get();
  implementation_->app->formatter(std::make_shared<BriefFormatter>());
}

Command::Command(std::unique_ptr<Implementation> implementation)
    : implementation_(std::move(implementation)) {}

Command::~Command() = default;

Command& Command::add_command(const std::string& name, const std::string& description) {
  auto below = std::make_unique<Implementation>();
  below->app = implementation_->app->add_subcommand(name, description);
  implementation_->app->require_subcommand(1);
  implementation_->commands.emplace_back(new Command(std::move(below)));
  return *implementation_->commands.back();
}

void Command::set_footer(const std::string& text) { implementation_->app->footer(text); }

void Command::set_version(const std::string& text) {
  implementation_->app->set_version_flag("--version", text);
}

void Command::on_run(std::function<void()> run) { implementation_->app->callback(std::move(run)); }

void Command::option(const OptionText& text, const Read& read) {
  implementation_->app->add_option_function<std::string>(text.name, read, text.description)
      ->required(text.required)
      ->type_name(text.type);
}

void Command::option(const OptionText& text, std::string& value) {
  option(text, [&value](const std::string& word) { value = word; });
}

void Command::option(const OptionText& text, int& value, int least, int most) {
  option(text, read_number(text, value, least, most));
}

void Command::option(const OptionText& text, double& value, double least, double most) {
  option(text, read_number(text, value, least, most));
}

void Command::list(const OptionText& text, const Read& read) {
  implementation_->app
      ->add_option_function<std::vector<std::string>>(
          text.name,
          [read](const std::vector<std::string>& words) {
            for (const std::string& word : words) read(word);
          },
          text.description)
      ->required(text.required)
      ->type_name(text.type);
}

void Command::flag(const std::string& name, bool& value, const std::string& description) {
  implementation_->app->add_flag(name, value, description);
}

void Command::exclude(const std::string& name, const std::string& other) {
  CLI::App* app = implementation_->app;
  app->get_option(name)->excludes(app->get_option(other));
}

void Command::run(int count, const char* const* words) {
  CLI::App* app = implementation_->app;
  try {
    app->parse(count, words);
  } catch (const CLI::RequiredError& error) {
    const bool command = error.what() == std::string("A subcommand is required");
    const auto unknown = app->remaining(true);
    const bool misnamed = command && !unknown.empty() && !unknown.front().starts_with("-");
    const std::string text = misnamed ? "" : unknown_option(*app);
    if (!text.empty()) throw InputError(text);
    if (!command) throw InputError(error.what());
    throw InputError(fmt::format(
        "{}; {} --help lists them",
        misnamed ? fmt::format("there is no command '{}'", unknown.front()) : "a command is wanted",
        whole_name(innermost(*app))));
  } catch (const CLI::ExtrasError&) {
    const std::string text = unknown_option(*app);
    throw InputError(text.empty() ? superfluous_word(*app) : text);
  } catch (const InputError&) {  // the value of an option that is not there may be taken for a file
    const std::string text = unknown_option(*app);
    if (!text.empty()) throw InputError(text);
    throw;
  } catch (const CLI::ParseError& error) {
    const std::string text = unknown_option(*app);
    if (error.get_exit_code() != 0)
      throw InputError(text.empty() ? mismatch_text(error.what()) : text);
    app->exit(error);  // prints help or version
  }
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == separator) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

}  // namespace gliss::tools
