// Counts contacts that outlive their touch: that are felt although the hand is out of the object.
#pragma once

#include <algorithm>
#include <cstdint>

#include "gliss/base/export.h"
#include "gliss/query/query.h"

namespace gliss {

// The bound: ticks that a contact may be felt outside, which take 5 x `settle` (as in QueryOptions)
// and one more. `tick`: s.
GLISS_EXPORT std::uint64_t held_bound(double settle, double tick = 1e-3);

// A contact is a row of ticks with a push. It is *held* if for longer than the bound, in a row, its
// HIP is outside and nothing justifies it.
struct HeldContacts {
  std::uint64_t contacts = 0, held = 0;
  std::uint64_t pulled = 0;  // ticks of held ones, beyond the bound, against the contact's normal
  double longest = 0;        // s, that a contact was outside and unjustified, held or not

  void merge(const HeldContacts& other) noexcept {
    contacts += other.contacts;
    held += other.held;
    pulled += other.pulled;
    longest = std::max(longest, other.longest);
  }
};

// Judges what a tracker says, tick by tick, by global and local searches of the same surface: it
// believes the tracker no more than that its contact settles or has not converged.
//
// The HIP is *outside* if the nearest point of the surface says so, a search that ended, from
// farther than rounding.
//
// Outside, a contact is *justified* if a solid holds the finger that was pressed right through it,
// as a god-object is held by a thin plate. Then it is converged, or settles towards such a
// contact; it pushes along its normal; it is a local nearest point of the HIP, or with friction
// leads to one; that nearest point is stable, for a HIP that goes a little aside and comes back has
// one within 2 % of the push from it (at the depth of a radius of curvature several lie as close),
// or it lies in a valley between parts, where nothing round it is nearer; and a solid lies between,
// for some of the way from the HIP to it leads through the inside. A ball holds no finger: opposite
// of a finger that is deeper than its radius is the farthest point, which no HIP beside it keeps.
class GLISS_EXPORT HeldOutsideCounter {
 public:
  // Contacts of trackers with these options, `tick` seconds apart. The cache must outlive it.
  HeldOutsideCounter(const PatchCache& cache, const QueryOptions& options, double tick = 1e-3);
  HeldOutsideCounter(const PatchCache&&, const QueryOptions&, double = 0) = delete;

  // Takes the next tick. `beneath`: the contact of a tracker without settle. What is felt on its
  // way to a justified contact is justified.
  void add(const Vec3& hip, const Contact& felt, const Contact& beneath);
  const HeldContacts& count() const { return count_; }

 private:
  bool is_outside(const Vec3& hip);
  bool is_justified(const Vec3& hip, const Contact& felt);
  bool is_nearest_around(const Vec3& hip, const Contact& felt) const;
  bool is_local_minimum(const Vec3& x, const Contact& felt) const;
  bool is_in_valley(const Vec3& x, const Contact& felt) const;
  bool leads_through_inside(const Vec3& hip, const Vec3& scp) const;

  const PatchCache* cache_;
  QueryOptions options_;
  double tick_;          // s
  double on_surface_;    // closer than this is on it, mesh's unit
  std::uint64_t bound_;  // ticks
  HeldContacts count_;
  bool is_felt_ = false;
  bool is_counted_ = false;    // this contact is among the held ones
  std::uint64_t outside_ = 0;  // ticks in a row, outside and unjustified
  // The HIP that was looked for last: no surface is nearer to it than `clear_`.
  Vec3 looked_ = Vec3::Zero();
  double clear_ = 0;
  bool was_outside_ = false;
  // The last judgement, of which contact, and for how many ticks it has stood.
  bool is_held_justly_ = false;
  Vec3 judged_hip_ = Vec3::Zero(), judged_scp_ = Vec3::Zero();
  int judged_for_ = 0;
};

}  // namespace gliss
