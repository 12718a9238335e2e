// gliss eval: points, derivatives and normals of patches. Its columns are a contract.
#include <fmt/format.h>

#include <cmath>
#include <span>

#include "gliss/tables/table_columns.h"
#include "tools/cli/commands/commands.h"
#include "tools/cli/terminal/watch.h"
#include "tools/cli/words/outputs.h"
#include "tools/cli/words/surface_input.h"

namespace gliss::tools {
namespace {

struct EvalOptions : TableOptions {
  std::string points;
  std::vector<std::string> keep;
};

void describe(Command& command, EvalOptions& options) {
  add_surface_options(command, options, "MESH_OR_CACHE");
  add_input_option(command, "--at", options.points,
                   "points: columns face,xi,eta; face is its number, from 0");
  add_output_option(command, options.output, "table to write; CSV on standard output without it");
  add_keep_option(command, options.keep);
}

InputTable read_points(const EvalOptions& options) {
  const Watch watch(options, "read " + options.points);
  InputTable table =
      read_table(options.points, {.alternatives = {{"face", "xi", "eta"}, {"patch", "xi", "eta"}},
                                  .optional = options.keep,
                                  .poll = stop_if_interrupted});
  check_kept(options.keep, table, options.points);
  return table;
}

// The points of the table, whose faces the cache has, and xi and eta in their domains.
std::vector<DomainPoint> domain_points(const InputTable& table, const PatchCache& cache) {
  const auto &faces = *table.find(table.alternative == 0 ? "face" : "patch"),
             &xi = *table.find("xi"), &eta = *table.find("eta");
  const auto refuse = [&](std::size_t row, const std::string& problem) {
    throw CsvError(fmt::format("{}: {}", table.place(row), problem));
  };
  std::vector<DomainPoint> points;
  points.reserve(table.rows);
  for (std::size_t i = 0; i < table.rows; ++i) {
    if (!(faces[i] >= 0 && faces[i] < cache.mesh_face_count) || faces[i] != std::floor(faces[i])) {
      refuse(i, fmt::format("there is no face {}; they are 0 to {}", faces[i],
                            cache.mesh_face_count - 1));
    }
    const DomainPoint point{static_cast<std::uint32_t>(faces[i]), xi[i], eta[i]};
    if (cache.first_patch(point.face) == kNone) {
      refuse(i, fmt::format("face {} is not in this cache of a region", faces[i]));
    }
    if (!in_domain(cache, point)) {
      refuse(i, fmt::format("({}, {}) is outside the domain of face {}, a regular {}-gon", xi[i],
                            eta[i], faces[i], cache.face_valence[point.face]));
    }
    points.push_back(point);
  }
  return points;
}

// Some points with what was found there; `begin` is the row of the first.
struct EvaluatedPoints {
  const InputTable& table;
  std::size_t begin;
  std::span<const DomainPoint> at;
  std::vector<SurfacePoint> found;

  const SurfacePoint& operator[](std::size_t i) const { return found[i]; }
};

TableColumns<EvaluatedPoints> columns_of(const EvalOptions& options, const PatchCache& cache) {
  using enum ColumnType;
  const std::string unit = unit_name(options.unit);
  const UnitChange length(cache.unit, options.unit);
  const auto lengths = [length](Vec3 SurfacePoint::*vector) {
    return [length, vector](const SurfacePoint& p) { return length(p.*vector); };
  };
  TableColumns<EvaluatedPoints> columns;
  columns.add("face", kUint32, "", [](const auto& p, std::size_t i) { return p.at[i].face; })
      .was("patch")
      .add("xi", kFloat64, "", [](const auto& p, std::size_t i) { return p.at[i].xi; })
      .add("eta", kFloat64, "", [](const auto& p, std::size_t i) { return p.at[i].eta; })
      .add_vector({"x", "y", "z"}, kFloat64, unit, lengths(&SurfacePoint::position))
      .add_vector({"dxi_x", "dxi_y", "dxi_z"}, kFloat64, unit, lengths(&SurfacePoint::d_xi))
      .add_vector({"deta_x", "deta_y", "deta_z"}, kFloat64, unit, lengths(&SurfacePoint::d_eta))
      .add_vector({"nx", "ny", "nz"}, kFloat64, "", &SurfacePoint::normal);
  for (const std::string& name : options.keep)
    columns.add(name.c_str(), kFloat64, "",
                [name](const EvaluatedPoints& p) { return p.table.find(name)->begin() + p.begin; });
  return columns;
}

void run(const EvalOptions& options) {
  check_outputs({options.output}, {options.surface, options.points});
  const auto engine = make_engine(options);
  const PatchCache cache = open_surface(options, *engine);
  const InputTable given = read_points(options);
  const std::vector<DomainPoint> points = domain_points(given, cache);
  const auto file = create_described_file(options.output, cache, options);
  const auto columns = columns_of(options, cache);
  ResultTable table(*file, "", columns.columns());
  const Stopwatch clock;
  const auto surface = engine->reside(cache);
  for_blocks(options, "eval", points.size(), "points",
             [&](std::size_t begin, std::size_t end, Watch&) {
               const std::size_t rows = end - begin;
               EvaluatedPoints evaluated{given, begin, std::span(points).subspan(begin, rows),
                                         std::vector<SurfacePoint>(rows)};
               surface->evaluate(evaluated.at, evaluated.found);
               columns.fill(table, evaluated, rows);
               table.write();
             });
  file->close();
  const double seconds = clock.seconds();
  report(options, fmt::format("{} points, {:.2f} s\n", points.size(), seconds),
         {{"points", points.size()}, {"seconds", seconds}}, options.output == "-");
}

}  // namespace

void add_eval(Command& program) {
  add_command<EvalOptions>(program, "eval", "Evaluate patches at points of their domains.",
                           "gliss eval teeth.gliss --at points.csv --unit mm -o surface.csv",
                           describe, run);
}

}  // namespace gliss::tools
