// Faces one by one: repeated corners, number of sides, duplicates, and sides or areas of nothing.
#include <algorithm>

#include "gliss/mesh/mesh_edges.h"
#include "gliss/mesh/topology.h"
#include "gliss/validate/face_edit.h"
#include "gliss/validate/validate_steps.h"

namespace gliss {

namespace {

void remove_repeated_corners(Mesh& mesh, Report& report) {
  FaceEdit edit(mesh, report);
  Polygon kept;
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    report.poll();
    kept.clear();
    const std::uint32_t begin = mesh.face_begin[face], end = mesh.face_begin[face + 1];
    const auto is_first = [&](std::uint32_t vertex) { return vertex == mesh.corner_vertex[begin]; };
    for (std::uint32_t c = begin; c < end; ++c) {
      const std::uint32_t vertex = mesh.corner_vertex[c];
      // One corner of a face that names no other vertex stays.
      const bool stays = vertex != mesh.corner_vertex[prev_corner(mesh, face, c)] ||
                         (c == begin && std::all_of(&mesh.corner_vertex[begin],
                                                    &mesh.corner_vertex[0] + end, is_first));
      if (stays) {
        kept.push_back(corner_of(mesh, c));
        continue;
      }
      report.add(Severity::kRepaired, "repeated-corner", {.face = face, .vertex = vertex},
                 "vertex {} follows itself and is kept once", vertex);
    }
    if (kept.size() < mesh.valence(face)) edit.replace(face, {kept});
  }
  edit.apply();
}

// Also finds b c a for a b c; a face turned over is another one.
bool same_cycle(const Mesh& mesh, std::uint32_t a, std::uint32_t b) {
  if (mesh.valence(a) != mesh.valence(b) || mesh.valence(a) == 0) return false;
  const auto first = mesh.corner_vertex.begin() + mesh.face_begin[a];
  const auto last = mesh.corner_vertex.begin() + mesh.face_begin[a + 1];
  const auto other = mesh.corner_vertex.begin() + mesh.face_begin[b];
  const auto other_end = mesh.corner_vertex.begin() + mesh.face_begin[b + 1];
  const auto start = std::find(other, other_end, *first);  // the only start where all are distinct
  return std::equal(start, other_end, first) &&
         std::equal(other, start, first + (other_end - start), last);
}

void remove_duplicates(Mesh& mesh, Report& report) {
  HashIndex known(mesh.face_count());
  FaceEdit edit(mesh, report);
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    report.poll();
    const std::uint32_t first = known.find_or_insert(
        face, vertex_hash(mesh, face),
        [&](std::uint32_t a, std::uint32_t b) { return same_cycle(mesh, a, b); });
    if (first == face) continue;
    report.add(Severity::kRepaired, "duplicate-face", {.face = face},
               "is face {} again and removed", report.number_of(first));
    edit.replace(face, {});
  }
  edit.apply();
}

}  // namespace

void repair_faces(Mesh& mesh, Report& report) {
  remove_repeated_corners(mesh, report);
  remove_duplicates(mesh, report);
}

void refuse_faces(Mesh& mesh, Report& report) {
  FaceEdit edit(mesh, report);
  std::vector<std::uint32_t> sorted;
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    report.poll();
    sorted.assign(mesh.corner_vertex.begin() + mesh.face_begin[face],
                  mesh.corner_vertex.begin() + mesh.face_begin[face + 1]);
    std::sort(sorted.begin(), sorted.end());
    const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
    const auto distinct = std::unique(sorted.begin(), sorted.end()) - sorted.begin();
    bool is_refused = true;
    if (distinct < 3) {
      report.add(Severity::kError, "too-few-vertices", {.face = face},
                 "only {} distinct vertices, a face needs 3", distinct);
    } else if (mesh.valence(face) > kMaxValence) {
      report.add(Severity::kError, "too-many-sides", {.face = face},
                 "{} sides, at most {} are possible", mesh.valence(face), kMaxValence);
    } else if (twice != sorted.end() && distinct < mesh.valence(face)) {
      report.add(Severity::kError, "self-touching-face", {.face = face, .vertex = *twice},
                 "comes back to vertex {}; export it with its faces cut into triangles", *twice);
    } else {
      is_refused = false;
    }
    if (is_refused) edit.replace(face, {});
  }
  edit.apply();
}

double side_length(const Mesh& mesh, std::uint32_t face, std::uint32_t side) {
  return (mesh.positions[mesh.corner_vertex[next_corner(mesh, face, side)]] -
          mesh.positions[mesh.corner_vertex[side]])
      .norm();
}

bool has_no_area(const Mesh& mesh, std::uint32_t face) {
  constexpr double kLine = 1e-13;  // area against squared girth where nothing but rounding is left
  double girth = 0;
  for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c)
    girth += side_length(mesh, face, c);
  return !(newell_normal(mesh, face).norm() > kLine * girth * girth);
}

void check_sizes(const Mesh& mesh, Report& report) {
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    report.poll();
    bool zero_side = false;
    for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c) {
      const std::uint32_t from = mesh.corner_vertex[c];
      const std::uint32_t to = mesh.corner_vertex[next_corner(mesh, face, c)];
      if (side_length(mesh, face, c) > 0) continue;
      zero_side = true;
      report.add(Severity::kError, "zero-length-side", {.face = face, .vertex = from},
                 "the side from vertex {} to {} has no length", from, to);
    }
    if (!zero_side && has_no_area(mesh, face))
      report.add(Severity::kError, "zero-area-face", {.face = face}, "has no area");
  }
}

}  // namespace gliss
