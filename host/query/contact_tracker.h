// Algorithm 1 for one HIP: a search while free, local tracking in contact.
#pragma once

#include <variant>

#include "gliss/base/export.h"
#include "gliss/query/friction.h"
#include "gliss/query/query.h"
#include "gliss/query/settling.h"

namespace gliss {

// A contact without friction, and how it moves with its HIP; lengths in the mesh's unit.
struct ContactFoot {
  Vec3 point = Vec3::Zero(), push = Vec3::Zero();  // as Contact's scp and push
  double depth = 0;  // k depth^2 / 2 is the energy of the spring; of force shading |push|
  Eigen::Matrix3d moves = Eigen::Matrix3d::Zero();  // d point / d HIP
};

// Follows the contact of one HIP with one cache by one method, tick by tick. It keeps a reference
// to the cache, which must outlive it; one thread at a time may use it.
//
// - A free HIP comes into contact where its way from the last tick enters the surface, at any speed
//   and however thin the part, and the contact stays on that side.
// - A contact is a nearest point that the last one leads to. It ends where the HIP lies on the
//   outer side of it. If the HIP is inside of something there nonetheless, its contact is the
//   nearest point of all. So a hand that has pressed through a part is held for as long as that
//   lies between the hand and its contact point, as a god-object holds it, and then it is free.
//   Past an open border a contact fades: the rim is rounded off (docs/meshes.md, Open borders), so
//   that it ends without force.
// - An open mesh is the skin of a solid that lies behind it. It acts on what comes from outside; a
//   HIP that went round the rim is behind it and feels nothing until it has come out and in again.
// - Where the place that it follows ends, as over an edge or in a thin part, the nearest point
//   leaps elsewhere, and the force with it. With `settle` the push that is felt turns there over
//   some ticks. If the contact has ended, the push keeps its direction, grows no more, and is gone
//   within 5 x settle, wherever the hand goes. How fast, and that no energy comes of it, Settling
//   says. Such contacts have kSettling, and a push that is not SCP - HIP. What is felt changes
//   nothing of the contact beneath, which is that without `settle`; elsewhere ticks have its bytes.
// - With friction the contact point is a point of the surface that stays, bit for bit, while the
//   HIP keeps within a cone below it, and else slips as far as the cone asks: kSlipping. With q the
//   point and x the HIP, k |q - x|^2 / 2 falls wherever q moves, so that friction makes no energy.
//   A contact ends where a slider ends it that is as far before the HIP as the force is tangential,
//   and no later than one without friction.
//   Force shading drags the god-object of the flat polygons, and turns the normal part of the
//   force.
class GLISS_EXPORT ContactTracker {
 public:
  // Evaluations of patches that a tick spends at most, with the default iterations of a solver; and
  // searches. What they do not suffice for, after a leap, the next ticks do: until then there is no
  // contact.
  static constexpr int kTickEvaluations = 1000, kTickSearches = 128;
  // s, from one tick to the next where nobody tells.
  static constexpr double kTick = 1e-3;

  // Throws std::invalid_argument for a cache without patches, and for a `settle` or friction that
  // is invalid.
  ContactTracker(const PatchCache& cache, const QueryOptions& options);
  ContactTracker(const PatchCache&&, const QueryOptions&) = delete;  // it would die at once
  // The contact after the HIP has moved to `hip` (mesh's unit), `dt` (s) after the last tick; one
  // that is not finite and above 0 counts as kTick. At the first tick it means nothing. A HIP that
  // is not finite has no contact, and changes nothing. Where the surface is at fault, the contact
  // is not touching and its push is NaN; the next tick searches anew.
  Contact tick(const Vec3& hip, double dt = kTick) noexcept;
  // Follows the local nearest point from a given contact, whatever the state. With `felt`, that of
  // another tracker before this tick, it settles from there, `dt` (s) after the last tick; with
  // `friction`, that of the other one after it, the contact point lags behind as far.
  Contact track(const Vec3& hip, const DomainPoint& start, const Settling* felt = nullptr,
                const Friction* friction = nullptr, double dt = kTick) noexcept;
  // The contact that the last tick gave, as it is without friction. By central differences: of six
  // HIPs, 1e-5 of the patch away, each with its nearest point. A foot moves at most kMostMoves
  // times as far as the HIP: more, where that is nearly as deep as the radius of curvature, is cut.
  // One that a leap moves, or that is held, stays: it moves by nothing.
  ContactFoot foot(const Vec3& hip, const Contact& contact) const noexcept;
  static constexpr double kMostMoves = 4;
  const Settling& felt() const { return felt_; }
  const Friction& friction() const { return friction_; }
  // Changes the friction, also during contact. Returns false, and changes nothing, if it is
  // invalid.
  bool set_friction(const FrictionOptions& friction) noexcept;
  // The tangential part of the last tick's push over what friction at rest permits; 0 without.
  double cone_share() const { return touching() && friction_.has_grip() ? friction_.share() : 0; }
  // True if the last tick's contact was touching.
  bool touching() const { return follows() || felt_.is_felt(); }
  // Makes the HIP free; no surface is nearer to it than `clear`.
  void release(const Vec3& hip, double clear) noexcept;
  // Goes on with another cache of the same mesh and precision; in contact, one that has the patch
  // that is touched.
  void move_to(const PatchCache& cache) noexcept;
  void move_to(const PatchCache&&) = delete;
  // True if the HIP is free, and nearer to where it was last looked for than any surface, by
  // `reach`: a tick there finds no contact and changes nothing, so that it may as well be left out.
  bool is_clear(const Vec3& hip, double reach = 0) const {
    return !touching() && (hip - past_.hip).norm() + reach < past_.clear;
  }

 private:
  template <class Real>
  class Tick;
  template <class Real>
  ContactFoot foot_on(const Surface<Real>& surface, const Vec3& hip) const;

  // The state that the last tick leaves besides its contact, mesh's unit.
  struct Past {
    Vec3 hip = Vec3::Zero();  // its HIP, or how far along its way a sweep has come
    double clear = -1;        // no surface is nearer to it than this; negative: there was no tick
    bool behind = false;      // it is free and behind an open surface
    double held_push = 0;     // push when the SCP came to be held; 0: it is not
  };

  bool follows() const;  // true if the HIP is not free

  const PatchCache* cache_;
  QueryOptions options_;
  std::variant<RawContact<float>, RawContact<double>> state_;  // without what settles
  Past past_;
  Settling felt_;      // with settle only
  Friction friction_;  // of a contact, where it is on
};

}  // namespace gliss
