#include "gliss/study/tessellate.h"

#include <span>

#include "gliss/base/plain_arithmetic.h"
#include "gliss/query/query.h"

namespace gliss {
namespace {

// Numbers the nodes of all faces: mesh vertices, then edges, then faces' inner nodes. Node (i, j)
// of corner k lies i cells along side k and j cells back along the side before.
class Nodes {
 public:
  Nodes(const Mesh& mesh, const Topology& topology, std::uint32_t cells)
      : mesh_(mesh), topology_(topology), cells_(cells), edge_(topology.side_face.size()) {
    for (std::uint32_t s = 0; s < edge_.size(); ++s) {
      if (s == edge_side(s)) edge_[s] = take(2 * cells - 1);
    }
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
      const std::uint32_t n = mesh.valence(f);
      face_.push_back(take(1 + n * (cells - 1) * cells));
    }
  }

  std::size_t count() const { return next_; }

  std::uint32_t id(std::uint32_t face, std::uint32_t k, std::uint32_t i, std::uint32_t j) const {
    const std::uint32_t n = mesh_.valence(face), first = mesh_.face_begin[face], c = cells_;
    if (i == 0 && j == 0) return mesh_.corner_vertex[first + k];
    if (j == 0) return on_side(first + k, i);
    if (i == 0) return on_side(first + (k + n - 1) % n, 2 * c - j);
    if (i == c && j == c) return face_[face];
    // The line from the middle of side k to the centre, which the next corner has as j = c.
    if (j == c) return id(face, (k + n - 1) % n, c, i);
    return face_[face] + 1 + (k * c + i - 1) * (c - 1) + j - 1;
  }

 private:
  std::uint32_t take(std::uint32_t count) {
    const std::uint32_t first = next_;
    next_ += count;
    return first;
  }
  std::uint32_t edge_side(std::uint32_t side) const {
    const std::uint32_t twin = topology_.side_twin[side];
    return twin == kNone ? side : std::min(side, twin);
  }
  std::uint32_t on_side(std::uint32_t side, std::uint32_t i) const {
    const std::uint32_t owner = edge_side(side);
    return edge_[owner] + (owner == side ? i : 2 * cells_ - i) - 1;
  }

  const Mesh& mesh_;
  const Topology& topology_;
  const std::uint32_t cells_;
  std::vector<std::uint32_t> edge_, face_;  // first node of each
  std::uint32_t next_ = static_cast<std::uint32_t>(mesh_.positions.size());
};

Eigen::Vector2d at_side(std::uint32_t n, std::uint32_t k, double t) {
  const DomainPoint x = on_side(0, n, k, t);
  return {x.xi, x.eta};
}

}  // namespace

std::uint64_t tessellated_count(const Mesh& mesh, std::uint32_t cells) {
  return 2 * std::uint64_t{cells} * cells * mesh.corner_vertex.size();
}

Mesh tessellate(const Mesh& mesh, const PatchCache& cache, std::uint32_t cells,
                const ParallelFor& parallel) {
  const PlainArithmetic plain;
  constexpr std::size_t kGrain = 4096;
  const Topology topology = build_topology(mesh);
  const Nodes nodes(mesh, topology, cells);
  std::vector<DomainPoint> at(nodes.count(), DomainPoint{kNone, 0, 0});
  Mesh dense;
  dense.unit = mesh.unit;
  dense.source = mesh.source + ", tessellated";
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const std::uint32_t n = mesh.valence(f);
    for (std::uint32_t k = 0; k < n; ++k) {
      const Eigen::Vector2d corner = at_side(n, k, 0), after = at_side(n, k, 0.5),
                            before = at_side(n, (k + n - 1) % n, 0.5);
      for (std::uint32_t j = 0; j <= cells; ++j) {
        for (std::uint32_t i = 0; i <= cells; ++i) {
          const double s = i / static_cast<double>(cells), t = j / static_cast<double>(cells);
          const Eigen::Vector2d x =
              (1 - s) * (1 - t) * corner + s * (1 - t) * after + (1 - s) * t * before;
          DomainPoint& node = at[nodes.id(f, k, i, j)];
          if (node.face == kNone) node = {f, x.x(), x.y()};
          if (i == cells || j == cells) continue;
          const std::uint32_t quad[] = {nodes.id(f, k, i, j), nodes.id(f, k, i + 1, j),
                                        nodes.id(f, k, i + 1, j + 1), nodes.id(f, k, i, j + 1)};
          for (const int c : {0, 1, 2, 0, 2, 3}) dense.corner_vertex.push_back(quad[c]);
        }
      }
    }
  }
  for (DomainPoint& node : at) {
    if (node.face == kNone) node.face = 0;  // a vertex that no face uses
  }
  std::vector<SurfacePoint> points(at.size());
  parallel(at.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    evaluate(cache, std::span(at).subspan(begin, end - begin),
             std::span(points).subspan(begin, end - begin));
  });
  for (const SurfacePoint& p : points) {
    dense.positions.push_back(p.position);
    dense.normals.push_back(p.normal);
  }
  dense.corner_normal = dense.corner_vertex;
  dense.face_begin.clear();
  for (std::size_t c = 0; c <= dense.corner_vertex.size(); c += 3)
    dense.face_begin.push_back(static_cast<std::uint32_t>(c));
  return dense;
}

}  // namespace gliss
