#include "gliss/mesh/fitted_normals.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "gliss/mesh/mesh_edges.h"

namespace gliss {
namespace {

// The vertices around one, ring by ring of edges.
struct Around {
  std::vector<Vec3> ways;       // from the vertex to them, over the least of their lengths
  std::vector<double> cosines;  // of their normals to the vertex's
  std::vector<double> weights;  // 1 / |way|^6
  std::size_t rings[2] = {};    // so many lie within one edge, and within two
};

constexpr int kQuadric = 5, kCubic = 9;  // terms

// The normal equations of the height over the plane across a unit normal, with the terms of
// fitted_normals: the first kQuadric of a quadric, all kCubic of a cubic.
template <int kTerms>
struct Heights {
  using Vector = Eigen::Matrix<double, kTerms, 1>;
  using Matrix = Eigen::Matrix<double, kTerms, kTerms>;

  Vec3 x, y, normal;
  Matrix terms_by_terms = Matrix::Zero();  // its lower half
  Vector terms_by_height = Vector::Zero();
  double height_by_height = 0;

  // `weight` [way].
  Heights(std::span<const Vec3> ways, std::span<const double> weight, const Vec3& across)
      : x(across.unitOrthogonal()), y(across.cross(x)), normal(across) {
    for (std::size_t i = 0; i < ways.size(); ++i) {
      const Vector t = terms(ways[i]);
      const double height = ways[i].dot(normal);
      terms_by_terms.template selfadjointView<Eigen::Lower>().rankUpdate(t, weight[i]);
      terms_by_height += weight[i] * height * t;
      height_by_height += weight[i] * height * height;
    }
  }
  Vector terms(const Vec3& d) const {
    const double u = d.dot(x), v = d.dot(y);
    Vector all;
    all.template head<kQuadric>() << u, v, d.squaredNorm() / 2, (u * u - v * v) / 2, u * v;
    if constexpr (kTerms == kCubic)
      all.template tail<kCubic - kQuadric>() << u * u * u, u * u * v, u * v * v, v * v * v;
    return all;
  }
};

// The polynomial of the first kTerms.
template <int kTerms>
struct Fit {
  bool is_determined = false;
  Eigen::Matrix<double, kTerms, 1> coefficient;
  double error = 0;  // sum of weighted squares

  template <int kAll>
  explicit Fit(const Heights<kAll>& heights) {
    constexpr double kDetermined = 1e-8;  // least pivot over the largest
    // Terms of third order cost so much of their squares, so that they vanish where the vertices do
    // not tell them from the others.
    constexpr double kCost = 0.02;
    Eigen::Matrix<double, kTerms, kTerms> squares =
        heights.terms_by_terms.template topLeftCorner<kTerms, kTerms>();
    squares.diagonal().template tail<kTerms - kQuadric>() *= 1 + kCost;
    const Eigen::LDLT<Eigen::Matrix<double, kTerms, kTerms>> solver(squares);
    const auto& pivots = solver.vectorD();
    if (!(pivots.minCoeff() > kDetermined * pivots.maxCoeff())) return;
    const auto right = heights.terms_by_height.template head<kTerms>();
    coefficient = solver.solve(right);
    error = heights.height_by_height - right.dot(coefficient);
    is_determined = coefficient.allFinite();
  }
  template <int kAll>
  Vec3 normal(const Heights<kAll>& heights) const {
    return (heights.normal - coefficient[0] * heights.x - coefficient[1] * heights.y).normalized();
  }
};

// Turns the normal of a quadric to that of a cubic, as far as that is nearer by more than its terms
// explain: noise has no third order.
Vec3 refined(Around& around, const Vec3& normal) {
  // A cubic needs neighbours on its side of a tube.
  double first = 0, count = 0;
  for (std::size_t i = 0; i < around.rings[0]; ++i) first += around.cosines[i];
  const double share = share_between(0.6, 0.85, first / static_cast<double>(around.rings[0]));
  if (!(share > 0)) return normal;
  for (std::size_t i = 0; i < around.ways.size(); ++i) {
    const double seen = std::max(0.0, around.cosines[i]);
    around.weights[i] *= seen * seen;
    count += seen > 0;
  }
  if (count <= kCubic) return normal;
  const Heights<kCubic> heights(around.ways, around.weights, normal);
  const Fit<kQuadric> quadric(heights);
  const Fit<kCubic> cubic(heights);
  if (!quadric.is_determined || !cubic.is_determined) return normal;
  const double left = cubic.error / (count - kCubic) / (quadric.error / (count - kQuadric));
  return left >= 0 ? blend(normal, cubic.normal(heights), share * share_between(0.9, 0.6, left))
                   : normal;
}

// Changes the weights.
FittedNormal fit_normal(Around& around, const Vec3& start) {
  constexpr int kPasses = 2;
  const std::span<const Vec3> near = std::span(around.ways).first(around.rings[1]);
  FittedNormal fitted{start, 0};
  for (int pass = 0; pass < kPasses; ++pass) {
    const Heights<kQuadric> heights(near, around.weights, fitted.normal);
    const Fit<kQuadric> quadric(heights);
    if (!quadric.is_determined) return {start, std::numeric_limits<double>::infinity()};
    fitted.normal = quadric.normal(heights);
    if (pass + 1 < kPasses) continue;
    for (const Vec3& d : near) {
      const double off = d.dot(heights.normal) - heights.terms(d).dot(quadric.coefficient);
      fitted.error += off * off / d.squaredNorm();
    }
  }
  fitted.error = std::sqrt(fitted.error / static_cast<double>(near.size()));
  fitted.normal = refined(around, fitted.normal);
  return fitted;
}

// The corners of each group and what their edges lead to.
class Neighbours {
 public:
  // Arrays of a thread that asks.
  struct Work {
    Around around;
    std::vector<std::uint32_t> vertices, groups;
  };

  Neighbours(const Mesh& mesh, std::span<const std::uint32_t> group, std::span<const Vec3> normals)
      : mesh_(mesh),
        group_(group),
        normals_(normals),
        edges_(group.size()),
        begin_(normals.size() + 1, 0) {
    for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
      for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c)
        edges_[c] = {{next_corner(mesh, face, c), prev_corner(mesh, face, c)}};
    }
    for (const std::uint32_t g : group) ++begin_[g + 1];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    corners_.resize(group.size());
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
    for (std::uint32_t c = 0; c < group.size(); ++c) corners_[next[group[c]]++] = c;
  }

  // Finds the vertices that one edge or two lead to from a group's, and three where two lead to
  // few. A neighbour where more than kMostCorners meet leads no farther. None if the corners of the
  // group do not go all round the vertex.
  Around& around(std::uint32_t g, Work& work) const {
    constexpr std::size_t kMostCorners = 64, kFew = 16;
    Around& around = work.around;
    std::vector<std::uint32_t>&vertices = work.vertices, &groups = work.groups;
    around.ways.clear(), around.cosines.clear(), around.weights.clear();
    around.rings[0] = around.rings[1] = 0;
    if (corners(g).empty()) return around;
    const std::uint32_t centre = mesh_.corner_vertex[corners(g).front()];
    vertices.assign(1, centre), groups.assign(1, g);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t ring = 0, begin = 0; ring < 3; ++ring) {
      for (const std::size_t end = groups.size(); begin < end; ++begin) {
        if (ring > 0 && corners(groups[begin]).size() > kMostCorners) continue;
        for_ends(groups[begin], [&](std::uint32_t end_corner) {
          const std::uint32_t v = mesh_.corner_vertex[end_corner], to = group_[end_corner];
          if (std::find(vertices.begin(), vertices.end(), v) != vertices.end()) return;
          vertices.push_back(v), groups.push_back(to);
          const Vec3 way = mesh_.positions[v] - mesh_.positions[centre];
          if (way.isZero(0)) return;  // it lies on the vertex
          around.ways.push_back(way);
          around.cosines.push_back(normals_[to].dot(normals_[g]));
          least = std::min(least, way.stableNorm());
        });
      }
      if (ring == 0 && groups.size() - 1 != corners(g).size()) break;
      if (ring < 2) around.rings[ring] = around.ways.size();
      if (ring == 1 && around.ways.size() >= kFew) break;
    }
    for (Vec3& way : around.ways) {
      way /= least;
      const double nearness = 1 / way.squaredNorm();
      around.weights.push_back(nearness * nearness * nearness);
    }
    return around;
  }

 private:
  std::span<const std::uint32_t> corners(std::uint32_t g) const {
    return std::span(corners_).subspan(begin_[g], begin_[g + 1] - begin_[g]);
  }

  template <class F>
  void for_ends(std::uint32_t g, F f) const {
    for (const std::uint32_t c : corners(g)) {
      for (const std::uint32_t end : edges_[c]) f(end);
    }
  }

  const Mesh& mesh_;
  std::span<const std::uint32_t> group_;
  std::span<const Vec3> normals_;                    // [group]
  std::vector<std::array<std::uint32_t, 2>> edges_;  // [corner], the corners that its edges lead to
  std::vector<std::uint32_t> begin_, corners_;       // [group], [begin_]
};

}  // namespace

std::vector<FittedNormal> fitted_normals(const Mesh& mesh, std::span<const std::uint32_t> group,
                                         std::span<const Vec3> start, const ParallelFor& parallel) {
  constexpr std::size_t kGrain = 1024;
  const Neighbours neighbours(mesh, group, start);
  std::vector<FittedNormal> fitted(start.size());
  parallel(start.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    Neighbours::Work work;
    for (std::size_t g = begin; g < end; ++g)
      fitted[g] = fit_normal(neighbours.around(static_cast<std::uint32_t>(g), work), start[g]);
  });
  return fitted;
}

}  // namespace gliss
