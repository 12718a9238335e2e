#include "gliss/mesh/sectors.h"

#include <algorithm>
#include <cmath>

namespace gliss {
namespace {

constexpr double kSameNormal = 1e-3;  // rad, what a file of few digits may leave between them
constexpr double kPasses = -0.5;      // cosine between two cuts that go on as one curve

const Vec3& start_of(const Mesh& mesh, std::uint32_t side) {
  return mesh.positions[mesh.corner_vertex[side]];
}

// Cuts vertex by vertex, and then finds normals.
class Cutter {
 public:
  Cutter(const Mesh& mesh, const Topology& topology, std::span<const std::uint8_t> cuts)
      : mesh_(mesh), topology_(topology), cuts_(cuts) {
    s_.tau.assign(mesh.corner_vertex.size(), Vec3::Zero());
    s_.group = mesh.corner_vertex;
  }

  Sectors find(NormalWeights weights, const ParallelFor& parallel) {
    for (const std::uint32_t first : topology_.vertex_side) {
      if (first != kNone) cut_vertex(first);
    }
    s_.normals =
        group_normals(mesh_, s_.group, mesh_.positions.size() + s_.cut.size(), weights, parallel);
    take_given_normals();
    return std::move(s_);
  }

 private:
  bool is_cut(std::uint32_t side) const {
    return cuts_[side] != 0 && topology_.side_twin[side] != kNone;
  }

  // Sectors of the vertex where `first` starts, and tangents of its cuts.
  void cut_vertex(std::uint32_t first) {
    std::vector<std::uint32_t> fan, cuts;  // sides; places in the fan
    bool is_closed = false;
    for (std::uint32_t side = first; side != kNone && !is_closed;) {
      if (is_cut(side)) cuts.push_back(static_cast<std::uint32_t>(fan.size()));
      fan.push_back(side);
      side = next_around(mesh_, topology_, side);
      is_closed = side == first;
    }
    if (cuts.size() < (is_closed ? 2 : 1)) return;
    for (const std::uint32_t i : cuts)
      s_.tau[fan[i]] = edge_of(mesh_, topology_, fan[i]).stableNormalized();
    if (cuts.size() == 2) pass(fan[cuts[0]], fan[cuts[1]]);
    const auto add = [&](std::uint32_t begin, std::uint32_t end, const Vec3& to, const Vec3& from) {
      Sector sector{{}, to, from};
      for (std::uint32_t i = begin; i != end; ++i) sector.corners.push_back(fan[i % fan.size()]);
      for (const std::uint32_t c : sector.corners)
        s_.group[c] = static_cast<std::uint32_t>(mesh_.positions.size() + s_.cut.size());
      s_.cut.push_back(std::move(sector));
    };
    const auto count = static_cast<std::uint32_t>(fan.size());
    const auto tau = [&](std::uint32_t i) { return s_.tau[fan[i]]; };
    if (!is_closed) add(0, cuts.front(), Vec3::Zero(), tau(cuts.front()));
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i)
      add(cuts[i], cuts[i + 1], tau(cuts[i]), tau(cuts[i + 1]));
    if (is_closed) {
      add(cuts.back(), cuts.front() + count, tau(cuts.back()), tau(cuts.front()));
    } else {
      add(cuts.back(), count, tau(cuts.back()), Vec3::Zero());
    }
  }

  // Two cuts that go on as one curve: their tangent is that of the circle through the vertex and
  // their other ends.
  void pass(std::uint32_t a, std::uint32_t b) {
    std::vector<Vec3>& tau = s_.tau;
    if (!(tau[a].dot(tau[b]) < kPasses)) return;
    const Vec3 along =
        tau[a] / edge_of(mesh_, topology_, a).norm() - tau[b] / edge_of(mesh_, topology_, b).norm();
    tau[a] = along.stableNormalized();
    tau[b] = -tau[a];
  }

  // The normals of the mesh, for vertices that are not cut, and for sectors of a vertex that has
  // several. Corners of one sector share the mean of theirs.
  void take_given_normals() {
    if (mesh_.normals.empty()) return;
    std::vector<Vec3> sum(s_.normals.size(), Vec3::Zero());
    std::vector<char> differs(mesh_.positions.size(), 0);
    std::vector<std::uint32_t> vertex(s_.normals.size(), kNone);
    for (std::uint32_t c = 0; c < s_.group.size(); ++c) {
      const std::uint32_t v = mesh_.corner_vertex[c];
      const Vec3& normal = mesh_.normals[mesh_.corner_normal[c]];
      if (normals_differ(mesh_, c, topology_.vertex_side[v])) differs[v] = 1;
      sum[s_.group[c]] += normal;
      vertex[s_.group[c]] = v;
    }
    for (std::size_t g = 0; g < s_.normals.size(); ++g) {
      const std::uint32_t v = vertex[g];
      const bool is_cut = g >= mesh_.positions.size();
      if (v == kNone || (is_cut && differs[v] == 0)) continue;
      if (sum[g].norm() > kSameNormal) s_.normals[g] = sum[g].normalized();
    }
  }

  const Mesh& mesh_;
  const Topology& topology_;
  std::span<const std::uint8_t> cuts_;
  Sectors s_;
};

}  // namespace

double angle_between(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

Vec3 edge_of(const Mesh& mesh, const Topology& topology, std::uint32_t side) {
  return start_of(mesh, next_side(mesh, topology, side)) - start_of(mesh, side);
}

namespace {

// The normal between two sides of a face, which come to a corner and leave it. Unit vectors.
Vec3 normal_between(const Vec3& in, const Vec3& out, const Vec3& face_normal) {
  const Vec3 m = in.cross(out);
  if (!(m.norm() > kCollinear)) return face_normal.stableNormalized();
  return (m.dot(face_normal) < 0 ? Vec3(-m) : m).normalized();
}

Vec3 normal_of_both(const Vec3& start, const Vec3& end, const Vec3& face_normal) {
  const Vec3 sum = start + end;
  return sum.norm() > kCollinear ? sum : face_normal;
}

}  // namespace

Vec3 corner_normal(const Mesh& mesh, const Topology& topology, std::uint32_t corner,
                   const Vec3& face_normal) {
  return normal_between(
      edge_of(mesh, topology, prev_side(mesh, topology, corner)).stableNormalized(),
      edge_of(mesh, topology, corner).stableNormalized(), face_normal);
}

Vec3 normal_beside(const Mesh& mesh, const Topology& topology, std::uint32_t side) {
  const Vec3 face = newell_normal(mesh, topology.side_face[side]);
  return normal_of_both(corner_normal(mesh, topology, side, face),
                        corner_normal(mesh, topology, next_side(mesh, topology, side), face), face);
}

LargeArray<Vec3> normals_beside(const Mesh& mesh, const Topology& topology) {
  LargeArray<Vec3> beside(mesh.corner_vertex.size());
  std::vector<Vec3> along, corner;  // of one face
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const std::uint32_t begin = mesh.face_begin[f], n = mesh.valence(f);
    const Vec3 face = newell_normal(mesh, f);
    along.resize(n), corner.resize(n);
    for (std::uint32_t k = 0; k < n; ++k)
      along[k] = edge_of(mesh, topology, begin + k).stableNormalized();
    for (std::uint32_t k = 0; k < n; ++k)
      corner[k] = normal_between(along[(k + n - 1) % n], along[k], face);
    for (std::uint32_t k = 0; k < n; ++k)
      beside[begin + k] = normal_of_both(corner[k], corner[(k + 1) % n], face);
  }
  return beside;
}

bool normals_differ(const Mesh& mesh, std::uint32_t corner, std::uint32_t other) {
  const std::uint32_t a = mesh.corner_normal[corner], b = mesh.corner_normal[other];
  return a != b && angle_between(mesh.normals[a], mesh.normals[b]) > kSameNormal;
}

bool shares_normals(const Mesh& mesh, const Topology& topology, std::uint32_t side) {
  const auto alike = [&](std::uint32_t corner, std::uint32_t other) {
    const std::uint32_t a = mesh.corner_normal[corner], b = mesh.corner_normal[other];
    return a == b || mesh.normals[a] == mesh.normals[b];
  };
  const std::uint32_t twin = topology.side_twin[side];
  return alike(side, next_side(mesh, topology, twin)) &&
         alike(twin, next_side(mesh, topology, side));
}

Sectors cut_sectors(const Mesh& mesh, const Topology& topology, std::span<const std::uint8_t> cuts,
                    NormalWeights weights, const ParallelFor& parallel) {
  return Cutter(mesh, topology, cuts).find(weights, parallel);
}

Vec3 tangent_along(const Vec3& edge, const Vec3& normal, const Vec3& mean) {
  const Vec3 t = normal.cross(edge.cross(mean));
  return t.norm() > kCollinear * edge.norm() ? t.normalized() : edge.normalized();
}

double arc_length(double chord, const Vec3& start, const Vec3& end) {
  return chord * 2 / (1 + std::sqrt(std::max(0.0, 0.5 * (1 + start.dot(end)))));
}

}  // namespace gliss
