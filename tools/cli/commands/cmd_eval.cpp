// gliss eval: points, derivatives and normals of patches. Its columns are a contract.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "gliss/tables/result_table.h"
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

// The column of faces, or by its old name.
const LargeArray<double>& faces_of(const InputTable& table) {
  return *table.find(table.alternative == 0 ? "face" : "patch");
}

// The points of the table, whose faces the cache has, and xi and eta in their domains.
InputTable read_domain_points(const EvalOptions& options, const PatchCache& cache) {
  const Watch watch(options, "read " + options.points);
  InputTable table =
      read_table(options.points, {.alternatives = {{"face", "xi", "eta"}, {"patch", "xi", "eta"}},
                                  .optional = options.keep,
                                  .poll = stop_if_interrupted});
  check_kept(options.keep, table, options.points);
  const auto &faces = faces_of(table), &xi = *table.find("xi"), &eta = *table.find("eta");
  const auto refuse = [&](std::size_t row, const std::string& problem) {
    throw CsvError(fmt::format("{}: {}", table.place(row), problem));
  };
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
  }
  return table;
}

// Three columns of a table, rows of which are under way.
using VectorColumns = std::array<std::span<double>, 3>;

VectorColumns extend_vectors(ResultTable& table, std::size_t rows) {
  VectorColumns columns;
  for (auto& column : columns) column = table.extend<double>(rows);
  return columns;
}

StridedVectors<double> vectors_of(const VectorColumns& columns) {
  return strided_vectors(columns[0].data(), columns[1].data(), columns[2].data());
}

void run(const EvalOptions& options) {
  check_outputs({options.output}, {options.surface, options.points});
  const auto engine = make_engine(options);
  const PatchCache cache = open_surface(options, *engine);
  const InputTable points = read_domain_points(options, cache);
  const auto &faces = faces_of(points), &xi = *points.find("xi"), &eta = *points.find("eta");
  const UnitChange length(cache.unit, options.unit);
  const auto file = create_described_file(options.output, cache, options);
  Columns columns;
  columns.add({"face"}, ColumnType::kUint32)
      .was("patch")
      .add({"xi", "eta"})
      .add({"x", "y", "z", "dxi_x", "dxi_y", "dxi_z", "deta_x", "deta_y", "deta_z"},
           ColumnType::kFloat64, unit_name(options.unit))
      .add({"nx", "ny", "nz"});
  for (const std::string& name : options.keep) columns.add({name.c_str()});
  ResultTable table(*file, "", columns);
  const Stopwatch clock;
  const auto surface = engine->reside(cache);
  for_blocks(
      options, "eval", points.rows, "points", [&](std::size_t begin, std::size_t end, Watch&) {
        const std::size_t rows = end - begin;
        const auto face = table.extend<std::uint32_t>(rows);
        std::copy_n(&faces[begin], rows, face.begin());
        table.fill(rows, [&](std::size_t i) { return xi[begin + i]; });
        table.fill(rows, [&](std::size_t i) { return eta[begin + i]; });
        const VectorColumns position = extend_vectors(table, rows),
                            d_xi = extend_vectors(table, rows), d_eta = extend_vectors(table, rows),
                            normal = extend_vectors(table, rows);
        surface->evaluate(
            {rows, {face.data()}, {&xi[begin]}, {&eta[begin]}},
            {vectors_of(position), vectors_of(d_xi), vectors_of(d_eta), vectors_of(normal)});
        for (const VectorColumns& vectors : {position, d_xi, d_eta}) {
          for (const auto& column : vectors) {
            for (double& x : column) x = length(x);
          }
        }
        for (const std::string& name : options.keep)
          table.fill(
              rows, [&kept = *points.find(name), begin](std::size_t i) { return kept[begin + i]; });
        table.write();
      });
  file->close();
  const double seconds = clock.seconds();
  report(options, fmt::format("{} points, {:.2f} s\n", points.rows, seconds),
         {{"points", points.rows}, {"seconds", seconds}}, options.output == "-");
}

}  // namespace

void add_eval(Command& program) {
  add_command<EvalOptions>(program, "eval", "Evaluate patches at points of their domains.",
                           "gliss eval teeth.gliss --at points.csv --unit mm -o surface.csv",
                           describe, run);
}

}  // namespace gliss::tools
