// Rounds the creases of a mesh by a radius, so that no edge stays sharp: the force turns over each
// of them on the way over its arc, where at a crease it steps.
#pragma once

#include "gliss/base/export.h"
#include "gliss/base/poll.h"
#include "gliss/mesh/mesh.h"

namespace gliss {

// Each marked crease (mesh.sharp, creases.h) becomes a strip between the two lines along which a
// ball of `radius` (m, > 0) rests against its two faces, at the distance radius tan(theta / 2) from
// the edge, theta being the angle between their normals. Where creases meet, a face closes the
// corner; a crease that ends within the mesh tapers to its end, one that meets a border ends there.
// Convex and concave creases are rounded alike. Creases that turn by less than a degree, and those
// of one edge that end within the mesh at both ends, are taken for smooth.
//
// The faces of the mesh keep their numbers and how many sides they have; mesh.strips and
// mesh.rounded_corners say which follow. The mesh is left with one unit normal a vertex (those that
// it has count as they do for creases, others have NormalWeights::kSmooth), with the tangents of
// the arcs, and without marks and smoothing groups. Vertices keep their numbers too: at a rounded
// one it is that of the first of those that it becomes. A mesh without marks is left alone.
//
// Vertices near faces that are too small for the radius slide over the surface, and along the
// creases, and pairs of triangles in one plane exchange diagonals.
//
// Throws MeshError, and leaves the mesh as it is, where the radius does not fit all the same;
// what() names the face with the least room, and the largest radius for which all faces have room.
// Time: linear, and for a face with creases the square of its sides; where vertices slide, some
// tens of times as much.
//
// The rounding of an edge by a ball is that of Rossignac and Requicha (1984, Constant-radius
// blending in solid modeling).
GLISS_EXPORT void round_creases(Mesh& mesh, double radius, const Poll& poll = {});

}  // namespace gliss
