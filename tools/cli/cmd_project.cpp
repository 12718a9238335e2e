// gliss project: the nearest point of the surface to each HIP. Its columns are a contract.
#include <fmt/format.h>

#include <optional>

#include "gliss/base/pace.h"
#include "gliss/tables/result_table.h"
#include "tools/cli/outputs.h"
#include "tools/cli/slips.h"
#include "tools/cli/surface_input.h"
#include "tools/cli/watch.h"

namespace gliss::tools {
namespace {

struct ProjectOptions : TableOptions {
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
      {"--stiffness", "STIFFNESS",
       "adds the force of the method, fx,fy,fz, with this force over depth"},
      [&options](const std::string& text) { options.stiffness = positive_stiffness(text); });
  add_keep_option(command, options.keep);
  add_solver_options(command, options.query);
  command.option({"--method", "NAME", "gregory (default), shaded or flat"},
                 [&options](const std::string& name) {
                   options.query.method = parse_name("--method", name, kMethodNames);
                 });
}

void run(const ProjectOptions& options) {
  check_outputs({options.output}, {options.surface, options.hips});
  const auto engine = make_engine(options);
  const PatchCache cache = open_surface(options, *engine);
  PointTable hips = read_hips(options, options.hips, options.keep);
  check_kept(options.keep, hips.table, options.hips);
  if (options.stiffness) tell_soft_spring(options, *options.stiffness, "--stiffness");
  const UnitChange inward(hips.unit, cache.unit), outward(cache.unit, options.unit);
  for (Vec3& hip : hips.points) hip = inward(hip);

  const std::string unit = unit_name(options.unit);
  const auto file = create_described_file(options.output, cache, options);
  Columns columns;
  columns.add({"patch"}, ColumnType::kUint32)
      .add({"xi", "eta"})
      .add({"x", "y", "z"}, ColumnType::kFloat64, unit)
      .add({"nx", "ny", "nz"})
      .add({"distance"}, ColumnType::kFloat64, unit)
      .add({"iterations", "flags"}, ColumnType::kUint32);
  if (options.stiffness) {
    file->set_attribute({"stiffness_N_per_m", *options.stiffness});
    columns.add({"fx", "fy", "fz"}, ColumnType::kFloat64, "N");
  }
  ResultTable table(*file, "", add_kept(columns, options.keep));
  const auto surface = engine->reside(cache);
  std::vector<Contact> found;
  std::size_t inside = 0, unconverged = 0;
  const Stopwatch clock;
  Pace pace;
  for_blocks(options, "project", hips.points.size(), "HIPs",
             [&](std::size_t begin, std::size_t end, Watch& watch) {
               const std::size_t rows = end - begin;
               found.resize(rows);
               pace.for_pieces(rows, [&](std::size_t from, std::size_t to) {
                 surface->project(std::span(hips.points).subspan(begin + from, to - from),
                                  options.query, std::span(found).subspan(from, to - from));
                 watch.reach(begin + to);
               });
               table.fill(rows, [&](std::size_t i) { return found[i].at.face; });
               table.fill(rows, [&](std::size_t i) { return found[i].at.xi; });
               table.fill(rows, [&](std::size_t i) { return found[i].at.eta; });
               table.fill_vectors(rows, [&](std::size_t i) { return outward(found[i].scp); });
               table.fill_vectors(rows, [&](std::size_t i) { return found[i].normal; });
               table.fill(rows, [&](std::size_t i) { return outward(found[i].distance); });
               table.fill(rows, [&](std::size_t i) { return found[i].iterations; });
               table.fill(rows, [&](std::size_t i) { return found[i].flags; });
               if (options.stiffness) {
                 table.fill_vectors(rows, [&](std::size_t i) {
                   return contact_force(cache, found[i], *options.stiffness);
                 });
               }
               fill_kept(table, options.keep, hips.table, begin, end);
               table.write();
               for (const Contact& contact : found) {
                 inside += contact.touching;
                 unconverged += (contact.flags & kConverged) == 0;
               }
             });
  file->close();
  const double seconds = clock.seconds();
  if (inside == 0 && !hips.points.empty()) {
    for (Vec3& hip : hips.points) hip *= cache.unit;
    const Box box = cache.bounds();
    tell_far(options, options.hips, hips.points, {box.low * cache.unit, box.high * cache.unit},
             "say so by --unit, or by columns x_mm,y_mm,z_mm");
  }
  report(options,
         fmt::format("{} HIPs, {} inside, {} not converged, {:.2f} s\n", hips.points.size(), inside,
                     unconverged, seconds),
         {{"hips", hips.points.size()},
          {"inside", inside},
          {"unconverged", unconverged},
          {"seconds", seconds}},
         options.output == "-");
}

}  // namespace

void add_project(Command& program) {
  add_command<ProjectOptions>(
      program, "project", "Find the nearest point of the surface to each HIP.",
      "gliss project teeth.gliss --hip hips.csv --unit mm -o nearest.csv", describe, run);
}

}  // namespace gliss::tools
