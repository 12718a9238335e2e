#include "gliss/build/parts.h"

#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <unordered_set>
#include <utility>

#include "gliss/base/hash_index.h"
#include "gliss/base/poll.h"
#include "gliss/build/overlaps.h"
#include "gliss/mesh/solid_angle.h"
#include "gliss/surface/base_triangles.h"
#include "gliss/surface/layout.h"

namespace gliss {
namespace {

using Triangle = BaseTriangle;

// Pairs of parts, in either order: bits where there are few parts, and any two may meet.
class PairSet {
 public:
  explicit PairSet(std::size_t parts) : parts_(parts) {
    if (parts <= kMostParts) bits_.resize(parts * parts);
  }
  bool contains(std::uint32_t a, std::uint32_t b) const {
    return bits_.empty() ? keys_.contains(key(a, b)) : bits_[key(a, b)];
  }
  void insert(std::uint32_t a, std::uint32_t b) {
    if (bits_.empty()) {
      keys_.insert(key(a, b));
    } else {
      bits_[key(a, b)] = true;
    }
  }

 private:
  static constexpr std::size_t kMostParts = 1 << 14;  // 32 MiB

  std::uint64_t key(std::uint32_t a, std::uint32_t b) const {
    return std::min(a, b) * std::uint64_t{parts_} + std::max(a, b);
  }

  const std::size_t parts_;
  std::vector<bool> bits_;
  std::unordered_set<std::uint64_t> keys_;
};

template <class Real>
class PartFinder {
 public:
  PartFinder(const std::vector<Box>& boxes, Surface<Real>& s, const Poll& poll)
      : boxes_(boxes), s_(s), poll_(poll) {}

  void run() {
    number_parts();
    if (count_ < 2) return;
    describe_parts();
    if (join_cavities()) describe_parts();
    find_copies();
    if (std::find(solid_.begin(), solid_.end(), 1) == solid_.end()) return;
    find_mixed();
    find_buried();
    if (!pairs_.empty()) store();
  }

 private:
  // Adds to the patches in `front` all beyond sides whose twin `enters`.
  template <class Enters>
  void flood(std::vector<std::uint32_t>& front, Enters enters) const {
    for (std::size_t done = 0; done < front.size(); ++done) {
      const std::uint32_t p = front[done];
      for (std::uint32_t side = s_.side_begin[p]; side < s_.side_begin[p + 1]; ++side) {
        const std::uint32_t twin = s_.side_twin[side];
        if (enters(twin)) front.push_back(s_.side_patch[twin]);
      }
    }
  }

  // Connected components over sides; closed where every side has a twin.
  void number_parts() {
    part_.assign(boxes_.size(), kNone);
    std::vector<std::uint32_t> front;
    for (std::uint32_t first = 0; first < boxes_.size(); ++first) {
      if (part_[first] != kNone) continue;
      bool closed = true;
      front.assign(1, first);
      part_[first] = count_;
      flood(front, [&](std::uint32_t twin) {
        closed = closed && twin != kNone;
        if (twin == kNone || part_[s_.side_patch[twin]] != kNone) return false;
        part_[s_.side_patch[twin]] = count_;
        return true;
      });
      closed_.push_back(closed);
      begin_.push_back(static_cast<std::uint32_t>(patches_.size()));
      patches_.insert(patches_.end(), front.begin(), front.end());
      ++count_;
    }
    begin_.push_back(static_cast<std::uint32_t>(patches_.size()));
    solid_ = closed_;
  }

  // Parts that are the same numbers at the same place as one before: a union holds them once.
  void find_copies() {
    const auto corners = [&](std::uint32_t p) { return s_.side_begin[p + 1] - s_.side_begin[p]; };
    HashIndex known(count_);
    for (std::uint32_t part = 0; part < count_; ++part) {
      XXH64_hash_t hash = begin_[part + 1] - begin_[part];
      for_patches(part, [&](std::uint32_t p) {
        hash = XXH3_64bits_withSeed(&s_.patch[p * kPatchReals], kPatchReals * sizeof(Real), hash);
      });
      alike_.push_back(known.find_or_insert(part, hash, [&](std::uint32_t a, std::uint32_t b) {
        const auto first = patches_.begin();
        return std::equal(
            first + begin_[a], first + begin_[a + 1], first + begin_[b], first + begin_[b + 1],
            [&](std::uint32_t p, std::uint32_t q) {
              return corners(p) == corners(q) &&
                     std::equal(&s_.patch[p * kPatchReals],
                                &s_.patch[p * kPatchReals] + kPatchReals,
                                &s_.patch[q * kPatchReals]) &&
                     std::equal(&s_.corner[6 * std::size_t{s_.side_begin[p]}],
                                &s_.corner[6 * std::size_t{s_.side_begin[p]}] + 6 * corners(p),
                                &s_.corner[6 * std::size_t{s_.side_begin[q]}]);
            });
      }));
    }
  }

  template <class Visit>
  void for_triangles(std::uint32_t patch, const Vec3& x, Visit visit) const {
    for_base_triangles(s_, patch, x, visit);
  }
  Vec3 corner_of(std::uint32_t patch) const {
    Vec3 x;
    for_triangles(patch, Vec3::Zero(), [&](const Triangle& t) { x = t[0]; });
    return x;
  }
  template <class Visit>
  void for_patches(std::uint32_t part, Visit visit) const {
    for (std::uint32_t i = begin_[part]; i < begin_[part + 1]; ++i) visit(patches_[i]);
  }

  // Boxes; solid are the closed parts that enclose something.
  void describe_parts() {
    constexpr double kRounding = 1e-9,
                     kSlack = 8 * static_cast<double>(std::numeric_limits<Real>::epsilon());
    part_box_.clear();
    volume_.clear();
    for (std::uint32_t part = 0; part < count_; ++part) {
      Box box = boxes_[patches_[begin_[part]]];
      double volume = 0, size = 0;
      const Vec3 apex = box.low;
      for_patches(part, [&](std::uint32_t p) {
        box.hold(boxes_[p]);
        for_triangles(p, apex, [&](const Triangle& t) {
          const double cone = t[0].dot(t[1].cross(t[2]));
          volume += cone;
          size += std::abs(cone);
        });
      });
      part_box_.push_back({box.low - Vec3::Constant(kSlack), box.high + Vec3::Constant(kSlack)});
      volume_.push_back(std::abs(volume) > kRounding * size ? volume : 0);
      if (!(volume_[part] > 0)) solid_[part] = 0;
    }
  }

  // Makes the shells of a solid one part: a closed one that is wound inward is a cavity of the
  // smallest solid that it lies in. False if there is none.
  bool join_cavities() {
    std::vector<std::uint32_t> number, of_solid;
    std::vector<char> solid;
    const BoxTree part_boxes(part_box_);
    const auto size = [&](std::uint32_t part) { return volume_[part]; };
    for (std::uint32_t part = 0; part < count_; ++part) {
      const Vec3 x = corner_of(patches_[begin_[part]]);
      const auto holds = [&](std::uint32_t p) { return solid_[p] && holds_all(p, part); };
      const bool is_cavity = volume_[part] < 0 && closed_[part];
      of_solid.push_back(is_cavity ? part_boxes.smallest_at(x, size, holds) : kNone);
      number.push_back(static_cast<std::uint32_t>(solid.size()));
      if (of_solid[part] == kNone) solid.push_back(solid_[part]);
    }
    if (solid.size() == count_) return false;
    for (std::uint32_t& part : part_)
      part = number[of_solid[part] == kNone ? part : of_solid[part]];
    solid_ = std::move(solid);
    count_ = static_cast<std::uint32_t>(solid_.size());
    std::stable_sort(patches_.begin(), patches_.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return part_[a] < part_[b]; });
    begin_.assign(count_ + 1, 0);
    for (const std::uint32_t part : part_) ++begin_[part + 1];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    return true;
  }

  // True if a solid holds another part, and not a piece of it alone, as where solids overlap.
  bool holds_all(std::uint32_t solid, std::uint32_t part) {
    constexpr std::size_t kLooks = 32;
    const Box &box = part_box_[solid], &of_part = part_box_[part];
    if (!box.contains(of_part.low) || !box.contains(of_part.high)) return false;
    const std::size_t first = begin_[part], count = begin_[part + 1] - first,
                      looks = std::min(count, kLooks);
    std::vector<Vec3> corners;
    for (std::size_t i = 0; i < looks; ++i)
      corners.push_back(corner_of(patches_[first + i * count / looks]));
    const std::vector<double> angles = angles_round(solid, corners);
    // One may lie on the solid's surface, where parts touch.
    return static_cast<std::size_t>(std::count_if(angles.begin(), angles.end(), goes_round)) +
               looks / kLooks >=
           looks;
  }

  struct OrientedBox {
    Eigen::Matrix3d axes;  // columns, unit
    Vec3 centre, half;
  };
  // Bounds a patch and its base polygon, mesh frame.
  OrientedBox oriented_box(std::uint32_t patch) const {
    const Real* numbers = &s_.patch[patch * kPatchReals];
    const double unscale = static_cast<double>(numbers[kPatchUnscale]),
                 slack = 8 * static_cast<double>(std::numeric_limits<Real>::epsilon());
    const Vec3 normal = vector_at(numbers + kPatchNormal),
               tangent = vector_at(numbers + kPatchTangent), low = vector_at(numbers + kPatchLow),
               high = vector_at(numbers + kPatchHigh);
    OrientedBox box;
    box.axes << tangent, normal.cross(tangent), normal;
    box.centre = from_local(s_, patch, box.axes * (0.5 * (low + high)));
    box.half = 0.5 * unscale * (high - low) + Vec3::Constant(slack);
    return box;
  }
  // True unless a plane along faces of one of them, or along an edge of each, parts them.
  static bool overlap_oriented(const OrientedBox& a, const OrientedBox& b) {
    const Vec3 apart = b.centre - a.centre;
    const auto parts = [&](const Vec3& axis) {
      return std::abs(axis.dot(apart)) > (a.axes.transpose() * axis).cwiseAbs().dot(a.half) +
                                             (b.axes.transpose() * axis).cwiseAbs().dot(b.half);
    };
    for (int i = 0; i < 3; ++i) {
      if (parts(a.axes.col(i)) || parts(b.axes.col(i))) return false;
      for (int k = 0; k < 3; ++k) {
        if (parts(a.axes.col(i).cross(b.axes.col(k)))) return false;
      }
    }
    return true;
  }

  // The patches whose boxes overlap those of a solid part.
  void find_mixed() {
    mixed_.assign(boxes_.size(), 0);
    PairSet known(count_);
    const auto mix = [&](std::uint32_t a, std::uint32_t b) {
      poll_();
      const std::uint32_t p = part_[a], q = part_[b];
      const bool is_known = known.contains(p, q);
      if (is_known && (mixed_[a] || !solid_[q]) && (mixed_[b] || !solid_[p])) return;
      if (!overlap_oriented(oriented_box(a), oriented_box(b))) return;
      if (!is_known) known.insert(p, q);
      const auto enter = [&](std::uint32_t patch, std::uint32_t part, std::uint32_t partner) {
        if (!solid_[partner]) return;
        mixed_[patch] = 1;
        if (!is_known) pairs_.emplace_back(part, partner);
      };
      enter(a, p, q);
      enter(b, q, p);
    };
    std::vector<std::uint32_t> label;
    for (const std::uint32_t part : part_) label.push_back(alike_[part]);
    Overlaps<Real>(s_.node, s_.child, label)
        .for_each(
            [&](std::uint32_t a, std::uint32_t b) {
              poll_();
              return !solid_[a] && !solid_[b];
            },
            [&](std::uint32_t a, std::uint32_t b) {
              mix(a, b);
              return true;
            });
  }

  // The others, in connected groups: all of a group lie within another part or none does.
  void find_buried() {
    buried_.assign(boxes_.size(), 0);
    const BoxTree part_boxes(part_box_);
    std::vector<char> seen(mixed_);
    std::vector<std::uint32_t> group;
    for (std::uint32_t first = 0; first < boxes_.size(); ++first) {
      if (std::exchange(seen[first], 1)) continue;
      group.assign(1, first);
      flood(group, [&](std::uint32_t twin) {
        return twin != kNone && !std::exchange(seen[s_.side_patch[twin]], 1);
      });
      const Vec3 x = corner_of(first);
      bool within = false;
      part_boxes.for_each_at(x, [&](std::uint32_t part) {
        poll_();
        if (alike_[part] == alike_[part_[first]] || !solid_[part] || !winds_round(part, x)) return;
        pairs_.emplace_back(part_[first], part);
        within = true;
      });
      for (const std::uint32_t p : group) buried_[p] = within;
    }
  }
  // The solid angles of a part's triangles, seen from some points.
  std::vector<double> angles_round(std::uint32_t part, const std::vector<Vec3>& at) {
    std::vector<double> angles(at.size(), 0);
    for_patches(part, [&](std::uint32_t p) {
      poll_();
      for_triangles(p, Vec3::Zero(), [&](const Triangle& t) {
        for (std::size_t k = 0; k < at.size(); ++k)
          angles[k] += solid_angle(t[0] - at[k], t[1] - at[k], t[2] - at[k]);
      });
    });
    return angles;
  }
  static bool goes_round(double angle) { return std::abs(angle) > 2 * std::numbers::pi; }
  bool winds_round(std::uint32_t part, const Vec3& x) {
    return goes_round(angles_round(part, {x}).front());
  }

  void store() {
    std::sort(pairs_.begin(), pairs_.end());
    pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
    s_.part.resize(boxes_.size());
    for (std::size_t p = 0; p < boxes_.size(); ++p)
      s_.part[p] = part_[p] | (mixed_[p] ? kPatchMixed : buried_[p] ? kPatchBuried : 0);
    std::size_t next = 0;
    for (std::uint32_t part = 0; part < count_; ++part) {
      const std::size_t begin = next;
      for (; next < pairs_.size() && pairs_[next].first == part; ++next)
        s_.partner.push_back(pairs_[next].second);
      for (const std::size_t number : {begin, next, std::size_t{patches_[begin_[part]]}})
        s_.part_table.push_back(static_cast<std::uint32_t>(number));
      for (const double x : part_box_[part].low) s_.part_box.push_back(static_cast<Real>(x));
      for (const double x : part_box_[part].high) s_.part_box.push_back(static_cast<Real>(x));
    }
  }

  const std::vector<Box>& boxes_;
  Surface<Real>& s_;
  ItemPoll poll_;
  std::uint32_t count_ = 0;
  std::vector<std::uint32_t> part_;     // [patch]
  std::vector<std::uint32_t> begin_;    // [part + 1], where its patches begin
  std::vector<std::uint32_t> patches_;  // those of the first part, of the second, ...
  std::vector<std::uint32_t> alike_;    // [part], the first that it is a copy of: itself, mostly
  std::vector<char> closed_;            // [part], of those before cavities join
  std::vector<char> solid_;             // [part]
  std::vector<double> volume_;          // [part], six times; below 0: it is wound inward
  std::vector<Box> part_box_;           // [part]
  std::vector<char> mixed_, buried_;    // [patch]
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs_;  // of a part and one it lies in
};

}  // namespace

template <class Real>
void find_parts(const std::vector<Box>& boxes, Surface<Real>& s, const Poll& poll) {
  PartFinder<Real>(boxes, s, poll).run();
}

template void find_parts(const std::vector<Box>&, Surface<float>&, const Poll&);
template void find_parts(const std::vector<Box>&, Surface<double>&, const Poll&);

}  // namespace gliss
