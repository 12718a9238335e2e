// The push that a hand feels where its contact point leaps: it goes to its new value over some
// ticks, and holds no energy that the hand has not put in.
#pragma once

#include "gliss/base/export.h"
#include "gliss/query/query.h"

namespace gliss {

// Knows what was felt at the last tick, and what may be felt now. Lengths: in the mesh's unit.
//
// A tick *leaps* if the push changes by more than the HIP's way and the larger of that and a
// stride. A stride is a share of the lesser push of the two ticks, 20 % of a tick over `settle`.
// But it is at most eight times the HIP's way, or a 32nd of that share: however deep it is, a slow
// hand feels no more than nine times its own way. Then the push that is felt changes by the way and
// a stride. Where friction lets go of a contact point, what its force changes by is no leap. The
// push of a contact that has ended fades by the whole share of what it was, so that it is gone five
// times `settle` later however the hand moves.
//
// The energy of a contact, over its stiffness, is push . (SCP - HIP) / 2. That is |push|^2 / 2, and
// the potential of the rim that rounds off an open border. It grows by the work of the hand alone,
// but for the error of a force that is held for a tick: a passivity observer counts it (Hannaford
// and Ryu 2002). Where a contact asks for more, its push is as long as the hand has paid for. Force
// shading has no such energy; its pushes just do not leap.
class GLISS_EXPORT Settling {
 public:
  // `settle`: s, as QueryOptions has it; `tiny`: a length that is rounding.
  Settling(double settle, double tiny);

  bool is_on() const { return settle_ > 0; }
  // Begins with a contact, felt in full, or free.
  void begin(const Vec3& hip, const Contact& contact) noexcept;
  void begin_free(const Vec3& hip) noexcept;
  // A tick begins, `dt` (s) after the last one, with the HIP at `hip`; no surface is nearer than
  // `clear` to where it was.
  void move(const Vec3& hip, double clear, double dt) noexcept;
  // Lets the push change by so much more in this tick without a leap: friction asks for it.
  void allow(double change) noexcept { allowed_ = change; }
  // Ends the tick: changes `now` to the push that is felt, and sets kSettling if that differs from
  // the contact's own.
  void feel(Contact& now, bool has_energy) noexcept;

  double way() const { return way_.norm(); }  // of the HIP in this tick
  bool is_felt() const { return !felt_.isZero(0); }

 private:
  // True if the push would leap from what is felt.
  bool is_leap(const Vec3& to) const;
  double share(double size) const;
  double stride(double size) const;
  // The stride of the smaller of what is felt and another push; of their mean if one is zero.
  double stride_to(const Vec3& to) const;
  double energy_of(const Contact& contact) const;
  double paid(const Contact& now) const;
  void turn(Contact& now, double most) const;
  void fade(Contact& now);

  double settle_, tiny_;
  Vec3 hip_ = Vec3::Zero(), way_ = Vec3::Zero(), felt_ = Vec3::Zero();
  double dt_ = 0;          // s, of this tick
  double pace_ = 0;        // how far the HIP has come near a surface in this tick
  double allowed_ = 0;     // change of the push that is friction's
  double energy_ = 0;      // that the hand has put in and not got back; negative: a debt
  double fading_ = 0;      // push when its contact ended, from which it fades; 0: it does not
  bool is_short_ = false;  // the last contact asked for more energy than there is
};

}  // namespace gliss
