// gliss sweep: what a hand would feel over the whole surface, at some depths, with each method.
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "gliss/base/units.h"
#include "gliss/files/atomic_file.h"
#include "gliss/study/sweep_parts.h"
#include "gliss/tables/file_seal.h"
#include "tools/cli/curvature.h"
#include "tools/cli/outputs.h"
#include "tools/cli/shard.h"
#include "tools/cli/slips.h"
#include "tools/cli/surface_input.h"
#include "tools/cli/sweep_files.h"
#include "tools/cli/sweep_member.h"
#include "tools/cli/sweep_report.h"
#include "tools/cli/sweep_statistics.h"
#include "tools/cli/sweep_team.h"
#include "tools/cli/terminal.h"
#include "tools/cli/watch.h"

namespace gliss::tools {
namespace {

struct SweepingOptions : SurfaceOptions {
  SweepOptions sweep;
  double samples = 0;  // 0: by rings
  int rings = 8;
  std::string output, picture, summary, parts;
  std::optional<Shard> shard;
  bool plain = false;

  bool keeps_samples() const { return !output.empty() || !picture.empty(); }
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
  command.option(
      {"--layout", "NAME",
       "of samples in .h5: compact; or plain, where every row has its place from the "
       "beginning: not compressed, and written by all ranks of gliss-mpi at once; "
       "default compact"},
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
  command.option(
      {"--parts", "FOLDER",
       "finished parts wait here until all is done, so that the same command goes on from them; "
       "default OUTPUT.parts; none: nowhere"},
      options.parts);
  command.option(
      {"--shard", "I/N",
       "do every Nth part from the Ith on, the first being 1, as 3/16, and write no result: the "
       "same command without --shard does, once all shards are done"},
      [&options](const std::string& text) { options.shard = parse_shard(text); });
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

// What is swept, and by what.
struct Sweeping {
  explicit Sweeping(const SweepingOptions& from)
      : options(from),
        engine(make_engine(options)),
        cache(open_surface(options, *engine)),
        grid(grid_of(options, cache)) {}

  SweepParts open_parts(const std::string& folder, PartsAccess access) const {
    constexpr double kPatience = 3;  // s
    return {folder, cache, grid, options.keeps_samples(), kPatience, access};
  }

  const SweepingOptions& options;
  const std::unique_ptr<Engine> engine;
  const PatchCache cache;
  const SweepOptions grid;
};

// Calls work(progress) with a bar, and says where finished parts are if it is interrupted.
// `sharers`: among which the samples are dealt out, in turns.
template <class Work>
SweepResult watched(const Sweeping& sweeping, const SweepParts* parts, std::size_t sharers,
                    const Work& work) {
  const SweepOptions& grid = sweeping.grid;
  const std::uint64_t total = sample_count(sweeping.cache, grid.rings) * grid.depths.size();
  SweepResult result;
  try {
    Watch watch(sweeping.options, "sweep", total / sharers, "samples");
    const auto reach = [&](std::uint64_t done, std::uint64_t) {
      watch.reach(done / sharers);
      return true;
    };
    result = work(reach);
  } catch (const Interrupted&) {
    if (parts == nullptr || (parts->kept() == 0 && parts->whole() == 0)) throw;
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

std::uint64_t peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

// What shards say as well as whole sweeps.
Json json_head(const Sweeping& sweeping, std::uint64_t contacts) {
  const PatchCache& cache = sweeping.cache;
  return {{"program", "gliss"},
          {"version", GLISS_VERSION},
          {"command_line", command_line()},
          {"surface", sweeping.options.surface},
          {"mesh_hash", hash_name(cache.mesh_hash)},
          {"precision", precision_name(cache.precision())},
          {"stiffness_N_per_m", sweeping.grid.stiffness},
          {"rings", sweeping.grid.rings},
          {"samples_per_depth", sample_count(cache, sweeping.grid.rings)},
          {"contacts_computed", contacts},
          {"threads", sweeping.engine->threads()},
          {"backend", sweeping.engine->name()}};
}

// The folder where those that share a sweep meet.
std::string shared_folder(const SweepingOptions& options) {
  const std::string folder = parts_folder(options);
  if (folder.empty()) {
    throw InputError(
        "parts that are shared need a folder; add what the whole command writes, as -o FILE or "
        "--summary FILE, or --parts FOLDER");
  }
  return folder;
}

void run_shard(const Sweeping& sweeping) {
  const SweepingOptions& options = sweeping.options;
  const Shard shard = *options.shard;
  SweepParts parts = sweeping.open_parts(shared_folder(options), PartsAccess::kShared);
  tell_found(parts, options);
  const Stopwatch clock;
  const SweepResult result = watched(sweeping, &parts, shard.count, [&](const auto& reach) {
    return sweep_parts(sweeping.cache, *sweeping.engine, sweeping.grid,
                       every_part(shard.number - 1, shard.count), parts, reach);
  });
  const std::size_t whole = parts.whole(), all = part_count(sweeping.cache, sweeping.grid);
  const std::string rest = command_line_without("--shard");
  Json json = json_head(sweeping, result.computed);
  json["seconds"] = clock.seconds();
  json["shard"] = shard_text(shard);
  json["parts_folder"] = parts.folder();
  json["parts"] = all;
  json["parts_done"] = whole;
  json["command_of_result"] = rest;
  report(options,
         fmt::format("shard {} is done: {} of {} parts are in '{}'; {}the result comes by\n{}\n",
                     shard_text(shard), whole, all, parts.folder(),
                     whole < all ? "once the others are, " : "", rest),
         json);
}

// How the samples of a result come: from a sweep, to a sink, or to a file that is shared.
using Sweeper = std::function<SweepResult(const SweepSink& sink, SampleFile* file)>;

std::vector<std::uint64_t> hashes_of(const std::string& path) {
  return block_hashes(path, std::filesystem::file_size(path), 0, 1, stop_if_interrupted);
}

// Writes what was asked for, a plain file with the hashes of its blocks. `team`: what its members
// did, once all of it is done; without them an empty function.
void write_result(const Sweeping& sweeping, SweepParts* parts, const Sweeper& sweep,
                  const BlockHashes& hashes = hashes_of,
                  const std::function<Json()>& team = nullptr) {
  const SweepingOptions& options = sweeping.options;
  const PatchCache& cache = sweeping.cache;
  const SweepOptions& grid = sweeping.grid;
  std::optional<SampleFile> file;
  std::optional<SweepPicture> picture;
  if (options.plain) {
    file.emplace(
        SampleFile::create_plain(options.output, cache, grid, provenance_of(options), hashes));
  } else if (!options.output.empty()) {
    file.emplace(options.output, cache, grid, provenance_of(options));
  }
  if (!options.picture.empty()) picture.emplace(cache, grid, options.unit);
  std::optional<AtomicFile> summary;
  if (!options.summary.empty()) summary.emplace(options.summary);
  SweepSink sink;
  if (options.keeps_samples()) {
    sink = [&](const SweepBlock& block) {
      if (file) file->add(block);
      if (picture) picture->add(block);
    };
  }

  const Stopwatch clock;
  const SweepResult result = sweep(sink, file ? &*file : nullptr);
  if (file) file->close(result);
  const double seconds = clock.seconds();
  const Json of_team = team ? team() : Json::object();
  const std::uint64_t computed = of_team.value("contacts_computed", result.computed),
                      samples = sample_count(cache, grid.rings);
  const double contacts = static_cast<double>(computed), rate = contacts / seconds;

  Json json = json_head(sweeping, computed);
  json["seconds"] = seconds;
  json["device_seconds"] = sweeping.engine->device_seconds();
  json["contacts_per_second"] = rate;
  json["peak_memory_bytes"] = peak_memory();
  if (team) json["mpi"] = of_team;
  for (const SweepStatistics& s : result.statistics) json["statistics"].push_back(json_of(s));
  if (picture) picture->write(options.picture);
  if (summary) {
    summary->write(printed(json));
    summary->commit();
  }
  if (parts != nullptr && !parts->remove() && !options.quiet) {
    tell(fmt::format("gliss: parts stay in '{}', where others are at work\n", parts->folder()));
  }
  tell_beyond_thickness(options, result);
  report(options,
         text_of(result) +
             fmt::format("{} samples a depth ({} rings), {:.4g} contacts computed in {:.2f} s, "
                         "{:.3g} M contacts/s, peak memory {:.0f} MiB\n",
                         samples, grid.rings, contacts, seconds, rate * 1e-6,
                         static_cast<double>(peak_memory()) / (1 << 20)),
         json, options.output == "-");
}

void check_files(const SweepingOptions& options) {
  if (options.plain && !options.output.ends_with(".h5") && !options.output.ends_with(".hdf5"))
    throw InputError("--layout: only HDF5 files have one; name the samples by -o FILE.h5");
  std::vector<std::string> outputs{options.output, options.summary};
  if (!options.picture.empty()) {
    outputs.push_back(options.picture);
    outputs.push_back(SweepPicture::mesh_path(options.picture));
  }
  check_outputs(outputs, {options.surface});
}

void run_whole(const Sweeping& sweeping) {
  const SweepingOptions& options = sweeping.options;
  std::unique_ptr<SweepParts> parts;
  if (const std::string folder = parts_folder(options); !folder.empty()) {
    parts.reset(new SweepParts(sweeping.open_parts(folder, PartsAccess::kAlone)));
    tell_found(*parts, options);
  }
  write_result(sweeping, parts.get(), [&](const SweepSink& sink, SampleFile*) {
    return watched(sweeping, parts.get(), 1, [&](const auto& reach) {
      return sweep(sweeping.cache, *sweeping.engine, sweeping.grid, sink, reach, parts.get());
    });
  });
}

void run(const SweepingOptions& options) {
  if (options.shard) (void)shared_folder(options);
  check_files(options);
  const Sweeping sweeping(options);
  options.shard ? run_shard(sweeping) : run_whole(sweeping);
}

// Rank 0 speaks, and writes the result: alone, or a plain file with the others. A picture wants all
// samples in their order.
void run_in_team(SweepingOptions options, const SweepTeam& team) {
  if (options.shard) throw InputError("--shard: ranks share the parts without it");
  const std::string folder = shared_folder(options);
  const bool leads = team.rank() == 0;
  options.quiet = options.quiet || !leads;
  if (options.threads == 0) options.threads = team.threads();
  agree(team, "the version of the program", GLISS_VERSION, "start the same one everywhere");
  if (leads) check_files(options);
  const Sweeping sweeping(options);
  std::unique_ptr<SweepParts> parts(
      new SweepParts(sweeping.open_parts(folder, PartsAccess::kShared)));
  tell_found(*parts, options);
  SweepMember member({sweeping.cache, *sweeping.engine, sweeping.grid}, team, *parts);
  const Hdf5Access access =
      options.plain && options.picture.empty() ? team.hdf5_access() : Hdf5Access();
  agree(team, "who writes the result", access ? "all ranks" : "rank 0",
        "start the same program with the same --layout and --vtp");
  const auto hashes = [&](const std::string& path) { return shared_hashes(team, path); };
  if (leads) {
    const auto sweep = [&](const SweepSink& sink, SampleFile* file) {
      return watched(sweeping, parts.get(), 1, [&](const auto& reach) {
        if (!access) return member.do_all(sink, reach);
        shared_path(team, file->temporary_path());
        file->share(access);
        return member.do_samples(*file, reach);
      });
    };
    return write_result(sweeping, parts.get(), sweep, access ? BlockHashes(hashes) : hashes_of,
                        [&] { return member.report(); });
  }
  watched(sweeping, parts.get(), 1, [&](const auto& reach) {
    if (!access) {
      member.do_parts(reach);
      return SweepResult();
    }
    const std::string temporary = shared_path(team, "");
    SampleFile file = SampleFile::join(temporary, options.output, sweeping.cache, sweeping.grid,
                                       options.unit, access);
    member.do_samples(file, reach);
    file.leave();
    shared_hashes(team, temporary);
    return SweepResult();
  });
  parts.reset();  // the leader removes them
  member.report();
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

void add_sweep(Command& program) { add(program, run); }

void add_shared_sweep(Command& program, const SweepTeam& team) {
  add(program, [&team](const SweepingOptions& options) { run_in_team(options, team); });
}

}  // namespace gliss::tools
