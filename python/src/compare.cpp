// Comparisons of what a mesh's surfaces cost and how they feel.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <cmath>
#include <stdexcept>

#include "calls.h"
#include "gliss/build/cache_mesh.h"
#include "gliss/compare/compare_mesh.h"
#include "gliss/compare/recommend.h"
#include "gliss/results/compare_json.h"
#include "json.h"
#include "options.h"
#include "surface.h"

namespace gliss::python {
namespace {

CompareCandidate candidate(const std::string& name) {
  if (const auto found = find_candidate(name)) return *found;
  throw py::value_error("surfaces: " + no_surface(name));
}

template <class Read>
auto chosen(const py::dict& options, const char* name, Read read) {
  std::vector<decltype(read(std::string()))> list;
  for (const py::handle item : options[name]) list.push_back(read(item.cast<std::string>()));
  if (list.empty()) throw py::value_error(fmt::format("{}: expected one at least", name));
  return list;
}

std::size_t count_of(const py::dict& options, const char* name, std::int64_t least) {
  const std::int64_t count = whole_number(options, name);
  if (count < least || count > 100000000)
    throw py::value_error(fmt::format("{}: {} is not from {} to 100000000", name, count, least));
  return static_cast<std::size_t>(count);
}

std::optional<double> budget_of(const py::dict& options, const char* name) {
  if (options[name].is_none()) return std::nullopt;
  return quantity(options[name], name, nullptr, "a number");
}

MeshComparisonOptions comparison_options(const py::dict& options) {
  MeshComparisonOptions how;
  CompareOptions& measuring = how.measuring;
  measuring.candidates = chosen(options, "surfaces", candidate);
  measuring.precisions = chosen(options, "precisions", [](const std::string& name) {
    return choice("precisions", name, kPrecisionNames);
  });
  measuring.solvers = chosen(options, "solvers", [](const std::string& name) {
    return choice("solvers", name, kSolverNames);
  });
  measuring.settle = settle(options["settle"], "settle");
  measuring.stiffness = stiffness(options["stiffness"]);
  measuring.poll = poll;
  if (!options["depth"].is_none()) how.depths = depths(options["depth"]);
  how.walk.walkers = count_of(options, "walks", 0);
  how.walk.ticks = count_of(options, "walk_ticks", 1);
  how.walk.seed = count_of(options, "seed", 0);
  if (!options["leaving"].is_none()) how.leaving = count_of(options, "leaving", 0);
  return how;
}

py::object compare(const OpenSurface& opened, const py::dict& options) {
  const MeshComparisonOptions how_asked = comparison_options(options);
  const std::size_t dense_limit = count_of(options, "dense_limit", 0);
  const CompareBudget budget{budget_of(options, "max_force_error"), budget_of(options, "max_tick"),
                             budget_of(options, "max_memory")};
  const Progress progress(options["progress"]);
  const Json json = released([&] {
    const ComparedMesh compared(opened.mesh ? *opened.mesh : mesh_of(*opened.cache));
    const PatchCache surface = opened.engine->build(compared.mesh, {});
    MeshComparisonOptions how = how_asked;
    if (how.depths.empty()) how.depths = {compared_depth(surface)};
    const Comparison comparison = compare_mesh(compared, surface, how, *opened.engine);
    std::size_t done = 0;
    const std::size_t total = comparison.row_count() + (dense_limit > 0 ? 2 : 0);
    const auto step = [&] { progress.reach(++done, total); };
    const std::vector<CompareRow> rows = comparison.measure(step);
    const auto dense = match_dense(comparison, rows, dense_limit, step);
    return json_of(how, comparison, rows, dense, recommend(rows, budget));
  });
  return python_of(json);
}

}  // namespace

void bind_compare(py::module_& module) { module.def("compare", compare); }

}  // namespace gliss::python
