#include "tools/view/view_run.h"

#include <algorithm>
#include <utility>

#include "gliss/scene/open_scene.h"

namespace gliss::tools {

Eigen::AlignedBox3d box_of(const std::vector<SceneObject>& objects) {
  Eigen::AlignedBox3d box;
  for (const SceneObject& object : objects) box.extend(gliss::box_of(object));
  return box;
}

TuneMessage tuning_of(const ViewScene& scene) {
  const SceneObject& object = scene.objects.front();
  return {object.method, object.stiffness, object.friction, object.settle, object.effects.texture};
}

void tune(ViewScene& scene, const TuneMessage& tuning) {
  for (SceneObject& object : scene.objects) {
    object.method = tuning.method;
    object.stiffness = tuning.stiffness;
    object.friction = tuning.friction;
    object.settle = tuning.settle;
    object.effects.texture = tuning.texture;
  }
}

ViewRun::ViewRun(ViewScene scene, HapticDevice& device, SessionOptions session)
    : scene_(std::move(scene)),
      tracker_(scene_.objects, scene_.hips),
      beside_(scene_.objects, scene_.hips, device.info().has_orientation) {
  session.after_tick = [this, seen = std::uint64_t{0}](Tracker& tracker) mutable {
    apply(tracker, seen);
  };
  loop_ = std::make_unique<LoopSession>(device, tracker_, scene_.rules, session);
}

bool ViewRun::tune(const TuneMessage& tuning) {
  if (!beside_.tune(tuning)) return false;
  tools::tune(scene_, tuning);
  tunings_.store({tuning.method, tuning.stiffness, tuning.friction.at_rest,
                  tuning.friction.slipping, tuning.friction.settle, tuning.settle,
                  tuning.texture.relief, tuning.texture.height, tuning.texture.period});
  return true;
}

void ViewRun::take() {
  loop_->take(ticks_);
  // Before the first page there is no hand, and nothing to record.
  std::erase_if(ticks_, [](const LoopTick& tick) { return tick.input.sequence == 0; });
  frame_.clear();
  for (const LoopTick& tick : ticks_) frame_.push_back(beside_.step(tick));
}

void ViewRun::apply(Tracker& tracker, std::uint64_t& seen) const noexcept {
  const auto latest = tunings_.load(1);
  if (!latest || latest->number == seen) return;
  seen = latest->number;
  const Tuning& now = latest->value;
  FrictionOptions friction;
  friction.at_rest = now.at_rest;
  friction.slipping = now.slipping;
  friction.settle = now.friction_settle;
  TextureOptions texture;
  texture.relief = now.relief;
  texture.height = now.height;
  texture.period = now.period;
  for (std::size_t i = 0; i < scene_.objects.size(); ++i)
    tune_object(tracker, i, {now.method, now.stiffness, friction, now.settle, texture});
}

}  // namespace gliss::tools
