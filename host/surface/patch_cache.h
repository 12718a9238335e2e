// The prebuilt surface: patches, base polygons, hierarchy, and what is known of each patch.
// Everything that evaluates, projects, sweeps or runs the device loop reads one of these.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <variant>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/base/vector.h"
#include "gliss/surface/surface.h"

namespace gliss {

class WindingTree;

enum class Precision { kFloat, kDouble };

// The rules by which patches are made from polygons and vertex normals.
enum class Construction : std::uint32_t {
  kPaper,  // Wu et al., eq. 2 to 14
  kFair,   // triangles and quads as Gregory patches that bend little, on irregular meshes too
           // (docs/method.md, The fair construction); blends of curved ribbons for faces of 5 to 31
           // sides, the paper's patch beyond
};

// The surface that stands for the construction's: a trade of accuracy for speed and memory. All but
// tables keep G1, with the boundary curves and boundary normals of the exact patch. Triangles and
// quads of the fair construction are polynomials at every level but that of tables.
struct Level {
  enum Kind : std::uint32_t {
    kExact,   // the construction's own equations
    kRibbon,  // cross tangents as polynomials that have the exact ones' ends, slopes and middles
    kBezier,  // Gregory quads and triangles; ribbons for faces of more sides
    kTable    // samples with bicubic interpolation: G1 but for a gap
  };
  Kind kind = kExact;
  std::uint32_t cells = 0;  // of a table, along half a side; else 0
  Construction construction = Construction::kFair;

  bool operator==(const Level&) const = default;
};
inline constexpr std::uint32_t kTableCells = 4, kMostTableCells = 64;  // usual, at most

// Tells how the patch of a face was made.
enum class PatchKind : std::uint8_t {
  kPlain,  // as the construction makes it
  kEased,  // folded: tamer cross tangents; boundary curves and normals as they were
  kSplit,  // folded: its face is cut into triangles, each a patch; boundary curves and normals as
           // they were
  kBent,   // folded or degenerate beyond that: boundary curves as they were, boundary normals not
};

// A patch's largest distance from its polygon, and the room that it has there: the way from the
// middle of the polygon, along its normal or against it, to the next one that lies across, through
// the solid or a gap. Lengths in the mesh's unit.
struct Departure {
  double distance = 0;                                    // of its farthest sample
  double room = std::numeric_limits<double>::infinity();  // infinity: there is no other
  std::uint32_t face = 0;

  double share() const { return distance / room; }
  bool operator==(const Departure&) const = default;
};

// The share of the room beyond which a surface is no longer faithful: the commands warn.
inline constexpr double kFaithful = 1.0 / 3;

// Invariants: every index in range, every number finite, hierarchy a binary tree over all patches.
// A patch is a face of the mesh, in the order of faces, except that a split face has a patch for
// each of its triangles. A cache that was moved from has no patches: patch_count() is 0, and all
// that needs some throws std::invalid_argument. Any number of threads may read one that none
// changes.
struct GLISS_EXPORT PatchCache {
  double unit = 1.0;           // metres per unit of the mesh
  Vec3 origin = Vec3::Zero();  // of the mesh frame, in the mesh's unit
  double scale = 1.0;          // mesh-frame length of one unit: a power of two
  Level level{};
  std::uint32_t mesh_face_count = 0;
  std::uint32_t crease_count = 0;  // edges of the mesh that are creases (mesh/creases.h)
  std::uint64_t mesh_hash = 0;     // XXH3 of the mesh's arrays and unit
  // The largest distance, and the largest share of the room, of those that are beyond kFaithful:
  // the same where none is.
  Departure departure{}, tightest{};
  std::variant<Surface<float>, Surface<double>> surface;
  LargeArray<std::uint32_t> patch_face;  // [patch]
  // [face], its first patch; kNone: not built. Empty in a cache of some faces of many
  // (BuildOptions::like). first_patch reads it.
  LargeArray<std::uint32_t> face_patch;
  LargeArray<PatchKind> kind;       // [patch]
  LargeArray<std::uint8_t> folded;  // [patch], 1: the exact patch folds or degenerates
  LargeArray<double> rho_min;       // [patch], least radius of curvature, mesh's unit
  // [side], which corner of its face it starts at; valence: the centre.
  LargeArray<std::uint32_t> corner_of_face;
  SharedArray<std::uint32_t> face_valence;  // [face]
  // [face], 1: its part, the faces that edges join to it, has an open border; empty: no part has
  // one. Not in files: find_open_parts makes it.
  SharedArray<std::uint8_t> open;
  // Null where normals say what is inside (find_folds). Not in files: find_folds makes it.
  std::shared_ptr<const WindingTree> winding;

  Precision precision() const {
    return surface.index() == 0 ? Precision::kFloat : Precision::kDouble;
  }
  std::uint32_t patch_count() const { return static_cast<std::uint32_t>(patch_face.size()); }
  // The first patch of a face; kNone: not built.
  std::uint32_t first_patch(std::uint32_t face) const {
    if (!face_patch.empty()) return face_patch[face];
    const auto at = std::lower_bound(patch_face.begin(), patch_face.end(), face);
    const bool is_built = at != patch_face.end() && *at == face;
    return is_built ? static_cast<std::uint32_t>(at - patch_face.begin()) : kNone;
  }
  // The end of a face's patches, of which this is one; kNone stays what it is.
  std::uint32_t end_of_face(std::uint32_t patch) const {
    if (patch == kNone) return kNone;
    const std::uint32_t face = patch_face[patch];
    while (patch < patch_count() && patch_face[patch] == face) ++patch;
    return patch;
  }
  // True if the patch's part has no open border: where it is nearest, its normal says what is
  // inside.
  bool is_closed_at(std::uint32_t patch) const { return open.empty() || !open[patch_face[patch]]; }
  double smallest_rho() const;
  // The box of all corners, mesh's unit; patches bulge beyond it.
  Box bounds() const;
  std::size_t bytes() const;
};

// Fills `open` of a cache whose other arrays are there.
GLISS_EXPORT void find_open_parts(PatchCache& cache);

// Makes `winding` of a cache whose other arrays are there, where a polygon faces against the normal
// at one of its corners, or patches cross at a wedge of polygons, or a patch folds or is bent:
// there normals do not say what is inside. Null where all parts are open and have large holes.
GLISS_EXPORT void find_folds(PatchCache& cache);

// Throws std::invalid_argument unless the cache has patches.
GLISS_EXPORT void require_patches(const PatchCache& cache);

}  // namespace gliss
