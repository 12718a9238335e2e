// How the patches of a mesh meet, judged by points of them alone.
#pragma once

#include <algorithm>
#include <vector>

#include "tests/support/surfaces.h"

namespace gliss::test {

inline constexpr int kSamples = 24;  // along a side, and within a face

inline std::vector<double> places() {
  std::vector<double> t;
  for (int i = 0; i <= kSamples; ++i) t.push_back(1.0 * i / kSamples);
  return t;
}
inline std::vector<double> places_back() {
  std::vector<double> t = places();
  std::reverse(t.begin(), t.end());
  return t;
}

inline std::vector<SurfacePoint> points_of(const PatchCache& cache, std::uint32_t face) {
  const int n = static_cast<int>(cache.face_valence[face]);
  std::vector<DomainPoint> at{{face, 0, 0}};
  for (int k = 0; k < n; ++k) {
    for (int i = 0; i < kSamples; ++i) {
      for (const double radius : {0.3, 0.7, 1.0}) {
        const Vec2 X = radius * oracle::on_side(n, k, 1.0 * i / kSamples);
        at.push_back({face, X.x(), X.y()});
      }
    }
  }
  std::vector<SurfacePoint> points(at.size());
  evaluate(cache, at, points);
  return points;
}

// Cubic curves in long double, from ends and tangents.
inline Vec3 curve_at(const Mesh& mesh, const Topology& topology, std::uint32_t side, double at) {
  using Wide = Eigen::Matrix<long double, 3, 1>;
  const auto wide = [](const Vec3& v) { return Wide(v.cast<long double>()); };
  const Wide a = wide(mesh.positions[mesh.corner_vertex[side]]),
             b = wide(mesh.positions[mesh.corner_vertex[next_side(mesh, topology, side)]]),
             s = wide(mesh.tangents[2 * side]), e = wide(mesh.tangents[2 * side + 1]);
  const long double t = static_cast<long double>(at), r = 1 - t;
  return (r * r * (1 + 2 * t) * a + t * t * (3 - 2 * t) * b + r * r * t * s - t * t * r * e)
      .cast<double>();
}

struct Joints {
  Worst gap, off_curve, bend;  // lengths over the mesh's size; rad
};

// Measures how the faces that were not tamed meet.
inline Joints joints_of(const Mesh& mesh, const PatchCache& cache) {
  Joints found;
  const Topology topology = build_topology(mesh);
  const double size = size_of(mesh);
  for_each_inner_edge(topology, [&](std::uint32_t side, std::uint32_t twin) {
    const auto is_bent = [&](std::uint32_t s) {
      return kind_of(cache, topology.side_face[s]) == PatchKind::kBent;
    };
    const auto left = along_side(cache, mesh, topology, side, places()),
               right = along_side(cache, mesh, topology, twin, places_back());
    const bool has_curve = !mesh.tangents.empty() && !mesh.tangents[2 * side].isZero(0),
               is_cut = has_curve && !mesh.sharp.empty();
    for (std::size_t i = 0; i < left.size(); ++i) {
      found.gap.add((left[i].position - right[i].position).norm() / size);
      if (has_curve) {
        const Vec3 at = curve_at(mesh, topology, side, places()[i]);
        found.off_curve.add((left[i].position - at).norm() / size);
      }
      if (!is_cut && !is_bent(side) && !is_bent(twin))
        found.bend.add(oracle::angle<double>(left[i].normal, right[i].normal));
    }
  });
  return found;
}

}  // namespace gliss::test
