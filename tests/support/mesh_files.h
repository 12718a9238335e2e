// Small mesh files written in place, what loading them finds, and writers of each format.
#pragma once

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <filesystem>
#include <string>
#include <vector>

#include "gliss/files/mesh_file.h"
#include "gliss/mesh/mesh.h"
#include "tests/support/scratch_folder.h"

namespace gliss {

class MeshFiles : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder_ / name; }

  Mesh load(const std::string& name, const std::string& text, const LoadOptions& options = {}) {
    findings_.clear();
    return load_mesh(folder_.write(name, text), options, &findings_);
  }

  // The reader's message, with the folder cut off; empty where it does not refuse.
  std::string refusal(const std::string& name, const std::string& text,
                      const LoadOptions& options = {}) {
    const std::string what = test::message_of<MeshError>([&] { load(name, text, options); });
    return what.starts_with(path("")) ? what.substr(path("").size()) : what;
  }

  // The number of times; 0: never.
  std::size_t count(const std::string& code) const {
    for (const Finding& finding : findings_) {
      if (finding.code == code) return finding.count;
    }
    return 0;
  }

  std::vector<std::string> codes() const {
    std::vector<std::string> all;
    for (const Finding& finding : findings_) all.push_back(finding.code);
    return all;
  }

  test::ScratchFolder folder_;
  std::vector<Finding> findings_;
};

inline const char* const kCubeVertices =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n";
inline const std::string kCube =
    std::string(kCubeVertices) +
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

inline std::vector<std::uint32_t> face_vertices(const Mesh& mesh, std::size_t face) {
  return {mesh.corner_vertex.begin() + mesh.face_begin[face],
          mesh.corner_vertex.begin() + mesh.face_begin[face + 1]};
}

inline std::string to_off(const Mesh& mesh) {
  std::string text = fmt::format("OFF\n{} {} 0\n", mesh.positions.size(), mesh.face_count());
  for (const Vec3& p : mesh.positions) text += fmt::format("{} {} {}\n", p.x(), p.y(), p.z());
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    text += fmt::format("{}", mesh.valence(face));
    for (const std::uint32_t vertex : face_vertices(mesh, face)) text += fmt::format(" {}", vertex);
    text += "\n";
  }
  return text;
}

template <class T>
std::string to_bytes(T value, bool big) {
  std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
  if (big != (std::endian::native == std::endian::big)) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

// The mesh as PLY, with properties and an element that nobody asked for.
inline std::string to_ply(const Mesh& mesh, const std::string& format) {
  std::string text = fmt::format(
      "ply\nformat {} 1.0\ncomment test\nelement vertex {}\nproperty double x\nproperty uchar red\n"
      "property double y\nproperty double z\nproperty list uchar short tags\nelement edge 2\n"
      "property int vertex1\nproperty float weight\nelement face {}\nproperty float area\n"
      "property list ushort uint vertex_indices\nend_header\n",
      format, mesh.positions.size(), mesh.face_count());
  const bool ascii = format == "ascii";
  const auto put = [&](auto value) {
    text += ascii ? fmt::format("{} ", value) : to_bytes(value, format == "binary_big_endian");
  };
  const auto end_item = [&] {
    if (ascii) text += "\n";
  };
  for (const Vec3& p : mesh.positions) {
    put(p.x()), put(std::uint8_t{200}), put(p.y()), put(p.z());
    put(std::uint8_t{2}), put(std::int16_t{-7}), put(std::int16_t{8});
    end_item();
  }
  for (int edge = 0; edge < 2; ++edge) put(std::int32_t{edge}), put(0.5f), end_item();
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    put(1.5f), put(static_cast<std::uint16_t>(mesh.valence(face)));
    for (const std::uint32_t vertex : face_vertices(mesh, face)) put(vertex);
    end_item();
  }
  return text;
}

// The mesh as STL, its faces cut into fans; numbers as float has them.
inline std::string to_stl(const Mesh& mesh, bool ascii) {
  std::string triangles;
  std::uint32_t count = 0;
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    const std::vector<std::uint32_t> polygon = face_vertices(mesh, face);
    for (std::size_t k = 1; k + 1 < polygon.size(); ++k, ++count) {
      triangles += ascii ? " facet normal 0 0 1\n  outer loop\n" : std::string(12, '\0');
      for (const std::size_t i : {std::size_t{0}, k, k + 1}) {
        const Eigen::Vector3f p = mesh.positions[polygon[i]].cast<float>();
        triangles += ascii
                         ? fmt::format("   vertex {} {} {}\n", p.x(), p.y(), p.z())
                         : to_bytes(p.x(), false) + to_bytes(p.y(), false) + to_bytes(p.z(), false);
      }
      triangles += ascii ? "  endloop\n endfacet\n" : std::string(2, 'a');
    }
  }
  return ascii ? "solid a\n" + triangles + "endsolid\n"
               : "solid" + std::string(75, ' ') + to_bytes(count, false) + triangles;
}

}  // namespace gliss
