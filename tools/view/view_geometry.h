// An object as gliss view draws it: its smooth surface as triangles, and its polygons.
#pragma once

#include <string>

#include "gliss/contact/tracker.h"

namespace gliss::tools {

// Triangles of all surfaces together, at most; each face has one for each side at least.
inline constexpr std::size_t kViewTriangles = 60'000;

// Packs an object as a message of the socket, little-endian, in metres of the world: eight 32-bit
// numbers, which are kGeometryMark, `number`, and the numbers of points, triangles, edges of
// polygons and triangles of polygons, and 0, 0; then
//   points: position (3 floats), normal (3 signed bytes of 1/127) and the kind of the patch
//     (PatchKind, a byte), height over the polygon's plane (float, m), face (32 bits)
//   triangles: 3 points (32 bits); edges: 2 places (6 floats); polygons' triangles: 9 floats
// in arrays of their own, in this order. The object has a cache.
inline constexpr std::uint32_t kGeometryMark = 0x47464c47;  // "GLFG"
std::string geometry_of(const SceneObject& object, std::uint32_t number, std::size_t triangles);

}  // namespace gliss::tools
