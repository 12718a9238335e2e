// Shapes that are known exactly, as meshes of four kinds. All vertices lie on the exact surface and
// have its normals.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "gliss/generate/generate.h"

namespace gliss::rivals {

struct Shape {
  std::string name;
  std::shared_ptr<const ExactSurface> exact;
  std::function<Mesh(int faces)> triangles, quads;  // about so many
};

enum class Kind { kTriangles, kRandomTriangles, kQuads, kPolygons };

std::vector<Shape> shapes();  // a sphere first
Generated made(const Shape& shape, Kind kind, int faces, std::uint64_t seed);

}  // namespace gliss::rivals
