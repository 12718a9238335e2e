// One HIP among the objects of a scene: what a device loop calls each tick. The same contacts as
// ContactTracker's (host/query.h), in metres and the world's frame; a step allocates nothing, takes
// no lock, and its work is bounded.
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <span>
#include <vector>

#include "host/query.h"

namespace gliss {

struct SceneObject {
  std::shared_ptr<const PatchCache> cache;
  double stiffness = 500;  // N/m
  Method method = Method::kGregory;
  Solver solver = Solver::kNewton;
  // From the object's frame to the world's; its translation in m.
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
};

// What a step found of one object.
struct ObjectStep {
  bool searched = false;      // false: too far to touch, nothing was computed, `contact` is older
  Contact contact;            // in the object's frame and its mesh's unit
  Vec3 force = Vec3::Zero();  // N, world
};

class Tracker {
 public:
  explicit Tracker(std::span<const SceneObject> objects);

  // The force on the hand at a HIP (m, world), in N: the sum over the objects. What is farther than
  // the HIP has moved since its last search costs a comparison.
  Vec3 step(const Vec3& hip) noexcept;
  std::span<const ObjectStep> objects() const { return steps_; }  // of the last step
  bool touching() const;

 private:
  struct Tracked {
    SceneObject object;
    Eigen::Isometry3d to_object;  // of points in m
    ContactTracker contact;
  };
  std::vector<Tracked> tracked_;
  std::vector<ObjectStep> steps_;  // [tracked_]
};

}  // namespace gliss
