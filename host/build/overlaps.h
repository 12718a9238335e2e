// Finds the boxes of a hierarchy (host/build/hierarchy.h) that overlap each other or hold a point.
// Private to host/.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "gliss/build/hierarchy.h"
#include "gliss/surface/instances.h"
#include "gliss/surface/layout.h"
#include "gliss/surface/patch_cache.h"

namespace gliss {

// The box of child[place].
template <class Real>
Box box_of(const LargeArray<Real>& node, std::size_t place) {
  const Real* at = &node[6 * place];
  return {vector_at(at), vector_at(at + 3)};
}

// The hierarchy of two boxes or more, which it keeps.
class BoxTree {
 public:
  explicit BoxTree(const std::vector<Box>& boxes) {
    build_hierarchy(boxes, node_, child_, serial_for);
  }

  // Calls visit(box) for each box that holds x.
  template <class Visit>
  void for_each_at(const Vec3& x, Visit visit) const {
    std::vector<std::uint32_t> open;
    if (!child_.empty()) open.push_back(0);
    while (!open.empty()) {
      const std::size_t at = open.back();
      open.pop_back();
      for (std::size_t place = 2 * at; place < 2 * at + 2; ++place) {
        if (!box_of(node_, place).contains(x)) continue;
        if (child_[place] & kNodeLeaf) {
          visit(child_[place] & ~kNodeLeaf);
        } else {
          open.push_back(child_[place]);
        }
      }
    }
  }

  // The box of least size(box), the first of those of one size, that holds x and for which
  // holds(box) is true, which is asked of few; kNone: there is none.
  template <class Size, class Holds>
  std::uint32_t smallest_at(const Vec3& x, Size size, Holds holds) const {
    std::uint32_t found = kNone;
    for_each_at(x, [&](std::uint32_t box) {
      const bool is_smaller =
          found == kNone || std::pair(size(box), box) < std::pair(size(found), found);
      if (is_smaller && holds(box)) found = box;
    });
    return found;
  }

 private:
  LargeArray<double> node_;
  LargeArray<std::uint32_t> child_;
};

template <class Real>
class Overlaps {
 public:
  // The arrays must outlive it. `label`: one for each box.
  Overlaps(const LargeArray<Real>& node, const LargeArray<std::uint32_t>& child,
           const std::vector<std::uint32_t>& label)
      : node_(node), child_(child), label_(label), beneath_(child.size() / 2) {
    // Parents come before their children.
    for (std::size_t n = beneath_.size(); n-- > 0;) {
      const std::uint32_t a = label_of(child[2 * n]), b = label_of(child[2 * n + 1]);
      beneath_[n] = a == b ? a : kSeveral;
    }
  }

  // Calls visit(a, b) once for each two boxes of different labels that overlap, until it returns
  // false. What lies beneath two boxes of one label each is left out where skips(label, label).
  template <class Skips, class Visit>
  void for_each(Skips skips, Visit visit) const {
    if (!beneath_.empty()) within(0, skips, visit);
  }

 private:
  static constexpr std::uint32_t kSeveral = kNone;

  std::uint32_t label_of(std::uint32_t child) const {
    return child & kNodeLeaf ? label_[child & ~kNodeLeaf] : beneath_[child];
  }

  template <class Skips, class Visit>
  bool within(std::uint32_t child, Skips skips, Visit visit) const {
    if ((child & kNodeLeaf) || beneath_[child] != kSeveral) return true;
    const std::size_t left = 2 * std::size_t{child};
    return within(child_[left], skips, visit) && within(child_[left + 1], skips, visit) &&
           between(left, left + 1, skips, visit);
  }
  template <class Skips, class Visit>
  bool between(std::size_t a, std::size_t b, Skips skips, Visit visit) const {
    const std::uint32_t at_a = child_[a], at_b = child_[b];
    const std::uint32_t label_a = label_of(at_a), label_b = label_of(at_b);
    if (!box_of(node_, a).meets(box_of(node_, b))) return true;
    if (label_a != kSeveral && label_b != kSeveral &&
        (label_a == label_b || skips(label_a, label_b)))
      return true;
    const bool leaf_a = at_a & kNodeLeaf, leaf_b = at_b & kNodeLeaf;
    if (leaf_a && leaf_b) return visit(at_a & ~kNodeLeaf, at_b & ~kNodeLeaf);
    if (leaf_b || (!leaf_a && at_a < at_b))  // the larger one, mostly
      return between(2 * std::size_t{at_a}, b, skips, visit) &&
             between(2 * std::size_t{at_a} + 1, b, skips, visit);
    return between(a, 2 * std::size_t{at_b}, skips, visit) &&
           between(a, 2 * std::size_t{at_b} + 1, skips, visit);
  }

  const LargeArray<Real>& node_;
  const LargeArray<std::uint32_t>& child_;
  const std::vector<std::uint32_t>& label_;
  std::vector<std::uint32_t> beneath_;  // [node], the label of all boxes beneath it, or kSeveral
};

}  // namespace gliss
