// A device's HIPs among the objects of a scene: what a device loop calls each tick. The same
// contacts as ContactTracker's (gliss/query/contact_tracker.h), in metres and the world's frame; a
// step allocates nothing, takes no lock, and its work is bounded.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/base/wrench.h"
#include "gliss/contact/lazy_contact.h"
#include "gliss/contact/motion.h"
#include "gliss/contact/pose.h"
#include "gliss/query/contact_tracker.h"
#include "gliss/query/effects.h"
#include "gliss/thread/clock.h"

namespace gliss {

// An object that a hand can touch. It needs a cache or `lazy`.
struct SceneObject {
  std::shared_ptr<const PatchCache> cache;  // null: its patches are built near the HIP, of `lazy`
  double stiffness = 500;                   // N/m, 0 or more
  Method method = Method::kGregory;
  Solver solver = Solver::kNewton;
  Pose pose = Pose::Identity();
  // It moves from there, as one of these says; null: it rests.
  std::shared_ptr<const Motion> motion = nullptr;      // by the time of a step, then `pose`
  std::shared_ptr<const PoseChannel> poses = nullptr;  // in place of `pose`, once there is one
  // The mesh of an object without a cache, for kGregory alone. Each HIP has a thread that builds
  // for it.
  std::shared_ptr<const LazyMesh> lazy = nullptr;
  LazyWorkerOptions worker = {};
  int max_iterations = 64;  // these two as SolverOptions has them
  double tolerance = 0;
  double settle = QueryOptions{}.settle;  // s
  FrictionOptions friction = {};
  EffectOptions effects = {};  // a magnet needs a cache

  // The mesh's unit in m. Requires a cache or `lazy`.
  double unit() const { return cache != nullptr ? cache->unit : lazy->base().unit; }
};

// One object in a step.
struct ObjectStep {
  bool searched = false;      // false: too far to touch, nothing was computed, `contact` is older
  Contact contact;            // in the object's frame and its mesh's unit
  Vec3 force = Vec3::Zero();  // N, world
};

// Objects move with their contacts: a contact is of the object's material and goes along, a hand
// that rests on it is dragged by friction, and velocities are those against the object. The force
// of a smooth surface changes in a tick by at most the stiffness times the ways of hand and object.
// One that comes to the hand is met however fast it is.
//
// One thread's at a time. It keeps copies of the objects, and with them their caches. A second hand
// is a second Tracker; caches are shared.
class GLISS_EXPORT Tracker {
 public:
  // HIPs times objects.
  static constexpr std::size_t kMostContacts = 10'000;
  static constexpr double kMostStiffness = 1e6;  // N/m: ten times what the stiffest device renders
  // No contact is searched or followed in a step after as many evaluations of patches, so that a
  // step spends at most these and ContactTracker::kTickEvaluations. Others are the first of the
  // next step; until then a HIP touches the plane of its last contact, or nothing if it had none.
  static constexpr int kStepEvaluations = 4000;

  // `hips`: where the tool's HIPs are from the device's position (m, the tool's frame, which is the
  // world's where the device does not turn); none: one, there.
  // Throws std::invalid_argument, one line with the object's index, for an object without a surface
  // (neither cache nor `lazy`, or a cache without patches) and for a lazy one with another method
  // than kGregory, poses that are not rigid, a stiffness, also a magnet's, that is not from 0 to
  // kMostStiffness, a `settle`, friction or effects that are invalid; for HIPs that are not finite,
  // and for more contacts than kMostContacts.
  explicit Tracker(std::span<const SceneObject> objects, std::span<const Vec3> hips = {});

  // The force on the hand at a position (m, world), in N: the sum over HIPs and objects. What is
  // farther than the HIP has moved since its last search costs a comparison. NaN, for the guard to
  // see, where a surface is at fault, and where the position is not finite: that is no step but for
  // the time, and contacts go on from where they are.
  // `time`: of the step, since any start. A step without a time is ContactTracker::kTick after the
  // last one; the first one is at 0. So long is also a step whose time has not gone on.
  // `velocity`: the device's own (m/s, world), for effects; zero: it tells none.
  Vec3 step(const Vec3& position, std::optional<Nanoseconds> time = {},
            const Vec3& velocity = Vec3::Zero()) noexcept;
  // The same for a tool that turns: `tool` leads from its frame to the world's. The torque is about
  // the device's position.
  Wrench step(const Pose& tool, std::optional<Nanoseconds> time = {},
              const Vec3& velocity = Vec3::Zero()) noexcept;
  // Puts an object of the constructor's list to where the next step finds it. False for a pose that
  // is not rigid: the object stays.
  bool move(std::size_t object, const Pose& pose) noexcept;
  // Gives an object another stiffness (N/m) and friction, in contact too: the next step's force is
  // of these. False for numbers that the constructor refuses: the object stays as it is.
  bool set_material(std::size_t object, double stiffness, const FrictionOptions& friction) noexcept;
  // Gives an object another method and `settle` (s), in contact too: the next step seeks its
  // contact anew, as a first step does, and the force may change at once. False for a `settle` that
  // the constructor refuses, and for an object without a cache: it stays as it is.
  bool set_contact(std::size_t object, Method method, double settle) noexcept;
  // Gives an object another texture, in contact too, but a grating runs along as it did.
  // False for one that the constructor refuses: the object stays as it is.
  bool set_texture(std::size_t object, const TextureOptions& texture) noexcept;
  // True if an object's contacts are sought by that method and settle so.
  bool is_by(std::size_t object, Method method, double settle) const noexcept {
    const SceneObject& now = places_[object].object;
    return now.method == method && now.settle == settle;
  }
  // The last step of the first HIP's objects, then of the next one's. Valid as long as
  // the tracker.
  std::span<const ObjectStep> objects() const { return steps_; }
  double unit(std::size_t i) const { return tracked_[i].unit; }  // m, of objects()[i]
  bool touching() const;

 private:
  struct Place {
    SceneObject object;
    Pose now, to_object;  // of points in m
  };
  struct Tracked {
    std::size_t place = 0;
    Vec3 hip = Vec3::Zero();  // in the tool's frame, m
    double unit = 1;          // m, of the object's mesh
    // One of them.
    std::optional<ContactTracker> whole;
    std::unique_ptr<LazyContact> lazy;
    std::optional<Effects> effects;
    double waiting = 0;      // s, since its last tick
    Vec3 at = Vec3::Zero();  // in the last step, in the object's frame and its mesh's unit

    // True if nothing is so near that it is felt.
    bool is_clear(const Vec3& at) const {
      return whole ? whole->is_clear(at, effects ? effects->reach() : 0) : lazy->is_clear(at);
    }
    const ContactTracker& tracker() const { return whole ? *whole : lazy->tracker(); }
    Contact tick(const Vec3& at, double dt) noexcept {
      return whole ? whole->tick(at, dt) : lazy->tick(at, dt);
    }
    void set_friction(const FrictionOptions& friction) noexcept {
      if (whole) whole->set_friction(friction);
      if (lazy) lazy->set_friction(friction);
    }
    bool touching() const { return whole ? whole->touching() : lazy->touching(); }
  };
  void follow_motions() noexcept;
  void feel(const Pose& tool, double dt, const Vec3& velocity, std::size_t i, int& left,
            Wrench& sum) noexcept;

  std::vector<Place> places_;  // [object]
  std::vector<Tracked> tracked_;
  std::vector<ObjectStep> steps_;           // [tracked_]
  std::size_t first_ = 0;                   // of tracked_, in the next step
  std::optional<Nanoseconds> time_, felt_;  // of the last step, and of the last with a position
};

}  // namespace gliss
