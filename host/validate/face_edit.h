// Faces of a mesh that is checked, taken out or put in the place of others. Private to
// host/validate.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "gliss/base/hash_index.h"
#include "gliss/validate/mesh_report.h"

namespace gliss {

struct Corner {
  std::uint32_t vertex, normal;  // normal kNone: the mesh has none, or none there
};
using Polygon = std::vector<Corner>;

inline Corner corner_of(const Mesh& mesh, std::uint32_t c) {
  return {mesh.corner_vertex[c], mesh.corner_normal.empty() ? kNone : mesh.corner_normal[c]};
}

inline Polygon polygon_of(const Mesh& mesh, std::uint32_t face) {
  Polygon polygon;
  for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c)
    polygon.push_back(corner_of(mesh, c));
  return polygon;
}

// A hash of a face's vertices: a sum, so that it does not matter where the face begins, nor which
// way round it goes.
inline std::uint64_t vertex_hash(const Mesh& mesh, std::uint32_t face) {
  std::uint64_t hash = 0;
  for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c)
    hash += mix_bits(mesh.corner_vertex[c] + 1);
  return hash;
}

// Turns a face the other way round; its first corner stays the first.
inline void reverse_face(Mesh& mesh, std::uint32_t face) {
  for (std::vector<std::uint32_t>* corners : {&mesh.corner_vertex, &mesh.corner_normal}) {
    if (!corners->empty())
      std::reverse(corners->begin() + mesh.face_begin[face] + 1,
                   corners->begin() + mesh.face_begin[face + 1]);
  }
}

// Puts other faces in the place of some: none, one or several for each. All others stay, in order.
class FaceEdit {
 public:
  FaceEdit(Mesh& mesh, Report& report)
      : mesh_(mesh), report_(report), edited_(mesh.face_count(), kNone) {}

  void replace(std::uint32_t face, std::vector<Polygon> by) {
    if (edited_[face] == kNone) {
      edited_[face] = static_cast<std::uint32_t>(by_.size());
      by_.emplace_back();
    }
    by_[edited_[face]] = std::move(by);
  }
  bool is_edited(std::uint32_t face) const { return edited_[face] != kNone; }

  // Returns true if there was anything to do.
  bool apply() {
    if (by_.empty()) return false;
    Mesh out;
    std::vector<std::uint32_t> file_face;
    const auto add = [&](std::uint32_t face, const Polygon& polygon) {
      for (const Corner& corner : polygon) {
        out.corner_vertex.push_back(corner.vertex);
        if (!mesh_.corner_normal.empty()) out.corner_normal.push_back(corner.normal);
      }
      out.face_begin.push_back(static_cast<std::uint32_t>(out.corner_vertex.size()));
      if (!mesh_.face_line.empty()) out.face_line.push_back(mesh_.face_line[face]);
      if (!mesh_.face_group.empty()) out.face_group.push_back(mesh_.face_group[face]);
      file_face.push_back(report_.number_of(face));
    };
    for (std::uint32_t face = 0; face < mesh_.face_count(); ++face) {
      report_.poll();
      if (!is_edited(face)) {
        add(face, polygon_of(mesh_, face));
      } else {
        for (const Polygon& polygon : by_[edited_[face]]) add(face, polygon);
      }
    }
    mesh_.face_begin = std::move(out.face_begin);
    mesh_.corner_vertex = std::move(out.corner_vertex);
    mesh_.corner_normal = std::move(out.corner_normal);
    mesh_.face_line = std::move(out.face_line);
    mesh_.face_group = std::move(out.face_group);
    report_.file_face = std::move(file_face);
    return true;
  }

 private:
  Mesh& mesh_;
  Report& report_;
  std::vector<std::uint32_t> edited_;  // [face], where in by_; kNone: stays
  std::vector<std::vector<Polygon>> by_;
};

}  // namespace gliss
