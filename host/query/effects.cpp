#include "gliss/query/effects.h"

#include <algorithm>
#include <cmath>

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
  if (!(options.tick > 0 && std::isfinite(options.tick)))
    return "has effects whose tick is not above 0";
  return fault_of(options.texture);
}

Effects::Effects(const EffectOptions& options, double stiffness, double unit)
    : options_(options), texture_(options.texture), stiffness_(stiffness), unit_(unit) {}

void Effects::see(const Vec3& hip) noexcept {
  if (!hip.allFinite()) {
    count_ = 0;
    return;
  }
  last_ = (last_ + 1) % seen_.size();
  seen_[last_] = hip;
  count_ = std::min(count_ + 1, seen_.size());
}

Vec3 Effects::velocity() const noexcept {
  if (count_ < 2) return Vec3::Zero();
  const std::size_t ticks = count_ - 1;
  const Vec3& first = seen_[(last_ + seen_.size() - ticks) % seen_.size()];
  return unit_ / (static_cast<double>(ticks) * options_.tick) * (seen_[last_] - first);
}

Vec3 Effects::force(const Contact& contact, const ContactTracker& tracker) const noexcept {
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
  const double distance = contact.distance * unit_, u = distance / options_.magnet.range;
  if (!options_.magnet.any() || contact.touching || !(u > 0 && u < 1)) return Vec3::Zero();
  const Vec3 way = contact.scp - seen_[last_];
  const double share = 4 * u * (1 - u);
  return share * share * options_.magnet.force * way.stableNormalized();
}

// The push of the textured surface, mesh's unit.
Vec3 Effects::textured(const Contact& contact, const ContactTracker& tracker) const {
  const Vec3& hip = seen_[last_];
  const ContactFoot foot = tracker.foot(hip, contact);
  const double depth = foot.depth;
  if (!(depth > 0)) return contact.push;
  const Texture::Place relief = texture_.at(unit_ * foot.point);
  const double pressed = std::max(0.0, depth + relief.height / unit_);
  const Vec3 bare = foot.push,
             felt = pressed * (bare / depth - foot.moves.transpose() * relief.slope);
  return contact.push + (felt - bare);
}

}  // namespace gliss
