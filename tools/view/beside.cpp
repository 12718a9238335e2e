#include "tools/view/beside.h"

#include <utility>

#include "gliss/query/query.h"
#include "gliss/query/work.h"
#include "gliss/surface/surface.h"
#include "tools/view/bytes.h"

namespace gliss::tools {
namespace {

// Returns what is felt most strongly of a tracker's last step.
FeltBeside felt_of(const Tracker& tracker, const std::vector<SceneObject>& objects,
                   const Vec3& force, const Vec3& hip) {
  FeltBeside felt;
  felt.force = force;
  felt.scp = hip;
  felt.touching = tracker.touching();
  const auto steps = tracker.objects();
  double most = -1;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const ObjectStep& step = steps[i];
    if (!step.searched || !step.contact.touching || !(step.force.norm() > most)) continue;
    most = step.force.norm();
    const std::size_t object = i % objects.size();  // all of the first HIP, then of the next
    felt.object = static_cast<std::uint32_t>(object);
    felt.face = step.contact.at.face;
    felt.flags = step.contact.flags;
    felt.depth = -step.contact.distance * tracker.unit(i);
    felt.scp = objects[object].pose * (step.contact.scp * tracker.unit(i));
  }
  return felt;
}

}  // namespace

MethodsBeside::MethodsBeside(std::vector<SceneObject> objects, const std::vector<Vec3>& hips,
                             bool has_orientation)
    : objects_(std::move(objects)), has_orientation_(has_orientation) {
  for (const Method method : kViewMethods) {
    for (SceneObject& object : objects_) object.method = method;
    trackers_.emplace_back(objects_, hips);
  }
}

TickBeside MethodsBeside::step(const LoopTick& tick) noexcept {
  TickBeside beside{tick, {}};
  const Vec3& hip = tick.input.position;
  Pose tool = Pose::Identity();
  if (has_orientation_) tool.linear() = tick.input.orientation.normalized().toRotationMatrix();
  tool.translation() = hip;
  for (std::size_t m = 0; m < trackers_.size(); ++m) {
    const Vec3 force = trackers_[m].step(tool, tick.time, tick.input.velocity).force;
    beside.felt[m] = felt_of(trackers_[m], objects_, force, hip);
    if (last_)
      work_[m] += Work::of_step(last_->felt[m].force, force, hip - last_->tick.input.position);
    beside.felt[m].work = work_[m];
  }
  last_ = beside;
  return beside;
}

bool MethodsBeside::tune(const TuneMessage& tuning) noexcept {
  bool done = true;
  for (std::size_t m = 0; m < trackers_.size(); ++m) {
    TuneMessage own = tuning;
    own.method = kViewMethods[m];
    for (std::size_t i = 0; i < objects_.size(); ++i)
      done = tune_object(trackers_[m], i, own) && done;
  }
  return done;
}

bool tune_object(Tracker& tracker, std::size_t object, const TuneMessage& tuning) noexcept {
  const bool done = tracker.set_material(object, tuning.stiffness, tuning.friction) &&
                    tracker.set_texture(object, tuning.texture);
  if (!done || tracker.is_by(object, tuning.method, tuning.settle)) return done;
  return tracker.set_contact(object, tuning.method, tuning.settle);
}

std::string frame_of(std::span<const TickBeside> ticks) {
  std::string bytes;
  bytes.reserve(24 + 4 * kRowNumbers * ticks.size());
  append_bytes(bytes, kFrameMark);
  append_bytes(bytes, static_cast<std::uint32_t>(ticks.size()));
  const Nanoseconds first = ticks.empty() ? Nanoseconds(0) : ticks.front().tick.time;
  append_bytes(bytes, ticks.empty() ? 0.0 : static_cast<double>(ticks.front().tick.number));
  append_bytes(bytes, in_seconds(first));
  for (const auto& [tick, all] : ticks) {
    append_bytes(bytes, static_cast<float>(in_seconds(tick.time - first)));
    append_floats(bytes, tick.input.position);
    append_floats(bytes, tick.sent);
    append_bytes(bytes, static_cast<float>(tick.state));
    append_bytes(bytes, static_cast<float>(tick.reason));
    for (const FeltBeside& felt : all) {
      append_floats(bytes, felt.force);
      append_floats(bytes, felt.scp);
      append_bytes(bytes, static_cast<float>(felt.depth));
      append_bytes(bytes, felt.touching ? is_slipping(felt.flags) ? 2.0F : 1.0F : 0.0F);
      append_bytes(bytes,
                   felt.object == LoopTick::kNothing ? -1.0F : static_cast<float>(felt.object));
      append_bytes(bytes, static_cast<float>(felt.face));
      append_bytes(bytes, static_cast<float>(1e3 * felt.work));
    }
  }
  return bytes;
}

}  // namespace gliss::tools
