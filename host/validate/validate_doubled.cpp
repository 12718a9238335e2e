// Faces that are there twice, the second time turned over: a sheet on a closed mesh, or a wall
// within one, as between the cells of a volume mesh.
#include <algorithm>

#include "gliss/mesh/mesh_edges.h"
#include "gliss/validate/face_edit.h"
#include "gliss/validate/validate_steps.h"

namespace gliss {
namespace {

bool is_reversed(const Mesh& mesh, std::uint32_t a, std::uint32_t b) {
  const std::uint32_t n = mesh.valence(a);
  if (mesh.valence(b) != n) return false;
  const auto first = mesh.corner_vertex.begin() + mesh.face_begin[a],
             other = mesh.corner_vertex.begin() + mesh.face_begin[b];
  const auto start = static_cast<std::uint32_t>(std::find(other, other + n, *first) - other);
  for (std::uint32_t k = 0; k < n; ++k) {
    if (start == n || first[k] != other[(start + n - k) % n]) return false;
  }
  return true;
}

class DoubledFaces {
 public:
  DoubledFaces(Mesh& mesh, Report& report)
      : mesh_(mesh), report_(report), twin_(mesh.face_count(), kNone) {}

  void remove() {
    if (!find_pairs()) return;
    const std::vector<std::uint32_t> side_face = side_faces(mesh_);
    DisjointSets clusters(mesh_.face_count());  // of pairs, by their first faces
    std::vector<char> closes(mesh_.face_count(), 1), parts(closes), bounds(closes.size(), 0);
    for (const bool judges : {false, true}) {
      for_each_edge(mesh_, side_face, [&](const Edge& edge) {
        report_.poll();
        std::size_t pairs = 0;
        std::uint32_t pair = kNone;
        for (const std::uint32_t side : edge.sides) {
          const std::uint32_t face = side_face[side];
          if (twin_[face] == kNone || twin_[face] < face) continue;
          if (!judges && pair != kNone) clusters.unite(pair, face);
          pair = face;
          ++pairs;
        }
        if (pair == kNone || !judges) return;
        const std::size_t others = edge.sides.size() - 2 * pairs;
        const std::uint32_t cluster = clusters.find(pair);
        closes[cluster] = closes[cluster] && others + pairs == 2;
        parts[cluster] = parts[cluster] && (others == 0 || others == 2);
        bounds[cluster] = bounds[cluster] || others > 0;
      });
    }
    FaceEdit edit(mesh_, report_);
    for (std::uint32_t face = 0; face < twin_.size(); ++face) {
      if (twin_[face] == kNone || twin_[face] < face) continue;
      const std::uint32_t cluster = clusters.find(face);
      if (closes[cluster]) {
        report_.add(report_.mended, "doubled-face", {.face = twin_[face]},
                    "is face {} turned over, and removed: the mesh is closed without it",
                    report_.number_of(face));
        edit.replace(twin_[face], {});
      } else if (parts[cluster] && bounds[cluster]) {
        report_.add(report_.mended, "doubled-face", {.face = twin_[face]},
                    "is face {} turned over, a wall within the mesh: both are removed",
                    report_.number_of(face));
        edit.replace(face, {});
        edit.replace(twin_[face], {});
      }
    }
    edit.apply();
  }

 private:
  // Fills twin_; false if no face is there turned over.
  bool find_pairs() {
    HashIndex known(mesh_.face_count());
    bool is_any = false;
    for (std::uint32_t face = 0; face < mesh_.face_count(); ++face) {
      report_.poll();
      const std::uint32_t first = known.find_or_insert(
          face, vertex_hash(mesh_, face), [&](std::uint32_t a, std::uint32_t b) {
            return twin_[a] == kNone && is_reversed(mesh_, a, b);
          });
      if (first == face) continue;
      twin_[first] = face;
      twin_[face] = first;
      is_any = true;
    }
    return is_any;
  }

  Mesh& mesh_;
  Report& report_;
  std::vector<std::uint32_t> twin_;  // [face], itself turned over; kNone: there is none
};

}  // namespace

void remove_doubled(Mesh& mesh, Report& report) { DoubledFaces(mesh, report).remove(); }

}  // namespace gliss
