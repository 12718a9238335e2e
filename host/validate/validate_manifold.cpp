// Around an edge two faces, around a vertex one fan: what is otherwise gets refused, or cut apart.
#include <fmt/ranges.h>

#include <algorithm>
#include <unordered_map>

#include "gliss/mesh/mesh_edges.h"
#include "gliss/validate/validate_steps.h"

namespace gliss {
namespace {

constexpr std::size_t kFewEdges = 100;  // of which a tenth says nothing

struct Fans {
  DisjointSets corners;  // corners of one vertex, joined where their faces share an edge there
  std::vector<std::vector<std::uint32_t>> bad_edges;  // sides of each edge that has too many
};

Fans find_fans(const Mesh& mesh, const std::vector<std::uint32_t>& side_face, Report& report) {
  Fans fans{DisjointSets(side_face.size()), {}};
  const auto corner_at = [&](std::uint32_t side, std::uint32_t vertex) {
    return mesh.corner_vertex[side] == vertex ? side : next_corner(mesh, side_face[side], side);
  };
  for_each_edge(mesh, side_face, [&](const Edge& edge) {
    report.poll();
    if (edge.sides.size() == 2) {
      for (const std::uint32_t vertex : {edge.lower, edge.upper}) {
        fans.corners.unite(corner_at(edge.sides[0], vertex), corner_at(edge.sides[1], vertex));
      }
    } else if (edge.sides.size() > 2) {
      fans.bad_edges.emplace_back(edge.sides.begin(), edge.sides.end());
    }
  });
  std::sort(fans.bad_edges.begin(), fans.bad_edges.end());  // in the order of the file
  return fans;
}

}  // namespace

// An edge with too many faces joins no fan, so each fan has at most two of its sides, the first and
// the last. Giving every fan a vertex of its own therefore leaves edges of one or two faces: two
// cubes that touch along an edge come apart whole.
void repair_manifold(Mesh& mesh, bool split, Report& report) {
  const Severity severity = split ? Severity::kRepaired : Severity::kError;
  const std::vector<std::uint32_t> side_face = side_faces(mesh);
  Fans fans = find_fans(mesh, side_face, report);

  const std::size_t edges = side_face.size() / 2;  // or nearly
  if (10 * fans.bad_edges.size() > edges && edges > kFewEdges)
    report.add(Severity::kWarning, "soup", {.face = side_face[fans.bad_edges[0][0]]},
               "{} of about {} edges have three faces or more: this is a soup of polygons, or the "
               "cells of a volume mesh. Save the outer surface alone",
               fans.bad_edges.size(), edges);
  std::vector<bool> on_bad_edge(mesh.positions.size(), false);
  for (const std::vector<std::uint32_t>& sides : fans.bad_edges) {
    const std::uint32_t from = mesh.corner_vertex[sides[0]];
    const std::uint32_t to = mesh.corner_vertex[next_corner(mesh, side_face[sides[0]], sides[0])];
    on_bad_edge[from] = on_bad_edge[to] = true;
    std::vector<std::uint32_t> faces;
    for (const std::uint32_t side : sides) faces.push_back(report.number_of(side_face[side]));
    report.add(severity, "non-manifold-edge", {.face = side_face[sides[0]], .vertex = from},
               "edge {}-{} is shared by {} faces ({})", from, to, sides.size(),
               fmt::join(faces, ", "));
  }

  std::vector<std::uint32_t> first_fan(mesh.positions.size(), kNone);  // [vertex]
  std::unordered_map<std::uint32_t, std::uint32_t> copy;               // of a vertex, for a fan
  std::vector<bool> named(mesh.positions.size(), false);
  for (std::uint32_t corner = 0; corner < side_face.size(); ++corner) {
    report.poll();
    const std::uint32_t vertex = mesh.corner_vertex[corner];
    const std::uint32_t fan = fans.corners.find(corner);
    if (first_fan[vertex] == kNone) first_fan[vertex] = fan;
    if (first_fan[vertex] == fan) continue;
    if (!on_bad_edge[vertex] && !named[vertex]) {
      named[vertex] = true;
      report.add(severity, "non-manifold-vertex", {.face = side_face[corner], .vertex = vertex},
                 "touches face {} at vertex {} only",
                 report.number_of(side_face[first_fan[vertex]]), vertex);
    }
    if (!split) continue;
    const auto next = static_cast<std::uint32_t>(mesh.positions.size());
    const auto [known, is_new] = copy.try_emplace(fan, next);
    if (is_new) mesh.positions.push_back(Vec3(mesh.positions[vertex]));
    mesh.corner_vertex[corner] = known->second;
  }
}

}  // namespace gliss
