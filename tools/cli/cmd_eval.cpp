// gliss eval: points, derivatives and normals of patches. Its columns are a contract.
#include <fmt/format.h>

#include <cmath>

#include "gliss/tables/result_table.h"
#include "tools/cli/outputs.h"
#include "tools/cli/surface_input.h"
#include "tools/cli/watch.h"

namespace gliss::tools {
namespace {

struct EvalOptions : TableOptions {
  std::string points;
};

void describe(Command& command, EvalOptions& options) {
  add_surface_options(command, options, "MESH_OR_CACHE");
  add_input_option(command, "--at", options.points,
                   "points: columns patch,xi,eta; a patch is the number of its face, from 0");
  add_output_option(command, options.output, "table to write; CSV on standard output without it");
}

std::vector<DomainPoint> read_domain_points(const std::string& path, const PatchCache& cache) {
  const CsvTable table =
      read_csv(path, {.alternatives = {{"patch", "xi", "eta"}}, .poll = stop_if_interrupted});
  const auto &patch = *table.find("patch"), &xi = *table.find("xi"), &eta = *table.find("eta");
  const auto refuse = [&](std::size_t row, const std::string& problem) {
    throw CsvError(fmt::format("{}: {}", table.place(row), problem));
  };
  std::vector<DomainPoint> points(table.rows);
  for (std::size_t i = 0; i < table.rows; ++i) {
    if (!(patch[i] >= 0 && patch[i] < cache.mesh_face_count) || patch[i] != std::floor(patch[i])) {
      refuse(i, fmt::format("no patch {}; they are 0 to {}", patch[i], cache.mesh_face_count - 1));
    }
    points[i] = {static_cast<std::uint32_t>(patch[i]), xi[i], eta[i]};
    if (cache.face_patch[points[i].face] == kNone) {
      refuse(i, fmt::format("patch {} is not in this cache of a region", patch[i]));
    }
    if (!in_domain(cache, points[i])) {
      refuse(i, fmt::format("({}, {}) is outside the domain of patch {}, a regular {}-gon", xi[i],
                            eta[i], patch[i], cache.face_valence[points[i].face]));
    }
  }
  return points;
}

void run(const EvalOptions& options) {
  check_outputs({options.output}, {options.surface, options.points});
  const auto engine = make_engine(options);
  const PatchCache cache = open_surface(options, *engine);
  const std::vector<DomainPoint> points = read_domain_points(options.points, cache);
  const UnitChange length(cache.unit, options.unit);
  const auto file = create_described_file(options.output, cache, options);
  ResultTable table(
      *file, "",
      Columns()
          .add({"patch"}, ColumnType::kUint32)
          .add({"xi", "eta"})
          .add({"x", "y", "z", "dxi_x", "dxi_y", "dxi_z", "deta_x", "deta_y", "deta_z"},
               ColumnType::kFloat64, unit_name(options.unit))
          .add({"nx", "ny", "nz"}));
  const auto surface = engine->reside(cache);
  std::vector<SurfacePoint> found;
  for_blocks(options, "eval", points.size(), "points", [&](std::size_t begin, std::size_t end) {
    const std::size_t rows = end - begin;
    const auto asked = std::span(points).subspan(begin, rows);
    found.resize(rows);
    surface->evaluate(asked, found);
    table.fill(rows, [&](std::size_t i) { return asked[i].face; });
    table.fill(rows, [&](std::size_t i) { return asked[i].xi; });
    table.fill(rows, [&](std::size_t i) { return asked[i].eta; });
    table.fill_vectors(rows, [&](std::size_t i) { return length(found[i].position); });
    table.fill_vectors(rows, [&](std::size_t i) { return length(found[i].d_xi); });
    table.fill_vectors(rows, [&](std::size_t i) { return length(found[i].d_eta); });
    table.fill_vectors(rows, [&](std::size_t i) { return found[i].normal; });
    table.write();
  });
  file->close();
}

}  // namespace

void add_eval(Command& program) {
  add_command<EvalOptions>(program, "eval", "Evaluate patches at points of their domains.",
                           "gliss eval teeth.gliss --at points.csv --unit mm -o surface.csv",
                           describe, run);
}

}  // namespace gliss::tools
