#include "gliss/scene/recorder.h"

namespace gliss {
namespace {

constexpr std::uint64_t kFlushedTicks = 4096;  // to disk together: a full one is noticed by then

Columns recorded_columns(bool turns) {
  using enum ColumnType;
  Columns columns;
  columns.add({"tick"}, kUint32)
      .add({"time", "lateness", "compute", "age"}, kFloat64, "s")
      .add({"missed"}, kUint32)
      .add({"x", "y", "z"}, kFloat64, "m")
      .add({"vx", "vy", "vz"}, kFloat64, "m/s")
      .add({"fx", "fy", "fz", "sent_x", "sent_y", "sent_z"}, kFloat64, "N")
      .add({"state", "guard", "reason"}, kText)
      .add({"object", "face"}, kUint32)
      .was("patch")
      .add({"distance"}, kFloat64, "m")
      .add({"iterations", "crossings", "flags"}, kUint32);
  if (turns)
    columns.add({"qw", "qx", "qy", "qz"}, kFloat64)
        .add({"tx", "ty", "tz", "sent_tx", "sent_ty", "sent_tz"}, kFloat64, "N m");
  return columns;
}

}  // namespace

RecordingFile::RecordingFile(const std::string& path, const std::vector<Attribute>& attributes,
                             bool turns)
    : many_tables_(!path.ends_with(".csv")),
      turns_(turns),
      file_(create_result_file(path)),
      table_(*file_, "ticks", recorded_columns(turns), {}, kFlushedTicks) {
  for (const Attribute& attribute : attributes) file_->set_attribute(attribute);
}

void RecordingFile::write(const std::vector<LoopTick>& ticks) {
  const auto fill = [&](const auto& get) {
    table_.fill(ticks.size(), [&](std::size_t i) { return get(ticks[i]); });
  };
  const auto fill_vectors = [&](const auto& get) {
    table_.fill_vectors(ticks.size(), [&](std::size_t i) -> const Vec3& { return get(ticks[i]); });
  };
  fill([](const LoopTick& t) { return t.number; });
  fill([](const LoopTick& t) { return in_seconds(t.time); });
  fill([](const LoopTick& t) { return in_seconds(t.lateness); });
  fill([](const LoopTick& t) { return in_seconds(t.compute); });
  fill([](const LoopTick& t) { return in_seconds(t.age); });
  fill([](const LoopTick& t) { return t.missed; });
  fill_vectors([](const LoopTick& t) -> const Vec3& { return t.input.position; });
  fill_vectors([](const LoopTick& t) -> const Vec3& { return t.input.velocity; });
  fill_vectors([](const LoopTick& t) -> const Vec3& { return t.rendered; });
  fill_vectors([](const LoopTick& t) -> const Vec3& { return t.sent; });
  fill([](const LoopTick& t) { return t.touching ? "contact" : "free"; });
  fill([](const LoopTick& t) { return guard_state_name(t.state); });
  fill([](const LoopTick& t) { return guard_reason_name(t.reason); });
  fill([](const LoopTick& t) { return t.object; });
  fill([](const LoopTick& t) { return t.face; });
  fill([](const LoopTick& t) { return t.distance; });
  fill([](const LoopTick& t) { return t.iterations; });
  fill([](const LoopTick& t) { return t.crossings; });
  fill([](const LoopTick& t) { return t.flags; });
  if (turns_) {
    fill([](const LoopTick& t) { return t.input.orientation.w(); });
    fill([](const LoopTick& t) { return t.input.orientation.x(); });
    fill([](const LoopTick& t) { return t.input.orientation.y(); });
    fill([](const LoopTick& t) { return t.input.orientation.z(); });
    fill_vectors([](const LoopTick& t) -> const Vec3& { return t.rendered_torque; });
    fill_vectors([](const LoopTick& t) -> const Vec3& { return t.sent_torque; });
  }
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
