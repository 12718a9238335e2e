// Things that the commands share: their options, their errors, and how they speak.
#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "gliss/base/stopwatch.h"
#include "gliss/engine/engine_choice.h"
#include "gliss/engine/opencl.h"
#include "gliss/mesh/creases.h"
#include "gliss/query/effects.h"
#include "gliss/surface/names.h"
#include "gliss/sweep/sweep.h"
#include "gliss/validate/validate.h"
#include "tools/cli/terminal/answer.h"
#include "tools/cli/words/command_line.h"

namespace gliss::tools {

struct Unavailable : std::runtime_error {  // exit code 4
  using std::runtime_error::runtime_error;
};

// Options of commands that use an engine.
struct CommonOptions : ReportOptions, EngineChoice {};

// Options of commands that read a mesh or a cache.
struct SurfaceOptions : CommonOptions {
  std::string surface;                       // path
  bool from_cache = false;                   // it must be a cache
  double unit = 1;                           // m, of coordinates read and written
  bool has_unit = false;                     // it was given
  bool in_scene = false;                     // a scene names the mesh, and says what is said here
  std::optional<Precision> precision;        // as the cache has it, or double
  std::optional<Level> level;                // as the cache has it, or exact
  std::optional<Construction> construction;  // as the cache has it, or the paper's
  // How a mesh is read.
  bool strict = false, keep_non_manifold = false;
  double weld = 0;  // m; below 0: nothing is welded
  NormalSource normals = NormalSource::kAuto;
  Orient orient = Orient::kOutward;
  bool flip = false;
  CreaseRules creases{};
  double crease_radius = 0;  // m, that they are rounded by; 0: they stay sharp
};

// Options of the commands that outsiders script against: one table out.
struct TableOptions : SurfaceOptions {
  std::string output = "-";
};

void add_common_options(Command& command, ReportOptions& options);
void add_common_options(Command& command, CommonOptions& options);
// `name` of the positional argument: "MESH" or "MESH_OR_CACHE".
void add_mesh_options(Command& command, SurfaceOptions& options, const std::string& name);
void add_surface_options(Command& command, SurfaceOptions& options, const std::string& name);
void add_output_option(Command& command, std::string& output, const std::string& description);
void add_input_option(Command& command, const std::string& name, std::string& path,
                      const std::string& description, bool required = true);
// The SCENE of a command; a mesh or a cache in its place is refused.
void add_scene_option(Command& command, std::string& scene, const std::string& description);
void add_cpu_option(Command& command, int& cpu);  // -1: any
// Throws InputError where it is no file that can be read.
void check_input(const std::string& name, const std::string& path);
double positive_stiffness(const std::string& text);  // N/m, of --stiffness
void add_stiffness_option(Command& command, double& stiffness);
// --settle TIME; `settle` (s), whose value is the default.
void add_settle_option(Command& command, double& settle);
// The same; nothing: nobody has told it.
void add_settle_option(Command& command, std::optional<double>& settle);
// --friction and --friction-settle.
void add_friction_options(Command& command, FrictionOptions& friction);
// --damping, --viscosity, --magnet and --texture.
void add_effect_options(Command& command, EffectOptions& effects);
// Adds the options of one solver; of all.
void add_solver_options(Command& command, SolverOptions& options);
void add_step_options(Command& command, SolverOptions& options);
void add_methods_option(Command& command, std::vector<Method>& methods);

// Throws InputError that lists the names where `wanted` is not among them.
template <class Value, std::size_t count>
Value parse_name(const std::string& option, const std::string& wanted,
                 const Named<Value> (&names)[count]) {
  if (const auto value = find_named(names, wanted)) return *value;
  throw InputError(option + ": '" + wanted + "' is not one of " + listed(names));
}

// Words between commas, each once.
template <class Parse>
auto parse_list(const std::string& option, const std::string& text, Parse parse) {
  std::vector<decltype(parse(text))> values;
  for (const std::string& word : split(text, ',')) {
    const auto value = parse(word);
    if (std::find(values.begin(), values.end(), value) != values.end())
      throw InputError(option + ": '" + word + "' is there twice");
    values.push_back(value);
  }
  return values;
}

// Adds an option whose value is one of those names.
template <class Chosen, class Value, std::size_t count>
void add_name_option(Command& command, const OptionText& text, Chosen& chosen,
                     const Named<Value> (&names)[count]) {
  command.option(text, [name = text.name, &chosen, &names](const std::string& word) {
    chosen = parse_name(name, word, names);
  });
}
// The same whose value is a list of them, each once.
template <class Chosen, class Value, std::size_t count>
void add_names_option(Command& command, const OptionText& text, std::vector<Chosen>& chosen,
                      const Named<Value> (&names)[count]) {
  command.option(text, [name = text.name, &chosen, &names](const std::string& list) {
    chosen = parse_list(name, list, [&](const std::string& word) -> Chosen {
      return parse_name(name, word, names);
    });
  });
}

inline bool has(const std::vector<Method>& methods, Method method) {
  return std::find(methods.begin(), methods.end(), method) != methods.end();
}

std::vector<double> parse_depths(const std::string& text);  // m, of --depth
Level parse_level(const std::string& option, const std::string& name);

// Registers a command: its options are described, filled in from the command line, and run.
template <class Options>
void add_command(Command& parent, const std::string& name, const std::string& description,
                 const std::string& example,
                 const std::function<void(Command&, Options&)>& describe,
                 const std::function<void(const Options&)>& run) {
  const auto options = std::make_shared<Options>();
  Command& command = parent.add_command(name, description);
  command.set_footer("Example: " + example);
  describe(command, *options);
  add_common_options(command, *options);
  command.on_run([options, run] { run(*options); });
}

// An engine whose work ends with Interrupted after Ctrl-C.
std::unique_ptr<Engine> make_engine(const CommonOptions& options);

// The command line as given, for the files that it leaves.
void keep_command_line(int count, const char* const* words);
std::string command_line();
std::string command_line_without(const std::string& option);  // and without its value

// A line that counts what is not finite, such as "steps"; "" where nothing is.
std::string unsound_text(std::uint64_t count, const std::string& what);

}  // namespace gliss::tools
