// gliss sweep: what a hand would feel over the whole surface, at some depths, with each method.
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "gliss/base/units.h"
#include "gliss/files/atomic_file.h"
#include "gliss/study/sweep_parts.h"
#include "tools/cli/curvature.h"
#include "tools/cli/outputs.h"
#include "tools/cli/slips.h"
#include "tools/cli/surface_input.h"
#include "tools/cli/sweep_files.h"
#include "tools/cli/sweep_report.h"
#include "tools/cli/sweep_statistics.h"
#include "tools/cli/terminal.h"
#include "tools/cli/watch.h"

namespace gliss::tools {
namespace {

struct SweepingOptions : SurfaceOptions {
  SweepOptions sweep;
  double samples = 0;  // 0: by rings
  int rings = 8;
  std::string output, picture, summary, parts;
};

void describe(Command& command, SweepingOptions& options) {
  add_surface_options(command, options, "MESH_OR_CACHE");
  command.option(
      {"--depth", "LIST", "depths of the HIPs below the surface, as 2mm,4mm", true},
      [&options](const std::string& text) { options.sweep.depths = parse_depths(text); });
  add_methods_option(command, options.sweep.methods);
  add_stiffness_option(command, options.sweep.stiffness);
  add_solver_options(command, options.sweep);
  command.option({"--samples", "COUNT", "points per depth over all faces, at least"},
                 options.samples, 1, 1e12);
  command.option({"--rings", "N", "of the grid on each patch; default 8"}, options.rings, 1, 10000);
  command.exclude("--rings", "--samples");
  add_output_option(command, options.output, "samples: .h5 with statistics, .csv or .npy");
  command.option({"--vtp", "FILE", "HIPs and forces of the first depth, for ParaView"},
                 [&options](const std::string& path) {
                   if (!path.ends_with(SweepPicture::kEnding)) {
                     throw InputError(fmt::format("--vtp: '{}' must end in .vtp", path));
                   }
                   options.picture = path;
                 });
  command.option({"--summary", "FILE", "statistics as a JSON file"}, options.summary);
  command.option(
      {"--parts", "FOLDER",
       "finished parts wait here until all is done, so that the same command goes on from them; "
       "default OUTPUT.parts; none: nowhere"},
      options.parts);
}

// The folder where parts wait: as asked for, or beside what the sweep leaves.
std::string parts_folder(const SweepingOptions& options) {
  if (options.parts == "none") return "";
  if (!options.parts.empty()) return options.parts;
  for (const std::string* file : {&options.output, &options.summary, &options.picture}) {
    if (!file->empty() && *file != "-") return with_ending(*file, ".parts");
  }
  return "";
}

void tell_found(const SweepParts& parts, const SweepingOptions& options) {
  if (options.quiet) return;
  if (parts.kept() > 0)
    tell(fmt::format("gliss: goes on from {} parts in '{}'\n", parts.kept(), parts.folder()));
  if (parts.foreign() > 0)
    tell(fmt::format("gliss: {} files of other sweeps in '{}' are left alone\n", parts.foreign(),
                     parts.folder()));
}

std::uint64_t peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

SweepOptions grid_of(const SweepingOptions& options, const PatchCache& cache) {
  check_depths("--depth", options.sweep.depths, cache);
  tell_soft_spring(options, options.sweep.stiffness, "--stiffness");
  SweepOptions grid = options.sweep;
  if (has(grid.methods, Method::kGregory))
    tell_tight_curvature(options, cache, *std::max_element(grid.depths.begin(), grid.depths.end()));
  grid.rings = options.samples > 0
                   ? rings_for(cache, static_cast<std::uint64_t>(std::ceil(options.samples)))
                   : static_cast<std::uint32_t>(options.rings);
  return grid;
}

// Sweeps with a bar, and says where finished parts are if it is interrupted.
SweepResult watched_sweep(const SweepingOptions& options, const PatchCache& cache,
                          const Engine& engine, const SweepOptions& grid, const SweepSink& sink,
                          SweepParts* parts) {
  SweepResult result;
  try {
    Watch watch(options, "sweep", sample_count(cache, grid.rings) * grid.depths.size(), "samples");
    const auto reach = [&](std::uint64_t done, std::uint64_t) {
      watch.reach(done);
      return true;
    };
    result = sweep(cache, engine, grid, sink, reach, parts);
  } catch (const Interrupted&) {
    if (parts == nullptr || parts->kept() == 0) throw;
    throw Interrupted{
        fmt::format("parts are in '{}': the same command goes on from them", parts->folder())};
  }
  if (parts != nullptr) {
    for (const std::string& path : parts->damaged())
      tell(fmt::format("gliss: '{}' was damaged, its part is computed again\n", path));
  }
  return result;
}

// Depths at which most HIPs have come out on the other side, or into another part.
void tell_beyond_thickness(const SweepingOptions& options, const SweepResult& result) {
  if (options.quiet) return;
  for (const SweepStatistics& s : result.statistics) {
    if (s.method != Method::kGregory || 2 * s.touching >= s.samples) continue;
    tell(fmt::format(
        "gliss: at {:.4g} mm only {:.2g} % of the HIPs feel a force: the mesh is "
        "thinner than that\n",
        s.depth * 1e3, 100 * static_cast<double>(s.touching) / static_cast<double>(s.samples)));
  }
}

void run(const SweepingOptions& options) {
  std::vector<std::string> outputs{options.output, options.summary};
  if (!options.picture.empty()) {
    outputs.push_back(options.picture);
    outputs.push_back(SweepPicture::mesh_path(options.picture));
  }
  check_outputs(outputs, {options.surface});
  const auto engine = make_engine(options);
  const PatchCache cache = open_surface(options, *engine);
  const SweepOptions grid = grid_of(options, cache);
  std::optional<SampleFile> file;
  std::optional<SweepPicture> picture;
  if (!options.output.empty()) file.emplace(options.output, cache, grid, provenance_of(options));
  if (!options.picture.empty()) picture.emplace(cache, grid, options.unit);
  std::optional<AtomicFile> summary;
  if (!options.summary.empty()) summary.emplace(options.summary);
  std::optional<SweepParts> parts;
  if (const std::string folder = parts_folder(options); !folder.empty()) {
    parts.emplace(folder, cache, grid, file || picture);
    tell_found(*parts, options);
  }
  SweepSink sink;
  if (file || picture) {
    sink = [&](const SweepBlock& block) {
      if (file) file->add(block);
      if (picture) picture->add(block);
    };
  }

  const Stopwatch clock;
  const SweepResult result =
      watched_sweep(options, cache, *engine, grid, sink, parts ? &*parts : nullptr);
  if (file) file->close(result);
  const double seconds = clock.seconds();
  const auto contacts = static_cast<double>(result.computed);
  const std::uint64_t samples = sample_count(cache, grid.rings);

  Json json = {{"program", "gliss"},
               {"version", GLISS_VERSION},
               {"command_line", command_line()},
               {"surface", options.surface},
               {"mesh_hash", hash_name(cache.mesh_hash)},
               {"precision", precision_name(cache.precision())},
               {"stiffness_N_per_m", grid.stiffness},
               {"rings", grid.rings},
               {"samples_per_depth", samples},
               {"contacts_computed", result.computed},
               {"threads", engine->threads()},
               {"backend", engine->name()},
               {"seconds", seconds},
               {"device_seconds", engine->device_seconds()},
               {"contacts_per_second", contacts / seconds},
               {"peak_memory_bytes", peak_memory()}};
  for (const SweepStatistics& s : result.statistics) json["statistics"].push_back(json_of(s));
  if (picture) picture->write(options.picture);
  if (summary) {
    summary->write(printed(json));
    summary->commit();
  }
  if (parts) parts->remove();
  tell_beyond_thickness(options, result);
  report(options,
         text_of(result) +
             fmt::format("{} samples a depth ({} rings), {:.4g} contacts computed in {:.2f} s, "
                         "{:.3g} M contacts/s, peak memory {:.0f} MiB\n",
                         samples, grid.rings, contacts, seconds, contacts / seconds * 1e-6,
                         static_cast<double>(peak_memory()) / (1 << 20)),
         json, options.output == "-");
}

}  // namespace

void add_sweep(Command& program) {
  add_command<SweepingOptions>(
      program, "sweep",
      "Sample the force beneath the whole surface and how smooth it is.\n"
      "step: change of the force from a sample to its neighbour, angle: between the two forces. "
      "jumps: steps above 20 % of stiffness x depth, lost: of them, those to a sample without a "
      "force, leaps: of them, those that denser samples do not make smaller. error: difference of "
      "the force from stiffness x depth along the normal above the sample. iter.: steps of all "
      "searches for a sample. p99: a hundredth of the samples are above it; it is interpolated "
      "within bins 12 % wide.\n",
      "gliss sweep teeth.gliss --depth 2mm,4mm --samples 1e6 --unit mm -o teeth.h5", describe, run);
}

}  // namespace gliss::tools
