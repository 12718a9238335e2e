// The generated meshes that benchmarks run on, and their caches, each made once a process.
#pragma once

#include <string>

#include "gliss/engine/engine.h"
#include "gliss/generate/generate.h"

namespace gliss::bench {

// About how many faces the meshes have: --size=FACES.
inline std::size_t mesh_faces = 1440;

enum class Shape {
  kKnot,       // quads, every vertex of four faces
  kIrregular,  // quads, none of whose faces is regular: three for each triangle of a knot
  kTriangles,  // a triangle knot
  kRandom,     // triangles between random points of the knot
  kPolygons,   // hexagons and 12 pentagons on a sphere
  kDense       // the knot of 1,440 quads as 46,080 triangles, for closest points on triangles
};

// The level whose benchmarks are called "exact".
inline constexpr Level kPapers{.construction = Construction::kPaper};

// Quads along and around the knot of `mesh_faces` quads.
struct KnotGrid {
  int along, around;
};
KnotGrid knot_grid(std::size_t faces);

const Mesh& mesh_of(Shape shape);
// The shape whose faces have n sides, 3 to 6.
Shape shape_of(std::uint32_t n);
const PatchCache& cache_of(Shape shape, Precision precision, const Level& level = kPapers);
// One of each number of threads.
const Engine& engine_of(int threads);

// Largest extent, mesh's unit: what offsets and steps are relative to.
double size_of(const PatchCache& cache);

// "path/level/precision/n/tbb/threads"
std::string work_name(const std::string& path, const Level& level, Precision precision,
                      std::uint32_t n, int threads);

}  // namespace gliss::bench
