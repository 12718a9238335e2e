// Tells what is inside where faces fold over their neighbours: there the nearest point's normal
// does not say it, and the winding number of the polygons does.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>
#include <vector>

#include "gliss/surface/base_triangles.h"

namespace gliss {

// Counts closed parts, and open ones whose holes are small, which it closes: each hole by a cone
// to its middle. Other open parts enclose nothing. It sums over the tree of the patches, each child
// that is far as a dipole (Barill, Dickson, Schmidt, Levin and Jacobson 2018, of first order). Does
// not change: any number of threads may ask.
class WindingTree {
 public:
  template <class Real>
  explicit WindingTree(const Surface<Real>& s);

  // True if some part counts. If none does, nothing but this may be asked.
  bool counts_any() const {
    return counted_.empty() || std::find(counted_.begin(), counted_.end(), 1) != counted_.end();
  }
  // True if a patch's part counts.
  bool counts(std::uint32_t patch) const { return counted_.empty() || counted_[patch]; }
  // True if a point of the mesh frame lies in the solid of the polygons.
  bool is_inside(const Vec3& x) const { return number_at(x) > (is_room_ ? -0.5 : 0.5); }
  // True if a point of the mesh frame may lie between a patch and its base polygon. `distance`: no
  // patch is nearer.
  bool may_be_between(const Vec3& x, double distance) const;

 private:
  struct Child {
    Vec3 middle = Vec3::Zero(), area = Vec3::Zero();  // of its triangles, by area; sum of normals
    double size = 0;                                  // sum of areas, twice
    double radius = 0;                                // of the ball round the middle that has all
    std::uint32_t begin = 0, end = 0;                 // its triangles
    std::uint32_t node = 0;                           // its children are 2 node and 2 node + 1
    bool is_leaf = true;
    Eigen::AlignedBox3d box;   // of its patches' own polygons
    double departure = 0;      // of what departs most from one of these
    Vec3 axis = Vec3::Zero();  // of a leaf: the normal of its own polygon, ...
    double low = 0, high = 0;  // ... along which that lies between these
  };

  double number_at(const Vec3& x) const;
  // The solid angle of a child as a dipole; none where it is too near for that.
  static std::optional<double> angle_of_dipole(const Child& c, const Vec3& x);
  double angle_of_triangles(const Child& c, const Vec3& x) const;
  // Takes the triangles from c.begin on.
  void take(Child& c);
  // Finds the parts that count, and closes their holes.
  template <class Real>
  void close_holes(const Surface<Real>& s);
  template <class Real>
  void gather(const Surface<Real>& s, std::uint32_t named, std::size_t child);

  std::vector<BaseTriangle> triangles_;  // in the order of the tree
  std::vector<Child> children_;          // two of each node; the last is the root
  std::vector<Child> holes_;             // their triangles come before those of the tree
  std::vector<char> counted_;            // [patch]; empty: all
  double departure_ = 0;                 // no patch is farther from its base polygon
  bool is_room_ = false;                 // the polygons enclose a negative volume
};

}  // namespace gliss
