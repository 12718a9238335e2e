#include "gliss/files/cache_check.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <limits>
#include <type_traits>

#include "gliss/files/cache_file.h"
#include "gliss/mesh/mesh.h"
#include "gliss/surface/base_triangles.h"
#include "gliss/surface/instances.h"
#include "gliss/surface/layout.h"

namespace gliss {
namespace {

// Frames: meshes lie in [-1, 1]^3 of theirs, polygons of theirs. Patches are as large, but for
// those that nothing could tame, and split faces may have a centre beside them.
constexpr double kFarthestCorner = 8;        // mesh frame
constexpr double kLeastPatchScale = 0x1p-4;  // a patch of that size
constexpr double kFarthest = 0x1p30;         // either frame: a float holds its fourth power
constexpr double kSlack = 0x1p-10;           // rounding, and more
// Scales of meshes of the largest coordinates, and of the shortest sides that have a length.
constexpr double kLeastScale = 0x1p-200, kMostScale = 0x1p540;

bool is_power_of_two(double x) {
  int exponent = 0;
  return std::isfinite(x) && std::frexp(x, &exponent) == 0.5;
}

// Integers, since these vectorise everywhere: those of larger numbers, of infinity and NaN are
// larger, and what is left of the most borrows from the sign bit.
template <class Real, class A>
bool all_within(const std::vector<Real, A>& numbers, Real most) {
  using Bits = std::conditional_t<sizeof(Real) == 4, std::uint32_t, std::uint64_t>;
  constexpr Bits kSign = Bits{1} << (8 * sizeof(Real) - 1);
  const Bits limit = std::bit_cast<Bits>(most);
  Bits borrow = 0;
  for (const Real x : numbers) borrow |= limit - (std::bit_cast<Bits>(x) & ~kSign);
  return !(borrow & kSign);
}

template <class Real>
class Check {
 public:
  Check(const PatchCache& cache, const Surface<Real>& surface, const std::string& source)
      : c_(cache),
        s_(surface),
        source_(source),
        patches_(cache.patch_face.size()),
        sides_(cache.corner_of_face.size()),
        faces_(cache.face_valence.size()) {}

  void run() const {
    check_frame();
    check_sizes();
    check_sides();
    check_faces();
    check_domain();
    check_forms();
    check_numbers();
    check_patches();
    check_tiles();
    check_hierarchy();
    check_boxes();
    check_parts();
  }

 private:
  [[noreturn]] void fail(const char* section, const std::string& what) const {
    throw CacheError(fmt::format("{}: section '{}': {}", source_, section, what), false);
  }
  void require(bool sound, const char* section, std::size_t at, const char* what) const {
    if (!sound) [[unlikely]]
      fail(section, fmt::format("entry {}: {}", at, what));
  }
  void require_size(std::size_t size, std::size_t expected, const char* section) const {
    if (size != expected) fail(section, fmt::format("{} entries where {} belong", size, expected));
  }

  void check_frame() const {
    const auto require_number = [&](bool sound, const char* what) {
      if (!sound) fail("header", what);
    };
    require_number(c_.unit >= kLeastUnit && c_.unit <= kMostUnit,
                   "the unit is not a positive number, or no length of anything");
    require_number((c_.origin.array().abs() <= kMostCoordinate).all(),
                   "the origin is not finite, or beyond what meshes have");
    require_number(is_power_of_two(c_.scale) && c_.scale >= kLeastScale && c_.scale <= kMostScale,
                   "the scale is not a power of two, or beyond what meshes have");
  }

  void check_sizes() const {
    if (patches_ == 0 || patches_ >= kNodeLeaf) fail("patch_face", "no patches, or too many");
    if (sides_ < 3 * patches_ || sides_ >= kNone)
      fail("corner_of_face", "too few sides, or too many");
    require_size(faces_, c_.mesh_face_count, "face_valence");
    require_size(c_.face_patch.size(), faces_, "face_patch");
    require_size(c_.kind.size(), patches_, "kind");
    require_size(c_.folded.size(), patches_, "folded");
    require_size(c_.rho_min.size(), patches_, "rho_min");
    require_size(s_.side_begin.size(), patches_ + 1, "side_begin");
    require_size(s_.side_patch.size(), sides_, "side_patch");
    require_size(s_.side_twin.size(), sides_, "side_twin");
    require_size(s_.control_begin.size(), patches_, "control_begin");
    require_size(s_.form.size(), patches_, "form");
    require_size(s_.corner.size(), sides_ * 6, "corner");
    require_size(s_.patch.size(), patches_ * kPatchReals, "patch");
    require_size(s_.triangle.size(), 3 * (sides_ - 2 * patches_), "triangle");
    require_size(s_.node.size(), (patches_ - 1) * kNodeReals, "node");
    require_size(s_.child.size(), (patches_ - 1) * 2, "child");
    require_size(s_.tile_begin.size(), patches_ + 1, "tile_begin");
  }

  // Twins that pair up also make every walk round a vertex end.
  void check_sides() const {
    require(s_.side_begin[0] == 0, "side_begin", 0, "not zero");
    for (std::uint32_t p = 0; p < patches_; ++p) {
      const std::uint32_t begin = s_.side_begin[p], end = s_.side_begin[p + 1];
      require(begin < end && end <= sides_, "side_begin", p + 1, "not ascending, or out of range");
      require(end - begin >= 3 && end - begin <= kMaxValence, "side_begin", p,
              "a valence out of range");
      for (std::uint32_t s = begin; s < end; ++s) {
        require(s_.side_patch[s] == p, "side_patch", s, "not the patch of the side");
      }
    }
    require(s_.side_begin[patches_] == sides_, "side_begin", patches_, "not the number of sides");
    for (std::uint32_t s = 0; s < sides_; ++s) {
      const std::uint32_t twin = s_.side_twin[s];
      require(twin == kNone || (twin < sides_ && twin != s && s_.side_twin[twin] == s), "side_twin",
              s, "out of range, or not a pair");
    }
  }

  // A face has one patch of its own valence, or triangles that follow each other.
  void check_faces() const {
    std::size_t built = 0, named = 0, corners = 0;
    for (std::size_t f = 0; f < faces_; ++f) {
      const std::uint32_t n = c_.face_valence[f];
      require(n >= 3 && n <= kMaxValence, "face_valence", f, "out of range");
      named += c_.face_patch[f] != kNone;
      corners += n;
    }
    if (c_.crease_count > corners / 2) fail("header", "more creases than edges");
    for (const Departure& d : {c_.departure, c_.tightest}) {
      if (!(d.distance >= 0 && std::isfinite(d.distance) && d.room > 0 && d.face < faces_))
        fail("header", "a departure that is none");
    }
    for (std::uint32_t p = 0; p < patches_; ++p) {
      const std::uint32_t face = c_.patch_face[p];
      require(face < faces_, "patch_face", p, "out of range");
      const bool first = p == 0 || c_.patch_face[p - 1] != face;
      require(!first || c_.face_patch[face] == p, "face_patch", face,
              "not the first patch of the face");
      built += first;
      const bool is_piece = !first || (p + 1 < patches_ && c_.patch_face[p + 1] == face);
      const std::uint32_t n = c_.face_valence[face];
      require(s_.valence(p) == (is_piece ? 3 : n), "side_begin", p, "not the valence of the face");
      for (std::uint32_t k = 0; k < s_.valence(p); ++k) {
        const std::size_t side = s_.side_begin[p] + k;
        const std::uint32_t corner = c_.corner_of_face[side];
        require(is_piece ? corner <= n : corner == k, "corner_of_face", side,
                "not a corner of the face");
      }
      const std::uint32_t* corner = &c_.corner_of_face[s_.side_begin[p]];
      require(corner[0] != corner[1] && corner[1] != corner[2] && corner[2] != corner[0],
              "corner_of_face", s_.side_begin[p], "a corner twice");
    }
    if (built != named) fail("face_patch", "names a patch of another face");
  }

  void check_domain() const {
    std::vector<char> used(kMaxValence + 1, 0);
    for (const std::uint32_t face : c_.patch_face) used[c_.face_valence[face]] = 1;
    for (std::uint32_t p = 0; p < patches_; ++p) used[s_.valence(p)] = 1;
    for (std::uint32_t n = 3; n <= kMaxValence; ++n) {
      if (!used[n]) continue;
      require(n < s_.domain_begin.size(), "domain_begin", n, "missing");
      const std::size_t reals = kernels<Real>().domain_reals(n), begin = s_.domain_begin[n];
      require(begin + reals <= s_.domain.size(), "domain_begin", n, "out of range");
      std::vector<Real> own(reals);
      kernels<Real>().fill_domain(n, own.data());
      for (std::size_t i = 0; i < reals; ++i) {
        require(std::abs(s_.domain[begin + i] - own[i]) <= 8 * std::numeric_limits<Real>::epsilon(),
                "domain", begin + i, "not that of its valence");
      }
    }
  }

  bool is_of_level(std::uint32_t form, std::uint32_t valence) const {
    const bool is_fair = c_.level.construction == Construction::kFair;
    switch (form) {
      case kFormPaper:
        return true;
      case kFormBezier:
        return valence <= 4 && (is_fair || c_.level.kind >= Level::kBezier);
      case kFormSextic:
        return valence == 3 && is_fair;
      case kFormCurved:
        return valence > 4 && valence <= kMostFairSides && is_fair;
      case kFormRibbon:
        return is_fair || c_.level.kind >= Level::kRibbon;
      case kFormTable:
        return c_.level.kind == Level::kTable;
      default:
        return false;
    }
  }

  // Checks that patches have the cache's level, or what stands in for it, and their control data
  // after the last one's.
  void check_forms() const {
    std::uint64_t begin = 0;
    for (std::uint32_t p = 0; p < patches_; ++p) {
      const std::uint32_t form = s_.form[p], kind = form & kFormMask;
      require(is_of_level(kind, s_.valence(p)) &&
                  form >> 8 == (kind == kFormTable ? c_.level.cells : 0),
              "form", p, "not of the cache's level");
      require(s_.control_begin[p] == begin, "control_begin", p, "not after the last patch");
      begin += kernels<Real>().control_reals(form, s_.valence(p)) / 3;
    }
    require_size(s_.control.size(), 3 * begin, "control");
  }

  // True for a patch of a face that is cut round a centre, all of whose patches hold pieces.
  bool is_piece(std::uint32_t patch, const std::uint32_t* piece) const {
    const std::uint32_t face = c_.patch_face[patch], n = c_.face_valence[face],
                        first = c_.face_patch[face];
    if (!(s_.domain_begin[0] & kHasFans) || piece[1] != s_.side_begin[first] || piece[2] != n ||
        n > patches_ - first)
      return false;
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t side = s_.side_begin[first + k];
      if (c_.patch_face[first + k] != face || s_.valence(first + k) != 3 ||
          c_.corner_of_face[side] != k || c_.corner_of_face[side + 2] != n ||
          !(s_.triangle[3 * (side - 2 * std::size_t{first + k})] & kFanPiece))
        return false;
    }
    return piece_corner(piece, 0) < n && piece_corner(piece, 1) < n && piece_corner(piece, 2) < n;
  }

  void check_patches() const {
    for (std::uint32_t p = 0; p < patches_; ++p) {
      const std::size_t begin = 3 * (s_.side_begin[p] - 2 * std::size_t{p});
      if (s_.triangle[begin] & kFanPiece) {
        require(is_piece(p, &s_.triangle[begin]), "triangle", begin, "not a piece of the face");
      } else {
        for (std::size_t i = begin; i < begin + 3 * (s_.valence(p) - 2); ++i) {
          require(s_.triangle[i] < s_.valence(p), "triangle", i, "not a corner of the patch");
        }
      }
      const Real* numbers = &s_.patch[p * kPatchReals];
      require(is_power_of_two(static_cast<double>(numbers[kPatchScale])) &&
                  numbers[kPatchScale] * numbers[kPatchUnscale] == 1,
              "patch", p, "its scale is not a power of two, or not the inverse of its unscale");
      require(static_cast<double>(numbers[kPatchScale]) >= kLeastPatchScale, "patch", p,
              "it is larger than the mesh");
      require(is_direction(numbers + kPatchNormal) && is_direction(numbers + kPatchTangent),
              "patch", p, "its normal or tangent is not a unit vector");
      require(numbers[kPatchSag] >= 0, "patch", p, "its sag is negative");
      require(numbers[kPatchCurvature] >= 0, "patch", p, "its curvature is negative");
      require(c_.kind[p] <= PatchKind::kBent, "kind", p, "out of range");
      require(c_.folded[p] <= 1, "folded", p, "out of range");
      require(c_.rho_min[p] >= 0, "rho_min", p, "negative");
    }
  }

  // Rows of as many tiles as there are sides; what is in them is sound whatever it is.
  void check_tiles() const {
    require(s_.tile_begin[0] == 0, "tile_begin", 0, "not zero");
    for (std::uint32_t p = 0; p < patches_; ++p) {
      const std::uint64_t begin = s_.tile_begin[p], end = s_.tile_begin[p + 1];
      std::uint64_t levels = 1;
      while (begin < end && s_.valence(p) * levels * levels < end - begin) ++levels;
      require(begin < end && s_.valence(p) * levels * levels == end - begin, "tile_begin", p + 1,
              "not as many tiles as a patch has");
    }
    require_size(s_.tile.size(), kTileUints * std::size_t{s_.tile_begin[patches_]}, "tile");
  }

  // Checks the hierarchy as it is built, parents before their children, so that nothing is cyclic.
  // It reaches as many nodes and patches as there are children, so that it reaches all of them if
  // it reaches none twice.
  void check_hierarchy() const {
    std::vector<std::uint8_t> level(patches_ - 1, 0), reached(patches_, 0);
    if (!level.empty()) level[0] = 1;
    for (std::size_t i = 0; i < s_.child.size(); ++i) {
      const std::uint32_t child = s_.child[i];
      const std::size_t parent = i / 2;
      require(level[parent] != 0 && level[parent] < kHierarchyDepth, "child", i,
              "its node is not reached, or too deep");
      if (child & kNodeLeaf) {
        const std::uint32_t patch = child & ~kNodeLeaf;
        require(patch < patches_ && reached[patch]++ == 0, "child", i,
                "a patch out of range or reached twice");
      } else {
        require(child > parent && child < level.size() && level[child] == 0, "child", i,
                "a node out of range, reached twice or before its parent");
        level[child] = static_cast<std::uint8_t>(level[parent] + 1);
      }
    }
  }

  using Vec = Eigen::Vector3d;
  static bool is_direction(const Real* at) {
    const double length = vector_at(at).norm();
    return length >= 0.5 && length <= 2;
  }
  struct Range {
    Vec low, high;
    bool holds(const Vec& a, const Vec& b, double slack) const {
      return (low.array() <= a.array() + slack).all() && (high.array() >= b.array() - slack).all();
    }
  };
  Range node_box(std::size_t child) const {
    return {vector_at(&s_.node[6 * child]), vector_at(&s_.node[6 * child + 3])};
  }

  // Boxes hold those beneath them, and the polygons.
  void check_boxes() const {
    std::vector<Range> around(patches_ - 1,
                              Range{Vec::Constant(-kFarthest), Vec::Constant(kFarthest)});
    std::vector<std::uint32_t> leaf(patches_, kNone);
    for (std::size_t i = 0; i < s_.child.size(); ++i) {
      const Range box = node_box(i);
      require((box.low.array() <= box.high.array()).all(), "node", 6 * i,
              "a box whose low corner is beyond the high one");
      require(around[i / 2].holds(box.low, box.high, 0), "node", 6 * i,
              "a box out of that of its parent");
      const std::uint32_t child = s_.child[i];
      if (child & kNodeLeaf) {
        leaf[child & ~kNodeLeaf] = static_cast<std::uint32_t>(i);
      } else {
        around[child] = box;
      }
    }
    for (std::uint32_t p = 0; p < patches_; ++p) {
      const Real* numbers = &s_.patch[p * kPatchReals];
      const Vec origin = vector_at(numbers + kPatchOrigin),
                normal = vector_at(numbers + kPatchNormal),
                tangent = vector_at(numbers + kPatchTangent);
      const double unscale = static_cast<double>(numbers[kPatchUnscale]);
      const Range own{vector_at(numbers + kPatchLow), vector_at(numbers + kPatchHigh)};
      const auto require_within = [&](const Vec& local) {
        const Vec x = origin + unscale * local;
        const Vec along(local.dot(tangent), local.dot(normal.cross(tangent)), local.dot(normal));
        require(own.holds(along, along, kSlack * (1 + local.norm())), "patch", p,
                "its box does not hold its polygon");
        require(patches_ == 1 || node_box(leaf[p]).holds(x, x, kSlack * unscale + kSlack / 64),
                "node", 6 * std::size_t{leaf[p]}, "a box that does not hold its polygon");
      };
      for (std::size_t side = s_.side_begin[p]; side < s_.side_begin[p + 1]; ++side) {
        const auto start = start_of(s_, static_cast<std::uint32_t>(side));
        require((start.array().abs() <= kFarthestCorner).all(), "corner", 6 * side,
                "a corner that is not in the mesh");
        require(is_direction(&s_.corner[6 * side + 3]), "corner", 6 * side + 3,
                "a normal that is not a unit vector");
        require_within(vector_at(&s_.corner[6 * side]));
      }
      const std::uint32_t* piece = &s_.triangle[3 * (s_.side_begin[p] - 2 * std::size_t{p})];
      for (std::uint32_t k = 0; (piece[0] & kFanPiece) != 0 && k < 3; ++k)
        require_within((start_of(s_, piece[1] + 3 * piece_corner(piece, k)) - origin) / unscale);
    }
  }

  // All empty, or of parts that meet.
  void check_parts() const {
    const std::size_t parts = s_.part_table.size() / kPartUints;
    require_size(s_.part.size(), s_.partner.empty() ? 0 : patches_, "part");
    require_size(s_.part_table.size(), s_.partner.empty() ? 0 : parts * kPartUints, "part_table");
    require_size(s_.part_box.size(), 6 * parts, "part_box");
    for (std::size_t p = 0; p < s_.part.size(); ++p)
      require((s_.part[p] & kPartMask) < parts, "part", p, "out of range");
    for (std::size_t p = 0; p < s_.partner.size(); ++p)
      require(s_.partner[p] < parts, "partner", p, "out of range");
    for (std::size_t p = 0; p < parts; ++p) {
      const std::uint32_t* table = &s_.part_table[p * kPartUints];
      require(table[0] <= table[1] && table[1] <= s_.partner.size(), "part_table", p,
              "its partners are out of range");
      require(table[2] < patches_ && (s_.part[table[2]] & kPartMask) == p, "part_table", p,
              "its first patch is another part's");
    }
  }

  void check_numbers() const {
    const auto require_within = [&]<class T>(const auto& numbers, T most, const char* section) {
      if (all_within(numbers, most)) return;
      for (std::size_t i = 0;; ++i) {
        require(std::abs(numbers[i]) <= most, section, i,
                std::isfinite(numbers[i]) ? "too large" : "not finite");
      }
    };
    const Real most = static_cast<Real>(kFarthest);
    require_within(s_.domain, most, "domain");
    require_within(s_.control, most, "control");
    require_within(s_.corner, most, "corner");
    require_within(s_.node, most, "node");
    require_within(s_.part_box, most, "part_box");
    require_within(c_.rho_min, std::numeric_limits<double>::max(), "rho_min");
    require_within(s_.patch, std::numeric_limits<Real>::max(), "patch");
    for (std::size_t i = 0; i < s_.patch.size(); ++i) {
      const std::size_t at = i % kPatchReals;
      require(at == kPatchScale || at == kPatchUnscale || std::abs(s_.patch[i]) <= most, "patch", i,
              "too large");
    }
  }

  const PatchCache& c_;
  const Surface<Real>& s_;
  const std::string& source_;
  const std::size_t patches_, sides_, faces_;
};

}  // namespace

void check_cache(const PatchCache& cache, const std::string& source) {
  std::visit([&]<class Real>(const Surface<Real>& s) { Check<Real>(cache, s, source).run(); },
             cache.surface);
}

}  // namespace gliss
