#include "gliss/compare/tessellate.h"

#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "gliss/base/plain_arithmetic.h"
#include "gliss/query/query.h"
#include "gliss/surface/domain.h"

namespace gliss {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

// The corners of the triangles that a face is cut into without a centre, as where it is not convex;
// none where it is one patch or lies round a centre.
std::vector<Triangle> pieces_of(const PatchCache& cache, std::uint32_t face) {
  std::vector<Triangle> pieces;
  const std::uint32_t n = cache.face_valence[face], first = cache.first_patch(face);
  if (n == 3 || first == kNone) return {};
  std::visit(
      [&](const auto& s) {
        for (std::uint32_t p = first, end = cache.end_of_face(first); p < end; ++p) {
          const std::uint32_t* corner = &cache.corner_of_face[s.side_begin[p]];
          if (s.valence(p) != 3 || std::find(corner, corner + 3, n) != corner + 3)
            return pieces.clear();
          pieces.push_back({corner[0], corner[1], corner[2]});
        }
      },
      cache.surface);
  return pieces;
}

// Numbers the nodes of all faces: mesh vertices, then edges, then what faces have inside. Node
// (i, j) of corner k of a face lies i cells along side k and j cells back along the side before. Of
// a piece of a face it lies i cells from its corner 0 towards its corner 1, and j towards 2.
class Nodes {
 public:
  Nodes(const Mesh& mesh, const Topology& topology, std::uint32_t cells)
      : mesh_(mesh), topology_(topology), cells_(cells), edge_(topology.side_face.size()) {
    for (std::uint32_t s = 0; s < edge_.size(); ++s) {
      if (s == edge_side(s)) edge_[s] = take(2 * cells - 1);
    }
  }

  std::size_t count() const { return next_; }

  void begin_face(std::uint32_t face) {
    face_ = face;
    inside_ = take(1 + mesh_.valence(face) * (cells_ - 1) * cells_);
  }
  std::uint32_t id(std::uint32_t k, std::uint32_t i, std::uint32_t j) const {
    const std::uint32_t n = mesh_.valence(face_), c = cells_;
    if (j == 0) return on_line(k, (k + 1) % n, i);
    const std::uint32_t before = (k + n - 1) % n;
    if (i == 0) return on_line(k, before, j);
    if (i == c && j == c) return inside_;
    // The line from the middle of side k to the centre, which the next corner has as j = c.
    if (j == c) return id(before, c, i);
    return inside_ + 1 + (k * c + i - 1) * (c - 1) + j - 1;
  }

  void begin_cut_face(std::uint32_t face) {
    face_ = face;
    cuts_.clear();
  }
  void begin_piece(const Triangle& corners) {
    piece_ = corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = corners[k], b = corners[(k + 1) % 3];
      if (!is_side(a, b) && !is_side(b, a) && !cuts_.contains(std::minmax(a, b)))
        cuts_[std::minmax(a, b)] = take(2 * cells_ - 1);
    }
    inside_ = take((2 * cells_ - 1) * (cells_ - 1));
  }
  std::uint32_t id_in_piece(std::uint32_t i, std::uint32_t j) const {
    const std::uint32_t last = 2 * cells_;
    if (j == 0) return on_line(piece_[0], piece_[1], i);
    if (i == 0) return on_line(piece_[0], piece_[2], j);
    if (i + j == last) return on_line(piece_[1], piece_[2], j);
    return inside_ + (j - 1) * (last - 2) - (j - 1) * (j - 2) / 2 + i - 1;
  }

 private:
  std::uint32_t take(std::uint32_t count) {
    const std::uint32_t first = next_;
    next_ += count;
    return first;
  }
  bool is_side(std::uint32_t from, std::uint32_t to) const {
    return to == (from + 1) % mesh_.valence(face_);
  }
  std::uint32_t edge_side(std::uint32_t side) const {
    const std::uint32_t twin = topology_.side_twin[side];
    return twin == kNone ? side : std::min(side, twin);
  }
  // So many cells from a corner of the face towards another, along a side or a cut.
  std::uint32_t on_line(std::uint32_t from, std::uint32_t to, std::uint32_t at) const {
    const std::uint32_t first = mesh_.face_begin[face_], last = 2 * cells_;
    if (at == 0) return mesh_.corner_vertex[first + from];
    if (at == last) return mesh_.corner_vertex[first + to];
    if (is_side(from, to)) return on_side(first + from, at);
    if (is_side(to, from)) return on_side(first + to, last - at);
    return cuts_.at(std::minmax(from, to)) + (from < to ? at : last - at) - 1;
  }
  std::uint32_t on_side(std::uint32_t side, std::uint32_t i) const {
    const std::uint32_t owner = edge_side(side);
    return edge_[owner] + (owner == side ? i : 2 * cells_ - i) - 1;
  }

  const Mesh& mesh_;
  const Topology& topology_;
  const std::uint32_t cells_;
  std::vector<std::uint32_t> edge_;  // [side that owns it], its first node
  std::uint32_t next_ = static_cast<std::uint32_t>(mesh_.positions.size());
  std::uint32_t face_ = 0, inside_ = 0;  // what was begun, and the first node inside of it
  Triangle piece_{};
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> cuts_;  // first node
};

// The triangles of a tessellation, and where its nodes lie.
class Tessellation {
 public:
  Tessellation(const Mesh& mesh, const PatchCache& cache, const Topology& topology,
               std::uint32_t cells, const Poll& poll)
      : nodes_(mesh, topology, cells), cells_(cells), poll_(poll) {
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
      const std::vector<Triangle> pieces = pieces_of(cache, f);
      pieces.empty() ? add_face(f, mesh.valence(f)) : add_cut_face(f, mesh.valence(f), pieces);
    }
    at.resize(nodes_.count(), DomainPoint{0, 0, 0});  // a vertex that no face uses
  }

  std::vector<std::uint32_t> corners;
  std::vector<DomainPoint> at;  // [node]

 private:
  void place(std::uint32_t node, std::uint32_t face, const Eigen::Vector2d& x) {
    if (at.size() <= node) at.resize(nodes_.count(), DomainPoint{kNone, 0, 0});
    if (at[node].face == kNone) at[node] = {face, x.x(), x.y()};
  }

  void add_face(std::uint32_t face, std::uint32_t n) {
    nodes_.begin_face(face);
    for (std::uint32_t k = 0; k < n; ++k) {
      poll_();
      const Eigen::Vector2d corner = on_side(n, k, 0), after = on_side(n, k, 0.5),
                            before = on_side(n, (k + n - 1) % n, 0.5);
      for (std::uint32_t j = 0; j <= cells_; ++j) {
        for (std::uint32_t i = 0; i <= cells_; ++i) {
          const double s = i / static_cast<double>(cells_), t = j / static_cast<double>(cells_);
          place(nodes_.id(k, i, j), face,
                (1 - s) * (1 - t) * corner + s * (1 - t) * after + (1 - s) * t * before);
          if (i == cells_ || j == cells_) continue;
          const std::uint32_t quad[] = {nodes_.id(k, i, j), nodes_.id(k, i + 1, j),
                                        nodes_.id(k, i + 1, j + 1), nodes_.id(k, i, j + 1)};
          for (const int c : {0, 1, 2, 0, 2, 3}) corners.push_back(quad[c]);
        }
      }
    }
  }

  void add_cut_face(std::uint32_t face, std::uint32_t n, const std::vector<Triangle>& pieces) {
    nodes_.begin_cut_face(face);
    const std::uint32_t last = 2 * cells_;
    for (const Triangle& piece : pieces) {
      poll_();
      nodes_.begin_piece(piece);
      const Eigen::Vector2d a = on_side(n, piece[0], 0), b = on_side(n, piece[1], 0),
                            c = on_side(n, piece[2], 0);
      for (std::uint32_t j = 0; j <= last; ++j) {
        for (std::uint32_t i = 0; i + j <= last; ++i) {
          const std::uint32_t node = nodes_.id_in_piece(i, j);
          place(node, face, a + (i * (b - a) + j * (c - a)) / last);
          if (i + j == last) continue;
          const std::uint32_t along = nodes_.id_in_piece(i + 1, j),
                              aside = nodes_.id_in_piece(i, j + 1);
          corners.insert(corners.end(), {node, along, aside});
          if (i + j + 1 == last) continue;
          corners.insert(corners.end(), {along, nodes_.id_in_piece(i + 1, j + 1), aside});
        }
      }
    }
  }

  Nodes nodes_;
  const std::uint32_t cells_;
  const Poll& poll_;
};

}  // namespace

std::uint64_t tessellated_count(const Mesh& mesh, const PatchCache& cache, std::uint32_t cells) {
  std::uint64_t quads = 0;  // in units of cells x cells
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const std::size_t pieces = pieces_of(cache, f).size();
    quads += pieces == 0 ? mesh.valence(f) : 2 * pieces;
  }
  return 2 * quads * cells * cells;
}

Mesh tessellate(const Mesh& mesh, const PatchCache& cache, std::uint32_t cells,
                const ParallelFor& parallel, const Poll& poll) {
  const PlainArithmetic plain;
  constexpr std::size_t kGrain = 4096;
  Tessellation made(mesh, cache, build_topology(mesh), cells, poll);
  Mesh dense;
  dense.unit = mesh.unit;
  dense.source = mesh.source + ", tessellated";
  dense.corner_vertex = std::move(made.corners);
  const std::vector<DomainPoint>& at = made.at;
  dense.positions.resize(at.size());
  dense.normals.resize(at.size());
  parallel(at.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    poll();
    std::vector<SurfacePoint> points(end - begin);
    evaluate(cache, std::span(at).subspan(begin, end - begin), points);
    for (std::size_t i = begin; i < end; ++i) {
      dense.positions[i] = points[i - begin].position;
      dense.normals[i] = points[i - begin].normal;
    }
  });
  dense.corner_normal = dense.corner_vertex;
  dense.face_begin.clear();
  for (std::size_t c = 0; c <= dense.corner_vertex.size(); c += 3)
    dense.face_begin.push_back(static_cast<std::uint32_t>(c));
  return dense;
}

}  // namespace gliss
