// The strict check of every mesh before anything is built from it, and its findings.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/base/poll.h"
#include "gliss/mesh/creases.h"
#include "gliss/mesh/mesh.h"
#include "gliss/surface/names.h"

namespace gliss {

enum class Severity { kError, kRepaired, kWarning };

// One thing that a check found. `code` is stable ("non-manifold-edge"), so that scripts can rely on
// it. face, vertex and line name the first occurrence (kNone / 0: not applicable), count says how
// many. Faces are numbered from 0 as in the file, before any duplicate was removed.
struct Finding {
  std::string code;
  Severity severity = Severity::kWarning;
  std::string message;  // one line, for people; names the place
  std::uint32_t face = kNone;
  std::uint32_t vertex = kNone;
  std::size_t line = 0;
  std::size_t count = 1;
};

// Which normals a mesh gets.
enum class NormalSource {
  kAuto,  // those of the file, unless each face has its own and nearly every edge is sharp by them
  kFile,
  kMade,  // made from the faces, whatever the file has
};
inline constexpr Named<NormalSource> kNormalNames[] = {
    {"auto", NormalSource::kAuto}, {"file", NormalSource::kFile}, {"made", NormalSource::kMade}};

// Which way round closed parts are.
enum class Orient {
  kOutward,  // outward; a part wound against the closed part around it is its cavity
  kFile,     // as the file has most of their faces: one that is inside out is a room
};
inline constexpr Named<Orient> kOrientNames[] = {{"outward", Orient::kOutward},
                                                 {"file", Orient::kFile}};

struct LoadOptions {
  double unit = 1.0;  // metres per unit of the file
  // Refuses faces without extent and places that are not manifold, and welds nothing, instead of
  // mending them.
  bool strict = false;
  bool keep_non_manifold = false;  // refuses non-manifold edges and vertices, and mends the rest
  // Vertices at open borders that are no farther apart, in the mesh's unit, become one where that
  // closes the borders; below 0: none.
  double weld = 0;
  NormalSource normals = NormalSource::kAuto;
  Orient orient = Orient::kOutward;
  bool flip = false;      // turns open parts over
  CreaseRules creases{};  // which edges are creases; a list of edges is for files/mesh_file.h
  Poll poll = {};
};

// The checks behind every reader, for meshes made in memory: repairs in place, marks creases,
// appends findings, throws MeshError where any is of severity kError, and std::invalid_argument for
// rules that name a list of edges, which take_mesh() (files/mesh_file.h) reads. mesh.unit stays; a
// corner_normal of kNone (missing) is filled in.
GLISS_EXPORT void validate(Mesh& mesh, const LoadOptions& options = {},
                           std::vector<Finding>* findings = nullptr);

}  // namespace gliss
