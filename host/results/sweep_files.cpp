#include "gliss/results/sweep_files.h"

#include <fmt/format.h>

#include "gliss/results/lengths.h"
#include "gliss/results/sweep_json.h"
#include "gliss/surface/names.h"

namespace gliss {
namespace {

// Opening and closing the columns of a table costs as much as writing some thousand rows.
constexpr std::size_t kBlockRows = 65536;

Columns sample_columns(bool single, ColumnType real, const std::string& unit) {
  Columns columns;
  if (single) {
    columns.add({"depth"}, ColumnType::kFloat64, unit).add({"method"}, ColumnType::kText);
  }
  return columns.add({"face"}, ColumnType::kUint32)
      .was("patch")
      .add({"xi", "eta"}, real)
      .add({"hip_x", "hip_y", "hip_z", "scp_x", "scp_y", "scp_z"}, real, unit)
      .add({"fx", "fy", "fz"}, real, "N")
      .add({"residual_angle"}, ColumnType::kFloat32, "rad")
      .add({"iterations", "crossings"}, ColumnType::kUint32)
      .add({"flags"}, ColumnType::kUint8);
}

std::string group_name(const SweepOptions& sweep, std::size_t kind) {
  return fmt::format("depth_{}/{}", depth_name(sweep.depths[kind / sweep.methods.size()]),
                     method_name(sweep.methods[kind % sweep.methods.size()]));
}

// What the table of statistics says of a histogram.
struct HistogramFigure {
  const char* name;
  bool is_count;  // and has no unit
  double (*of)(const Histogram&);
};

constexpr HistogramFigure kFigures[] = {
    {"count", true, [](const Histogram& h) { return static_cast<double>(h.count()); }},
    {"mean", false, [](const Histogram& h) { return h.mean(); }},
    {"p50", false, [](const Histogram& h) { return h.quantile(0.5); }},
    {"p99", false, [](const Histogram& h) { return h.quantile(0.99); }},
    {"max", false, [](const Histogram& h) { return h.max(); }},
    {"unsound", true, [](const Histogram& h) { return static_cast<double>(h.unsound()); }}};

void write_bins(ResultFile& file, const std::string& name, const SweepStatistics& statistics) {
  ResultTable bins(file, name,
                   Columns().add({"upper_edge", "step", "edge_step", "angle", "error", "residual"}),
                   {}, Histogram::kBins);
  bins.fill(Histogram::kBins,
            [](std::size_t i) { return Histogram::bin_edge(static_cast<int>(i)); });
  for (const auto& named : kHistograms) {
    const Histogram& histogram = statistics.*named.histogram;
    bins.fill(Histogram::kBins, [&](std::size_t i) { return histogram.bins()[i]; });
  }
  bins.write();
}

}  // namespace

SampleFile::SampleFile(const std::string& path, const PatchCache& cache, const SweepOptions& sweep,
                       const Provenance& from)
    : SampleFile(create_described_file(path, cache, from), nullptr,
                 path == "-" || path.ends_with(".csv") || path.ends_with(".npy"), cache, sweep,
                 from.unit) {}

SampleFile SampleFile::create_plain(const std::string& path, const PatchCache& cache,
                                    const SweepOptions& sweep, const Provenance& from,
                                    const BlockHashes& hashes) {
  auto plain = create_plain_file(path, hashes);
  describe_file(*plain, cache, from);
  PlainFile& file = *plain;
  SampleFile samples(std::move(plain), &file, false, cache, sweep, from.unit);
  file.reopen();
  return samples;
}

SampleFile SampleFile::join(const std::string& temporary, const std::string& path,
                            const PatchCache& cache, const SweepOptions& sweep, double unit,
                            const Hdf5Access& access) {
  auto plain = join_plain_file(temporary, path, access);
  PlainFile& file = *plain;
  SampleFile samples(std::move(plain), &file, false, cache, sweep, unit);
  samples.waits_ = true;
  return samples;
}

SampleFile::SampleFile(std::unique_ptr<ResultFile> file, PlainFile* plain, bool single,
                       const PatchCache& cache, const SweepOptions& sweep, double unit)
    : sweep_(sweep),
      length_(cache.unit, unit),
      unit_(unit),
      single_(single),
      file_(std::move(file)),
      plain_(plain) {
  file_->set_attribute({"stiffness_N_per_m", sweep.stiffness});
  file_->set_attribute({"rings", static_cast<std::int64_t>(sweep.rings)});
  std::string depths;
  for (const double depth : sweep.depths) {
    depths += (depths.empty() ? "" : ",") + depth_name(depth);
  }
  file_->set_attribute({"depths", depths});
  const ColumnType real =
      cache.precision() == Precision::kDouble ? ColumnType::kFloat64 : ColumnType::kFloat32;
  const Columns columns = sample_columns(single_, real, unit_name(unit_));
  const std::uint64_t rows = sample_count(cache, sweep.rings);
  const std::size_t kinds = single_ ? 1 : sweep.depths.size() * sweep.methods.size();
  for (std::size_t kind = 0; kind < kinds; ++kind) {
    const double depth = sweep.depths[kind / sweep.methods.size()];
    const std::string method = method_name(sweep.methods[kind % sweep.methods.size()]);
    tables_.emplace_back(*file_, group_name(sweep, kind), columns,
                         std::vector<Attribute>{{"depth_m", depth}, {"method", method}}, rows);
  }
}

void SampleFile::add(const SweepBlock& block) {
  const std::size_t kind = block.depth_index * sweep_.methods.size() + block.method_index;
  ResultTable& table = tables_[single_ ? 0 : kind];
  const std::size_t rows = block.face.size();
  if (plain_ != nullptr && table.rows() == 0) plain_->seek(table.id(), block.row);
  if (single_) {
    const double depth = UnitChange(1, unit_)(sweep_.depths[block.depth_index]);
    const char* method = method_name(sweep_.methods[block.method_index]);
    table.fill(rows, [&](std::size_t) { return depth; });
    table.fill(rows, [&](std::size_t) { return method; });
  }
  const auto column = [&](const auto& values) {
    table.fill(rows, [&](std::size_t i) { return values[i]; });
  };
  column(block.face);
  column(block.xi);
  column(block.eta);
  table.fill_vectors(rows, [&](std::size_t i) { return length_(block.hip[i]); });
  table.fill_vectors(rows, [&](std::size_t i) { return length_(block.scp[i]); });
  table.fill_vectors(rows, [&](std::size_t i) { return block.force[i]; });
  column(block.residual_angle);
  column(block.iterations);
  column(block.crossings);
  column(block.flags);
  if (table.rows() >= kBlockRows && !waits_) table.write();
}

void SampleFile::share(const Hdf5Access& access) {
  plain_->reopen(access);
  waits_ = true;
}

void SampleFile::write() {
  for (ResultTable& table : tables_) table.write();
}

void SampleFile::leave() {
  write();
  file_->close();
}

void SampleFile::close(const SweepResult& result) {
  write();
  if (plain_ != nullptr) plain_->reopen();
  if (!single_) add_statistics(result);
  file_->close();
}

// Counts are float64, exact up to 2^53.
void SampleFile::add_statistics(const SweepResult& result) {
  const auto& all = result.statistics;
  Columns columns;
  columns.add({"depth"}, ColumnType::kFloat64, "m").add({"method"}, ColumnType::kText);
  columns.add({"samples", "touching", "unconverged", "iterations", "crossings"});
  columns.add({"jumps_per_100k", "lost_per_100k", "leaps_per_100k"});
  columns.add({"iterations_sum", "crossings_sum"});  // those of version 0.1 are the same
  for (const auto& [name, unit, histogram] : kHistograms) {
    for (const HistogramFigure& figure : kFigures)
      columns.add({fmt::format("{}_{}", name, figure.name).c_str()}, ColumnType::kFloat64,
                  figure.is_count ? "" : unit);
  }
  ResultTable table(*file_, "statistics", columns, {}, all.size());
  const auto column = [&](auto get) {
    table.fill(all.size(), [&](std::size_t i) { return get(all[i]); });
  };
  column([](const SweepStatistics& s) { return s.depth; });
  column([](const SweepStatistics& s) { return method_name(s.method); });
  for (const auto count :
       {&SweepStatistics::samples, &SweepStatistics::touching, &SweepStatistics::unconverged,
        &SweepStatistics::iterations, &SweepStatistics::crossings}) {
    column([count](const SweepStatistics& s) { return s.*count; });
  }
  column([](const SweepStatistics& s) { return s.jumps_per_100k(); });
  column([](const SweepStatistics& s) { return s.lost_per_100k(); });
  column([](const SweepStatistics& s) { return s.leaps_per_100k(); });
  column([](const SweepStatistics& s) { return s.iterations; });
  column([](const SweepStatistics& s) { return s.crossings; });
  for (const auto& named : kHistograms) {
    for (const HistogramFigure& figure : kFigures)
      column([&](const SweepStatistics& s) { return figure.of(s.*named.histogram); });
  }
  table.write();
  for (std::size_t kind = 0; kind < all.size(); ++kind)
    write_bins(*file_, group_name(sweep_, kind) + "/histogram", all[kind]);
}

}  // namespace gliss
