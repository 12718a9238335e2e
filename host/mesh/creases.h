// Creases: edges along which a surface is sharp. Which edges they are, and the normals and tangents
// that the patches beside them have, so that they meet there without a gap and are smooth
// everywhere else. docs/method.md has the equations.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/mesh/topology.h"

namespace gliss {

// The rules by which an edge between two faces is a crease: any of these. Where nobody names one, a
// mesh's own normals say it, if it has some (`normals`), and else how far its edges turn
// (mark_creases).
struct CreaseRules {
  bool none = false;              // no edge is one, whatever stands below
  std::optional<double> angle{};  // rad, in [0, pi): its faces turn by more
  bool plain = false;             // its faces turn by more than plain_crease_angle
  bool normals = false;           // the mesh's normals differ across it, at an end
  bool groups = false;            // its faces are not of one smoothing group
  std::string edges{};            // it is in a list: the path of one (files/mesh_file.h)

  // True if they name none.
  bool are_usual() const {
    return !(none || angle || plain || normals || groups || !edges.empty());
  }
};

inline constexpr double kSharpTurn = 75;  // degrees, of the usual rule (mark_creases)

// From words between commas: an angle ("40deg"), "auto", "normals", "groups", "edges:PATH"; or
// "none" alone. Throws UnitError.
GLISS_EXPORT CreaseRules parse_creases(std::string_view text);

using VertexPair = std::array<std::uint32_t, 2>;

// A side of the edge between two vertices; kNone: there is no such edge between two faces.
GLISS_EXPORT std::uint32_t find_inner_edge(const Mesh& mesh, const Topology& topology,
                                           const VertexPair& vertices);

// The angle (rad) that plainly parts the edges of a validated mesh, as those of a machine part are
// parted: of its inner edges hardly any turns by up to 15 degrees less or more, 2 % at least by
// more, and 25 % at least by less: by at most 40 degrees. Hardly any crease that it makes ends
// within the mesh. None where there is no such angle.
GLISS_EXPORT std::optional<double> plain_crease_angle(const Mesh& mesh, const Topology& topology);

// Marks the creases of a validated mesh in mesh.sharp, which stays empty where there are none:
// those of the rules but for rules.edges, and the edges of `sides`, each between two faces. Throws
// MeshError where the mesh has nothing that a rule asks for.
//
// The usual rule for a mesh without normals: edges that turn by more than kSharpTurn, which every
// edge of a box does and none of an octahedron (70.5) or dodecahedron (63.4), for which smooth
// patches are meant. A chain of them goes on over edges that turn by more than 50 degrees. One that
// ends within the mesh, or whose turn changes by more than 20 degrees at a vertex, is a fold of a
// smooth shape, and no crease. Then corners are cut: where two creases that form an angle of less
// than 120 degrees bound faces that turn by more than 2 degrees from each other, the sharpest edge
// between these is a crease, which may end at its other vertex, a dart; and where a crease ends at
// a vertex all of whose edges turn by more than 50 degrees, they all are.
GLISS_EXPORT void mark_creases(Mesh& mesh, const Topology& topology, const CreaseRules& rules,
                               std::span<const std::uint32_t> sides = {});

// The marked edges, lower vertex first, ascending.
GLISS_EXPORT std::vector<VertexPair> crease_edges(const Mesh& mesh, const Topology& topology);

// Members of Mesh by these names. Where no crease cuts the corners of a vertex from each other,
// they have its normal; a crease that ends within the mesh (a dart) cuts none there. Else each
// sector between creases has a normal of its own, and each crease a tangent that is at right angles
// to the normals on both of its sides.
struct SharpCorners {
  std::vector<Vec3> normals, tangents;
  std::vector<std::uint32_t> corner_normal;
};

// From the marks and the normals of the mesh, if it has some: they count where they agree with the
// marks. `weights`: of normals that are made. Any number of threads may call it.
GLISS_EXPORT SharpCorners sharp_corners(const Mesh& mesh, const Topology& topology,
                                        NormalWeights weights = NormalWeights::kAngle,
                                        const ParallelFor& parallel = serial_for);

}  // namespace gliss
