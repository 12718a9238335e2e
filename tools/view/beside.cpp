#include "tools/view/beside.h"

#include <utility>

#include "gliss/query/query.h"
#include "gliss/surface/surface.h"
#include "tools/view/bytes.h"

namespace gliss::tools {
namespace {

// What is felt most strongly of a tracker's last step.
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

MethodsBeside::MethodsBeside(std::vector<SceneObject> objects, const std::vector<Vec3>& hips)
    : objects_(std::move(objects)) {
  for (const Method method : kViewMethods) {
    for (SceneObject& object : objects_) object.method = method;
    trackers_.emplace_back(objects_, hips);
  }
}

TickBeside MethodsBeside::step(const LoopTick& tick) noexcept {
  TickBeside beside{tick, {}};
  for (std::size_t m = 0; m < trackers_.size(); ++m) {
    Vec3 force = Vec3::Zero();
    const Vec3& hip = tick.input.position;
    if (tick.input.sequence > 0) force = trackers_[m].step(hip, tick.time, tick.input.velocity);
    beside.felt[m] = felt_of(trackers_[m], objects_, force, hip);
  }
  return beside;
}

bool MethodsBeside::tune(double stiffness, const FrictionOptions& friction,
                         double settle) noexcept {
  bool done = true;
  for (std::size_t m = 0; m < trackers_.size(); ++m) {
    for (std::size_t i = 0; i < objects_.size(); ++i) {
      done = trackers_[m].set_material(i, stiffness, friction) && done;
      if (objects_[i].settle == settle) continue;
      done = trackers_[m].set_contact(i, kViewMethods[m], settle) && done;
    }
  }
  for (SceneObject& object : objects_) object.settle = settle;
  return done;
}

std::string frame_of(const std::vector<TickBeside>& ticks) {
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
    }
  }
  return bytes;
}

}  // namespace gliss::tools
