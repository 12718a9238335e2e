// gliss project: the nearest point of the surface to each HIP. Its columns are a contract.
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "gliss/files/cache_format.h"
#include "tools/cli/commands/commands.h"
#include "tools/cli/parts/parted_work.h"
#include "tools/cli/parts/projection.h"
#include "tools/cli/terminal/watch.h"
#include "tools/cli/words/slips.h"
#include "tools/cli/words/surface_input.h"

namespace gliss::tools {
namespace {

struct ProjectOptions : PartedOptions {
  ProjectOptions() { output = "-"; }
  CommandFiles files() const { return {{output}, {surface, hips}}; }

  std::string hips;
  std::vector<std::string> keep;
  std::optional<double> stiffness;  // of forces that are written as well
  QueryOptions query;
};

void describe(Command& command, ProjectOptions& options) {
  add_surface_options(command, options, "MESH_OR_CACHE");
  add_input_option(command, "--hip", options.hips,
                   "HIPs: columns x,y,z in the unit of --unit, or x_mm,y_mm,z_mm");
  add_output_option(command, options.output, "table to write; CSV on standard output without it");
  command.option(
      {"--stiffness", "STIFFNESS", "stiffness; adds the columns fx,fy,fz, the force"},
      [&options](const std::string& text) { options.stiffness = positive_stiffness(text); });
  add_keep_option(command, options.keep);
  add_solver_options(command, options.query);
  add_name_option(command, {"--method", "NAME", "gregory (default), shaded or flat"},
                  options.query.method, kMethodNames);
  add_parts_options(command, options);
}

class Projecting final : public PartedWork {
 public:
  explicit Projecting(const ProjectOptions& from)
      : options_(from),
        engine_(make_engine(from)),
        cache_(open_surface(from, *engine_)),
        hips_(open_hips(from, from.hips, from.keep)),
        wanted_{from.query, from.stiffness, from.unit, from.keep},
        projection_(wanted_, cache_, *engine_, hips_) {
    check_kept(options_.keep, hips_.read(0, 0).table, options_.hips);
    examine();
    if (options_.stiffness) tell_soft_spring(options_, *options_.stiffness, "--stiffness");
  }

  Size size() const override { return {"project", hips_.rows(), "HIPs"}; }
  std::size_t part_count() const override { return projection_.part_count(); }
  bool is_short() const override { return part_count() < 2; }
  PartFolder& open_parts(const std::string& folder, PartsAccess access) override;
  void close_parts() override { parts_.reset(); }
  void agree_on_work(const Team& team) override {
    agree(team, "the surface", hash_name(surface_hash_), "give all the same file");
    agree(team, "the file of HIPs", hash_name(hips_hash_), "give all the same file");
    agree(team, "the work", hash_name(parts_->hash()), "start the same with the same options");
  }
  std::uint64_t do_parts(const PartSource& source, const PartProgress& progress) override {
    return projection_.run(source, &*parts_, true, progress);
  }
  Json report_of_shard(std::uint64_t contacts) const override {
    return {{"hips", hips_.rows()}, {"contacts_computed", contacts}};
  }
  void write_result(const PartsOfResult& come) override;

 private:
  void examine();
  void tell_where();

  const ProjectOptions& options_;
  const std::unique_ptr<Engine> engine_;
  const PatchCache cache_;
  PointReader hips_;
  const ProjectionOptions wanted_;
  Projection projection_;
  std::uint64_t surface_hash_ = 0, hips_hash_ = 0;
  std::optional<PartFolder> parts_;
  PartsAccess access_ = PartsAccess::kAlone;
};

// Reads all HIPs once: a row that is no HIP is told before there is a part or a result. Hashes
// them.
void Projecting::examine() {
  Watch watch(options_, "read " + options_.hips, hips_.rows(), "HIPs");
  std::string told;
  projection_.for_each_part([&](const PointTable& hips) {
    const auto put = [&](const auto& values) {
      told += fmt::format(" {}",
                          cache_format::checksum(values.data(), values.size() * sizeof(values[0])));
    };
    put(hips.points);
    for (const std::string& name : options_.keep) put(*hips.table.find(name));
    told = fmt::format("{} {}", cache_format::checksum(told.data(), told.size()), hips.unit);
    watch.add(hips.points.size());
  });
  hips_hash_ = cache_format::checksum(told.data(), told.size());
}

PartFolder& Projecting::open_parts(const std::string& folder, PartsAccess access) {
  access_ = access;
  surface_hash_ = surface_hash(cache_);
  const QueryOptions& query = options_.query;
  std::string told = fmt::format(
      "project {} {} {} {} {} {} {} {} {} {}", Projection::kPartRows, hips_.rows(), hips_hash_,
      static_cast<int>(query.method), static_cast<int>(query.solver), query.max_iterations,
      query.tolerance, query.budget, options_.stiffness.value_or(0), options_.unit);
  for (const std::string& name : options_.keep) told += " " + name;
  return parts_.emplace(folder, work_hash(surface_hash_, told), access);
}

// HIPs none of which is inside, and which are far off.
void Projecting::tell_where() {
  const Box box = cache_.bounds();
  Nearness nearness({{box.low * cache_.unit, box.high * cache_.unit}});
  if (!options_.quiet) {
    projection_.for_each_part(
        [&](const PointTable& hips) { nearness.add(points_in_metres(hips)); });
  }
  tell_far(options_, options_.hips, nearness, "say so by --unit, or by columns x_mm,y_mm,z_mm");
}

void Projecting::write_result(const PartsOfResult& come) {
  constexpr std::size_t kBlockRows = 65536;
  const auto file = create_described_file(options_.output, cache_, options_);
  if (options_.stiffness) file->set_attribute({"stiffness_N_per_m", *options_.stiffness});
  ResultTable table(*file, "", projection_.columns());
  std::uint64_t inside = 0, unconverged = 0, computed = 0;
  const auto write = [&](const ProjectedPart& part) {
    for (std::size_t begin = 0; begin < part.rows.rows(); begin += kBlockRows)
      table.append(part.rows, begin, std::min(part.rows.rows(), begin + kBlockRows));
    inside += part.inside;
    unconverged += part.unconverged;
  };
  const Stopwatch clock;
  const Json of_team = come([&](const PartSource& source, const PartProgress& progress) {
    return computed = projection_.run(source, parts_ ? &*parts_ : nullptr,
                                      access_ == PartsAccess::kShared, progress, write);
  });
  file->close();
  const double seconds = clock.seconds();
  if (inside == 0) tell_where();
  Json json = report_of_shard(of_team.value("contacts_computed", computed));
  json["inside"] = inside;
  json["unconverged"] = unconverged;
  json["seconds"] = seconds;
  json["peak_memory_bytes"] = peak_memory();
  if (!of_team.empty()) json["mpi"] = of_team;
  report(options_,
         fmt::format("{} HIPs, {} inside, {} not converged, {:.2f} s\n", hips_.rows(), inside,
                     unconverged, seconds),
         json, options_.output == "-");
}

void add(Command& program, const std::function<void(const ProjectOptions&)>& run) {
  add_command<ProjectOptions>(
      program, "project", "Find the nearest point of the surface to each HIP.",
      "gliss project teeth.gliss --hip hips.csv --unit mm -o nearest.csv", describe, run);
}

}  // namespace

void add_project(Command& program) { add(program, run_alone<Projecting, ProjectOptions>); }

void add_shared_project(Command& program, const Team& team) {
  add(program, [&team](const ProjectOptions& options) { run_in_team<Projecting>(options, team); });
}

}  // namespace gliss::tools
