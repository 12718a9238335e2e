// Faces of a mesh near each other.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/mesh/mesh.h"
#include "gliss/mesh/topology.h"

namespace gliss {

// Faces that meet a box (mesh's unit); faces within `rings` edges of the nearest of some; faces
// that share a corner with one of these, and these. Ascending.
GLISS_EXPORT std::vector<std::uint32_t> faces_in_box(const Mesh& mesh, const Box& box);
GLISS_EXPORT std::vector<std::uint32_t> faces_around(const Mesh& mesh, const Topology& topology,
                                                     std::span<const std::uint32_t> faces,
                                                     int rings);
GLISS_EXPORT std::vector<std::uint32_t> faces_touching(const Mesh& mesh, const Topology& topology,
                                                       std::span<const std::uint32_t> faces);

}  // namespace gliss
