#include "gliss/build/fair_sides.h"

#include "gliss/mesh/sectors.h"
#include "gliss/surface/layout.h"

#include <algorithm>
#include <cmath>

namespace gliss {
namespace {

constexpr std::size_t kVertexGrain = 64;

bool is_finite(const FairVertex<double>& v) {
  return std::all_of(std::begin(v.shape), std::end(v.shape),
                     [](double x) { return std::isfinite(x); });
}

}  // namespace

FairSides::FairSides(const MeshFrame& frame, const Topology& topology,
                     std::span<const std::uint32_t> faces, const ParallelFor& parallel)
    : frame_(frame), mesh_(frame.mesh), topology_(topology) {
  const auto for_vertices = [&](auto body) {
    for (const std::uint32_t f : faces) {
      if (mesh_.valence(f) > 4) continue;
      for (std::uint32_t s = mesh_.face_begin[f]; s < mesh_.face_begin[f + 1]; ++s)
        body(mesh_.corner_vertex[s]);
    }
  };
  if (faces.size() == mesh_.face_count()) {
    has_shape_.resize(mesh_.positions.size());
    for_vertices([&](std::uint32_t v) { has_shape_[v] = 1; });
  } else {
    for_vertices([&](std::uint32_t v) { vertices_.push_back(v); });
    std::sort(vertices_.begin(), vertices_.end());
    vertices_.erase(std::unique(vertices_.begin(), vertices_.end()), vertices_.end());
    has_shape_.resize(vertices_.size(), 1);
  }
  if (vertices_.empty()) {
    std::vector<char> flat(mesh_.face_count());
    parallel(flat.size(), kVertexGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f) flat[f] = is_flat(static_cast<std::uint32_t>(f));
    });
    flat_ = std::move(flat);
  }
  shapes_.resize(has_shape_.size());
  parallel(shapes_.size(), kVertexGrain,
           [&](std::size_t begin, std::size_t end) { find_shapes(begin, end); });
}

void FairSides::put_corner(std::uint32_t side, double* reals) const {
  std::copy_n(frame_.position(side).data(), 3, reals);
  std::copy_n(frame_.normal(side).data(), 3, reals + 3);
}

// True if the face lies, with its normals, in a plane.
bool FairSides::is_flat(std::uint32_t face) const {
  constexpr double kFlat = 1e-5;  // sine
  if (!flat_.empty()) return flat_[face] != 0;
  const std::uint32_t begin = mesh_.face_begin[face], end = mesh_.face_begin[face + 1];
  for (std::uint32_t c = begin; c < end; ++c) {
    const Vec3 normal = frame_.normal(c), at = frame_.position(c);
    for (std::uint32_t d = begin; d < end; ++d) {
      const Vec3 way = frame_.position(d) - at;
      if (std::abs(normal.dot(way)) > kFlat * way.norm()) return false;
    }
  }
  return true;
}

// 3 or 4 if both of its faces are triangles, or quads, that have the same normals at its ends, or
// if it is a triangle's at a border; else 0, as at creases, and beside a flat face.
std::uint32_t FairSides::joined_valence(std::uint32_t side) const {
  if (mesh_.has_tangents(side)) return 0;
  const std::uint32_t face = topology_.side_face[side], n = mesh_.valence(face),
                      twin = topology_.side_twin[side];
  if (twin == kNone) return n == 3 && !is_flat(face) ? 3 : 0;
  const std::uint32_t beyond = topology_.side_face[twin];
  const bool is_joined = n <= 4 && mesh_.valence(beyond) == n &&
                         shares_normals(mesh_, topology_, side) && !is_flat(face) &&
                         !is_flat(beyond);
  return is_joined ? n : 0;
}

FairEdge<double> FairSides::edge(std::uint32_t side, std::uint32_t joined) const {
  FairEdge<double> e;
  put_corner(side, e.start);
  put_corner(next_side(mesh_, topology_, side), e.end);
  if (mesh_.has_tangents(side)) {
    for (std::uint32_t i = 0; i < 2; ++i)
      std::copy_n(frame_.tangent(side, i).data(), 3, e.tangents + 3 * i);
  }
  e.by_arc = joined == 3;
  return e;
}

void FairSides::find_shapes(std::size_t begin, std::size_t end) {
  std::vector<FairEdge<double>> edges;
  std::vector<std::size_t> vertices;
  std::vector<std::uint32_t> edge_begin{0};
  for (std::size_t i = begin; i < end; ++i) {
    if (!has_shape_[i]) continue;
    has_shape_[i] = add_edges(i, edges);
    if (has_shape_[i]) {
      vertices.push_back(i);
      edge_begin.push_back(static_cast<std::uint32_t>(edges.size()));
    }
    edges.resize(edge_begin.back());
  }
  std::vector<FairVertex<double>> shapes(vertices.size());
  kernels<double>().fair_vertices(edges.data(), edge_begin.data(), vertices.size(), shapes.data());
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    shapes_[vertices[k]] = shapes[k];
    has_shape_[vertices[k]] = is_finite(shapes[k]);
  }
}

bool FairSides::add_edges(std::size_t i, std::vector<FairEdge<double>>& edges) const {
  const std::uint32_t first =
      topology_.vertex_side[vertices_.empty() ? static_cast<std::uint32_t>(i) : vertices_[i]];
  const auto normal = [&](std::uint32_t s) { return mesh_.normals[mesh_.corner_normal[s]]; };
  for (std::uint32_t side = first; side != kNone;) {
    if (normal(side) != normal(first)) return false;
    // The arc of a rounded crease, which bends where the faces beside it do not.
    if (!mesh_.strips.empty() && mesh_.has_tangents(side)) return false;
    edges.push_back(edge(side, joined_valence(side)));
    const std::uint32_t last = prev_side(mesh_, topology_, side);
    side = next_around(mesh_, topology_, side);
    if (side == first) break;
    if (side != kNone) continue;
    // The border side that ends here.
    FairEdge<double> e;
    put_corner(first, e.start);
    put_corner(last, e.end);
    e.by_arc = joined_valence(last) == 3;
    edges.push_back(e);
  }
  return true;
}

const FairVertex<double>* FairSides::shape_of(std::uint32_t vertex) const {
  std::size_t i = vertex;
  if (!vertices_.empty()) {
    const auto at = std::lower_bound(vertices_.begin(), vertices_.end(), vertex);
    if (at == vertices_.end() || *at != vertex) return nullptr;
    i = static_cast<std::size_t>(at - vertices_.begin());
  }
  return i < has_shape_.size() && has_shape_[i] ? &shapes_[i] : nullptr;
}

// A turn of the normals at mid-side lifts a face by its extent across the side: one that is short
// for its faces turns less.
double FairSides::twist_share(std::uint32_t side) const {
  constexpr double kShort = 0.5;
  const Vec3 from = frame_.position(side),
             edge = frame_.position(next_side(mesh_, topology_, side)) - from;
  double across = 0;  // times the edge's length
  for (const std::uint32_t s : {side, topology_.side_twin[side]}) {
    if (s == kNone) continue;
    const Vec3 way = frame_.position(prev_side(mesh_, topology_, s)) - from;
    across = std::max(across, way.cross(edge).norm());
  }
  return std::min(1.0, edge.squaredNorm() / (kShort * across));
}

void FairSides::sides_of(std::span<const std::uint32_t> faces, std::vector<double>& out) const {
  thread_local std::vector<FairSide<double>> sides;
  sides.clear();
  for (const std::uint32_t face : faces) {
    for (std::uint32_t side = mesh_.face_begin[face]; side < mesh_.face_begin[face + 1]; ++side) {
      const std::uint32_t joined = joined_valence(side);
      FairSide<double>& s = sides.emplace_back();
      s.edge = edge(side, joined);
      if (joined == 0) continue;
      const FairVertex<double>*from = shape_of(mesh_.corner_vertex[side]),
            *to = shape_of(mesh_.corner_vertex[next_side(mesh_, topology_, side)]);
      if (from == nullptr || to == nullptr) continue;
      s.from = *from;
      s.to = *to;
      (joined == 4 ? s.has_mid_normal : s.bends) = 1;
      s.twist_share = twist_share(side);
    }
  }
  out.resize(sides.size() * kFairReals);
  kernels<double>().fair_sides(sides.data(), sides.size(), out.data());
}

}  // namespace gliss
