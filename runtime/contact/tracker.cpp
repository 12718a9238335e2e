#include "gliss/contact/tracker.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "gliss/base/plain_arithmetic.h"
#include "gliss/query/tick_time.h"

namespace gliss {
namespace {

constexpr Nanoseconds kTick = std::chrono::milliseconds(1);
static_assert(in_seconds(kTick) == ContactTracker::kTick);
const Vec3 kNaN = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());

QueryOptions query_of(const SceneObject& object) {
  QueryOptions query{{object.solver, object.max_iterations, object.tolerance}, object.method};
  query.settle = object.settle;
  query.friction = object.friction;
  return query;
}

// The contact of a HIP that has gone a way and waits for its tick.
Contact on_its_plane(Contact contact, const Vec3& way) {
  const double depth = contact.push.dot(contact.normal), now = depth - way.dot(contact.normal);
  contact.push *= now > 0 && depth > 0 ? now / depth : 0;
  return contact;
}

bool is_rendered(double stiffness) {
  return stiffness >= 0 && stiffness <= Tracker::kMostStiffness;
}

// Why nothing can be touched of an object, as the end of a sentence about it; null: it can.
const char* fault_of(const SceneObject& object) {
  if (!object.pose.matrix().allFinite()) return "has a pose that is not finite";
  if (!is_rigid(object.pose)) return "has a pose that is not a rotation and translation";
  if (object.motion != nullptr && object.poses != nullptr)
    return "has a motion and poses, of which it can follow one";
  if (!is_rendered(object.stiffness)) return "has a stiffness that is not from 0 to 1e6 N/m";
  if (!(object.settle >= 0 && object.settle <= kMostSettleTime))
    return "has a settle that is not from 0 to 1 s";
  if (const char* fault = fault_of(object.friction)) return fault;
  if (const char* fault = fault_of(object.effects)) return fault;
  if (!is_rendered(object.effects.magnet.stiffness()))
    return "has a magnet whose stiffness, 3.08 force / range, is not from 0 to 1e6 N/m";
  if (object.cache != nullptr)
    return object.cache->patch_count() == 0 ? "has a cache without patches" : nullptr;
  if (object.lazy == nullptr)
    return "has no surface: set its cache, or lazy to build patches near the HIP";
  if (object.effects.magnet.any()) return "is lazy and has a magnet, which needs a cache";
  if (object.lazy->needs_all())
    return "is lazy, and its parts lie within one another or fold: it needs a cache";
  return object.method == Method::kGregory ? nullptr
                                           : "is lazy, which is for the method gregory alone";
}

void check(std::span<const SceneObject> objects) {
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (const char* fault = fault_of(objects[i]))
      throw std::invalid_argument("SceneObject " + std::to_string(i) + " " + fault);
  }
}

}  // namespace

Tracker::Tracker(std::span<const SceneObject> objects, std::span<const Vec3> hips) {
  check(objects);
  for (const Vec3& hip : hips) {
    if (!hip.allFinite()) throw std::invalid_argument("hips: one is not finite");
  }
  if (objects.size() * hips.size() > kMostContacts)
    throw std::invalid_argument("hips: " + std::to_string(hips.size()) + " on " +
                                std::to_string(objects.size()) + " objects are more than " +
                                std::to_string(kMostContacts) + " contacts");
  static const Vec3 at_the_device = Vec3::Zero();
  if (hips.empty()) hips = {&at_the_device, 1};
  for (const SceneObject& object : objects)
    places_.push_back({object, object.pose, object.pose.inverse()});
  for (const Vec3& hip : hips) {
    for (std::size_t place = 0; place < places_.size(); ++place) {
      const SceneObject& object = places_[place].object;
      Tracked& tracked = tracked_.emplace_back();
      tracked.place = place;
      tracked.hip = hip;
      tracked.unit = object.unit();
      if (object.effects.any())
        tracked.effects.emplace(object.effects, object.stiffness, tracked.unit);
      if (object.cache != nullptr) {
        tracked.whole.emplace(*object.cache, query_of(object));
      } else {
        tracked.lazy = std::make_unique<LazyContact>(object.lazy, query_of(object), object.worker);
      }
    }
  }
  steps_.resize(tracked_.size());
}

bool Tracker::move(std::size_t object, const Pose& pose) noexcept {
  if (!is_rigid(pose)) return false;
  places_[object].now = pose;
  places_[object].to_object = pose.inverse();
  return true;
}

bool Tracker::set_material(std::size_t object, double stiffness,
                           const FrictionOptions& friction) noexcept {
  if (!is_rendered(stiffness) || fault_of(friction) != nullptr) return false;
  places_[object].object.stiffness = stiffness;
  places_[object].object.friction = friction;
  for (Tracked& tracked : tracked_) {
    if (tracked.place != object) continue;
    tracked.set_friction(friction);
    if (tracked.effects) tracked.effects->set_stiffness(stiffness);
  }
  return true;
}

bool Tracker::set_contact(std::size_t place, Method method, double settle) noexcept {
  SceneObject& object = places_[place].object;
  if (object.cache == nullptr || !(settle >= 0 && settle <= kMostSettleTime)) return false;
  object.method = method;
  object.settle = settle;
  for (Tracked& tracked : tracked_) {
    if (tracked.place == place) tracked.whole.emplace(*object.cache, query_of(object));
  }
  return true;
}

bool Tracker::set_texture(std::size_t place, const TextureOptions& texture) noexcept {
  SceneObject& object = places_[place].object;
  EffectOptions effects = object.effects;
  effects.texture = texture;
  effects.texture.along = object.effects.texture.along;
  if (fault_of(effects) != nullptr) return false;
  object.effects = effects;
  for (Tracked& tracked : tracked_) {
    if (tracked.place != place) continue;
    if (tracked.effects) {
      tracked.effects->set_texture(effects.texture);
    } else if (effects.any()) {
      tracked.effects.emplace(effects, object.stiffness, tracked.unit);
    }
  }
  return true;
}

void Tracker::follow_motions() noexcept {
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const SceneObject& object = places_[i].object;
    if (object.motion != nullptr) {
      move(i, object.motion->at(in_seconds(*time_)) * object.pose);
    } else if (object.poses != nullptr) {
      if (const auto pose = object.poses->latest()) move(i, *pose);
    }
  }
}

Vec3 Tracker::step(const Vec3& position, std::optional<Nanoseconds> time,
                   const Vec3& velocity) noexcept {
  Pose tool = Pose::Identity();
  tool.translation() = position;
  return step(tool, time, velocity).force;
}

Wrench Tracker::step(const Pose& tool, std::optional<Nanoseconds> time,
                     const Vec3& velocity) noexcept {
  const PlainArithmetic plain;
  if (!time_ || time) {
    time_ = time.value_or(Nanoseconds(0));
  } else {
    time_ = std::min(*time_, Nanoseconds::max() - kTick) + kTick;
  }
  if (!tool.matrix().allFinite()) return {kNaN, kNaN};
  follow_motions();
  const double dt = tick_time(felt_.value_or(*time_), *time_);
  felt_ = time_;
  Wrench sum;
  int left = kStepEvaluations;
  const std::size_t n = tracked_.size(), first = std::exchange(first_, 0);
  for (std::size_t i = first; i < first + n; ++i) {
    const bool had_some = left > 0;
    feel(tool, dt, velocity, i % n, left, sum);
    if (had_some && left <= 0) first_ = (i + 1) % n;
  }
  return sum;
}

// Adds what is felt of a HIP and an object; `left`: the evaluations that others may spend after it.
void Tracker::feel(const Pose& tool, double dt, const Vec3& velocity, std::size_t i, int& left,
                   Wrench& sum) noexcept {
  Tracked& tracked = tracked_[i];
  const Place& place = places_[tracked.place];
  ObjectStep& step = steps_[i];
  const Vec3 arm = tool.linear() * tracked.hip;
  const Vec3 at = place.to_object * (tool.translation() + arm) / tracked.unit;
  if (tracked.lazy) tracked.lazy->post(at);
  if (tracked.effects) tracked.effects->see(at, dt, place.to_object.linear() * velocity);
  step.searched = !tracked.is_clear(at);
  step.force.setZero();
  tracked.waiting = step.searched ? tracked.waiting + dt : 0;
  const Vec3 way = at - std::exchange(tracked.at, at);
  if (!step.searched) return;
  if (left > 0) {
    step.contact = tracked.tick(at, std::exchange(tracked.waiting, 0));
    left -= step.contact.iterations + 1;
  } else {
    step.contact = on_its_plane(step.contact, way);
  }
  if (step.contact.push.isZero(0) && !tracked.effects) return;
  const Vec3 force = tracked.effects
                         ? tracked.effects->force(step.contact, tracked.tracker())
                         : Vec3(place.object.stiffness * tracked.unit * step.contact.push);
  step.force = place.now.linear() * force;
  sum.force += step.force;
  sum.torque += arm.cross(step.force);
}

bool Tracker::touching() const {
  return std::any_of(tracked_.begin(), tracked_.end(),
                     [](const Tracked& t) { return t.touching(); });
}

}  // namespace gliss
