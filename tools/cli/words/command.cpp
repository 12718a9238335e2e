#include "tools/cli/words/command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <utility>

#include "gliss/base/units.h"
#include "gliss/files/cache_file.h"
#include "gliss/files/mesh_file.h"
#include "gliss/query/friction.h"
#include "tools/cli/terminal/terminal.h"
#include "tools/cli/terminal/watch.h"

namespace gliss::tools {
namespace {

double parse_weld(const std::string& text) {
  if (text == "none") return -1;
  const double length = parse_length(text);
  if (!(length >= 0)) throw InputError("--weld must not be negative; 'none' welds nothing");
  return length;
}

// A time from 0 to 1 s, for an option of which `usual` is a sensible value.
double time_of_option(const std::string& option, const std::string& text,
                      const std::string& usual) {
  const double seconds = parse_time(text);
  if (!(seconds >= 0 && seconds <= kMostSettleTime))
    throw InputError(
        fmt::format("{}: '{}' is not from 0 to 1 s; {} is usual", option, text, usual));
  return seconds;
}

// Adds --settle, whose `usual` value the help tells, for a number or an optional one.
void add_settle(Command& command, auto& settle, double usual) {
  command.option(
      {"--settle", "TIME",
       fmt::format("when the nearest point leaps elsewhere, the contact slides there: the time in "
                   "which the force changes by 20 % meanwhile; 0: it leaps; default {}",
                   usual > 0 ? fmt::format("{:g}ms", 1e3 * usual) : "0")},
      [&settle](const std::string& text) { settle = time_of_option("--settle", text, "5ms"); });
}

std::vector<std::string>& kept_words() {  // quoted for a shell where they need it
  static std::vector<std::string> words;
  return words;
}

}  // namespace

void add_common_options(Command& command, ReportOptions& options) {
  command.flag("--json", options.json, "print figures as JSON");
  command.flag("--quiet", options.quiet, "print errors only");
}

void add_common_options(Command& command, CommonOptions& options) {
  command.option({"--threads", "N", "threads to use; 0, the default: all of the machine"},
                 options.threads, 0, 4096);
  add_name_option(command,
                  {"--backend", "NAME",
                   "tbb (default), serial, opencl, or auto: opencl on a GPU, tbb where that fails"},
                  options.backend, kBackendNames);
  command.option({"--opencl-device", "NAME",
                  "OpenCL device: part of its name, or its number in gliss devices"},
                 options.device);
  command.option({"--device-memory", "MIB", "the most of its memory to use; default: half of it"},
                 options.device_memory, 1, 1 << 24);
  add_common_options(command, static_cast<ReportOptions&>(options));
}

void add_mesh_options(Command& command, SurfaceOptions& options, const std::string& name) {
  command.option({name, "FILE",
                  name == "MESH" ? "mesh file: .obj, .off, .ply or .stl"
                                 : "mesh file (.obj, .off, .ply, .stl) or cache of gliss bake",
                  true},
                 options.surface);
  command.option({"--unit", "UNIT", "unit of the coordinates: m (default), cm, mm, um, nm, in"},
                 [&options](const std::string& text) {
                   options.unit = parse_unit(text);
                   options.has_unit = true;
                 });
  command.flag("--strict", options.strict,
               "refuse a mesh that is not sound, instead of mending it; weld nothing");
  command.flag("--keep-non-manifold", options.keep_non_manifold,
               "refuse non-manifold edges and vertices instead of cutting them open");
  command.option({"--weld", "LENGTH",
                  "weld borders whose vertices are no farther apart, as 0.01mm; default: only "
                  "vertices at the very same place; none: never"},
                 [&options](const std::string& text) { options.weld = parse_weld(text); });
  add_name_option(
      command,
      {"--normals", "NAME",
       "vertex normals to use: file, made (from the faces), or auto (default): made where the "
       "file has only those of its facets"},
      options.normals, kNormalNames);
  add_name_option(command,
                  {"--orient", "NAME",
                   "how closed parts face: outward (default; one wound against the part around it "
                   "is a cavity), or file: one that is inside out is a room"},
                  options.orient, kOrientNames);
  command.flag("--flip", options.flip, "turn the faces of open parts over");
  command.option(
      {"--crease", "LIST",
       "edges to keep sharp, any of: an angle such as 40deg that faces turn by, auto (one "
       "found in the mesh), normals that differ in the file, groups (smoothing), "
       "edges:FILE; or none (default: where normals of the file differ, else 75deg and chains of "
       "such edges)"},
      [&options](const std::string& text) { options.creases = parse_creases(text); });
  command.option(
      {"--crease-radius", "LENGTH",
       "round the edges of --crease by this radius, as 1mm, instead of keeping them sharp"},
      [&options](const std::string& text) {
        options.crease_radius = parse_length(text);
        if (!(options.crease_radius > 0)) throw InputError("--crease-radius must be positive");
      });
}

void add_surface_options(Command& command, SurfaceOptions& options, const std::string& name) {
  add_mesh_options(command, options, name);
  add_name_option(command, {"--precision", "NAME", "float or double (default)"}, options.precision,
                  kPrecisionNames);
  command.option(
      {"--level", "NAME",
       "exact (default), ribbon, bezier or table; table:N has N cells along half a side"},
      [&options](const std::string& text) { options.level = parse_level("--level", text); });
  add_name_option(
      command,
      {"--construction", "NAME",
       "fair (default), or paper: the paper's own patches, which bend more on irregular meshes"},
      options.construction, kConstructionNames);
}

void add_output_option(Command& command, std::string& output, const std::string& description) {
  command.option({"-o,--output", "FILE", description}, [&output](const std::string& path) {
    const bool known = path == "-" || path.ends_with(".csv") || path.ends_with(".h5") ||
                       path.ends_with(".hdf5") || path.ends_with(".npy");
    if (!known) throw InputError(fmt::format("'{}' must end in .csv, .npy, .h5 or .hdf5", path));
    output = path;
  });
}

void add_input_option(Command& command, const std::string& name, std::string& path,
                      const std::string& description, bool required) {
  command.option({name, "FILE", description, required}, [name, &path](const std::string& text) {
    check_input(name, text);
    path = text;
  });
}

void check_input(const std::string& name, const std::string& path) {
  std::error_code failed;
  const auto status = std::filesystem::status(path, failed);
  if (status.type() == std::filesystem::file_type::not_found && path == "-")
    throw InputError(fmt::format("{}: standard input is not read; name a file", name));
  if (status.type() == std::filesystem::file_type::not_found)
    throw InputError(fmt::format("{}: there is no file '{}'", name, path));
  if (is_directory(status)) throw InputError(fmt::format("{}: '{}' is a folder", name, path));
  if (failed || access(path.c_str(), R_OK) != 0)
    throw InputError(fmt::format("{}: cannot read '{}': {}", name, path, std::strerror(errno)));
}

void add_cpu_option(Command& command, int& cpu) {
  command.option({"--cpu", "N", "run the loop's thread on processor N alone; default: any"}, cpu, 0,
                 1023);
}

void add_scene_option(Command& command, std::string& scene, const std::string& description) {
  command.option({"SCENE", "FILE", description, true}, [&scene](const std::string& path) {
    check_input("SCENE", path);
    const bool is_cache = is_meant_as_cache(path);
    if (is_cache || has_mesh_ending(path))
      throw InputError(fmt::format(
          "{0} is a {1}: a scene is a text file, such as scene.toml, that names it by {1} = "
          "\"{0}\"",
          path, is_cache ? "cache" : "mesh"));
    scene = path;
  });
}

double positive_stiffness(const std::string& text) {
  const double stiffness = parse_stiffness(text);
  if (!(stiffness > 0)) throw InputError("--stiffness must be positive");
  return stiffness;
}

void add_stiffness_option(Command& command, double& stiffness) {
  command.option({"--stiffness", "STIFFNESS", "stiffness: force over depth; default 0.5N/mm"},
                 [&stiffness](const std::string& text) { stiffness = positive_stiffness(text); });
}

void add_solver_options(Command& command, SolverOptions& options) {
  add_name_option(command, {"--solver", "NAME", "newton (default), gauss-newton or paper"},
                  options.solver, kSolverNames);
  add_step_options(command, options);
}

void add_step_options(Command& command, SolverOptions& options) {
  command.option({"--tolerance", "RATIO",
                  "when the solver stops: its last step over the patch's size; default: as the "
                  "precision allows"},
                 options.tolerance, 0, 1);
  command.option({"--iterations", "N", "the most steps of the solver; default 64"},
                 options.max_iterations, 1, 10000);
}

void add_settle_option(Command& command, double& settle) { add_settle(command, settle, settle); }
void add_settle_option(Command& command, std::optional<double>& settle) {
  add_settle(command, settle, QueryOptions{}.settle);
}

void add_friction_options(Command& command, FrictionOptions& friction) {
  command.option(
      {"--friction", "STATIC[,DYNAMIC]",
       "coefficients of friction, at rest and while the contact slips; one number is both; "
       "default 0: none"},
      [&friction](const std::string& text) {
        const std::vector<std::string> words = split(text, ',');
        if (words.size() > 2)
          throw InputError(fmt::format("--friction: '{}' is not STATIC or STATIC,DYNAMIC", text));
        friction.at_rest = parse_number<double>("--friction", words.front());
        friction.slipping = parse_number<double>("--friction", words.back());
        if (fault_of(friction) != nullptr)
          throw InputError(
              fmt::format("--friction: '{}' is not from 0 to {:g}, the second at most "
                          "the first",
                          text, FrictionOptions::kMost));
      });
  command.option(
      {"--friction-settle", "TIME",
       "the time in which static friction falls to dynamic by 63 % once a contact slips; default "
       "0: at once"},
      [&friction](const std::string& text) {
        friction.settle = time_of_option("--friction-settle", text, "2ms");
      });
}

namespace {

// Throws InputError for an option that made invalid effects.
void check_effects(const std::string& option, const std::string& text,
                   const EffectOptions& effects) {
  if (const char* fault = fault_of(effects))
    throw InputError(fmt::format("{}: '{}' {}", option, text, fault));
}

void set_texture(const std::string& text, TextureOptions& texture) {
  const std::vector<std::string> words = split(text, ',');
  if (words.size() != 3 && words.size() != 6)
    throw InputError(fmt::format(
        "--texture: '{}' is not RELIEF,HEIGHT,PERIOD or RELIEF,HEIGHT,PERIOD,X,Y,Z", text));
  texture.relief = parse_name("--texture", words[0], kReliefNames);
  texture.height = parse_length(words[1]);
  texture.period = parse_length(words[2]);
  for (std::size_t i = 3; i < words.size(); ++i)
    texture.along[static_cast<int>(i) - 3] = parse_number<double>("--texture", words[i]);
}

}  // namespace

void add_effect_options(Command& command, EffectOptions& effects) {
  const auto option = [&](const char* name, const char* value, const char* description,
                          const std::function<void(const std::string&)>& set) {
    command.option({name, value, description}, [&effects, name, set](const std::string& text) {
      set(text);
      check_effects(name, text, effects);
    });
  };
  option("--damping", "DAMPING",
         "the normal force grows by this times the velocity inwards, such as 2s/m; default 0",
         [&effects](const std::string& text) { effects.damping = parse_damping(text); });
  option("--viscosity", "VISCOSITY",
         "a force against the velocity inside, such as 3Ns/m; default 0",
         [&effects](const std::string& text) { effects.viscosity = parse_viscosity(text); });
  option("--magnet", "FORCE,RANGE",
         "a pull to the surface from outside, so large at most and from so far, such as 0.5N,2mm",
         [&effects](const std::string& text) {
           const std::vector<std::string> words = split(text, ',');
           if (words.size() != 2)
             throw InputError(fmt::format("--magnet: '{}' is not FORCE,RANGE", text));
           effects.magnet = {parse_force(words[0]), parse_length(words[1])};
         });
  option("--texture", "RELIEF,HEIGHT,PERIOD[,X,Y,Z]",
         "a relief of the surface: grating,50um,2mm,1,0,0 or noise,50um,2mm; the way across the "
         "grooves of a grating is x unless it is given",
         [&effects](const std::string& text) { set_texture(text, effects.texture); });
}

void add_methods_option(Command& command, std::vector<Method>& methods) {
  add_names_option(command, {"--method", "LIST", "methods: gregory, shaded, flat; all by default"},
                   methods, kMethodNames);
}

std::vector<double> parse_depths(const std::string& text) {
  return parse_list("--depth", text, [](const std::string& word) {
    const double depth = parse_length(word);
    if (!(depth > 0)) throw InputError(fmt::format("--depth: '{}' is not positive", word));
    return depth;
  });
}

Level parse_level(const std::string& option, const std::string& name) {
  if (const auto level = find_level(name)) return *level;
  throw InputError(option + ": " + no_level(name));
}

std::unique_ptr<Engine> make_engine(const CommonOptions& options) {
  if (options.names_device_in_vain())
    throw InputError("--opencl-device and --device-memory ask for --backend opencl or auto");
  return make_engine(options, stop_if_interrupted, [&options](const std::string& line) {
    if (!options.quiet) tell(fmt::format("gliss: {}\n", line));
  });
}

void keep_command_line(int count, const char* const* words) {
  kept_words() = {"gliss"};
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    const bool plain = !word.empty() && word.find_first_of(" \t\n'\"\\$&|;<>()*?") == word.npos;
    kept_words().push_back(plain ? word : fmt::format("'{}'", word));
  }
}

std::string command_line() { return fmt::format("{}", fmt::join(kept_words(), " ")); }

std::string command_line_without(const std::string& option) {
  std::vector<std::string> words;
  for (auto word = kept_words().begin(); word != kept_words().end(); ++word) {
    if (*word == option && std::next(word) != kept_words().end())
      ++word;
    else if (!word->starts_with(option + "="))
      words.push_back(*word);
  }
  return fmt::format("{}", fmt::join(words, " "));
}

std::string unsound_text(std::uint64_t count, const std::string& what) {
  return count == 0 ? "" : fmt::format("{} {} are not finite\n", count, what);
}

}  // namespace gliss::tools
