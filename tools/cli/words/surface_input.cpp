#include "tools/cli/words/surface_input.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <new>
#include <numbers>
#include <optional>
#include <span>
#include <stdexcept>

#include "gliss/build/build_cache.h"
#include "gliss/build/cache_mesh.h"
#include "gliss/files/cache_file.h"
#include "gliss/files/mesh_file.h"
#include "gliss/mesh/rounding.h"
#include "gliss/surface/names.h"
#include "gliss/walk/fidelity.h"
#include "tools/cli/terminal/terminal.h"
#include "tools/cli/terminal/watch.h"
#include "tools/cli/words/shape_text.h"
#include "tools/cli/words/slips.h"

namespace gliss::tools {
namespace {

// One line that counts all that was repaired, "" where nothing was; and one for a soup.
std::string repairs_text(const SurfaceOptions& options, const Mesh& mesh,
                         const std::vector<Finding>& findings) {
  std::string all, soup;
  for (const Finding& finding : findings) {
    if (finding.severity == Severity::kRepaired)
      all += fmt::format("{}{} {}", all.empty() ? "" : ", ", finding.code, finding.count);
    if (finding.code == "soup") soup = fmt::format("gliss: {}\n", finding.message);
  }
  if (all.empty()) return soup;
  const std::string lost = removed_text(mesh);
  return soup + fmt::format("gliss: {}: repaired: {}{}{}; 'gliss check' says where\n",
                            options.surface, all, lost.empty() ? "" : "; ", lost);
}

// Caches are read as a whole.
[[noreturn]] void refuse_size(const std::string& path, double memory) {
  constexpr double kGiB = 1 << 30;
  std::error_code none;
  const auto size = static_cast<double>(std::filesystem::file_size(path, none));
  throw std::runtime_error(fmt::format(
      "{}: a cache of {:.3g} GiB does not fit into the memory that there is, of this machine's "
      "{:.3g} GiB; gliss bake --region makes a cache of a part of the mesh",
      path, size / kGiB, memory / kGiB));
}

PatchCache load_what_fits(const SurfaceOptions& options) {
  const std::string& path = options.surface;
  const double memory =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  std::error_code none;
  if (const auto size = std::filesystem::file_size(path, none);
      !none && static_cast<double>(size) > memory)
    refuse_size(path, memory);
  try {
    return load_cache_of(path, {options.precision, options.level, options.construction},
                         stop_if_interrupted);
  } catch (const std::bad_alloc&) {
    refuse_size(path, memory);
  }
}

}  // namespace

std::string removed_text(const Mesh& mesh) {
  constexpr std::size_t kNamed = 8;
  const auto& lost = mesh.lost_faces;
  if (lost.empty()) return "";
  const auto named = std::span(lost).first(std::min(lost.size(), kNamed));
  return fmt::format("removed face{} {}{}, those behind have moved up", lost.size() == 1 ? "" : "s",
                     fmt::join(named, ","),
                     lost.size() > kNamed ? fmt::format(",... ({})", lost.size()) : "");
}

Mesh load_mesh(const SurfaceOptions& options, std::vector<Finding>& findings) {
  const Watch watch(options, "read " + options.surface);
  return gliss::load_mesh(options.surface,
                          {.unit = options.unit,
                           .strict = options.strict,
                           .keep_non_manifold = options.keep_non_manifold,
                           .weld = options.weld / options.unit,
                           .normals = options.normals,
                           .orient = options.orient,
                           .flip = options.flip,
                           .creases = options.creases,
                           .poll = stop_if_interrupted},
                          &findings);
}

PointTable read_hips(const SurfaceOptions& options, const std::string& path,
                     const std::vector<std::string>& further) {
  const Watch watch(options, "read " + path);
  return read_points(path, options.unit, further, stop_if_interrupted);
}

PointReader open_hips(const SurfaceOptions& options, const std::string& path,
                      const std::vector<std::string>& further) {
  const Watch watch(options, "read " + path);
  return {path, options.unit, further, stop_if_interrupted};
}

void add_keep_option(Command& command, std::vector<std::string>& names) {
  command.option({"--keep", "LIST", "columns of numbers to carry along, as time,id"},
                 [&names](const std::string& text) {
                   names = parse_list("--keep", text, [](const std::string& name) { return name; });
                 });
}

void check_kept(const std::vector<std::string>& names, const InputTable& table,
                const std::string& path) {
  for (const std::string& name : names) {
    if (table.find(name) == nullptr)
      throw InputError(fmt::format("--keep: {} has no column '{}'", path, name));
  }
}

void round_creases(const SurfaceOptions& options, Mesh& mesh) {
  if (!(options.crease_radius > 0)) return;
  if (mesh.sharp.empty() && (options.creases.none || options.creases.are_usual()))
    throw InputError(
        "--crease-radius: no edge is a crease; add which edges it rounds, as '--crease auto' or "
        "'--crease 40deg'");
  gliss::round_creases(mesh, options.crease_radius, stop_if_interrupted);
}

Mesh read_mesh(const SurfaceOptions& options, bool tells_of_creases) {
  std::vector<Finding> findings;
  Mesh mesh = load_mesh(options, findings);
  if (!options.quiet) tell(repairs_text(options, mesh, findings));
  tell_odd_size(options, mesh);
  tell_seams(options, mesh, findings);
  if (tells_of_creases) tell_creases(options, mesh);
  round_creases(options, mesh);
  return mesh;
}

void tell_creases(const SurfaceOptions& options, const Mesh& mesh) {
  const bool are_usual = options.creases.are_usual();
  if (options.quiet || !(are_usual || options.creases.plain)) return;
  if (are_usual && !mesh.sharp.empty()) {
    const auto marked = std::count(mesh.sharp.begin(), mesh.sharp.end(), 1) / 2;
    tell(fmt::format(
        "gliss: {} edges {} are kept sharp; '--crease none' makes the mesh smooth all "
        "over\n",
        marked,
        mesh.normals.empty() ? fmt::format("that turn by more than {} degrees", kSharpTurn)
                             : "at which the file's normals differ"));
    return;
  }
  const Topology topology = build_topology(mesh);
  stop_if_interrupted();  // a million faces take a while
  const std::optional<double> angle = plain_crease_angle(mesh, topology);
  stop_if_interrupted();
  const double degrees = angle.value_or(0) * 180 / std::numbers::pi;
  if (options.creases.plain) {
    tell(angle
             ? fmt::format("gliss: creases: edges that turn by more than {:.1f} degrees\n", degrees)
             : "gliss: creases: no angle parts the edges of this mesh plainly\n");
  } else if (angle) {
    tell(fmt::format(
        "gliss: the edges of this mesh turn by much less than {:.0f} degrees or by much "
        "more, as a machine part's do: '--crease auto' keeps the latter sharp\n",
        degrees));
  }
}

PatchCache build(const Mesh& mesh, const SurfaceOptions& options, const Engine& engine,
                 BuildOptions build_options, BuildReport* report) {
  build_options.precision = options.precision.value_or(Precision::kDouble);
  build_options.level = chosen_level(options.level, options.construction);
  std::optional<Watch> watch(
      std::in_place, options, "build",
      build_options.faces.empty() ? mesh.face_count() : build_options.faces.size(), "faces");
  BuildBackend backend = engine.build_backend();
  backend.progress = [&](std::size_t faces) { watch->reach(faces); };
  PatchCache cache = build_cache(mesh, build_options, report, backend);
  watch.reset();
  tell_departure(options, cache);
  return cache;
}

std::string built_text(const BuildReport& report) {
  return fmt::format("folded {}, degenerate {}; eased {}, split {}, bent {}", report.folded,
                     report.degenerate, report.eased, report.split, report.bent);
}

Json built_json(const BuildReport& report) {
  return {{"folded", report.folded},
          {"degenerate", report.degenerate},
          {"eased", report.eased},
          {"split", report.split},
          {"bent", report.bent}};
}

bool is_cache(const SurfaceOptions& options) {
  return options.from_cache || is_meant_as_cache(options.surface);
}

PatchCache read_cache(const SurfaceOptions& options) {
  check_input("MESH_OR_CACHE", options.surface);
  const bool marks = !options.creases.are_usual();
  if (marks || options.crease_radius > 0)
    throw InputError(
        fmt::format("{}: a cache has the creases that it was baked with; {} is for meshes",
                    options.surface, marks ? "--crease" : "--crease-radius"));
  std::optional<Watch> watch(std::in_place, options, "read " + options.surface);
  PatchCache cache = load_what_fits(options);
  watch.reset();
  tell_edited_mesh(options, cache);
  tell_departure(options, cache);
  return cache;
}

Mesh mesh_of(const SurfaceOptions& options, const PatchCache& cache, const std::string& cure) {
  try {
    return gliss::mesh_of(cache);
  } catch (const std::invalid_argument& error) {
    throw InputError(fmt::format("{}: {}; {}", options.surface, error.what(), cure));
  }
}

std::vector<Vec3> own_path(const Mesh& mesh, const Topology& topology, const PatchCache& cache,
                           double depth, int ticks) {
  return path_over(mesh, topology, cache, depth / mesh.unit, diagonal_of(cache.bounds()) / 1000,
                   static_cast<std::size_t>(ticks), stop_if_interrupted);
}

PatchCache open_surface(const SurfaceOptions& options, const Engine& engine) {
  return is_cache(options) ? read_cache(options) : build(read_mesh(options), options, engine);
}

std::unique_ptr<ResultFile> create_described_file(const std::string& path, const PatchCache& cache,
                                                  const SurfaceOptions& options) {
  return create_described_file(path, cache, provenance_of(options));
}

Provenance provenance_of(const SurfaceOptions& options) {
  return {command_line(), options.surface, options.unit, options.crease_radius};
}

}  // namespace gliss::tools
