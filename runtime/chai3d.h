// A Gliss surface as an object of a CHAI3D scene (docs/chai3d.md). For programs that use CHAI3D:
// its own chai3d.h is included from here. Names are CHAI3D's way where they add to a class of it.
#pragma once

#include <chai3d.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <memory>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "gliss/compare/tessellate.h"
#include "gliss/contact/tracker.h"
#include "gliss/thread/clock.h"

namespace gliss {

// Who makes the force of a cGlissObject.
enum class ForceBy {
  kGliss,   // Gliss: spring, friction, effects; those of CHAI3D are added, but for its spring
  kChai3d,  // CHAI3D's effects, as createEffectSurface makes them, at the point that Gliss finds
};

// A surface that CHAI3D's tools touch, added to a world as any other object is. Stiffness (N for a
// unit of the world's length) and friction are m_material's, read each tick; CHAI3D moves it
// (setLocalPos, setLocalRot), enables it and scales it. A contact is of the object's material and
// goes along with it.
//
// Every interaction point of a tool has a tracker, made by the constructor: a tick allocates
// nothing, takes no lock, and its work is bounded. One haptic thread may ask at a time. Ticks may
// come at any rate: the time between them is taken from a clock.
//
// What a tick cannot do is told by fault(), and once on the standard error: by the next call that
// is no tick, such as the drawing of the next frame. Where a position is not finite or the surface
// is at fault, the point's last force is held for kHold and then falls to zero until kZero. Where
// there is a force again, it comes back in kReturn, from the share that was left.
class cGlissObject : public chai3d::cGenericObject {
 public:
  // Interaction points of all tools together that touch it, unless the constructor is told another
  // number.
  static constexpr std::size_t kPoints = 16;
  // As Guard's limits.
  static constexpr Nanoseconds kHold = std::chrono::milliseconds(2),
                               kZero = std::chrono::milliseconds(10),
                               kReturn = std::chrono::milliseconds(500);

  // `metres`: the length of one unit of CHAI3D's world. Takes the stiffness and friction of
  // `surface` for its material, unless that gets others. Throws std::invalid_argument for what
  // Tracker refuses, for poses (CHAI3D has its own), a length or number that is not above 0, and
  // effects without ForceBy::kGliss.
  explicit cGlissObject(SceneObject surface, double metres = 1, std::size_t points = kPoints,
                        ForceBy force = ForceBy::kGliss)
      : surface_(std::move(surface)), metres_(metres), points_(points), force_by_(force) {
    if (!(metres > 0 && std::isfinite(metres)))
      throw std::invalid_argument("cGlissObject: metres of a unit of the world are above 0");
    if (points == 0) throw std::invalid_argument("cGlissObject: points are 1 or more");
    if (surface_.motion != nullptr || surface_.poses != nullptr ||
        !surface_.pose.matrix().isIdentity(0))
      throw std::invalid_argument(
          "cGlissObject: has a pose or motion; CHAI3D moves it, by setLocalPos and setLocalRot");
    setEffects(surface_.effects);
    m_material->setStiffness(surface_.stiffness * metres);
    m_material->setStaticFriction(surface_.friction.at_rest);
    m_material->setDynamicFriction(surface_.friction.slipping);
  }

  ~cGlissObject() override { say_faults(); }

  std::string getClassName() override { return "GlissObject"; }

  // Effects of Gliss; contacts begin anew. Not while a haptic thread asks. Throws as the
  // constructor does, and then nothing has changed.
  void setEffects(const EffectOptions& effects) {
    if (effects.any() && force_by_ == ForceBy::kChai3d)
      throw std::invalid_argument("cGlissObject: its forces are CHAI3D's, without Gliss's effects");
    say_faults();
    SceneObject surface = surface_;
    surface.effects = effects;
    std::vector<Point> made;
    made.reserve(points_);
    for (std::size_t i = 0; i < points_; ++i) {
      made.push_back({i < used_ ? points_made_[i].id : 0, Tracker(std::span(&surface, 1))});
    }
    points_made_ = std::move(made);
    surface_ = std::move(surface);
  }

  // Frees the trackers of interaction points that are no more, and all others, whose contacts begin
  // anew. Not while a haptic thread asks.
  void forgetPoints() {
    setEffects(surface_.effects);
    used_ = 0;
  }

  // Draws the surface by a child, which this object owns and which no tool feels: each part of a
  // face as cells x cells quads, in this object's material. `mesh`: the one that the surface was
  // built from. A second call replaces it. Throws std::invalid_argument for a lazy surface. Needs
  // gliss::study.
  chai3d::cMesh* createDrawing(const Mesh& mesh, std::uint32_t cells = 8) {
    if (surface_.cache == nullptr)
      throw std::invalid_argument("cGlissObject: a lazy surface has no drawing; it needs a cache");
    const Mesh dense = tessellate(mesh, *surface_.cache, cells);
    auto drawing = std::make_unique<chai3d::cMesh>();
    for (std::size_t i = 0; i < dense.positions.size(); ++i)
      drawing->newVertex(local(dense.unit * dense.positions[i]), vector(dense.normals[i]));
    for (std::size_t i = 0; i < dense.corner_vertex.size(); i += 3)
      drawing->newTriangle(dense.corner_vertex[i], dense.corner_vertex[i + 1],
                           dense.corner_vertex[i + 2]);
    drawing->setMaterial(m_material);
    drawing->setHapticEnabled(false);
    if (drawing_ != nullptr) deleteChild(drawing_);
    drawing_ = drawing.release();
    addChild(drawing_);
    return drawing_;
  }

  // Says in words what a tick could last not do; null: nothing. Any thread may ask.
  const char* fault() const { return fault_; }

 protected:
  // When a tick comes, since any start. A program with a clock of its own may give that.
  virtual Nanoseconds now() { return monotonic_time(); }

  // CHAI3D calls this, then its effects, then computeOtherInteractions, each tick of a point.
  void computeLocalInteraction(const chai3d::cVector3d& position, const chai3d::cVector3d& velocity,
                               const unsigned int id) override {
    m_interactionInside = false;
    m_interactionPoint = position;  // no effect of CHAI3D pulls there
    found_ = {};
    Point* point = point_of(id);
    if (point == nullptr) return tell(kTooManyPoints);
    Tracker& tracker = point->tracker;
    if (!follow_material(tracker)) tell(kNoMaterial);
    const Vec3 hip = metres_ * vector(position);
    const Nanoseconds time = now();
    const Vec3 rendered = tracker.step(hip, time, metres_ * vector(velocity)),
               force = point->bridge(rendered, time);
    if (!is_finite(rendered)) {
      found_ = vector(force);
      return tell(is_finite(hip) ? kNoSurface : kNoPosition);
    }

    const double unit = tracker.unit(0);
    ObjectStep step = tracker.objects()[0];
    const bool effects_want_it = !m_effects.empty() && surface_.cache != nullptr;
    if (!step.searched && effects_want_it) {  // too far to touch
      QueryOptions query;
      query.method = surface_.method;
      query.budget = ContactTracker::kTickEvaluations;
      step.contact = nearest(*surface_.cache, hip / unit, query);
    }
    m_interactionInside = step.searched && step.contact.touching;
    m_interactionPoint = local(unit * step.contact.scp);
    m_interactionNormal = vector(step.contact.normal);
    if (force_by_ == ForceBy::kGliss) {
      found_ = vector(force);
    } else if (step.searched && !step.contact.push.isZero(0)) {  // where its spring pulls to
      m_interactionInside = true;
      m_interactionPoint = local(hip + point->share * unit * step.contact.push);
    }
  }

  chai3d::cVector3d computeOtherInteractions(const chai3d::cVector3d& position,
                                             const chai3d::cVector3d&, const unsigned int,
                                             chai3d::cInteractionRecorder& recorder) override {
    for (chai3d::cGenericEffect* effect : m_effects) {
      if (force_by_ != ForceBy::kGliss || !effect->getEnabled()) continue;
      if (dynamic_cast<chai3d::cEffectSurface*>(effect) == nullptr) continue;
      tell(kTwoSprings);
      return {};
    }
    if (found_.lengthsq() > 0 || (force_by_ == ForceBy::kGliss && m_interactionInside)) {
      chai3d::cInteractionEvent event;
      event.m_object = this;
      event.m_isInside = m_interactionInside;
      event.m_localPos = position;
      event.m_localNormal = m_interactionNormal;
      event.m_localForce = found_;
      event.m_localSurfacePos = m_interactionPoint;
      recorder.m_interactions.push_back(event);
    }
    return found_;
  }

  // The box of the polygons' corners.
  void updateBoundaryBox() override {
    const PatchCache& cache = surface_.cache != nullptr ? *surface_.cache : surface_.lazy->base();
    const Box box = cache.bounds();
    m_boundaryBoxMin = local(cache.unit * box.low);
    m_boundaryBoxMax = local(cache.unit * box.high);
    m_boundaryBoxEmpty = false;
  }

  // CHAI3D calls this for each frame, in the thread that draws.
  void render(chai3d::cRenderOptions& options) override {
    say_faults();
    cGenericObject::render(options);
  }

  void scaleObject(const double& factor) override {
    const double metres = metres_ / factor;
    if (!(metres >= 1e-9 && metres <= 1e9)) return tell(kNoScale);
    metres_ = metres;
    updateBoundaryBox();
  }

 private:
  enum Fault { kTooManyPoints, kNoMaterial, kNoSurface, kNoPosition, kTwoSprings, kNoScale };
  static constexpr const char* kTold[] = {
      "more interaction points than it was made for: no force on those that came last",
      ("its material has a stiffness that is not from 0 to 1e6 N/m, or a friction above 5: it "
       "keeps the one before"),
      "the surface is at fault: the force is held and taken away",
      "a position is not finite: the force is held and taken away",
      "createEffectSurface adds a second spring: no force of Gliss until deleteEffectSurface",
      "a scale that leaves a unit of the world no length from 1e-9 to 1e9 m: it keeps the one "
      "before"};

  // No operation of it is one that a host may have made fatal (feenableexcept).
  static bool is_finite(const Vec3& v) {
    return std::isfinite(v.x()) && std::isfinite(v.y()) && std::isfinite(v.z());
  }

  // An interaction point, with what was felt there.
  struct Point {
    unsigned int id;  // its own from the first tick on
    Tracker tracker;
    Vec3 held = Vec3::Zero();    // N, the last finite force
    double share = 1;            // of the force, that goes out
    Nanoseconds felt{}, last{};  // ticks: the last with a finite force, and the last

    // The force that goes out for one of the tracker's, in a tick at `time`.
    Vec3 bridge(const Vec3& force, Nanoseconds time) {
      const double gap = share_of(time - felt, kHold, kZero);
      if (!is_finite(force)) {
        last = time;
        return (1 - gap) * held;
      }
      share = std::min(1.0, share * (1 - share_of(last - felt, kHold, kZero)) +
                                share_of(time - last, Nanoseconds(0), kReturn));
      felt = last = time;
      held = share * force;
      return held;
    }
    // How far a time is from one to another, 0 to 1.
    static double share_of(Nanoseconds time, Nanoseconds from, Nanoseconds to) {
      return std::clamp(in_seconds(time - from) / in_seconds(to - from), 0.0, 1.0);
    }
  };

  static chai3d::cVector3d vector(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
  static Vec3 vector(const chai3d::cVector3d& v) { return {v(0), v(1), v(2)}; }
  chai3d::cVector3d local(const Vec3& metres) const { return vector(metres / metres_); }

  // Null: all are taken.
  Point* point_of(unsigned int id) {
    for (std::size_t i = 0; i < used_; ++i) {
      if (points_made_[i].id == id) return &points_made_[i];
    }
    if (used_ == points_) return nullptr;
    points_made_[used_].id = id;
    return &points_made_[used_++];
  }

  // False for a material that is invalid. While it changes, the friction of slipping may be the
  // larger.
  bool follow_material(Tracker& tracker) const {
    const double at_rest = m_material->getStaticFriction();
    const double slipping = std::min(at_rest, m_material->getDynamicFriction());
    return tracker.set_material(0, m_material->getStiffness() / metres_,
                                {at_rest, slipping, surface_.friction.settle});
  }

  void tell(Fault fault) {
    fault_ = kTold[fault];
    faults_ |= 1u << fault;
  }
  // Prints what was not printed yet.
  void say_faults() {
    const unsigned int all = faults_, said = said_.exchange(all);
    for (std::size_t i = 0; i < std::size(kTold); ++i) {
      if ((all & ~said) >> i & 1)
        std::fprintf(stderr, "cGlissObject %s: %s\n", m_name.c_str(), kTold[i]);
    }
  }

  SceneObject surface_;
  double metres_;
  std::size_t points_;
  ForceBy force_by_;
  std::vector<Point> points_made_;
  std::size_t used_ = 0;     // of them, in the order of their first ticks
  chai3d::cVector3d found_;  // this tick's force, this object's frame
  chai3d::cMesh* drawing_ = nullptr;
  std::atomic<const char*> fault_ = nullptr;
  std::atomic<unsigned int> faults_ = 0, said_ = 0;  // bits of Fault
};

}  // namespace gliss
