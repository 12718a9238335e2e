// The strict check of every mesh before anything is built from it. Findings, by code:
//
//   error, from the readers
//   unreadable            the file cannot be opened or read
//   unsupported           a kind of file, version or element that no reader knows
//   syntax                a word is missing or is not what has to be there
//   truncated             the file ends before all it announces
//   extra-data            the file has more than it announces
//   count-mismatch        another number of faces or corners was read than the file has
//   error
//   bad-unit              the unit is not a positive number, or no length of anything
//   inconsistent-arrays   the arrays of a mesh made in memory do not fit together
//   too-large             more corners than 32 bits can number
//   no-faces              nothing to touch
//   non-finite            NaN or infinity in a coordinate or normal
//   huge-coordinate       beyond 1e60, where areas and volumes would overflow
//   vertex-index          no such vertex
//   too-many-sides        a face with more than kMaxValence sides
//   non-orientable        a part whose faces cannot all be turned one way (a Moebius strip)
//   self-touching-face    a face that goes along a bridge to a hole in it, and back
//   repaired; an error with LoadOptions::strict
//   non-finite            a vertex that no face uses; moved to one that is used
//   huge-coordinate       likewise
//   count-mismatch        a binary STL counts other triangles than its size has; those are read
//   extra-data            a binary STL has bytes after its last triangle; skipped
//   normal-index          no such normal; the corner gets one from the faces around
//   too-few-vertices      a face with fewer than 3 distinct vertices; removed
//   self-touching-face    a face that comes back to one of its vertices; cut there into several
//   zero-length-side      a side whose ends are at one place; they become one vertex
//   zero-area-face        a face that is a line or a point; removed, and of a triangle the corner
//                         within its longest side, but for a millionth of that, joins the face
//                         beyond
//   inside-out-part       a closed part of negative volume that is no cavity; turned outward, and
//                         what lies in it with it; not with Orient::kFile
//   repaired; an error with LoadOptions::strict and keep_non_manifold
//   non-manifold-edge     an edge of three or more faces; cut open
//   non-manifold-vertex   a vertex where faces meet that share no edge there (a bow-tie); cut open
//   doubled-face          another face turned over, on or within a mesh that is closed without it;
//                         removed, or both are
//   repaired; not with LoadOptions::strict
//   welded-vertices       vertices at the place of another one, where two borders run (seams); they
//                         become one
//   repaired
//   facet-normals         each face has its own normal, and every edge is sharp; made anew
//   repeated-corner       a face that names a vertex twice in a row; once is kept
//   duplicate-face        the same cycle of vertices again; the first is kept
//   flipped-face          a face turned against most of its part; turned back
//   zero-normal           a normal of no length; computed from the faces around
//   missing-normal        a face without normals among others with; computed likewise
//   non-unit-normal       a length off 1 by more than 1e-5; made 1
//   warning
//   soup                  a tenth of the edges or more have three faces or more: no surface
//   unknown-statement     an OBJ statement that is not known; skipped
//   ignored-weight        an OBJ vertex with w other than 1
//   extra-columns         further numbers after a vertex, or one after a face; skipped
//   unused-normals        normals that no face uses, or of fewer than three numbers; dropped
//   unused-vertices       vertices that no face uses; kept
//   coincident-vertices   further vertices at the place of another one
//   several-parts         parts that share no edge; the count is that of the parts
//   parts-intersect       a closed part and another one intersect or touch; the count is that of
//                         the pairs, up to a million. Contact takes closed parts as a union of
//                         solids
//   part-inside-part      parts that lie within closed ones; the count is that of the parts
//   cavity                closed parts within a closed one that is wound the other way: holes in
//                         its solid
//   room                  closed parts that are inside out and stay so, with Orient::kFile
//   faces-inward          open parts most of which faces their own middle
//   no-volume             closed parts that enclose nothing, such as a face and its reverse
//   open-border           sides without a face beyond
//   concave               faces with a reflex corner, or that cross themselves
//   fold                  faces against the mean normal at one of their vertices, such as lie over
//                         others: the winding number says there what is inside
//   non-planar            faces off their plane by more than 5 % of the root of their area
//   sharp-normals         vertices whose faces have different normals there, with no crease between
//   normals-against-face  corners whose normal is more than 90 degrees off their face's
#include "gliss/validate/validate.h"

#include <algorithm>
#include <cmath>

#include "gliss/base/plain_arithmetic.h"
#include "gliss/validate/validate_parts.h"
#include "gliss/validate/validate_steps.h"

namespace gliss {
namespace {

void check_arrays(const Mesh& mesh, double unit, Report& report) {
  const std::size_t corners = mesh.corner_vertex.size();
  if (!(unit >= kLeastUnit && unit <= kMostUnit)) {
    report.fail("bad-unit", {}, "the unit must be a length from {} to {} m, not {} m", kLeastUnit,
                kMostUnit, unit);
  }
  const bool consistent = !mesh.face_begin.empty() && mesh.face_begin.front() == 0 &&
                          mesh.face_begin.back() == corners &&
                          std::is_sorted(mesh.face_begin.begin(), mesh.face_begin.end()) &&
                          mesh.corner_normal.size() == (mesh.normals.empty() ? 0 : corners) &&
                          (mesh.face_line.empty() || mesh.face_line.size() == mesh.face_count()) &&
                          (mesh.face_group.empty() || mesh.face_group.size() == mesh.face_count());
  if (!consistent) report.fail("inconsistent-arrays", {}, "the arrays do not fit together");
  if (std::max({corners, mesh.positions.size(), mesh.normals.size()}) >= kNone) {
    report.fail("too-large", {}, "more than {} corners, vertices or normals", kNone - 1);
  }
  if (mesh.face_count() > 0) return;
  if (mesh.positions.empty()) report.fail("no-faces", {}, "there are no faces");
  report.fail("no-faces", {}, "there are {} vertices and no faces: points alone have no surface",
              mesh.positions.size());
}

// Vertices without a place that no face uses, as scanners write them, are moved to one that is
// used.
void check_positions(Mesh& mesh, Report& report) {
  std::vector<bool> used;  // [vertex], once needed
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    Vec3& p = mesh.positions[v];
    const bool finite = p.allFinite();
    if (finite && p.cwiseAbs().maxCoeff() <= kMostCoordinate) continue;
    if (used.empty()) {
      used.resize(mesh.positions.size(), false);
      for (const std::uint32_t vertex : mesh.corner_vertex) used[vertex] = true;
    }
    report.add(used[v] ? Severity::kError : report.mended,
               finite ? "huge-coordinate" : "non-finite", {.vertex = v}, "({}, {}, {}) is {}{}",
               p.x(), p.y(), p.z(),
               finite ? fmt::format("beyond {}", kMostCoordinate) : "not finite",
               used[v] ? "" : ", and belongs to no face");
    if (used[v]) continue;
    p = mesh.corner_vertex.empty() ? Vec3(0, 0, 0) : mesh.positions[mesh.corner_vertex.front()];
  }
}

void check_normals(const Mesh& mesh, Report& report) {
  for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
    const Vec3& n = mesh.normals[i];
    if (!n.allFinite()) {
      report.add(Severity::kError, "non-finite", {}, "normal {} ({}, {}, {}) is not finite", i,
                 n.x(), n.y(), n.z());
    }
  }
}

void check_indices(Mesh& mesh, Report& report) {
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c) {
      if (mesh.corner_vertex[c] >= mesh.positions.size()) {
        report.add(Severity::kError, "vertex-index", {.face = face},
                   "vertex index {} is out of range ({} vertices)", mesh.corner_vertex[c],
                   mesh.positions.size());
      }
      if (mesh.corner_normal.empty() || mesh.corner_normal[c] == kNone) continue;
      if (mesh.corner_normal[c] >= mesh.normals.size()) {
        report.add(report.mended, "normal-index", {.face = face},
                   "normal index {} is out of range ({} normals)", mesh.corner_normal[c],
                   mesh.normals.size());
        mesh.corner_normal[c] = kNone;
      }
    }
  }
}

// The numbers that `count` faces of a file had before, of those that are there no more.
std::vector<std::uint32_t> lost_faces(std::uint32_t count, const Report& report) {
  if (report.file_face.empty()) return {};
  std::vector<bool> is_kept(count, false);
  for (const std::uint32_t face : report.file_face) is_kept[face] = true;
  std::vector<std::uint32_t> lost;
  for (std::uint32_t face = 0; face < count; ++face) {
    if (!is_kept[face]) lost.push_back(face);
  }
  return lost;
}

}  // namespace

void validate(Mesh& mesh, const LoadOptions& options, Report& report) {
  const PlainArithmetic plain;
  check_arrays(mesh, mesh.unit, report);
  check_indices(mesh, report);
  report.stop_on_error();
  check_positions(mesh, report);
  check_normals(mesh, report);
  report.stop_on_error();
  const auto faces = static_cast<std::uint32_t>(mesh.face_count());
  repair_faces(mesh, report);
  std::vector<bool> joined(mesh.positions.size(), false);
  if (!options.strict) {
    mend_faces(mesh, joined, report);
    weld_borders(mesh, options.weld, joined, report);
    flatten_faces(mesh, report);
    if (!report.file_face.empty()) repair_faces(mesh, report);
    if (mesh.face_count() == 0) report.fail("no-faces", {}, "no face of the file is left");
  }
  warn_of_vertices(mesh, joined, report);  // before copies of split vertices coincide as well
  refuse_faces(mesh, report);
  check_sizes(mesh, report);
  const bool splits = !options.strict && !options.keep_non_manifold;
  if (splits) remove_doubled(mesh, report);
  repair_manifold(mesh, splits, report);
  report.stop_on_error();
  MeshParts parts = repair_orientation(mesh, report);
  report.stop_on_error();
  PartPairs pairs(mesh, parts, report);
  pairs.turn(options);
  report.stop_on_error();
  mesh.lost_faces = lost_faces(faces, report);
  const bool keeps =
      options.creases.normals || (options.strict && options.normals == NormalSource::kAuto);
  repair_normals(mesh, keeps ? NormalSource::kFile : options.normals, report);
  warn_of_shapes(mesh, report);
  pairs.warn();
}

void validate(Mesh& mesh, const LoadOptions& options, std::vector<Finding>* findings) {
  if (!options.creases.edges.empty())
    throw std::invalid_argument("creases: '" + options.creases.edges +
                                "' is a list of edges, which take_mesh() reads");
  Report report(mesh, findings, options.poll, options.strict);
  validate(mesh, options, report);
  mark_creases(mesh, build_topology(mesh), options.creases, {}, report);
}

}  // namespace gliss
