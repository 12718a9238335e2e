// Judges what has to hold of any mesh that the checks let pass: finite everywhere, closed, what is
// not flagged right, what is flagged with the boundary that it had.
#pragma once

#include "gliss/build/build_cache.h"
#include "gliss/validate/validate.h"
#include "tests/extremes/extreme_errors.h"
#include "tests/oracle/fair_oracle.h"

namespace gliss::test {

// Counts what may not be, and keeps where it was first.
struct Times {
  std::uint64_t count = 0;
  std::string first;

  template <class Where>
  void add(Where where) {
    if (++count == 1) first = where();
  }
};

struct Judgement {
  PatchErrors sound;       // of faces not flagged
  WorstPlace boundary;     // of flagged faces, from eq. 6, relative to the size, times soundness
  WorstPlace gap;          // between neighbours, relative to the size of the first
  WorstPlace unit_normal;  // off length 1
  std::uint64_t faces = 0, flagged = 0, refused = 0;
  // Points; faces that fold, and that have a ribbon without a direction, and are not flagged.
  Times not_finite, folds, degenerate;
};

// Judges patches of a construction: the paper's and the fair triangles against the oracles; fair
// quads have none.
class Judge {
 public:
  Judge(Precision precision, Construction construction, std::uint64_t seed)
      : precision_(precision), construction_(construction), rng_(seed) {}

  // `name` tells how to make it again.
  void judge(Mesh mesh, const std::string& name) {
    try {
      validate(mesh);
    } catch (const MeshError& e) {
      ++found_.refused;
      const std::string why = e.what();
      EXPECT_TRUE(why.find("face") != std::string::npos || why.find("vertex") != std::string::npos)
          << why;
      return;
    }
    BuildReport report;
    const PatchCache cache = cache_of(mesh, precision_, true, &report, construction_);
    const Topology topology = build_topology(mesh);
    // Sides and shape operators at vertices are of all faces round them.
    bool is_defined = construction_ == Construction::kFair;
    for (std::uint32_t face = 0; face < mesh.face_count(); ++face)
      is_defined = is_defined && has_sides(exact_of(polygon_of(mesh, face)));
    std::optional<oracle::Fair> fair;
    if (is_defined) fair.emplace(mesh, topology);
    for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
      const bool flagged =
          std::binary_search(report.flagged_faces.begin(), report.flagged_faces.end(), face);
      ++found_.faces;
      found_.flagged += flagged;
      judge_face(cache, polygon_of(mesh, face), fair ? &*fair : nullptr, face, flagged,
                 fmt::format("{}, face {}", name, face));
    }
    judge_edges(cache, mesh, topology, name);
  }

  const Judgement& found() const { return found_; }

 private:
  using Exact = oracle::Polygon<long double>;
  static Exact exact_of(const Polygon& polygon) {
    return oracle::with_unit_normals(oracle::cast<long double>(oracle::with_unit_normals(polygon)));
  }
  // A build flags what is below 1e-2.
  static bool is_degenerate(const Exact& exact) { return oracle::soundness(exact) < 5e-3L; }

  // True if neighbours can make fair sides with a face: not where the corner beyond a side stands
  // straight over it, as the normals see it. Then rounding decides how its normal turns (step 2).
  static bool has_sides(const Exact& exact) {
    for (int k = 0; k < exact.size(); ++k) {
      const oracle::Vec<long double> way = exact.position(k + 2) - exact.position(k);
      const oracle::Vec<long double> across =
          (exact.position(k + 1) - exact.position(k))
              .cross(oracle::Vec<long double>(exact.normal(k) + exact.normal(k + 1)))
              .normalized();
      if (exact.size() == 3 && !(std::abs(way.dot(across)) > 1e-6L * way.norm())) return false;
    }
    return !is_degenerate(exact);
  }

  // `fair` is the oracle of fair faces but quads; null where they have none.
  void judge_face(const PatchCache& cache, const Polygon& polygon, const oracle::Fair* fair,
                  std::uint32_t face, bool flagged, const std::string& name) {
    const int n = polygon.size();
    const Exact exact = exact_of(polygon);
    const bool is_fair = construction_ == Construction::kFair && n <= 31;
    const double size = oracle::size_of(polygon);
    const bool degenerate = is_degenerate(exact);
    if (degenerate && !flagged) {
      found_.degenerate.add([&] {
        return fmt::format("{}, soundness {:.2g}", name,
                           static_cast<double>(oracle::soundness(exact)));
      });
    }
    for (const Vec2& free : hard_points(rng_, n, 12, 2)) {
      const Vec2 X = held(precision_, free);
      const SurfacePoint got = at(cache, face, X);
      const auto where = [&] { return name + ", " + place_of(n, X); };
      note_finite(got, where);
      if (flagged || degenerate) continue;
      if (!is_fair) found_.sound.add(got, oracle::evaluate(exact, X), size, where);
      if (is_fair && n != 4 && fair != nullptr)
        found_.sound.add(got, fair->evaluate(face, X), size, where);
    }
    if (flagged && is_fair && n == 3) return;  // its sides are not those of eq. 6
    if (flagged) {
      judge_boundary(cache, exact, face, size, name);
    } else if (!degenerate) {
      look_for_folds(cache, polygon, face, name);
    }
  }

  template <class Where>
  void note_finite(const SurfacePoint& p, Where where) {
    const bool finite =
        p.position.allFinite() && p.d_xi.allFinite() && p.d_eta.allFinite() && p.normal.allFinite();
    if (!finite) found_.not_finite.add(where);
    found_.unit_normal.add(std::abs(p.normal.norm() - 1), where);
  }

  void judge_boundary(const PatchCache& cache, const Exact& exact, std::uint32_t face, double size,
                      const std::string& name) {
    const int n = exact.size();
    for (int k = 0; k < n; ++k) {
      for (const double t : {0.0, 0.125, 0.5, 0.75, 1.0}) {
        const oracle::Vec<long double> C = oracle::side(exact, k, static_cast<long double>(t)).C;
        if (!C.allFinite()) continue;  // (8) and (9) say nothing there
        const Vec3 got = at(cache, face, oracle::on_side(n, k, t)).position;
        const long double error =
            (got.cast<long double>() - C).norm() * oracle::soundness(exact, k);
        found_.boundary.add(static_cast<double>(error) / size,
                            [&] { return fmt::format("{}, side {}, t {}", name, k, t); });
      }
    }
  }

  // Denser than a build looks.
  void look_for_folds(const PatchCache& cache, const Polygon& polygon, std::uint32_t face,
                      const std::string& name) {
    const Vec3 up = oracle::face_normal(polygon);
    for (const Vec2& X : oracle::sample_domain<double>(polygon.size(), 24)) {
      const SurfacePoint p = at(cache, face, X);
      // On the very boundary a patch may turn by a rounding, and at a corner of 180 degrees it has
      // no tangent plane.
      const bool flat = p.d_xi.cross(p.d_eta).norm() < 1e-6 * p.d_xi.norm() * p.d_eta.norm();
      if (flat || p.normal.dot(up) > -1e-6) continue;
      found_.folds.add([&] {
        return fmt::format("{}, {}, cosine {:.3g}", name, place_of(polygon.size(), X),
                           p.normal.dot(up));
      });
      return;
    }
  }

  void judge_edges(const PatchCache& cache, const Mesh& mesh, const Topology& topology,
                   const std::string& name) {
    for_each_inner_edge(topology, [&](std::uint32_t side, std::uint32_t twin) {
      const auto a = along_side(cache, mesh, topology, side, {0, 0.1, 0.5, 0.8, 1});
      const auto b = along_side(cache, mesh, topology, twin, {1, 0.9, 0.5, 0.2, 0});
      const double size = oracle::size_of(polygon_of(mesh, topology.side_face[side]));
      for (std::size_t i = 0; i < a.size(); ++i)
        found_.gap.add((a[i].position - b[i].position).norm() / size,
                       [&] { return fmt::format("{}, side {}", name, side); });
    });
  }

  Precision precision_;
  Construction construction_;
  oracle::Rng rng_;
  Judgement found_;
};

// A face and one beyond its edge k, which share two vertices and their normals.
inline void add_pair(Mesh& mesh, const Polygon& left, int k, const Polygon& right) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  const auto close = [&] {
    mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corner_vertex.size()));
  };
  const auto n = static_cast<std::uint32_t>(left.size()),
             m = static_cast<std::uint32_t>(right.size());
  const auto edge = static_cast<std::uint32_t>(k);
  for (std::uint32_t i = 0; i < n; ++i) mesh.corner_vertex.push_back(first + i);
  close();
  mesh.corner_vertex.push_back(first + (edge + 1) % n);
  mesh.corner_vertex.push_back(first + edge);
  for (std::uint32_t i = 2; i < m; ++i) mesh.corner_vertex.push_back(first + n + i - 2);
  close();
  mesh.positions.insert(mesh.positions.end(), left.positions.begin(), left.positions.end());
  mesh.positions.insert(mesh.positions.end(), right.positions.begin() + 2, right.positions.end());
  mesh.normals.insert(mesh.normals.end(), left.normals.begin(), left.normals.end());
  mesh.normals.insert(mesh.normals.end(), right.normals.begin() + 2, right.normals.end());
  mesh.corner_normal = mesh.corner_vertex;
}

inline Mesh mesh_of(const Polygon& left, int k, const Polygon& right) {
  Mesh mesh;
  add_pair(mesh, left, k, right);
  return mesh;
}

}  // namespace gliss::test
