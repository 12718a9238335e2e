// Coulomb friction of one contact: a point of the surface that the HIP drags by a spring, as far as
// a cone about the force's normal part asks (docs/method.md, Friction).
#pragma once

#include "gliss/base/export.h"
#include "gliss/query/query.h"

namespace gliss {

// Returns null if the options are valid; else why not, as the end of a sentence ("has a ...").
GLISS_EXPORT const char* fault_of(const FrictionOptions& options) noexcept;

// Knows how wide the cone is, which way the surface pushes, and what the last tick used of the
// cone. Lengths: in the mesh's unit; forces over the stiffness, so that they are lengths too.
//
// The offset SCP - HIP has a part along the axis, the press, and one across, the lag: the spring of
// friction. At rest the SCP stays while |lag| <= static x press. Else it slips, and the cone
// narrows to the dynamic coefficient, at once or over `settle`; until a tick ends within it.
//
// Past an open border, where the SCP cannot follow and the HIP has left the cone, the force fades
// with a potential P, as that of a rim does (docs/meshes.md, Open borders). With u the depth
// along the edge of the cone and v the way across it, T = 2 / (1 + mu)^2 and m = 1 + 2 / T^2, it is
// P = (u^2 - m v^2) / 2 as far as m T v = u, and from there on (u - v / T)^2 / 2 times
// (T^2 + 2) / (T^2 + 1). It ends at v = T u, which is (2 + mu) depths past the border, and its push
// changes by at most m of the HIP's way. At a border mu is at most 1/2, because m grows as mu^4.
class GLISS_EXPORT Friction {
 public:
  // Requires options without a fault.
  explicit Friction(const FrictionOptions& options);

  // Goes on with other options, without a fault. A point at rest keeps its lag as far as the new
  // cone permits; without friction it has no lag.
  void change(const FrictionOptions& options) noexcept;

  bool is_on() const { return static_ > 0; }
  // A contact begins at rest, pushed along `axis` (unit). Past a border it has no grip: there it is
  // without friction until it has left that.
  void begin(const Vec3& axis, bool has_grip) noexcept;
  bool has_grip() const { return has_grip_; }

  // True if the SCP stays, for the offset that it would have.
  bool holds(const Vec3& offset, bool on_border) const;
  // Narrows the cone for a tick that slips, `dt` (s) after the last one.
  void narrow(double dt) noexcept;
  // The lag that the cone leaves of an offset's, at the same axis.
  Vec3 lag_within(const Vec3& offset, bool on_border) const;
  // ... as a factor of a lag with which the HIP's point on the surface was found: `offset` is its
  // offset, `rest` that from the place that it is nearest to. At a border only the lag along it is
  // free.
  double lag_factor(const Vec3& offset, const Vec3& rest, const Vec3& axis, bool on_border) const;
  // The share of lag_within's that the last slip took to its end: where to begin in this tick.
  double guess() const { return slips_ ? guess_ : 1; }
  void learn(double share) noexcept { guess_ = share; }
  // The tick ends with this offset. Returns the push: zero where it ends past a border.
  Vec3 feel(const Vec3& offset, const Vec3& axis, bool slips, bool on_border) noexcept;

  const Vec3& axis() const { return axis_; }
  const Vec3& lag() const { return lag_; }
  bool slips() const { return slips_; }
  // |lag| over static x press, of the last tick.
  double share() const;
  // Returns how far the lag may change in this tick, for a HIP that moves by `way`.
  double slack(double way) const { return mu_ * way + narrowed_ * press_; }

 private:
  double coefficient(bool on_border) const;
  Vec3 past_border(const Vec3& offset) const;

  double static_, dynamic_, settle_;  // settle_: s
  double mu_;                         // now
  double narrowed_ = 0;               // by how much mu_ fell in this tick
  double press_ = 0;
  double guess_ = 1;
  Vec3 axis_ = Vec3::Zero(), lag_ = Vec3::Zero();
  bool has_grip_ = false, slips_ = false;
};

}  // namespace gliss
