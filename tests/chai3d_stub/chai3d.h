// A stub of CHAI3D's public interface, as far as gliss/chai3d.h uses it: the names and
// calls of a program with CHAI3D 3, and the order in which a world asks an object for its force.
// Nothing is drawn.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace chai3d {

class cVector3d {
 public:
  cVector3d(double x = 0, double y = 0, double z = 0) : v_{x, y, z} {}
  double& operator()(unsigned int i) { return v_[i]; }
  double operator()(unsigned int i) const { return v_[i]; }
  double lengthsq() const { return v_[0] * v_[0] + v_[1] * v_[1] + v_[2] * v_[2]; }
  void add(const cVector3d& b) {
    for (int i = 0; i < 3; ++i) v_[i] += b.v_[i];
  }
  void mul(double factor) {
    for (double& x : v_) x *= factor;
  }

 private:
  double v_[3];
};

inline cVector3d cSub(const cVector3d& a, const cVector3d& b) {
  return {a(0) - b(0), a(1) - b(1), a(2) - b(2)};
}

// A rotation by its columns.
class cMatrix3d {
 public:
  void setCol(const cVector3d& x, const cVector3d& y, const cVector3d& z) {
    column_[0] = x, column_[1] = y, column_[2] = z;
  }
  cVector3d times(const cVector3d& v) const {
    cVector3d sum;
    for (unsigned int i = 0; i < 3; ++i) {
      for (unsigned int j = 0; j < 3; ++j) sum(i) += column_[j](i) * v(j);
    }
    return sum;
  }
  cVector3d times_back(const cVector3d& v) const {
    cVector3d sum;
    for (unsigned int i = 0; i < 3; ++i) {
      for (unsigned int j = 0; j < 3; ++j) sum(i) += column_[i](j) * v(j);
    }
    return sum;
  }

 private:
  cVector3d column_[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
};

class cMaterial {
 public:
  double getStiffness() const { return stiffness_; }
  double getStaticFriction() const { return at_rest_; }
  double getDynamicFriction() const { return slipping_; }
  void setStiffness(double value) { stiffness_ = std::max(0.0, value); }
  void setStaticFriction(double value) { at_rest_ = std::max(0.0, value); }
  void setDynamicFriction(double value) { slipping_ = std::max(0.0, value); }

 private:
  double stiffness_ = 0, at_rest_ = 0, slipping_ = 0;
};
using cMaterialPtr = std::shared_ptr<cMaterial>;

class cGenericObject;

struct cInteractionEvent {
  cGenericObject* m_object = nullptr;
  bool m_isInside = false;
  cVector3d m_localPos, m_localNormal, m_localForce, m_localSurfacePos;
};

class cInteractionRecorder {
 public:
  std::vector<cInteractionEvent> m_interactions;
};

class cGenericEffect {
 public:
  explicit cGenericEffect(cGenericObject* parent) : m_parent(parent) {}
  virtual ~cGenericEffect() = default;
  bool getEnabled() const { return true; }
  // Adds nothing where it returns false.
  virtual bool computeForce(const cVector3d& position, const cVector3d& velocity,
                            const unsigned int& id, cVector3d& force) = 0;

 protected:
  cGenericObject* m_parent;
};

// The spring from a tool to the point that the object found for it.
class cEffectSurface : public cGenericEffect {
 public:
  using cGenericEffect::cGenericEffect;
  bool computeForce(const cVector3d& position, const cVector3d&, const unsigned int&,
                    cVector3d& force) override;
};

struct cRenderOptions {};

class cGenericType {
 public:
  virtual ~cGenericType() = default;
  std::string m_name;
};

class cGenericObject : public cGenericType {
 public:
  cGenericObject() = default;
  ~cGenericObject() override {
    for (cGenericObject* child : m_children) delete child;
    for (cGenericEffect* effect : m_effects) delete effect;
  }
  cGenericObject(const cGenericObject&) = delete;
  cGenericObject& operator=(const cGenericObject&) = delete;

  virtual std::string getClassName() { return "GenericObject"; }
  void setLocalPos(const cVector3d& position) { m_localPos = position; }
  void setLocalRot(const cMatrix3d& rotation) { m_localRot = rotation; }
  void setEnabled(bool enabled) { m_enabled = enabled; }
  virtual void setHapticEnabled(bool enabled, bool = true, bool = true) {
    m_hapticEnabled = enabled;
  }
  bool getHapticEnabled() const { return m_hapticEnabled; }
  virtual void setMaterial(cMaterialPtr material, bool = false, bool = true) {
    m_material = std::move(material);
  }
  bool addEffect(cGenericEffect* effect) {
    m_effects.push_back(effect);
    return true;
  }
  void createEffectSurface() { addEffect(new cEffectSurface(this)); }
  void deleteEffectSurface() {
    std::erase_if(m_effects, [](cGenericEffect* effect) {
      const bool is_surface = dynamic_cast<cEffectSurface*>(effect) != nullptr;
      if (is_surface) delete effect;
      return is_surface;
    });
  }
  bool addChild(cGenericObject* child) {
    m_children.push_back(child);
    return true;
  }
  bool deleteChild(cGenericObject* child) {
    delete child;
    return std::erase(m_children, child) != 0;
  }
  unsigned int getNumChildren() const { return static_cast<unsigned int>(m_children.size()); }
  cGenericObject* getChild(unsigned int i) const { return m_children[i]; }
  void scale(const double& factor) { scaleObject(factor); }
  void computeBoundaryBox() { updateBoundaryBox(); }
  cVector3d getBoundaryMin() const { return m_boundaryBoxMin; }
  cVector3d getBoundaryMax() const { return m_boundaryBoxMax; }

  virtual void renderSceneGraph(cRenderOptions& options) { render(options); }

  // The force on a tool, both in the frame of this object's parent: the object finds its point,
  // then come its effects and what else it does, then its children.
  virtual cVector3d computeInteractions(const cVector3d& position, const cVector3d& velocity,
                                        unsigned int id, cInteractionRecorder& recorder) {
    const cVector3d at = m_localRot.times_back(cSub(position, m_localPos)),
                    speed = m_localRot.times_back(velocity);
    cVector3d sum;
    if (m_enabled) {
      computeLocalInteraction(at, speed, id);
      if (m_hapticEnabled) {
        for (cGenericEffect* effect : m_effects) {
          cVector3d force;
          effect->computeForce(at, speed, id, force);
          sum.add(force);
        }
        sum.add(computeOtherInteractions(at, speed, id, recorder));
      }
    }
    for (cGenericObject* child : m_children)
      sum.add(child->computeInteractions(at, speed, id, recorder));
    return m_localRot.times(sum);
  }

  cMaterialPtr m_material = std::make_shared<cMaterial>();
  cVector3d m_interactionPoint, m_interactionNormal;
  bool m_interactionInside = false;

 protected:
  virtual void render(cRenderOptions&) {}
  virtual void updateBoundaryBox() {}
  virtual void scaleObject(const double&) {}
  virtual void computeLocalInteraction(const cVector3d&, const cVector3d&, const unsigned int) {}
  virtual cVector3d computeOtherInteractions(const cVector3d&, const cVector3d&, const unsigned int,
                                             cInteractionRecorder&) {
    return {};
  }

  std::vector<cGenericEffect*> m_effects;
  cVector3d m_boundaryBoxMin, m_boundaryBoxMax;
  bool m_boundaryBoxEmpty = true;

 private:
  cVector3d m_localPos;
  cMatrix3d m_localRot;
  std::vector<cGenericObject*> m_children;
  bool m_enabled = true, m_hapticEnabled = true;
};

inline bool cEffectSurface::computeForce(const cVector3d& position, const cVector3d&,
                                         const unsigned int&, cVector3d& force) {
  if (!m_parent->m_interactionInside) return false;
  force = cSub(m_parent->m_interactionPoint, position);
  force.mul(m_parent->m_material->getStiffness());
  return true;
}

// Counts and keeps what a drawing is made of.
class cMesh : public cGenericObject {
 public:
  unsigned int newVertex(const cVector3d& position, const cVector3d& normal) {
    positions.push_back(position);
    normals.push_back(normal);
    return static_cast<unsigned int>(positions.size() - 1);
  }
  unsigned int newTriangle(unsigned int a, unsigned int b, unsigned int c) {
    for (unsigned int corner : {a, b, c}) corners.push_back(corner);
    return static_cast<unsigned int>(corners.size() / 3 - 1);
  }

  std::vector<cVector3d> positions, normals;
  std::vector<unsigned int> corners;
};

}  // namespace chai3d
