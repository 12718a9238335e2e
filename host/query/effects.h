// Adds to a contact what a hand feels beyond its spring: damping, viscosity, a magnet, a texture
// (docs/method.md, Effects).
#pragma once

#include <array>
#include <optional>

#include "gliss/base/export.h"
#include "gliss/query/contact_tracker.h"
#include "gliss/query/texture.h"

namespace gliss {

// A pull to the surface from outside, up to `force` (N), within `range` (m).
struct GLISS_EXPORT MagnetOptions {
  double force = 0, range = 0;

  bool any() const { return force > 0; }
  // N/m: the force changes by at most so much a way.
  double stiffness() const;
};

// All off by default. Velocities are those of the HIP in the object's frame, m/s.
struct EffectOptions {
  // Above these the delay of a measured velocity, 4 ms, makes a hand that holds 0.1 kg tremble.
  static constexpr double kMostDamping = 20, kMostViscosity = 20;

  double damping = 0;    // s/m: by how much the normal force grows with the velocity inwards
  double viscosity = 0;  // N s/m, inside
  MagnetOptions magnet = {};
  TextureOptions texture = {};

  bool any() const { return damping > 0 || viscosity > 0 || magnet.any() || texture.any(); }
};

// Returns null if the options are valid; else why not, as the end of a sentence ("has a ...").
GLISS_EXPORT const char* fault_of(const EffectOptions& options) noexcept;

// The effects of one contact. It allocates nothing and takes no lock; one thread at a time.
//
// With x the HIP, p(x) its nearest point, D its depth, F = k D n the spring's force:
// - Texture: h(p) <= 0 is a change of depth. The energy k (D + h)^2 / 2, none where D + h < 0, has
//   the force k (D + h) (n - (dp/dx)^T grad h), so that closed paths do no work. It is added to the
//   force of friction, which is passive itself. A contact that a leap moves (kSettling) has a
//   point that stays: dp/dx = 0.
// - Damping (Hunt and Crossley 1975): the normal part of the force times 1 + damping x v, v the
//   velocity inwards, but 0 at least and 2 at most. It is zero on touching and never pulls.
// - Viscosity: -viscosity x velocity, from nothing at the surface to all of it kSkin below.
// - Magnet: outside, -dU/dd along the way to the nearest point, d the distance, with force x
//   16 u^2 (1 - u)^2, u = d / range: nothing on touching and where its range ends.
class GLISS_EXPORT Effects {
 public:
  static constexpr double kSkin = 1e-4;  // m
  // s, over which a velocity is measured, and the places that are kept for it at most. What comes
  // faster than so many in a window replaces the last one.
  static constexpr double kWindow = 8e-3;
  static constexpr std::size_t kPlaces = 64;
  static constexpr double kFastest = 100;  // m/s, of a device: what is faster is a fault

  // `unit`: of the mesh, m; `stiffness`: N/m. Requires options without a fault.
  Effects(const EffectOptions& options, double stiffness, double unit);

  void set_stiffness(double stiffness) noexcept { stiffness_ = stiffness; }
  // Requires a texture without a fault.
  void set_texture(const TextureOptions& texture) noexcept {
    options_.texture = texture;
    texture_ = Texture(texture);
  }
  // A tick begins with the HIP at `hip` (mesh's unit), `dt` (s) after the last one, as tick_time()
  // takes it; each tick once. `own`: the velocity that the device tells, m/s in the object's frame;
  // zero: it tells none. One above kFastest counts as the last one.
  void see(const Vec3& hip, double dt = ContactTracker::kTick,
           const Vec3& own = Vec3::Zero()) noexcept;
  // The distance outside (mesh's unit) within which a contact has to be looked for.
  double reach() const { return options_.magnet.any() ? options_.magnet.range / unit_ : 0; }
  // The force on the hand, N in the object's frame, for the contact that `tracker` gave of the HIP.
  Vec3 force(const Contact& contact, const ContactTracker& tracker) const noexcept;

  // m/s, object's frame: the way over the last kWindow, or since the last tick where that is longer
  // ago; so it is 4 ms old, or half a tick. But of the device's own velocity v it is v now, and
  // only what the way differs from v by, such as the motion of the object, is as old.
  Vec3 velocity() const noexcept;

 private:
  Vec3 pull(const Contact& contact) const;
  Vec3 textured(const Contact& contact, const ContactTracker& tracker) const;

  EffectOptions options_;
  Texture texture_;
  double stiffness_, unit_;
  // A place of the HIP, less the way that the device's own velocity has led it. Mesh's unit, s.
  struct Place {
    Vec3 at = Vec3::Zero();
    double time = 0;
  };
  const Place& place(std::size_t back) const { return seen_[(last_ + kPlaces - back) % kPlaces]; }

  std::array<Place, kPlaces> seen_;       // the last ones, in turns
  std::size_t count_ = 0, last_ = 0;      // of them
  double time_ = 0;                       // s, of the last tick
  Vec3 hip_ = Vec3::Zero();               // at the last tick
  Vec3 own_ = Vec3::Zero(), led_ = own_;  // mesh's unit: a second, and where it has led
};

// The force on the hand, N in the object's frame, of a contact that `tracker` gave: with its
// effects, or its spring's alone where it has no effects.
inline Vec3 force_of(const std::optional<Effects>& effects, const Contact& contact,
                     const ContactTracker& tracker, const PatchCache& cache, double stiffness) {
  // A sum, as of the objects of a scene: it has no -0.
  return Vec3::Zero() +
         (effects ? effects->force(contact, tracker) : contact_force(cache, contact, stiffness));
}

}  // namespace gliss
