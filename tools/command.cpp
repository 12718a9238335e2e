#include "tools/command.h"

#include <fmt/format.h>

#include <cstdio>
#include <map>

#include "host/units.h"

namespace gliss::tools {
namespace {

const std::map<std::string, Solver> kSolvers = {
    {"newton", Solver::kNewton}, {"gauss-newton", Solver::kGaussNewton}, {"paper", Solver::kPaper}};
const std::map<std::string, Precision> kPrecisions = {{"float", Precision::kFloat},
                                                      {"double", Precision::kDouble}};

std::string& kept_command_line() {
  static std::string line;
  return line;
}

// An option of one word that a function reads.
template <class Read>
CLI::Option* add_read(CLI::App& command, const std::string& name, const std::string& type,
                      const std::string& description, Read read) {
  return command.add_option_function<std::string>(name, read, description)->type_name(type);
}

}  // namespace

void add_common_options(CLI::App& command, CommonOptions& options) {
  command.add_option("--threads", options.threads, "threads to use; 0: all of the machine")
      ->check(CLI::Range(0, 4096))
      ->type_name("N");
  command.add_option("--backend", options.backend, "tbb (default), serial or opencl")
      ->check(CLI::IsMember({"tbb", "serial", "opencl"}))
      ->type_name("NAME");
  command.add_flag("--json", options.json, "print figures as JSON");
  command.add_flag("--quiet", options.quiet, "print errors only");
}

void add_surface_options(CLI::App& command, SurfaceOptions& options, const std::string& name) {
  command
      .add_option(name, options.surface,
                  name == "MESH" ? "mesh file: .obj, .off or .ply"
                                 : "mesh file (.obj, .off, .ply) or cache made by gliss bake")
      ->required()
      ->type_name("FILE");
  add_read(command, "--unit", "UNIT", "unit of the coordinates: m (default), cm, mm, um, nm, in",
           [&options](const std::string& text) { options.unit = parse_unit(text); });
  add_read(command, "--precision", "NAME", "float or double (default)",
           [&options](const std::string& text) { options.precision = kPrecisions.at(text); })
      ->check(CLI::IsMember({"float", "double"}));
  command.add_flag("--split-non-manifold", options.split_non_manifold,
                   "cut non-manifold edges and vertices open instead of refusing them");
}

void add_output_option(CLI::App& command, std::string& output, const std::string& description) {
  const auto known_ending = [](const std::string& path) -> std::string {
    for (const char* ending : {".csv", ".h5", ".hdf5"}) {
      if (path.ends_with(ending)) return "";
    }
    return path == "-" ? "" : fmt::format("'{}' must end in .csv, .h5 or .hdf5", path);
  };
  command.add_option("-o,--output", output, description)
      ->check(CLI::Validator(known_ending, ""))
      ->type_name("FILE");
}

void add_input_option(CLI::App& command, const std::string& name, std::string& path,
                      const std::string& description) {
  command.add_option(name, path, description)
      ->required()
      ->check(CLI::ExistingFile)
      ->type_name("FILE");
}

void add_stiffness_option(CLI::App& command, double& stiffness) {
  add_read(command, "--stiffness", "STIFFNESS", "force per depth; default 0.5N/mm",
           [&stiffness](const std::string& text) {
             stiffness = parse_stiffness(text);
             if (!(stiffness > 0)) throw InputError("--stiffness must be positive");
           });
}

void add_solver_option(CLI::App& command, Solver& solver) {
  add_read(command, "--solver", "NAME", "newton (default), gauss-newton or paper",
           [&solver](const std::string& text) { solver = kSolvers.at(text); })
      ->check(CLI::IsMember({"newton", "gauss-newton", "paper"}));
}

void add_methods_option(CLI::App& command, std::vector<Method>& methods) {
  add_read(command, "--method", "LIST", "of gregory, shaded and flat; all by default",
           [&methods](const std::string& text) {
             methods.clear();
             for (const std::string& name : split(text, ',')) {
               const Method method = parse_method(name);
               if (std::find(methods.begin(), methods.end(), method) != methods.end()) {
                 throw InputError(fmt::format("--method: '{}' is there twice", name));
               }
               methods.push_back(method);
             }
           });
}

Method parse_method(const std::string& name) {
  for (const Method method : {Method::kGregory, Method::kShaded, Method::kFlat}) {
    if (name == method_name(method)) return method;
  }
  throw InputError(fmt::format("--method: '{}' is none of gregory, shaded, flat", name));
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

std::unique_ptr<Engine> make_engine(const CommonOptions& options) {
  if (options.backend == "opencl") throw BackendError("backend 'opencl' is not available");
  return options.backend == "serial" ? make_serial_engine() : make_tbb_engine(options.threads);
}

void keep_command_line(int count, const char* const* words) {
  std::string& line = kept_command_line();
  line = "gliss";
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    const bool plain = !word.empty() && word.find_first_of(" \t\n'\"\\$&|;<>()*?") == word.npos;
    line += plain ? ' ' + word : fmt::format(" '{}'", word);
  }
}

const std::string& command_line() { return kept_command_line(); }

void report(const CommonOptions& options, const std::string& text, const Json& json,
            bool table_on_stdout) {
  std::FILE* stream = table_on_stdout ? stderr : stdout;
  if (options.json) {
    fmt::print(stream, "{}\n", json.dump(2));
  } else if (!options.quiet) {
    fmt::print(stream, "{}", text);
  }
}

std::string unit_name(double unit) {
  for (const char* name : {"m", "cm", "mm", "um", "nm", "in"}) {
    if (unit == parse_unit(name)) return name;
  }
  return fmt::format("{} m", unit);
}

const char* precision_name(Precision precision) {
  return precision == Precision::kFloat ? "float" : "double";
}

std::string hash_name(std::uint64_t hash) { return fmt::format("{:016x}", hash); }

}  // namespace gliss::tools
