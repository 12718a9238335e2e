// Sweeps, and the files and parts that they leave, which are the program's.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <cmath>
#include <optional>

#include "arrays.h"
#include "calls.h"
#include "gliss/results/lengths.h"
#include "gliss/results/sweep_files.h"
#include "gliss/results/sweep_json.h"
#include "gliss/sweep/sweep_parts.h"
#include "json.h"
#include "options.h"
#include "surface.h"

namespace gliss::python {
namespace {

SweepOptions grid_of(const OpenSurface& surface, py::handle depth, const py::dict& options) {
  SweepOptions grid;
  grid.depths = depths(depth);
  check_depths("depth", grid.depths, *surface.cache);
  grid.methods.clear();
  for (const py::handle name : options["methods"])
    grid.methods.push_back(choice("methods", py::str(name).cast<std::string>(), kMethodNames));
  if (grid.methods.empty()) throw py::value_error("methods: expected one at least");
  grid.stiffness = stiffness(options["stiffness"]);
  const auto rings = whole_number(options, "rings");
  if (rings < 1 || rings > 10000)
    throw py::value_error(fmt::format("rings: {} is not from 1 to 10000", rings));
  grid.rings = static_cast<std::uint32_t>(rings);
  if (!options["samples"].is_none()) {
    const double samples = quantity(options["samples"], "samples", nullptr, "a number");
    if (!(samples >= 1 && samples <= 1e12))
      throw py::value_error(fmt::format("samples: {} is not from 1 to 1e12", samples));
    grid.rings = rings_for(*surface.cache, static_cast<std::uint64_t>(std::ceil(samples)));
  }
  return grid;
}

py::dict histograms_of(const SweepStatistics& statistics) {
  py::dict out;
  for (const auto& [name, unit, histogram] : kHistograms) {
    const auto& bins = (statistics.*histogram).bins();
    out[name] = py::array_t<std::uint64_t>(static_cast<py::ssize_t>(bins.size()), bins.data());
  }
  return out;
}

py::dict sweep(const OpenSurface& surface, py::handle depth, const py::dict& options) {
  const SweepOptions grid = grid_of(surface, depth, options);
  const auto output = text(options, "output"), folder = text(options, "parts");
  const Provenance provenance{text(options, "command_line"), surface.path, surface.cache->unit,
                              surface.crease_radius};
  const Progress progress(options["progress"]);
  const SweepResult result = released([&] {
    std::optional<SampleFile> file;
    if (!output.empty()) file.emplace(output, *surface.cache, grid, provenance);
    std::optional<SweepParts> parts;
    if (!folder.empty()) parts.emplace(folder, *surface.cache, grid, file.has_value());
    SweepSink sink;
    if (file) sink = [&](const SweepBlock& block) { file->add(block); };
    const auto reach = [&](std::uint64_t done, std::uint64_t total) {
      poll();
      progress.reach(done, total);
    };
    SweepResult swept =
        gliss::sweep(*surface.cache, *surface.engine, grid, sink, reach, parts ? &*parts : nullptr);
    if (file) file->close(swept);
    if (parts) parts->remove();
    return swept;
  });
  py::list statistics, histograms;
  for (const SweepStatistics& s : result.statistics) {
    statistics.append(python_of(json_of(s)));
    histograms.append(histograms_of(s));
  }
  NewArray<double> edges(Histogram::kBins);
  for (int bin = 0; bin < Histogram::kBins; ++bin) edges.data()[bin] = Histogram::bin_edge(bin);
  py::dict out;
  out["statistics"] = statistics;
  out["histograms"] = histograms;
  out["bin_edges"] = edges.array();
  out["computed"] = result.computed;
  out["rings"] = grid.rings;
  return out;
}

}  // namespace

void bind_sweep(py::module_& module) {
  module.def("sweep", sweep);
  module.def("unit_name", unit_name);
  module.def("length_text", length_text);
  module.def("tight_curvature_text", [](const OpenSurface& surface) {
    const PatchCache& cache = *surface.cache;
    return tight_curvature_text(cache, usual_depth(cache), "0.5 % of the diagonal");
  });
  module.def("depth_names", [](py::handle list) {
    std::vector<std::string> names;
    for (const double depth : depths(list)) names.push_back(depth_name(depth));
    return names;
  });
}

}  // namespace gliss::python
