// Mends invalid faces: cuts them where they touch themselves, or removes them so that no gap is
// left.
#include <algorithm>

#include "gliss/mesh/mesh_edges.h"
#include "gliss/validate/face_edit.h"
#include "gliss/validate/validate_steps.h"

namespace gliss {
namespace {

// The simple loops of three and more corners that a closed walk is made of.
struct Loops {
  std::vector<Polygon> loops;
  std::uint32_t twice = kNone;  // a vertex that it comes back to
  bool is_keyhole = false;      // two loops and a bridge between them: one is a hole in the other
};

Loops loops_of(const Polygon& walk) {
  Loops found;
  Polygon way;
  bool has_bridge = false;
  const auto close = [&](Polygon loop) {
    if (loop.size() == 2) has_bridge = true;
    if (loop.size() > 2) found.loops.push_back(std::move(loop));
  };
  for (const Corner& corner : walk) {
    const auto known = std::find_if(way.begin(), way.end(),
                                    [&](const Corner& c) { return c.vertex == corner.vertex; });
    if (known == way.end()) {
      way.push_back(corner);
      continue;
    }
    if (way.end() - known > 1) found.twice = corner.vertex;
    close(Polygon(known, way.end()));
    way.erase(known + 1, way.end());
  }
  close(way);
  found.is_keyhole = has_bridge && found.loops.size() > 1;
  return found;
}

void join_ends_of_no_length(Mesh& mesh, std::vector<bool>& joined, Report& report) {
  DisjointSets places(mesh.positions.size());
  bool any = false;
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    report.poll();
    for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c) {
      const std::uint32_t from = mesh.corner_vertex[c],
                          to = mesh.corner_vertex[next_corner(mesh, face, c)];
      if (from == to || side_length(mesh, face, c) > 0) continue;
      report.add(Severity::kRepaired, "zero-length-side", {.face = face, .vertex = from},
                 "the side from vertex {} to {} has no length; they are one now", from, to);
      places.unite(from, to);
      any = true;
    }
  }
  if (!any) return;
  for (std::uint32_t& vertex : mesh.corner_vertex) {
    const std::uint32_t first = places.find(vertex);
    if (first != vertex) joined[vertex] = true;
    vertex = first;
  }
}

// The face with a vertex put into one of its sides; a triangle is cut into two there.
std::vector<Polygon> put_into(const Mesh& mesh, std::uint32_t face, std::uint32_t side,
                              const Corner& corner) {
  Polygon polygon = polygon_of(mesh, face);
  const std::uint32_t after = side - mesh.face_begin[face] + 1;
  polygon.insert(polygon.begin() + after, corner);
  if (polygon.size() != 4) return {polygon};
  const auto at = [&](std::uint32_t i) { return polygon[(after + i) % 4]; };
  return {{at(0), at(1), at(2)}, {at(0), at(2), at(3)}};
}

// The longest of a triangle's sides.
std::uint32_t longest_side(const Mesh& mesh, std::uint32_t face) {
  std::uint32_t longest = mesh.face_begin[face];
  for (const std::uint32_t c : {longest + 1, longest + 2}) {
    if (side_length(mesh, face, c) > side_length(mesh, face, longest)) longest = c;
  }
  return longest;
}

// True if a triangle has a vertex in its longest side, away from the ends of that, but for a
// millionth of it. No patch of such a triangle is smooth.
bool is_cap(const Mesh& mesh, std::uint32_t face) {
  constexpr double kHeight = 1e-6, kEnd = 1e-3;  // of the side
  if (mesh.valence(face) != 3) return false;
  const std::uint32_t longest = longest_side(mesh, face);
  const auto at = [&](std::uint32_t corner) { return mesh.positions[mesh.corner_vertex[corner]]; };
  const Vec3 side = at(next_corner(mesh, face, longest)) - at(longest),
             way = at(prev_corner(mesh, face, longest)) - at(longest);
  const double along = side.dot(way) / side.squaredNorm();
  return along > kEnd && along < 1 - kEnd && (way - along * side).norm() < kHeight * side.norm();
}

// Marks the faces without area and the caps: [face], 1 for such; empty if there are none.
std::vector<char> find_flat(const Mesh& mesh, Report& report) {
  std::vector<char> is_flat;
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    report.poll();
    if (!has_no_area(mesh, face) && !is_cap(mesh, face)) continue;
    is_flat.resize(mesh.face_count());
    is_flat[face] = 1;
  }
  return is_flat;
}

// One pass over the faces without area; those beside a face that has just changed wait for the
// next. Returns true if any is left that may find a neighbour then.
bool flatten_some(Mesh& mesh, const std::vector<char>& is_flat, Report& report) {
  const std::vector<std::uint32_t> side_face = side_faces(mesh),
                                   other = pair_sides(mesh, side_face);
  FaceEdit edit(mesh, report);
  bool waits = false;
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    report.poll();
    if (!is_flat[face] || mesh.valence(face) != 3) continue;
    const std::uint32_t longest = longest_side(mesh, face), beyond = other[longest];
    if (beyond == kNone) continue;
    const std::uint32_t neighbour = side_face[beyond], middle = prev_corner(mesh, face, longest),
                        vertex = mesh.corner_vertex[middle];
    const auto first = mesh.corner_vertex.begin() + mesh.face_begin[neighbour],
               last = mesh.corner_vertex.begin() + mesh.face_begin[neighbour + 1];
    if (std::find(first, last, vertex) != last || mesh.valence(neighbour) >= kMaxValence) continue;
    if (is_flat[neighbour] || edit.is_edited(neighbour)) {
      waits = true;
      continue;
    }
    report.add(Severity::kRepaired, "zero-area-face", {.face = face, .vertex = vertex},
               "has no area{}; removed, and its vertex {} joins face {}",
               has_no_area(mesh, face) ? "" : " but for rounding", vertex,
               report.number_of(neighbour));
    const Corner corner = corner_of(mesh, middle);
    edit.replace(neighbour, put_into(mesh, neighbour, beyond, corner));
    edit.replace(face, {});
  }
  return edit.apply() && waits;
}

// True if a face has three sides or a few more and names no vertex twice, which is quickly told.
bool names_each_once(const Mesh& mesh, std::uint32_t face) {
  constexpr std::uint32_t kFew = 8;
  const std::uint32_t begin = mesh.face_begin[face], end = mesh.face_begin[face + 1];
  if (end - begin < 3 || end - begin > kFew) return false;
  for (std::uint32_t a = begin; a < end; ++a) {
    for (std::uint32_t b = a + 1; b < end; ++b) {
      if (mesh.corner_vertex[a] == mesh.corner_vertex[b]) return false;
    }
  }
  return true;
}

}  // namespace

void mend_faces(Mesh& mesh, std::vector<bool>& joined, Report& report) {
  join_ends_of_no_length(mesh, joined, report);
  FaceEdit edit(mesh, report);
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    report.poll();
    if (names_each_once(mesh, face)) continue;
    const Polygon polygon = polygon_of(mesh, face);
    if (polygon.size() > kMaxValence) continue;
    Loops found = loops_of(polygon);
    if (found.is_keyhole || (found.loops.size() == 1 && found.loops[0].size() == polygon.size()))
      continue;
    if (found.loops.empty()) {
      report.add(Severity::kRepaired, "too-few-vertices", {.face = face},
                 "fewer than 3 distinct vertices on a loop; removed");
    } else if (found.twice != kNone) {
      report.add(Severity::kRepaired, "self-touching-face", {.face = face, .vertex = found.twice},
                 "comes back to vertex {}; {}", found.twice,
                 found.loops.size() == 1
                     ? "what it encloses there without area is cut off"
                     : fmt::format("cut there into {} faces", found.loops.size()));
    }
    edit.replace(face, std::move(found.loops));
  }
  edit.apply();
}

void flatten_faces(Mesh& mesh, Report& report) {
  constexpr int kPasses = 64;
  for (int pass = 0; pass < kPasses; ++pass) {
    const std::vector<char> is_flat = find_flat(mesh, report);
    if (is_flat.empty()) return;
    if (!flatten_some(mesh, is_flat, report)) break;
  }
  FaceEdit edit(mesh, report);
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    report.poll();
    if (!has_no_area(mesh, face)) continue;
    report.add(Severity::kRepaired, "zero-area-face", {.face = face}, "has no area; removed");
    edit.replace(face, {});
  }
  edit.apply();
}

}  // namespace gliss
