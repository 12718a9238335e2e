#include "gliss/walk/held_outside.h"

#include <array>
#include <cmath>
#include <utility>

namespace gliss {
namespace {

constexpr double kOnSurface = 1e-6;  // of the size: closer to the surface is on it
constexpr double kSettleTimes = 5;
constexpr double kAside = 1e-5;   // of the push: a HIP so far aside has a contact beside it
constexpr double kApart = 1e-3;   // of the push: a contact so far off is another one
constexpr double kStays = 2e-2;   // of the push: it comes back to as near
constexpr double kBeside = 1e-2;  // of the push: so far round a place in a valley nothing is nearer
constexpr int kJudgements = 8;    // ticks that share one: a contact that holds changes slowly
constexpr std::size_t kAsideCount = 4;

}  // namespace

std::uint64_t held_bound(double settle, double tick) {
  const double ticks = kSettleTimes * settle / tick;
  return static_cast<std::uint64_t>(std::floor(ticks * (1 + 1e-12))) + 1;
}

HeldOutsideCounter::HeldOutsideCounter(const PatchCache& cache, const QueryOptions& options,
                                       double tick)
    : cache_(&cache),
      options_(options),
      tick_(tick),
      on_surface_(kOnSurface / cache.scale),
      bound_(held_bound(options.settle, tick)) {}

void HeldOutsideCounter::add(const Vec3& hip, const Contact& felt, const Contact& beneath) {
  const bool was_felt = std::exchange(is_felt_, felt.push.allFinite() && !felt.push.isZero(0));
  if (!was_felt) is_counted_ = false;
  count_.contacts += is_felt_ && !was_felt;
  if (!is_felt_ || !is_outside(hip)) {
    outside_ = 0;
    judged_for_ = 0;
    return;
  }
  outside_ = is_justified(hip, is_settling(felt.flags) ? beneath : felt) ? 0 : outside_ + 1;
  count_.longest = std::max(count_.longest, static_cast<double>(outside_) * tick_);
  count_.held += outside_ == bound_ + 1 && !std::exchange(is_counted_, true);
  count_.pulled +=
      outside_ > bound_ && (felt.flags & kOnBorder) == 0 && (felt.scp - hip).dot(felt.normal) < 0;
}

bool HeldOutsideCounter::is_outside(const Vec3& hip) {
  if ((hip - looked_).norm() < clear_) return was_outside_;
  const Contact found = nearest(*cache_, hip, options_);
  const bool is_known = (found.flags & kUnfinished) == 0;
  looked_ = hip;
  clear_ = (is_known ? std::abs(found.distance) : found.clear) - on_surface_;
  return was_outside_ = is_known && !found.touching && found.distance > on_surface_;
}

bool HeldOutsideCounter::is_justified(const Vec3& hip, const Contact& felt) {
  constexpr std::uint32_t kStates = kConverged | kSettling | kUnfinished;
  if (!felt.touching || (felt.flags & kStates) != kConverged ||
      !((felt.scp - hip).dot(felt.normal) > 0)) {
    judged_for_ = 0;
    return false;
  }
  const bool is_same = judged_for_ > 0 && judged_hip_ == hip && judged_scp_ == felt.scp;
  if (is_same || (judged_for_ > 0 && judged_for_ < kJudgements && is_held_justly_)) {
    ++judged_for_;
    return is_held_justly_;
  }
  judged_for_ = 1;
  judged_hip_ = hip;
  judged_scp_ = felt.scp;
  const bool is_rim = (felt.flags & kOnBorder) != 0;  // of a solid that is not drawn
  return is_held_justly_ =
             is_nearest_around(hip, felt) && (is_rim || leads_through_inside(hip, felt.scp));
}

// True if the contact is a nearest point, or lies in a valley. With friction the contact without
// it, from the same place, is judged. A seam is not known by a place on one part: there friction
// goes unjudged.
bool HeldOutsideCounter::is_nearest_around(const Vec3& hip, const Contact& felt) const {
  if (!options_.friction.any()) return is_local_minimum(hip, felt) || is_in_valley(hip, felt);
  if ((felt.flags & kOnCrease) != 0) return true;
  Contact without;
  track(*cache_, {&hip, 1}, {&felt.at, 1}, options_, {&without, 1});
  return is_local_minimum(hip, without) || is_in_valley(hip, without);
}

bool HeldOutsideCounter::is_local_minimum(const Vec3& x, const Contact& felt) const {
  const double push = (felt.scp - x).norm(), aside = std::max(kAside * push, on_surface_);
  const Vec3 n = felt.normal, u = n.unitOrthogonal(), v = n.cross(u);
  const std::array<Vec3, kAsideCount + 1> there = {x + aside * u, x - aside * u, x + aside * v,
                                                   x - aside * v, x};
  std::array<Vec3, kAsideCount + 1> here;
  here.fill(x);
  std::array<DomainPoint, kAsideCount + 1> from;
  from.fill(felt.at);
  std::array<Contact, kAsideCount + 1> gone, back;
  track(*cache_, there, from, options_, gone);
  for (std::size_t i = 0; i < gone.size(); ++i) from[i] = gone[i].at;
  track(*cache_, here, from, options_, back);
  const Contact& own = gone.back();
  const double apart = kApart * push + on_surface_;
  if (!own.touching || (own.scp - felt.scp).norm() > apart) return false;
  for (std::size_t i = 0; i < kAsideCount; ++i) {
    const double went = (gone[i].scp - own.scp).norm(), left = (back[i].scp - own.scp).norm();
    if (!(left <= std::max({went / 2, on_surface_ / 2, kStays * push}))) return false;
  }
  return true;
}

// Between parts that overlap, a valley holds the contact as no single part does, which a search
// from its place on one of them cannot know: nothing round it is nearer.
bool HeldOutsideCounter::is_in_valley(const Vec3& x, const Contact& felt) const {
  if ((felt.flags & kOnCrease) == 0) return false;
  const double push = (felt.scp - x).norm();
  const Vec3 u = felt.normal.unitOrthogonal(), v = felt.normal.cross(u);
  for (const Vec3& way : {u, v, Vec3(u + v), Vec3(u - v)}) {
    for (const double round : {kBeside * push, -kBeside * push}) {
      const Vec3 beside = nearest(*cache_, felt.scp + round * way, options_).scp;
      if ((beside - x).norm() < push - on_surface_) return false;
    }
  }
  return true;
}

// From the contact point on: a solid is there or nowhere.
bool HeldOutsideCounter::leads_through_inside(const Vec3& hip, const Vec3& scp) const {
  const Vec3 way = hip - scp;
  const double length = way.norm();
  for (double at = 4 * on_surface_; at < length; at *= 2) {
    if (nearest(*cache_, scp + at / length * way, options_).touching) return true;
  }
  return false;
}

}  // namespace gliss
