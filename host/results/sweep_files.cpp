#include "gliss/results/sweep_files.h"

#include <fmt/format.h>

#include "gliss/results/lengths.h"
#include "gliss/results/sweep_json.h"
#include "gliss/surface/names.h"

namespace gliss {
namespace {

// Opening and closing the columns of a table costs as much as writing some thousand rows.
constexpr std::size_t kBlockRows = 65536;

// The columns of samples in the unit of coordinates; with depth and method in one table for all.
TableColumns<SweepBlock> sample_columns(const PatchCache& cache, const SweepOptions& sweep,
                                        double unit, bool single) {
  using enum ColumnType;
  const ColumnType real = cache.precision() == Precision::kDouble ? kFloat64 : kFloat32;
  const std::string name = unit_name(unit);
  const UnitChange length(cache.unit, unit), from_metres(1, unit);
  TableColumns<SweepBlock> columns;
  if (single)
    columns
        .add("depth", kFloat64, name,
             [&sweep, from_metres](const SweepBlock& b, std::size_t) {
               return from_metres(sweep.depths[b.depth_index]);
             })
        .add("method", kText, "", [&sweep](const SweepBlock& b, std::size_t) {
          return method_name(sweep.methods[b.method_index]);
        });
  columns.add("face", kUint32, "", &SweepBlock::face)
      .was("patch")
      .add("xi", real, "", &SweepBlock::xi)
      .add("eta", real, "", &SweepBlock::eta)
      .add_vector({"hip_x", "hip_y", "hip_z"}, real, name,
                  [length](const SweepBlock& b, std::size_t i) { return length(b.hip[i]); })
      .add_vector({"scp_x", "scp_y", "scp_z"}, real, name,
                  [length](const SweepBlock& b, std::size_t i) { return length(b.scp[i]); })
      .add_vector({"fx", "fy", "fz"}, real, "N", &SweepBlock::force)
      .add("residual_angle", kFloat32, "rad", &SweepBlock::residual_angle)
      .add("iterations", kUint32, "", &SweepBlock::iterations)
      .add("crossings", kUint32, "", &SweepBlock::crossings)
      .add("flags", kUint8, "", &SweepBlock::flags);
  return columns;
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

// Counts are float64, exact up to 2^53.
constexpr ColumnType kReal = ColumnType::kFloat64;

void write_bins(ResultFile& file, const std::string& name, const SweepStatistics& statistics) {
  TableColumns<SweepStatistics> columns;
  columns.add("upper_edge", kReal, "", [](const SweepStatistics&, std::size_t i) {
    return Histogram::bin_edge(static_cast<int>(i));
  });
  for (const auto& named : kHistograms)
    columns.add(named.name, kReal, "",
                [of = named.histogram](const SweepStatistics& s) { return (s.*of).bins(); });
  write_table(file, name, columns, statistics, Histogram::kBins);
}

TableColumns<std::vector<SweepStatistics>> statistics_columns() {
  TableColumns<std::vector<SweepStatistics>> columns;
  columns.add("depth", kReal, "m", &SweepStatistics::depth)
      .add("method", ColumnType::kText, "",
           [](const SweepStatistics& s) { return method_name(s.method); })
      .add("samples", kReal, "", &SweepStatistics::samples)
      .add("touching", kReal, "", &SweepStatistics::touching)
      .add("unconverged", kReal, "", &SweepStatistics::unconverged)
      .add("jumps_per_100k", kReal, "", &SweepStatistics::jumps_per_100k)
      .add("lost_per_100k", kReal, "", &SweepStatistics::lost_per_100k)
      .add("leaps_per_100k", kReal, "", &SweepStatistics::leaps_per_100k)
      .add("iterations_sum", kReal, "", &SweepStatistics::iterations)
      .add("crossings_sum", kReal, "", &SweepStatistics::crossings);
  for (const auto& named : kHistograms) {
    for (const HistogramFigure& figure : kFigures)
      columns.add(
          fmt::format("{}_{}", named.name, figure.name).c_str(), kReal,
          figure.is_count ? "" : named.unit,
          [of = named.histogram, get = figure.of](const SweepStatistics& s) { return get(s.*of); });
  }
  return columns;
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
      single_(single),
      columns_(sample_columns(cache, sweep, unit, single)),
      file_(std::move(file)),
      plain_(plain) {
  file_->set_attribute({"stiffness_N_per_m", sweep.stiffness});
  file_->set_attribute({"rings", static_cast<std::int64_t>(sweep.rings)});
  std::string depths;
  for (const double depth : sweep.depths) {
    depths += (depths.empty() ? "" : ",") + depth_name(depth);
  }
  file_->set_attribute({"depths", depths});
  const std::uint64_t rows = sample_count(cache, sweep.rings);
  const std::size_t kinds = single_ ? 1 : sweep.depths.size() * sweep.methods.size();
  for (std::size_t kind = 0; kind < kinds; ++kind) {
    const double depth = sweep.depths[kind / sweep.methods.size()];
    const std::string method = method_name(sweep.methods[kind % sweep.methods.size()]);
    tables_.emplace_back(*file_, group_name(sweep, kind), columns_.columns(),
                         std::vector<Attribute>{{"depth_m", depth}, {"method", method}}, rows);
  }
}

void SampleFile::add(const SweepBlock& block) {
  const std::size_t kind = block.depth_index * sweep_.methods.size() + block.method_index;
  ResultTable& table = tables_[single_ ? 0 : kind];
  if (plain_ != nullptr && table.rows() == 0) plain_->seek(table.id(), block.row);
  columns_.fill(table, block, block.face.size());
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

void SampleFile::add_statistics(const SweepResult& result) {
  const auto& all = result.statistics;
  write_table(*file_, "statistics", statistics_columns(), all, all.size());
  for (std::size_t kind = 0; kind < all.size(); ++kind)
    write_bins(*file_, group_name(sweep_, kind) + "/histogram", all[kind]);
}

}  // namespace gliss
