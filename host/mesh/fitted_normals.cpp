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

using Vec5 = Eigen::Matrix<double, 5, 1>;
using Mat5 = Eigen::Matrix<double, 5, 5>;

// The coefficients a, b, c, p, q of the quadric across a unit normal; lengths in the least distance
// of the vertices around.
struct Quadric {
  Vec3 x, y, normal;
  Vec5 coefficient;

  Vec5 terms(const Vec3& d) const {
    const double u = d.dot(x), v = d.dot(y);
    return {u, v, d.squaredNorm() / 2, (u * u - v * v) / 2, u * v};
  }
};

// False if the vertices around do not determine it.
bool fit_quadric(const std::vector<Vec3>& around, const Vec3& normal, Quadric& quadric) {
  constexpr double kDetermined = 1e-8;  // least pivot over the largest, of squares
  quadric.normal = normal;
  quadric.x = normal.unitOrthogonal();
  quadric.y = normal.cross(quadric.x);
  Mat5 squares = Mat5::Zero();
  Vec5 heights = Vec5::Zero();
  for (const Vec3& d : around) {
    const double nearness = 1 / d.squaredNorm();
    const double weight = nearness * nearness * nearness;
    const Vec5 terms = quadric.terms(d);
    squares += weight * terms * terms.transpose();
    heights += weight * d.dot(normal) * terms;
  }
  const Eigen::LDLT<Mat5> solver(squares);
  const Vec5 pivots = solver.vectorD();
  if (!(pivots.minCoeff() > kDetermined * pivots.maxCoeff())) return false;
  quadric.coefficient = solver.solve(heights);
  return quadric.coefficient.allFinite();
}

FittedNormal fit_normal(const std::vector<Vec3>& around, const Vec3& start) {
  constexpr int kPasses = 2;
  const FittedNormal none = {start, std::numeric_limits<double>::infinity()};
  FittedNormal fitted = none;
  for (int pass = 0; pass < kPasses; ++pass) {
    Quadric quadric;
    if (!fit_quadric(around, fitted.normal, quadric)) return none;
    double sum = 0;
    for (const Vec3& d : around) {
      const double off = d.dot(quadric.normal) - quadric.terms(d).dot(quadric.coefficient);
      sum += off * off / d.squaredNorm();
    }
    fitted.normal =
        (quadric.normal - quadric.coefficient[0] * quadric.x - quadric.coefficient[1] * quadric.y)
            .normalized();
    fitted.error = std::sqrt(sum / static_cast<double>(around.size()));
  }
  return fitted;
}

// The corners of each group and what their edges lead to.
class Neighbours {
 public:
  // Arrays of a thread that asks.
  struct Work {
    std::vector<std::uint32_t> vertices, groups;
    std::vector<Vec3> ways;
  };

  Neighbours(const Mesh& mesh, std::span<const std::uint32_t> group, std::size_t count)
      : mesh_(mesh), group_(group), edges_(group.size()), begin_(count + 1, 0) {
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

  // The ways from a group's vertex to those that one edge or two lead to, over the least of their
  // lengths. A neighbour where more than kMostCorners meet leads no farther. None if the corners
  // of the group do not go all round the vertex.
  const std::vector<Vec3>& around(std::uint32_t g, Work& work) const {
    constexpr std::size_t kMostCorners = 64;
    auto& [vertices, groups, ways] = work;
    ways.clear();
    if (corners(g).empty()) return ways;
    vertices.clear();
    groups.clear();
    for_ends(g, [&](std::uint32_t end) {
      vertices.push_back(mesh_.corner_vertex[end]);
      groups.push_back(group_[end]);
    });
    keep_one_each(groups);
    if (groups.size() != corners(g).size()) return ways;
    for (const std::uint32_t neighbour : groups) {
      if (corners(neighbour).size() > kMostCorners) continue;
      for_ends(neighbour, [&](std::uint32_t end) { vertices.push_back(mesh_.corner_vertex[end]); });
    }
    keep_one_each(vertices);
    const Vec3& at = mesh_.positions[mesh_.corner_vertex[corners(g).front()]];
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t v : vertices) {
      const Vec3 way = mesh_.positions[v] - at;
      const double length = way.stableNorm();
      if (length == 0) continue;  // the vertex itself, or one that lies on it
      ways.push_back(way);
      least = std::min(least, length);
    }
    for (Vec3& way : ways) way /= least;
    return ways;
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

  static void keep_one_each(std::vector<std::uint32_t>& numbers) {
    std::sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  }

  const Mesh& mesh_;
  std::span<const std::uint32_t> group_;
  std::vector<std::array<std::uint32_t, 2>> edges_;  // [corner], the corners that its edges lead to
  std::vector<std::uint32_t> begin_, corners_;       // [group], [begin_]
};

}  // namespace

std::vector<FittedNormal> fitted_normals(const Mesh& mesh, std::span<const std::uint32_t> group,
                                         std::size_t count, std::span<const Vec3> start,
                                         const ParallelFor& parallel) {
  constexpr std::size_t kGrain = 1024;
  const Neighbours neighbours(mesh, group, count);
  std::vector<FittedNormal> fitted(count);
  parallel(count, kGrain, [&](std::size_t begin, std::size_t end) {
    Neighbours::Work work;
    for (std::size_t g = begin; g < end; ++g)
      fitted[g] = fit_normal(neighbours.around(static_cast<std::uint32_t>(g), work), start[g]);
  });
  return fitted;
}

}  // namespace gliss
