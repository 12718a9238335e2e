// The steps of `validate`, in order; validate.cpp lists what they may find. Private to host/.
#pragma once

#include <span>

#include "gliss/validate/mesh_report.h"
#include "gliss/validate/validate.h"

namespace gliss {

void validate(Mesh& mesh, const LoadOptions& options, Report& report);

// Removes repeated corners and duplicate faces.
void repair_faces(Mesh& mesh, Report& report);

// Faces of too few vertices or too many sides, or that touch themselves: reported as errors, and
// taken out, lest the steps that follow report what comes of them.
void refuse_faces(Mesh& mesh, Report& report);

// Sides of no length, faces of no area.
void check_sizes(const Mesh& mesh, Report& report);

// Edges of three and more faces, and vertices where fans of faces touch: refused or split.
void repair_manifold(Mesh& mesh, bool split, Report& report);

// Turns the faces of each part one way, closed parts outward; reports borders and parts.
void repair_orientation(Mesh& mesh, Report& report);

// Leaves unit normals at every corner, or none at all.
void repair_normals(Mesh& mesh, Report& report);

// Warns of vertices with several normals where no crease is between them. group[corner]: corners of
// a vertex without a crease between them have one number.
void warn_of_sharp_normals(const Mesh& mesh, std::span<const std::uint32_t> group, Report& report);

// Warn of what is accepted: shapes of faces, vertices unused or at one place.
void warn_of_vertices(const Mesh& mesh, Report& report);
void warn_of_shapes(const Mesh& mesh, Report& report);

// Closed parts that meet other parts or hold them.
void warn_of_parts(const Mesh& mesh, Report& report);

}  // namespace gliss
