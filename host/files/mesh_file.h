// Mesh files: OBJ, OFF, PLY and STL.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/base/poll.h"
#include "gliss/validate/validate.h"

namespace gliss {

// Reads a mesh file by the ending of its name, validates, repairs and marks creases. Pipes and
// devices are refused, and lines of over 16 MiB. No face is dropped in silence: counts are checked
// against the file. Appends what was found to *findings (may be null). Throws MeshError on the
// first finding of severity kError, after all findings are appended.
GLISS_EXPORT Mesh load_mesh(const std::string& path, const LoadOptions& options = {},
                            std::vector<Finding>* findings = nullptr);

// Does with a mesh made in memory what load_mesh() does with one that it has read: validate(), and
// creases of a list of edges too.
GLISS_EXPORT void take_mesh(Mesh& mesh, const LoadOptions& options = {},
                            std::vector<Finding>* findings = nullptr);

// Endings of the files that load_mesh() reads, in small letters, as ".obj".
GLISS_EXPORT std::span<const std::string_view> mesh_endings();

// True if load_mesh() has a reader for files of this name.
GLISS_EXPORT bool has_mesh_ending(const std::string& path);

// Sides of the edges that a text file lists: the numbers of two vertices a line, from 0; # begins a
// comment. Throws MeshError, which names file and line, for other lines and for edges that the mesh
// has not between two faces.
GLISS_EXPORT std::vector<std::uint32_t> read_edges(const std::string& path, const Mesh& mesh,
                                                   const Topology& topology);

// Writes OBJ (positions, normals as v//vn, n-gons) with 17 digits, atomically. Throws
// std::system_error. Stopped, it leaves no file.
GLISS_EXPORT void save_obj(const Mesh& mesh, const std::string& path,
                           const std::string& comment = "", const Poll& poll = {});

}  // namespace gliss
