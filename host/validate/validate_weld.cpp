// Seams: borders whose vertices lie at the same places as those of other borders.
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "gliss/base/hash_index.h"
#include "gliss/mesh/mesh_edges.h"
#include "gliss/validate/validate_steps.h"

namespace gliss {
namespace {

// Groups vertices that are no farther apart than `most`, or linked by others that are: [vertex],
// the first of its group. Those that are not `wanted` stay alone.
std::vector<std::uint32_t> find_places(const Mesh& mesh, const std::vector<bool>& wanted,
                                       double most, Report& report) {
  DisjointSets sets(mesh.positions.size());
  // Cells as wide as `most`; where that is 0, a cell for each place.
  const auto cell_of = [&](const Vec3& p, const Eigen::Vector3i& step) -> Vec3 {
    if (most == 0) return p;
    return (p / most).array().floor().matrix() + step.cast<double>();
  };
  std::unordered_multimap<std::uint64_t, std::uint32_t> seen;
  const int reach = most > 0 ? 1 : 0;
  for (std::uint32_t v = 0; v < wanted.size(); ++v) {
    report.poll();
    if (!wanted[v]) continue;
    const Vec3& p = mesh.positions[v];
    for (int i = -reach; i <= reach; ++i) {
      for (int j = -reach; j <= reach; ++j) {
        for (int k = -reach; k <= reach; ++k) {
          const auto [first, last] = seen.equal_range(mix_bits(cell_of(p, {i, j, k})));
          for (auto it = first; it != last; ++it) {
            if ((mesh.positions[it->second] - p).norm() > most) continue;
            sets.unite(it->second, v);
            if (most == 0) break;  // all others there are of one group
          }
        }
      }
    }
    seen.emplace(mix_bits(cell_of(p, {0, 0, 0})), v);
  }
  std::vector<std::uint32_t> place(wanted.size());
  for (std::uint32_t v = 0; v < place.size(); ++v) place[v] = sets.find(v);
  return place;
}

// A border side between two places.
struct BorderSide {
  std::uint32_t low, high;  // places, ascending
  std::uint32_t side;

  bool is_beside(const BorderSide& b) const { return low == b.low && high == b.high; }
  auto operator<=>(const BorderSide&) const = default;
};

// True if two faces have their corners at the same places: the two sides of one sheet.
bool have_one_place(const Mesh& mesh, const std::vector<std::uint32_t>& place, std::uint32_t a,
                    std::uint32_t b) {
  const auto places = [&](std::uint32_t face) {
    std::vector<std::uint32_t> all;
    for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c)
      all.push_back(place[mesh.corner_vertex[c]]);
    std::sort(all.begin(), all.end());
    return all;
  };
  return mesh.valence(a) == mesh.valence(b) && places(a) == places(b);
}

}  // namespace

void weld_borders(Mesh& mesh, double most, std::vector<bool>& joined, Report& report) {
  if (!(most >= 0)) return;
  const std::vector<std::uint32_t> side_face = side_faces(mesh);
  const auto end_of = [&](std::uint32_t side) {
    return mesh.corner_vertex[next_corner(mesh, side_face[side], side)];
  };
  std::vector<std::uint32_t> border;
  std::vector<bool> is_at_border(mesh.positions.size(), false);
  for_each_edge(mesh, side_face, [&](const Edge& edge) {
    report.poll();
    if (edge.sides.size() != 1) return;
    border.push_back(edge.sides[0]);
    is_at_border[edge.lower] = is_at_border[edge.upper] = true;
  });
  const std::vector<std::uint32_t> place = find_places(mesh, is_at_border, most, report);
  std::vector<BorderSide> sides;
  for (const std::uint32_t side : border) {
    const auto [low, high] = std::minmax(place[mesh.corner_vertex[side]], place[end_of(side)]);
    if (low != high) sides.push_back({low, high, side});
  }
  std::sort(sides.begin(), sides.end());
  DisjointSets vertices(mesh.positions.size());
  const auto weld = [&](std::uint32_t a, std::uint32_t b) {
    const bool same_way = place[mesh.corner_vertex[a]] == place[mesh.corner_vertex[b]];
    vertices.unite(mesh.corner_vertex[a], same_way ? mesh.corner_vertex[b] : end_of(b));
    vertices.unite(end_of(a), same_way ? end_of(b) : mesh.corner_vertex[b]);
  };
  for (std::size_t i = 0, next = 0; i < sides.size(); i = next) {
    report.poll();
    while (next < sides.size() && sides[next].is_beside(sides[i])) ++next;
    if (next - i != 2) continue;  // of three and more nobody knows which two are one edge
    const std::uint32_t a = sides[i].side, b = sides[i + 1].side;
    if (!have_one_place(mesh, place, side_face[a], side_face[b])) weld(a, b);
  }
  for (std::uint32_t& vertex : mesh.corner_vertex) {
    const std::uint32_t first = vertices.find(vertex);
    if (first == vertex) continue;
    if (!joined[vertex]) {
      report.add(Severity::kRepaired, "welded-vertices", {.vertex = vertex},
                 "is where vertex {} is, and one with it now: that closes a border", first);
      joined[vertex] = true;
    }
    vertex = first;
  }
}

}  // namespace gliss
