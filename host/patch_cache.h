// The prebuilt surface: patches, base polygons, hierarchy, and what is known of each patch.
// Everything that evaluates, projects, sweeps or runs the device loop reads one of these.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "host/mesh.h"
#include "host/patch_batch.h"
#include "host/surface.h"
#include "host/topology.h"

namespace gliss {

// A cache that cannot be read; what() names the file and the section. `stale`: sound, but of
// another mesh or version.
struct CacheError : std::runtime_error {
  CacheError(const std::string& what, bool stale) : std::runtime_error(what), stale(stale) {}
  bool stale;
};

enum class Precision { kFloat, kDouble };

// Which surface stands for the paper's: a trade of accuracy for speed and memory. All but tables
// keep G1, with the boundary curves and boundary normals of the exact patch.
struct Level {
  enum Kind : std::uint32_t {
    kExact,   // the paper's equations
    kRibbon,  // cross tangents as polynomials that have the exact ones' ends, slopes and middles
    kBezier,  // Gregory quads and triangles; ribbons for faces of more sides
    kTable    // samples with bicubic interpolation: G1 but for a gap
  };
  Kind kind = kExact;
  std::uint32_t cells = 0;  // of a table, along half a side; else 0

  bool operator==(const Level&) const = default;
};
inline constexpr std::uint32_t kTableCells = 4, kMostTableCells = 64;  // usual, at most

struct PatchCache;

// How the patch of a face was made.
enum class PatchKind : std::uint8_t {
  kExact,  // the paper's, eq. 2 to 14
  kEased,  // folded: cross tangents shortened; boundary curves and normals as they were
  kSplit,  // folded: its face is cut into triangles, each a patch; boundary curves and normals as
           // they were
  kBent,   // folded or degenerate beyond that: boundary curves as they were, boundary normals not
};

struct BuildOptions {
  Precision precision = Precision::kDouble;
  Level level{};
  bool tame = true;  // false: folded patches are found and flagged, and kept as they are
  std::vector<std::uint32_t> faces{};  // only these, each once, ascending; empty: all
  // A cache of the same mesh, or none: what it says of the whole mesh (frame, hash, valences) is
  // taken from there, so that a few faces are built without a walk through all of them.
  const PatchCache* like = nullptr;
};

// Axis-aligned box in the mesh's unit.
struct Box {
  Vec3 low, high;
};

// Findings of a build, by face.
struct BuildReport {
  std::uint32_t folded = 0;  // the exact patch's normal turns against its face somewhere
  std::uint32_t degenerate =
      0;  // a ribbon vanishes: an edge parallel to a normal, or opposed end normals
  std::uint32_t eased = 0, split = 0, bent = 0;
  std::vector<std::uint32_t> flagged_faces;  // folded or degenerate, ascending
};

// Invariants: every index in range, every number finite, hierarchy a binary tree over all patches.
// A patch is a face of the mesh, in the order of faces, except that a split face has a patch for
// each of its triangles. A cache that was moved from has no patches: patch_count() is 0, and all
// that needs some throws std::invalid_argument.
struct PatchCache {
  double unit = 1.0;           // metres per unit of the mesh
  Vec3 origin = Vec3::Zero();  // of the mesh frame, in the mesh's unit
  double scale = 1.0;          // mesh-frame length of one unit: a power of two
  Level level{};
  // True if the mesh has no open border: where the nearest point's normal says inside, a HIP is.
  bool is_closed = true;
  std::uint32_t mesh_face_count = 0;
  std::uint64_t mesh_hash = 0;  // XXH3 of the mesh's arrays and unit
  std::variant<Surface<float>, Surface<double>> surface;
  LargeArray<std::uint32_t> patch_face;  // [patch]
  LargeArray<std::uint32_t> face_patch;  // [face], its first patch; kNone: not built
  LargeArray<PatchKind> kind;            // [patch]
  LargeArray<std::uint8_t> folded;       // [patch], 1: the exact patch folds or degenerates
  LargeArray<double> rho_min;            // [patch], least radius of curvature, mesh's unit
  LargeArray<std::uint32_t>
      corner_of_face;  // [side], which corner of its face it starts at; valence: the centre
  LargeArray<std::uint32_t> face_valence;  // [face]

  Precision precision() const {
    return surface.index() == 0 ? Precision::kFloat : Precision::kDouble;
  }
  std::uint32_t patch_count() const { return static_cast<std::uint32_t>(patch_face.size()); }
  double smallest_rho() const;
  // Largest |coordinate| extent, mesh's unit: what "relative to the size" means for a whole mesh.
  Box bounds() const;
  std::size_t bytes() const;
};

// Builds all patches, or those of options.faces. The mesh must be validated; vertex normals are
// made where it has none. Throws MeshError.
PatchCache build_cache(const Mesh& mesh, const BuildOptions& options = {},
                       BuildReport* report = nullptr, const BuildBackend& backend = {});

// The same with a topology made before and vertex normals in the mesh, for builds of many regions.
PatchCache build_cache(const Mesh& mesh, const Topology& topology, const BuildOptions& options,
                       BuildReport* report = nullptr, const BuildBackend& backend = {});

// Base polygons alone, for searches with the flat and shaded methods: no patch is built and none
// may be evaluated.
PatchCache build_base(const Mesh& mesh, const Topology& topology, Precision precision);

// Faces that meet a box; faces within `rings` edges of a face, or of the nearest one of several;
// faces that share a corner with one of these, and these. Ascending.
std::vector<std::uint32_t> faces_in_box(const Mesh& mesh, const Box& box);
std::vector<std::uint32_t> faces_around(const Mesh& mesh, const Topology& topology,
                                        std::uint32_t face, int rings);
std::vector<std::uint32_t> faces_around(const Mesh& mesh, const Topology& topology,
                                        std::span<const std::uint32_t> faces, int rings);
std::vector<std::uint32_t> faces_touching(const Mesh& mesh, const Topology& topology,
                                          std::span<const std::uint32_t> faces);

std::uint64_t hash_of(const Mesh& mesh);

// True if a side of a patch has no neighbour.
bool has_border(const PatchCache& cache);

// Written to a temporary beside `path`, synced and renamed: a reader sees a whole cache or none.
// Throws std::system_error. Reading checks every section's checksum, size, index and number; throws
// CacheError, or NoFileError (host/open_file.h) of what is no regular file. `poll` is asked many
// times a second, and what it throws ends the reading.
void save_cache(const PatchCache& cache, const std::string& path);
PatchCache load_cache(const std::string& path, const std::function<void()>& poll = nullptr);
bool is_cache_file(const std::string& path);

}  // namespace gliss
