#include "gliss/mesh/regions.h"

#include <algorithm>
#include <unordered_set>

namespace gliss {

std::vector<std::uint32_t> faces_in_box(const Mesh& mesh, const Box& box) {
  std::vector<std::uint32_t> faces;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    if (box_of(mesh, f).meets(box)) faces.push_back(f);
  }
  return faces;
}

std::vector<std::uint32_t> faces_around(const Mesh& mesh, const Topology& topology,
                                        std::span<const std::uint32_t> faces, int rings) {
  std::vector<std::uint32_t> found, front;
  std::unordered_set<std::uint32_t> seen;  // no walk through all faces of the mesh
  for (const std::uint32_t f : faces) {
    if (seen.insert(f).second) front.push_back(f);
  }
  found = front;
  for (int r = 0; r < rings; ++r) {
    std::vector<std::uint32_t> next;
    for (const std::uint32_t f : front) {
      for (std::uint32_t s = mesh.face_begin[f]; s < mesh.face_begin[f + 1]; ++s) {
        const std::uint32_t twin = topology.side_twin[s];
        if (twin != kNone && seen.insert(topology.side_face[twin]).second)
          next.push_back(topology.side_face[twin]);
      }
    }
    found.insert(found.end(), next.begin(), next.end());
    front = std::move(next);
  }
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<std::uint32_t> faces_touching(const Mesh& mesh, const Topology& topology,
                                          std::span<const std::uint32_t> faces) {
  std::vector<std::uint32_t> found(faces.begin(), faces.end());
  for (const std::uint32_t f : faces) {
    for (std::uint32_t s = mesh.face_begin[f]; s < mesh.face_begin[f + 1]; ++s) {
      // Round the corner one way, and from a border the other way.
      std::uint32_t at = next_around(mesh, topology, s);
      for (; at != kNone && at != s; at = next_around(mesh, topology, at))
        found.push_back(topology.side_face[at]);
      if (at == s) continue;
      for (at = topology.side_twin[s]; at != kNone; at = topology.side_twin[at]) {
        found.push_back(topology.side_face[at]);
        at = next_side(mesh, topology, at);
      }
    }
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

}  // namespace gliss
