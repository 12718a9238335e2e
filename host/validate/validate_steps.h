// The steps of `validate`, in order; validate.cpp lists what they may find. Private to host/.
#pragma once

#include <span>
#include <vector>

#include "gliss/validate/mesh_report.h"
#include "gliss/validate/validate.h"

namespace gliss {

void validate(Mesh& mesh, const LoadOptions& options, Report& report);

// Removes repeated corners and duplicate faces.
void repair_faces(Mesh& mesh, Report& report);

// Removes faces of fewer than three vertices, cuts faces that touch themselves at a vertex, and
// makes the ends of sides without length one vertex. joined[vertex]: another one has taken its
// place.
void mend_faces(Mesh& mesh, std::vector<bool>& joined, Report& report);

// Welds pairs of border sides whose ends are no farther apart than `most` into one edge; none where
// `most` is below 0.
void weld_borders(Mesh& mesh, double most, std::vector<bool>& joined, Report& report);

// Removes faces without area. The corner of a triangle that lies on its longest side joins the face
// beyond, so that no gap is left.
void flatten_faces(Mesh& mesh, Report& report);

// Faces of too few vertices or too many sides, or that touch themselves: reported as errors, and
// taken out, lest the steps that follow report what comes of them.
void refuse_faces(Mesh& mesh, Report& report);

// Sides of no length, faces of no area.
void check_sizes(const Mesh& mesh, Report& report);

double side_length(const Mesh& mesh, std::uint32_t face, std::uint32_t side);

// True if nothing but rounding is left of a face's area.
bool has_no_area(const Mesh& mesh, std::uint32_t face);

// Removes faces that are another one turned over where the mesh is closed without them: the second
// one of each pair, or both, between two solids.
void remove_doubled(Mesh& mesh, Report& report);

// Edges of three and more faces, and vertices where fans of faces touch: refused or split.
void repair_manifold(Mesh& mesh, bool split, Report& report);

// The parts of a mesh: faces that edges join, in the order of their first faces.
struct MeshParts {
  std::vector<std::uint32_t> of_face;     // [face], its part
  std::vector<std::uint32_t> first_face;  // [part]
  std::vector<char> closed;               // [part], 1: every side has a face beyond
  // [part], six times the volume that it encloses; below 0: it is inside out. 0: nothing but
  // rounding. Says nothing of an open part.
  std::vector<double> volume;

  std::size_t count() const { return first_face.size(); }
};

// Turns the faces of each part the way of most of them; reports borders and parts.
MeshParts repair_orientation(Mesh& mesh, Report& report);

// Leaves unit normals at every corner, or none at all: as of a file that has each face's own.
void repair_normals(Mesh& mesh, NormalSource source, Report& report);

// Marks creases as mark_creases (mesh/creases.h) does, and warns of vertices with several normals
// where no crease is between them.
void mark_creases(Mesh& mesh, const Topology& topology, const CreaseRules& rules,
                  std::span<const std::uint32_t> sides, Report& report);

// Warn of what is accepted: shapes of faces, vertices unused or at one place, but for those that
// are `joined` to another one.
void warn_of_vertices(const Mesh& mesh, const std::vector<bool>& joined, Report& report);
void warn_of_shapes(const Mesh& mesh, Report& report);

}  // namespace gliss
