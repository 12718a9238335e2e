#include "gliss/query/effects.h"

#include <algorithm>
#include <cmath>

#include "gliss/base/plain_arithmetic.h"
#include "gliss/query/tick_time.h"

namespace gliss {

double MagnetOptions::stiffness() const {
  return any() ? 16 / (3 * std::sqrt(3.0)) * force / range : 0;
}

const char* fault_of(const EffectOptions& options) noexcept {
  const auto is_within = [](double x, double most) { return x >= 0 && x <= most; };
  if (!is_within(options.damping, EffectOptions::kMostDamping))
    return "has a damping that is not from 0 to 20 s/m";
  if (!is_within(options.viscosity, EffectOptions::kMostViscosity))
    return "has a viscosity that is not from 0 to 20 N s/m";
  if (!(options.magnet.force >= 0 && std::isfinite(options.magnet.force)))
    return "has a magnet whose force is not 0 or more";
  if (options.magnet.any() && !(options.magnet.range > 0 && std::isfinite(options.magnet.range)))
    return "has a magnet whose range is not above 0";
  return fault_of(options.texture);
}

Effects::Effects(const EffectOptions& options, double stiffness, double unit)
    : options_(options), texture_(options.texture), stiffness_(stiffness), unit_(unit) {}

void Effects::see(const Vec3& hip, double dt, const Vec3& own) noexcept {
  const PlainArithmetic plain;
  constexpr double kApart = kWindow / kPlaces, kRounding = 1e-6;
  dt = tick_time(dt);
  time_ += dt;
  if (!hip.allFinite()) return;
  const Vec3 was = own_;
  if (own.norm() <= kFastest) own_ = own / unit_;
  if (count_ > 0) led_ += 0.5 * dt * (was + own_);
  hip_ = hip;
  const bool is_close = count_ > 1 && place(0).time - place(1).time < kApart - kRounding;
  if (!is_close) last_ = (last_ + 1) % kPlaces;
  seen_[last_] = {hip - led_, time_};
  count_ = std::min(count_ + !is_close, kPlaces);
  while (count_ > 2 && time_ - place(count_ - 1).time > kWindow + kRounding) --count_;
}

Vec3 Effects::velocity() const noexcept {
  if (count_ < 2) return unit_ * own_;
  const Place &first = place(count_ - 1), &last = place(0);
  return unit_ * (own_ + (last.at - first.at) / (last.time - first.time));
}

Vec3 Effects::force(const Contact& contact, const ContactTracker& tracker) const noexcept {
  const PlainArithmetic plain;
  if (contact.push.isZero(0)) return pull(contact);
  Vec3 force =
      stiffness_ * unit_ * (options_.texture.any() ? textured(contact, tracker) : contact.push);
  const Vec3 v = velocity();
  if (options_.damping > 0) {
    const Vec3 axis =
        tracker.friction().is_on() ? tracker.friction().axis() : contact.push.normalized();
    const double normal = force.dot(axis);
    const double grows = std::clamp(-options_.damping * v.dot(axis), -1.0, 1.0);
    if (normal > 0) force += grows * normal * axis;
  }
  if (options_.viscosity > 0) {
    const double share = std::min(1.0, contact.push.norm() * unit_ / kSkin);
    force -= share * options_.viscosity * v;
  }
  return force;
}

Vec3 Effects::pull(const Contact& contact) const {
  if (!options_.magnet.any() || contact.touching) return Vec3::Zero();
  const double u = contact.distance * unit_ / options_.magnet.range;
  if (!(u > 0 && u < 1)) return Vec3::Zero();
  const Vec3 way = contact.scp - hip_;
  const double share = 4 * u * (1 - u);
  return share * share * options_.magnet.force * way.stableNormalized();
}

// The push of the textured surface, mesh's unit.
Vec3 Effects::textured(const Contact& contact, const ContactTracker& tracker) const {
  const ContactFoot foot = tracker.foot(hip_, contact);
  const double depth = foot.depth;
  if (!(depth > 0)) return contact.push;
  const Texture::Place relief = texture_.at(unit_ * foot.point);
  const double pressed = std::max(0.0, depth + relief.height / unit_);
  const Vec3 bare = foot.push,
             felt = pressed * (bare / depth - foot.moves.transpose() * relief.slope);
  return contact.push + (felt - bare);
}

}  // namespace gliss
