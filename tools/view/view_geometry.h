// An object as gliss view draws it: its smooth surface as triangles, and its polygons.
#pragma once

#include <string>

#include "gliss/contact/tracker.h"

namespace gliss::tools {

// Triangles of all surfaces together, at most; but each face has those between its corners.
inline constexpr std::size_t kViewTriangles = 60'000;

// Packs an object as a message of the socket, little-endian, in metres of the world: eight 32-bit
// numbers, which are kGeometryMark, `number`, and the numbers of points, triangles, edges of
// polygons, triangles of polygons, faces and sides; then
//   points: position (3 floats), normal (3 signed bytes of 1/127) and the kind of the patch
//     (PatchKind, a byte; 4: exact beside a crease), height over the polygon's plane (float, m),
//     face (32 bits)
//   triangles: 3 points (32 bits); edges: 2 places (6 floats); polygons' triangles: 9 floats
//   faces: largest curvature (float, 1/m), first side (32 bits); sides: the face across it (32
//     bits, 0xffffffff: a border)
// in arrays of their own, in this order. The object has a cache.
inline constexpr std::uint32_t kGeometryMark = 0x47464c47;  // "GLFG"
std::string geometry_of(const SceneObject& object, std::uint32_t number, std::size_t triangles);

}  // namespace gliss::tools
