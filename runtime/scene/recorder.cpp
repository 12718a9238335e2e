#include "gliss/scene/recorder.h"

#include "gliss/tables/table_columns.h"

namespace gliss {
namespace {

constexpr std::uint64_t kFlushedTicks = 4096;  // to disk together: a full one is noticed by then

using Ticks = std::vector<LoopTick>;

TableColumns<Ticks> recorded_columns(bool has_orientation) {
  using enum ColumnType;
  const auto seconds = [](Nanoseconds LoopTick::*time) {
    return [time](const LoopTick& t) { return in_seconds(t.*time); };
  };
  TableColumns<Ticks> columns;
  columns.add("tick", kUint32, "", &LoopTick::number)
      .add("time", kFloat64, "s", seconds(&LoopTick::time))
      .add("lateness", kFloat64, "s", seconds(&LoopTick::lateness))
      .add("compute", kFloat64, "s", seconds(&LoopTick::compute))
      .add("age", kFloat64, "s", seconds(&LoopTick::age))
      .add("missed", kUint32, "", &LoopTick::missed)
      .add_vector({"x", "y", "z"}, kFloat64, "m",
                  [](const LoopTick& t) { return t.input.position; })
      .add_vector({"vx", "vy", "vz"}, kFloat64, "m/s",
                  [](const LoopTick& t) { return t.input.velocity; })
      .add_vector({"fx", "fy", "fz"}, kFloat64, "N", &LoopTick::rendered)
      .add_vector({"sent_x", "sent_y", "sent_z"}, kFloat64, "N", &LoopTick::sent)
      .add("state", kText, "", [](const LoopTick& t) { return t.touching ? "contact" : "free"; })
      .add("guard", kText, "", [](const LoopTick& t) { return guard_state_name(t.state); })
      .add("reason", kText, "", [](const LoopTick& t) { return guard_reason_name(t.reason); })
      .add("object", kUint32, "", &LoopTick::object)
      .add("face", kUint32, "", &LoopTick::face)
      .was("patch")
      .add("distance", kFloat64, "m", &LoopTick::distance)
      .add("iterations", kUint32, "", &LoopTick::iterations)
      .add("crossings", kUint32, "", &LoopTick::crossings)
      .add("flags", kUint32, "", &LoopTick::flags);
  if (has_orientation)
    columns.add("qw", kFloat64, "", [](const LoopTick& t) { return t.input.orientation.w(); })
        .add_vector({"qx", "qy", "qz"}, kFloat64, "",
                    [](const LoopTick& t) { return t.input.orientation.vec(); })
        .add_vector({"tx", "ty", "tz"}, kFloat64, "N m", &LoopTick::rendered_torque)
        .add_vector({"sent_tx", "sent_ty", "sent_tz"}, kFloat64, "N m", &LoopTick::sent_torque);
  return columns;
}

const TableColumns<Ticks>& columns_of(bool has_orientation) {
  static const TableColumns<Ticks> plain = recorded_columns(false), turned = recorded_columns(true);
  return has_orientation ? turned : plain;
}

}  // namespace

RecordingFile::RecordingFile(const std::string& path, const std::vector<Attribute>& attributes,
                             bool has_orientation)
    : many_tables_(!path.ends_with(".csv")),
      has_orientation_(has_orientation),
      file_(create_result_file(path)),
      table_(*file_, "ticks", columns_of(has_orientation).columns(), {}, kFlushedTicks) {
  for (const Attribute& attribute : attributes) file_->set_attribute(attribute);
}

void RecordingFile::write(const std::vector<LoopTick>& ticks) {
  columns_of(has_orientation_).fill(table_, ticks, ticks.size());
  table_.write();
}

void RecordingFile::add_histogram(const std::string& name, const DurationHistogram& durations) {
  if (!many_tables_) return;
  ResultTable table(
      *file_, "histograms/" + name,
      Columns().add({"longest"}, ColumnType::kFloat64, "s").add({"count"}, ColumnType::kFloat64));
  const auto bins = durations.bins();
  table.fill(bins.size(), [&](std::size_t i) { return in_seconds(bins[i].longest); });
  table.fill(bins.size(), [&](std::size_t i) { return bins[i].count; });
  table.write();
}

void RecordingFile::close() { file_->close(); }

}  // namespace gliss
