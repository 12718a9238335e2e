// Reads what gliss sweep sampled: forces over the offset surfaces, thinned (Figures 12 and 13), and
// how neighbours differ.
#include <fmt/format.h>

#include <algorithm>

#include "gliss/results/sweep_json.h"
#include "tools/cli/words/command_line.h"
#include "tools/report/report_data.h"
#include "tools/report/report_source.h"

namespace gliss::tools {
namespace {

constexpr std::size_t kMostPoints = 100000;  // a depth

// Its columns are read one after the other.
class SampleReader {
 public:
  SampleReader(const Hdf5Reader& file, const ReportSource& source, std::size_t columns)
      : file_(file), source_(source), share_(source.bytes / columns) {}

  LargeArray<double> column(const std::string& name, std::size_t stride) const {
    auto values = file_.numbers(name, stride);
    source_.watch.add(share_);
    return values;
  }
  // x y z x y z ..., quantised.
  Json vectors(const std::string& group, std::initializer_list<const char*> names,
               std::size_t count, std::size_t stride) const {
    std::vector<float> together(count * names.size());
    std::size_t axis = 0;
    for (const char* name : names) {
      const auto values = column(group + "/" + name, stride);
      if (values.size() != count) {
        throw InputError(fmt::format("{}: '{}/{}' is not as long as the columns beside it",
                                     source_.path, group, name));
      }
      for (std::size_t i = 0; i < count; ++i)
        together[i * names.size() + axis] = static_cast<float>(values[i]);
      ++axis;
    }
    return quantised(together, names.size());
  }

 private:
  const Hdf5Reader& file_;
  const ReportSource& source_;
  std::uint64_t share_;
};

Json statistics_of(const Hdf5Reader& file, std::size_t row) {
  const auto figure = [&](const std::string& name) {
    return file.numbers("statistics/" + name)[row];
  };
  // Files of version 0.1.0 have no such column.
  const auto figure_or_none = [&](const std::string& name) {
    return file.has("statistics/" + name) ? Json(figure(name)) : Json();
  };
  Json json = {{"samples", figure("samples")},
               {"touching", figure("touching")},
               {"unconverged", figure("unconverged")},
               {"jumps_per_100k", figure_or_none("jumps_per_100k")},
               {"lost_per_100k", figure_or_none("lost_per_100k")},
               {"leaps_per_100k", figure_or_none("leaps_per_100k")}};
  for (const auto& [name, unit, histogram] : kHistograms) {
    for (const char* of : {"count", "mean", "p50", "p99", "max"}) {
      json[name][of] = figure(fmt::format("{}_{}", name, of));
    }
    json[name]["unsound"] = figure_or_none(fmt::format("{}_unsound", name));
  }
  return json;
}

Json bins_of(const Hdf5Reader& file, const std::string& group) {
  Json json;
  const auto pack = [&](const std::string& name) {
    const auto values = file.numbers(group + "/histogram/" + name);
    return packed(std::vector<float>(values.begin(), values.end()));
  };
  json["upper_edge"] = pack("upper_edge");
  for (const auto& named : kHistograms) json[named.name] = pack(named.name);
  return json;
}

}  // namespace

Json read_sweep(const Hdf5Reader& file, const ReportSource& source) {
  const auto depth = file.numbers("statistics/depth");
  const auto method = file.texts("statistics/method");
  if (depth.empty() || method.size() != depth.size())
    throw InputError(source.path + ": a sweep without depths");
  const auto depths = static_cast<std::size_t>(
      std::count_if(method.begin(), method.end(), [&](const auto& m) { return m == method[0]; }));
  const std::size_t methods = depth.size() / depths;
  const SampleReader samples(file, source, depths * (4 + 3 * methods));
  // Position and patch once a depth, a force for each method.
  const std::size_t point_bytes = depths * (6 + 4 + 6 * methods);
  const std::size_t most = std::clamp<std::size_t>(source.page_bytes / point_bytes, 1, kMostPoints);

  Json json = {{"kind", "sweep"}, {"origin", provenance(file, source)}};
  for (std::size_t kind = 0; kind < depth.size(); ++kind) {
    const std::string group = fmt::format("depth_{}/{}", depth_name(depth[kind]), method[kind]);
    const std::size_t rows = file.rows(group + "/patch");
    const std::size_t stride = std::max<std::size_t>(1, (rows + most - 1) / most);
    const std::size_t count = (rows + stride - 1) / stride;
    Json& depths_json = json["depths"];
    if (depths_json.empty() || depths_json.back()["depth_m"] != depth[kind]) {
      const auto patch = samples.column(group + "/patch", stride);
      depths_json.push_back(
          {{"depth_m", depth[kind]},
           {"name", depth_name(depth[kind])},
           {"samples", rows},
           {"shown", count},
           {"hip", samples.vectors(group, {"hip_x", "hip_y", "hip_z"}, count, stride)},
           {"patch", narrowed(std::vector<std::uint32_t>(patch.begin(), patch.end()))}});
    } else if (depths_json.back()["shown"] != count) {
      throw InputError(
          fmt::format("{}: '{}' has other samples than the methods beside it", source.path, group));
    }
    depths_json.back()["methods"].push_back(
        {{"method", method[kind]},
         {"force", samples.vectors(group, {"fx", "fy", "fz"}, count, stride)},
         {"statistics", statistics_of(file, kind)},
         {"histograms", bins_of(file, group)}});
  }
  return json;
}

}  // namespace gliss::tools
