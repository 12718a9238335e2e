// Faces one by one: repeated corners, number of sides, duplicates, and sides or areas of nothing.
#include <algorithm>
#include <numeric>

#include "gliss/base/hash_index.h"
#include "gliss/mesh/mesh_edges.h"
#include "gliss/mesh/topology.h"
#include "gliss/validate/validate_steps.h"

namespace gliss {

void remove(Mesh& mesh, const std::vector<bool>& corners, const std::vector<bool>& faces,
            Report& report) {
  const std::size_t face_count = mesh.face_count();
  if (report.file_face.empty()) {
    report.file_face.resize(face_count);
    std::iota(report.file_face.begin(), report.file_face.end(), 0u);
  }
  std::uint32_t corner_to = 0;
  std::uint32_t face_to = 0;
  std::uint32_t c = 0;
  for (std::size_t face = 0; face < face_count; ++face) {
    report.poll();
    for (const std::uint32_t end = mesh.face_begin[face + 1]; c < end; ++c) {
      if (faces[face] || corners[c]) continue;
      mesh.corner_vertex[corner_to] = mesh.corner_vertex[c];
      if (!mesh.corner_normal.empty()) mesh.corner_normal[corner_to] = mesh.corner_normal[c];
      ++corner_to;
    }
    if (faces[face]) continue;
    if (!mesh.face_line.empty()) mesh.face_line[face_to] = mesh.face_line[face];
    if (!mesh.face_group.empty()) mesh.face_group[face_to] = mesh.face_group[face];
    report.file_face[face_to] = report.file_face[face];
    mesh.face_begin[++face_to] = corner_to;
  }
  mesh.face_begin.resize(face_to + 1);
  mesh.corner_vertex.resize(corner_to);
  if (!mesh.corner_normal.empty()) mesh.corner_normal.resize(corner_to);
  if (!mesh.face_line.empty()) mesh.face_line.resize(face_to);
  if (!mesh.face_group.empty()) mesh.face_group.resize(face_to);
  report.file_face.resize(face_to);
}

namespace {

void remove_repeated_corners(Mesh& mesh, Report& report) {
  std::vector<bool> repeated(mesh.corner_vertex.size(), false);
  bool any = false;
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    report.poll();
    const std::uint32_t begin = mesh.face_begin[face], end = mesh.face_begin[face + 1];
    const auto is_first = [&](std::uint32_t vertex) { return vertex == mesh.corner_vertex[begin]; };
    for (std::uint32_t c = begin; c < end; ++c) {
      const std::uint32_t vertex = mesh.corner_vertex[c];
      if (vertex != mesh.corner_vertex[prev_corner(mesh, face, c)]) continue;
      if (c == begin &&
          std::all_of(&mesh.corner_vertex[begin], &mesh.corner_vertex[0] + end, is_first))
        continue;  // one corner of a face that names no other vertex stays
      report.add(Severity::kRepaired, "repeated-corner", {.face = face, .vertex = vertex},
                 "vertex {} follows itself and is kept once", vertex);
      repeated[c] = any = true;
    }
  }
  if (any) remove(mesh, repeated, std::vector<bool>(mesh.face_count(), false), report);
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
  std::vector<bool> duplicate(mesh.face_count(), false);
  bool any = false;
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    report.poll();
    std::uint64_t hash = 0;  // a sum, so that it does not matter where the cycle starts
    for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c) {
      hash += mix_bits(mesh.corner_vertex[c] + 1);
    }
    const std::uint32_t first = known.find_or_insert(
        face, hash, [&](std::uint32_t a, std::uint32_t b) { return same_cycle(mesh, a, b); });
    if (first == face) continue;
    report.add(Severity::kRepaired, "duplicate-face", {.face = face},
               "is face {} again and removed", report.number_of(first));
    duplicate[face] = any = true;
  }
  if (any) remove(mesh, std::vector<bool>(mesh.corner_vertex.size(), false), duplicate, report);
}

}  // namespace

void repair_faces(Mesh& mesh, Report& report) {
  remove_repeated_corners(mesh, report);
  remove_duplicates(mesh, report);
}

void refuse_faces(Mesh& mesh, Report& report) {
  std::vector<bool> refused(mesh.face_count(), false);
  std::vector<std::uint32_t> sorted;
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    report.poll();
    sorted.assign(mesh.corner_vertex.begin() + mesh.face_begin[face],
                  mesh.corner_vertex.begin() + mesh.face_begin[face + 1]);
    std::sort(sorted.begin(), sorted.end());
    const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
    const auto distinct = std::unique(sorted.begin(), sorted.end()) - sorted.begin();
    refused[face] = true;
    if (distinct < 3) {
      report.add(Severity::kError, "too-few-vertices", {.face = face},
                 "only {} distinct vertices, a face needs 3", distinct);
    } else if (mesh.valence(face) > kMaxValence) {
      report.add(Severity::kError, "too-many-sides", {.face = face},
                 "{} sides, at most {} are possible", mesh.valence(face), kMaxValence);
    } else if (twice != sorted.end() && distinct < mesh.valence(face)) {
      report.add(Severity::kError, "self-touching-face", {.face = face, .vertex = *twice},
                 "comes back to vertex {}", *twice);
    } else {
      refused[face] = false;
    }
  }
  if (std::find(refused.begin(), refused.end(), true) != refused.end()) {
    remove(mesh, std::vector<bool>(mesh.corner_vertex.size(), false), refused, report);
  }
}

bool has_no_area(const Mesh& mesh, std::uint32_t face) {
  constexpr double kLine = 1e-13;  // area against squared girth where nothing but rounding is left
  double girth = 0;
  for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c) {
    girth += (mesh.positions[mesh.corner_vertex[next_corner(mesh, face, c)]] -
              mesh.positions[mesh.corner_vertex[c]])
                 .norm();
  }
  return !(newell_normal(mesh, face).norm() > kLine * girth * girth);
}

void check_sizes(const Mesh& mesh, Report& report) {
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    report.poll();
    bool zero_side = false;
    for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c) {
      const std::uint32_t from = mesh.corner_vertex[c];
      const std::uint32_t to = mesh.corner_vertex[next_corner(mesh, face, c)];
      if ((mesh.positions[to] - mesh.positions[from]).norm() > 0) continue;
      zero_side = true;
      report.add(Severity::kError, "zero-length-side", {.face = face, .vertex = from},
                 "the side from vertex {} to {} has no length", from, to);
    }
    if (!zero_side && has_no_area(mesh, face))
      report.add(Severity::kError, "zero-area-face", {.face = face}, "has no area");
  }
}

}  // namespace gliss
