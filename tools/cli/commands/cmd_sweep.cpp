// gliss sweep: what a hand would feel over the whole surface, at some depths, with each method.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "gliss/base/units.h"
#include "gliss/files/atomic_file.h"
#include "gliss/results/sweep_files.h"
#include "gliss/results/sweep_json.h"
#include "gliss/sweep/sweep_parts.h"
#include "gliss/tables/file_seal.h"
#include "gliss/tables/input_table.h"
#include "tools/cli/commands/commands.h"
#include "tools/cli/commands/sweep_report.h"
#include "tools/cli/parts/parted_work.h"
#include "tools/cli/terminal/terminal.h"
#include "tools/cli/terminal/watch.h"
#include "tools/cli/words/shape_text.h"
#include "tools/cli/words/slips.h"
#include "tools/cli/words/surface_input.h"

namespace gliss::tools {
namespace {

struct SweepingOptions : PartedOptions {
  SweepOptions sweep;
  double samples = 0;  // 0: by rings
  int rings = 8;
  std::string picture, summary;
  bool plain = false;

  bool keeps_samples() const { return !output.empty() || !picture.empty(); }
  CommandFiles files() const {
    if (plain && !is_hdf5(output))
      throw InputError("--layout: only HDF5 files have one; name the samples by -o FILE.h5");
    CommandFiles files{{output, summary}, {surface}};
    if (!picture.empty())
      files.outputs.insert(files.outputs.end(), {picture, SweepPicture::mesh_path(picture)});
    return files;
  }
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
  command.option({"--rings", "N", "rings of the grid on each patch; default 8"}, options.rings, 1,
                 10000);
  command.exclude("--rings", "--samples");
  add_output_option(command, options.output, "samples: .h5 with statistics, .csv or .npy");
  command.option(
      {"--layout", "NAME",
       "how samples lie in .h5: compact (default), or plain, where every row has its place from "
       "the beginning: not compressed, and written by all ranks of gliss-mpi at once"},
      [&options](const std::string& name) {
        if (name != "compact" && name != "plain")
          throw InputError(fmt::format("--layout: '{}' is neither compact nor plain", name));
        options.plain = name == "plain";
      });
  command.option({"--vtp", "FILE", "HIPs and forces of the first depth, for ParaView"},
                 [&options](const std::string& path) {
                   if (!path.ends_with(SweepPicture::kEnding)) {
                     throw InputError(fmt::format("--vtp: '{}' must end in .vtp", path));
                   }
                   options.picture = path;
                 });
  command.option({"--summary", "FILE", "statistics as a JSON file"}, options.summary);
  add_parts_options(command, options);
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

class Sweeping final : public PartedWork {
 public:
  explicit Sweeping(const SweepingOptions& from)
      : options_(from),
        engine_(make_engine(from)),
        cache_(open_surface(from, *engine_)),
        grid_(grid_of(from, cache_)) {}

  Size size() const override {
    return {"sweep", sample_count(cache_, grid_.rings) * grid_.depths.size(), "samples"};
  }
  std::size_t part_count() const override { return gliss::part_count(cache_, grid_); }
  PartFolder& open_parts(const std::string& folder, PartsAccess access) override {
    access_ = access;
    return parts_.emplace(folder, cache_, grid_, options_.keeps_samples(), access);
  }
  void close_parts() override { parts_.reset(); }
  void agree_on_work(const Team& team) override;
  std::uint64_t do_parts(const PartSource& source, const PartProgress& progress) override {
    return sweep_parts(cache_, *engine_, grid_, source, *parts_, progress).computed;
  }
  Json report_of_shard(std::uint64_t contacts) const override;
  void write_result(const PartsOfResult& come) override;
  bool is_written_together() const override { return together_ != nullptr; }
  void write_share(const PartsOfResult& come) override;

 private:
  std::optional<SampleFile> create_file() const;
  PartWork samples_to(SampleFile& file);
  Json write_together(SampleFile& file, const PartsOfResult& come, SweepResult& result);
  Json figures_of(const SweepResult& result, double seconds, const Json& of_team) const;
  std::string cost_text(const Json& figures) const;

  const SweepingOptions& options_;
  const std::unique_ptr<Engine> engine_;
  const PatchCache cache_;
  const SweepOptions grid_;
  std::optional<SweepParts> parts_;
  PartsAccess access_ = PartsAccess::kAlone;
  const Team* together_ = nullptr;  // its members write one file, by the access to it
  Hdf5Access hdf5_access_;
};

// A picture wants all samples in their order.
void Sweeping::agree_on_work(const Team& team) {
  agree(team, "the surface", hash_name(parts_->surface_hash()), "give all the same file");
  agree(team, "the sweep", hash_name(parts_->hash()), "start the same with the same options");
  if (options_.plain && options_.picture.empty()) hdf5_access_ = team.hdf5_access();
  if (hdf5_access_) together_ = &team;
  agree(team, "who writes the result", hdf5_access_ ? "all ranks" : "rank 0",
        "start the same program with the same --layout and --vtp");
}

// What shards say as well as whole sweeps.
Json Sweeping::report_of_shard(std::uint64_t contacts) const {
  return {{"program", "gliss"},
          {"version", GLISS_VERSION},
          {"command_line", command_line()},
          {"surface", options_.surface},
          {"mesh_hash", hash_name(cache_.mesh_hash)},
          {"precision", precision_name(cache_.precision())},
          {"stiffness_N_per_m", grid_.stiffness},
          {"rings", grid_.rings},
          {"samples_per_depth", sample_count(cache_, grid_.rings)},
          {"contacts_computed", contacts},
          {"threads", engine_->threads()},
          {"backend", engine_->name()}};
}

std::vector<std::uint64_t> hashes_of(const std::string& path) {
  return block_hashes(path, std::filesystem::file_size(path), 0, 1, stop_if_interrupted);
}

std::optional<SampleFile> Sweeping::create_file() const {
  std::optional<SampleFile> file;
  const Provenance from = provenance_of(options_);
  if (options_.plain) {
    const auto hashes = [team = together_](const std::string& path) {
      return team == nullptr ? hashes_of(path) : shared_hashes(*team, path);
    };
    file.emplace(SampleFile::create_plain(options_.output, cache_, grid_, from, hashes));
  } else if (!options_.output.empty()) {
    file.emplace(options_.output, cache_, grid_, from);
  }
  return file;
}

// Does parts, and writes the samples of each before the next.
PartWork Sweeping::samples_to(SampleFile& file) {
  return [&](const PartSource& source, const PartProgress& progress) {
    const auto next = [&] {
      file.write();
      return source();
    };
    const auto add = [&](const SweepBlock& block) { file.add(block); };
    return sweep_parts(cache_, *engine_, grid_, next, *parts_, progress, add).computed;
  };
}

// Rank 0 adds up the statistics of all parts while the others wait.
Json Sweeping::write_together(SampleFile& file, const PartsOfResult& come, SweepResult& result) {
  shared_path(*together_, file.temporary_path());
  file.share(hdf5_access_);
  const Json of_team = come(samples_to(file));
  result = kept_statistics(cache_, grid_, *parts_, [](std::uint64_t, std::uint64_t) {
    stop_if_interrupted();
    return true;
  });
  together_->gather("");
  return of_team;
}

void Sweeping::write_share(const PartsOfResult& come) {
  const std::string temporary = shared_path(*together_, "");
  SampleFile file =
      SampleFile::join(temporary, options_.output, cache_, grid_, options_.unit, hdf5_access_);
  come(samples_to(file));
  together_->gather("");
  file.leave();
  shared_hashes(*together_, temporary);
}

void Sweeping::write_result(const PartsOfResult& come) {
  std::optional<SampleFile> file = create_file();
  std::optional<SweepPicture> picture;
  if (!options_.picture.empty()) picture.emplace(cache_, grid_, options_.unit);
  std::optional<AtomicFile> summary;
  if (!options_.summary.empty()) summary.emplace(options_.summary);
  const auto keep = [&](const SweepBlock& block) {
    if (file) file->add(block);
    if (picture) picture->add(block);
  };
  const SweepSink sink = options_.keeps_samples() ? SweepSink(keep) : nullptr;

  const Stopwatch clock;
  SweepResult result;
  const auto make = [&](const PartSource& source, const PartProgress& progress) {
    SweepParts* const parts = parts_ ? &*parts_ : nullptr;
    result = access_ == PartsAccess::kShared
                 ? sweep_parts(cache_, *engine_, grid_, source, *parts, progress, sink)
                 : sweep(cache_, *engine_, grid_, sink, progress, parts);
    return result.computed;
  };
  const Json of_team = together_ != nullptr ? write_together(*file, come, result) : come(make);
  if (file) file->close(result);
  const Json figures = figures_of(result, clock.seconds(), of_team);
  if (picture) picture->write(options_.picture);
  if (summary) {
    summary->write(printed(figures));
    summary->commit();
  }
  tell_beyond_thickness(options_, result);
  report(options_, text_of(result) + cost_text(figures), figures, options_.output == "-");
}

Json Sweeping::figures_of(const SweepResult& result, double seconds, const Json& of_team) const {
  const std::uint64_t computed = of_team.value("contacts_computed", result.computed);
  Json json = report_of_shard(computed);
  json["seconds"] = seconds;
  json["device_seconds"] = engine_->device_seconds();
  json["contacts_per_second"] = static_cast<double>(computed) / seconds;
  json["peak_memory_bytes"] = peak_memory();
  if (!of_team.empty()) json["mpi"] = of_team;
  for (const SweepStatistics& s : result.statistics) json["statistics"].push_back(json_of(s));
  return json;
}

std::string Sweeping::cost_text(const Json& figures) const {
  const auto figure = [&](const char* name) { return figures[name].get<double>(); };
  return fmt::format(
      "{} samples a depth ({} rings), {:.4g} contacts computed in {:.2f} s, {:.3g} M contacts/s, "
      "peak memory {:.0f} MiB\n",
      sample_count(cache_, grid_.rings), grid_.rings, figure("contacts_computed"),
      figure("seconds"), figure("contacts_per_second") * 1e-6,
      figure("peak_memory_bytes") / (1 << 20));
}

void add(Command& program, const std::function<void(const SweepingOptions&)>& run) {
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

}  // namespace

void add_sweep(Command& program) { add(program, run_alone<Sweeping, SweepingOptions>); }

void add_shared_sweep(Command& program, const Team& team) {
  add(program, [&team](const SweepingOptions& options) { run_in_team<Sweeping>(options, team); });
}

}  // namespace gliss::tools
