// A Gliss surface as an object of a CHAI3D scene (docs/chai3d.md). For programs that use CHAI3D:
// its own chai3d.h is included from here. Names are CHAI3D's way where they add to a class of it.
#pragma once

#include <chai3d.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <memory>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "gliss/contact/tracker.h"
#include "gliss/study/tessellate.h"

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
// nothing, takes no lock, and its work is bounded. One haptic thread may ask at a time. What a tick
// cannot do is told once on the standard error, and by fault().
class cGlissObject : public chai3d::cGenericObject {
 public:
  // Interaction points of all tools together that touch it, unless the constructor is told another
  // number.
  static constexpr std::size_t kPoints = 16;

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
    ids_.reserve(points);
    m_material->setStiffness(surface_.stiffness * metres);
    m_material->setStaticFriction(surface_.friction.at_rest);
    m_material->setDynamicFriction(surface_.friction.slipping);
  }

  std::string getClassName() override { return "GlissObject"; }

  // Effects of Gliss; contacts begin anew. Not while a haptic thread asks. Throws as the
  // constructor does, and then nothing has changed.
  void setEffects(const EffectOptions& effects) {
    if (effects.any() && force_by_ == ForceBy::kChai3d)
      throw std::invalid_argument("cGlissObject: its forces are CHAI3D's, without Gliss's effects");
    SceneObject surface = surface_;
    surface.effects = effects;
    std::vector<Tracker> trackers;
    trackers.reserve(points_);
    while (trackers.size() < points_) trackers.emplace_back(std::span(&surface, 1));
    trackers_ = std::move(trackers);
    surface_ = std::move(surface);
  }

  // Frees the trackers of interaction points that are no more, and all others, whose contacts begin
  // anew. Not while a haptic thread asks.
  void forgetPoints() {
    setEffects(surface_.effects);
    ids_.clear();
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
  // CHAI3D calls this, then its effects, then computeOtherInteractions, each tick of a point.
  void computeLocalInteraction(const chai3d::cVector3d& position, const chai3d::cVector3d&,
                               const unsigned int id) override {
    m_interactionInside = false;
    m_interactionPoint = position;  // no effect of CHAI3D pulls there
    found_ = {};
    Tracker* tracker = tracker_of(id);
    if (tracker == nullptr) return tell(kTooManyPoints);
    if (!follow_material(*tracker)) tell(kNoMaterial);
    const Vec3 hip = metres_ * Vec3(position(0), position(1), position(2));
    const Vec3 force = tracker->step(hip);
    if (!force.allFinite()) return tell(kNoSurface);

    const double unit = tracker->unit(0);
    ObjectStep step = tracker->objects()[0];
    const bool effects_want_it = !m_effects.empty() && surface_.cache != nullptr;
    if (!step.searched && effects_want_it && hip.allFinite()) {  // too far to touch
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
      m_interactionPoint = local(hip + unit * step.contact.push);
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

  void scaleObject(const double& factor) override {
    metres_ /= factor;
    updateBoundaryBox();
  }

 private:
  static constexpr char
      kTooManyPoints[] =
          "more interaction points than it was made for: no force on those that came last",
      kNoMaterial[] =
          "its material has no finite stiffness or a friction above 5: it keeps the one before",
      kNoSurface[] = "the surface is at fault: no force",
      kTwoSprings[] =
          "createEffectSurface adds a second spring: no force of Gliss until "
          "deleteEffectSurface";

  static chai3d::cVector3d vector(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
  chai3d::cVector3d local(const Vec3& metres) const { return vector(metres / metres_); }

  // The tracker of a point, its own from the first tick on; null: all are taken.
  Tracker* tracker_of(unsigned int id) {
    for (std::size_t i = 0; i < ids_.size(); ++i) {
      if (ids_[i] == id) return &trackers_[i];
    }
    if (ids_.size() == points_) return nullptr;
    ids_.push_back(id);
    return &trackers_[ids_.size() - 1];
  }

  // False for a material that is none. While it changes, the friction of slipping may be the
  // larger.
  bool follow_material(Tracker& tracker) const {
    const double at_rest = m_material->getStaticFriction();
    const double slipping = std::min(at_rest, m_material->getDynamicFriction());
    return tracker.set_material(0, m_material->getStiffness() / metres_,
                                {at_rest, slipping, surface_.friction.settle});
  }

  void tell(const char* fault) {
    fault_ = fault;
    for (const char*& told : told_) {
      if (told == fault) return;
      if (told != nullptr) continue;
      told = fault;
      std::fprintf(stderr, "cGlissObject %s: %s\n", m_name.c_str(), fault);
      return;
    }
  }

  SceneObject surface_;
  double metres_;
  std::size_t points_;
  ForceBy force_by_;
  std::vector<Tracker> trackers_;
  std::vector<unsigned int> ids_;  // of the points that have trackers, in their order
  chai3d::cVector3d found_;        // this tick's force, this object's frame
  chai3d::cMesh* drawing_ = nullptr;
  std::atomic<const char*> fault_ = nullptr;
  std::array<const char*, 4> told_{};
};

}  // namespace gliss
