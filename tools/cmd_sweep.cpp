// gliss sweep: what a hand would feel over the whole surface, at some depths, with each method.
#include <fmt/format.h>
#include <sys/resource.h>

#include <cmath>

#include "host/atomic_file.h"
#include "host/units.h"
#include "tools/sweep_files.h"
#include "tools/watch.h"

namespace gliss::tools {
namespace {

struct SweepingOptions : SurfaceOptions {
  SweepOptions sweep;
  double samples = 0;  // 0: by rings
  std::string output, picture, summary;
};

void describe(CLI::App& command, SweepingOptions& options) {
  add_surface_options(command, options, "MESH_OR_CACHE");
  command
      .add_option_function<std::string>(
          "--depth",
          [&depths = options.sweep.depths](const std::string& text) {
            depths.clear();
            for (const std::string& word : split(text, ',')) {
              depths.push_back(parse_length(word));
              if (!(depths.back() > 0)) throw InputError("--depth must be positive");
              for (std::size_t i = 0; i + 1 < depths.size(); ++i) {
                if (depth_name(depths[i]) != depth_name(depths.back())) continue;
                throw InputError(fmt::format("--depth: '{}' is there twice", word));
              }
            }
          },
          "depths of the HIPs below the surface, as 2mm,4mm")
      ->required()
      ->type_name("LIST");
  add_methods_option(command, options.sweep.methods);
  add_stiffness_option(command, options.sweep.stiffness);
  add_solver_option(command, options.sweep.solver);
  CLI::Option* samples =
      command.add_option("--samples", options.samples, "points per depth over all faces, at least")
          ->check(CLI::Range(1.0, 1e12))
          ->type_name("COUNT");
  command.add_option("--rings", options.sweep.rings, "of the grid on each patch; default 8")
      ->check(CLI::Range(1, 10000))
      ->type_name("N")
      ->excludes(samples);
  add_output_option(command, options.output, "samples: .h5 with statistics, or .csv");
  command.add_option("--vtp", options.picture, "HIPs and forces of the first depth, for ParaView")
      ->type_name("FILE");
  command.add_option("--summary", options.summary, "statistics as a JSON file")->type_name("FILE");
}

std::uint64_t peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

Json json_of(const SweepStatistics& s) {
  Json json = {{"depth_m", s.depth},           {"method", method_name(s.method)},
               {"samples", s.samples},         {"touching", s.touching},
               {"unconverged", s.unconverged}, {"iterations", s.iterations},
               {"crossings", s.crossings}};
  for (const auto& [name, unit, histogram] : kHistograms) {
    const Histogram& h = s.*histogram;
    json[fmt::format("{}_{}", name, unit)] = {
        {"count", h.count()},     {"mean", h.mean()},        {"p50", h.quantile(0.5)},
        {"p90", h.quantile(0.9)}, {"p99", h.quantile(0.99)}, {"p999", h.quantile(0.999)},
        {"max", h.max()}};
  }
  return json;
}

std::string text_of(const SweepResult& result) {
  std::string text =
      fmt::format("{:<8} {:<8} {:>29} {:>29} {:>19} {:>19} {:>6} {:>8}\n", "", "",
                  "step within patches, N", "step across edges, N", "angle, rad", "error, N",
                  "iter.", "not con-") +
      fmt::format(
          "{:<8} {:<8} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>6} {:>8}\n",
          "depth", "method", "mean", "p99", "max", "mean", "p99", "max", "p99", "max", "p99", "max",
          "mean", "verged");
  for (const SweepStatistics& s : result.statistics) {
    text += fmt::format("{:<8} {:<8}", depth_name(s.depth), method_name(s.method));
    for (const Histogram* h : {&s.step, &s.edge_step}) {
      text += fmt::format(" {:>9.3g} {:>9.3g} {:>9.3g}", h->mean(), h->quantile(0.99), h->max());
    }
    for (const Histogram* h : {&s.angle, &s.error}) {
      text += fmt::format(" {:>9.3g} {:>9.3g}", h->quantile(0.99), h->max());
    }
    text += fmt::format(" {:>6.2f} {:>8}\n",
                        static_cast<double>(s.iterations) / static_cast<double>(s.samples),
                        s.unconverged);
  }
  return text;
}

void run(const SweepingOptions& options) {
  const auto engine = make_engine(options);
  const PatchCache cache = open_surface(options, *engine);
  SweepOptions grid = options.sweep;
  if (options.samples > 0) {
    grid.rings = rings_for(cache, static_cast<std::uint64_t>(std::ceil(options.samples)));
  }
  std::optional<SampleFile> file;
  std::optional<SweepPicture> picture;
  if (!options.output.empty()) file.emplace(options.output, cache, grid, options.unit);
  if (!options.picture.empty()) picture.emplace(cache, grid, options.unit);
  SweepSink sink;
  if (file || picture) {
    sink = [&](const SweepBlock& block) {
      if (file) file->add(block);
      if (picture) picture->add(block);
    };
  }

  const Stopwatch clock;
  const std::uint64_t samples = sample_count(cache, grid.rings);
  SweepResult result;
  {
    Watch watch(options, "sweep", samples * grid.depths.size(), "samples");
    result = sweep(cache, *engine, grid, sink, [&](std::uint64_t done, std::uint64_t) {
      watch.reach(done);
      return true;
    });
  }
  if (file) file->close(result);
  const double seconds = clock.seconds();
  const auto contacts = static_cast<double>(samples * grid.depths.size() * grid.methods.size());

  Json json = {{"program", "gliss"},
               {"version", GLISS_VERSION},
               {"command_line", command_line()},
               {"surface", options.surface},
               {"mesh_hash", hash_name(cache.mesh_hash)},
               {"precision", precision_name(cache.precision())},
               {"stiffness_N_per_m", grid.stiffness},
               {"rings", grid.rings},
               {"samples_per_depth", samples},
               {"threads", engine->threads()},
               {"seconds", seconds},
               {"contacts_per_second", contacts / seconds},
               {"peak_memory_bytes", peak_memory()}};
  for (const SweepStatistics& s : result.statistics) json["statistics"].push_back(json_of(s));
  if (picture) picture->write(options.picture);
  if (!options.summary.empty()) {
    AtomicFile summary(options.summary);
    summary.write(json.dump(2) + "\n");
    summary.commit();
  }
  report(options,
         text_of(result) +
             fmt::format("{} samples a depth ({} rings), {:.4g} contacts in {:.2f} s, "
                         "{:.3g} M contacts/s, peak memory {:.0f} MiB\n",
                         samples, grid.rings, contacts, seconds, contacts / seconds * 1e-6,
                         static_cast<double>(peak_memory()) / (1 << 20)),
         json, options.output == "-");
}

}  // namespace

void add_sweep(CLI::App& program) {
  add_command<SweepingOptions>(
      program, "sweep", "Sample the force beneath the whole surface and how smooth it is.",
      "gliss sweep teeth.gliss --depth 2mm,4mm --samples 1e6 --unit mm -o teeth.h5", describe, run);
}

}  // namespace gliss::tools
