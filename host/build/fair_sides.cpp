#include "gliss/build/fair_sides.h"

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
  const auto is_triangle = [&](std::uint32_t f) { return mesh_.valence(f) == 3; };
  if (vertices_.empty() && std::any_of(faces.begin(), faces.end(), is_triangle))
    find_turns(parallel);
  shapes_.resize(has_shape_.size());
  parallel(shapes_.size(), kVertexGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (has_shape_[i]) has_shape_[i] = find_shape(i);
    }
  });
}

FairSides::End FairSides::corner(std::uint32_t side) const {
  const Vec3 p = frame_.position(side), n = frame_.normal(side);
  return {{p.x(), p.y(), p.z(), n.x(), n.y(), n.z()}};
}

// 3 or 4 if both of its faces are triangles, or quads, that have the same normals at its ends, or
// if it is a triangle's at a border; else 0, as at creases.
std::uint32_t FairSides::joined_valence(std::uint32_t side) const {
  if (frame_.has_tangents(side)) return 0;
  const std::uint32_t n = mesh_.valence(topology_.side_face[side]),
                      twin = topology_.side_twin[side];
  if (twin == kNone) return n == 3 ? 3 : 0;
  const auto normal = [&](std::uint32_t s) { return mesh_.normals[mesh_.corner_normal[s]]; };
  const bool is_joined = n <= 4 && mesh_.valence(topology_.side_face[twin]) == n &&
                         normal(side) == normal(next_side(mesh_, topology_, twin)) &&
                         normal(next_side(mesh_, topology_, side)) == normal(twin);
  return is_joined ? n : 0;
}

// Turns each edge once and not four times: if all faces are built.
void FairSides::find_turns(const ParallelFor& parallel) {
  turn_.resize(mesh_.corner_vertex.size());
  parallel(mesh_.face_count(), kVertexGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      if (mesh_.valence(f) != 3) continue;
      for (std::uint32_t s = mesh_.face_begin[f]; s < mesh_.face_begin[f + 1]; ++s) {
        const std::uint32_t twin = topology_.side_twin[s];
        if (twin != kNone && s < twin && joined_valence(s) == 3) turn_[s] = find_turn(s);
      }
    }
  });
}

Vec3 FairSides::find_turn(std::uint32_t side) const {
  const std::uint32_t next = next_side(mesh_, topology_, side), twin = topology_.side_twin[side];
  const End ends[2] = {corner(side), corner(next)},
            beyond[2] = {corner(next_side(mesh_, topology_, next)),
                         corner(prev_side(mesh_, topology_, twin))};
  Vec3 turn;
  kernels<double>().fair_turn(ends[0].reals, beyond[0].reals, turn.data());
  return turn;
}

FairEdge<double> FairSides::edge(std::uint32_t side, std::uint32_t joined, const End& end) const {
  const std::uint32_t twin = topology_.side_twin[side];
  FairEdge<double> e;
  std::copy_n(end.reals, 6, e.end);
  if (frame_.has_tangents(side)) {
    for (std::uint32_t i = 0; i < 2; ++i)
      std::copy_n(frame_.tangent(side, i).data(), 3, e.tangents + 3 * i);
  }
  e.by_arc = joined == 3;
  if (!e.by_arc || twin == kNone) return e;
  const std::uint32_t lesser = std::min(side, twin);
  const Vec3 turn = turn_.empty() ? find_turn(lesser) : turn_[lesser];
  std::copy_n(turn.data(), 3, e.turn);
  return e;
}

bool FairSides::find_shape(std::size_t i) {
  const std::uint32_t first =
      topology_.vertex_side[vertices_.empty() ? static_cast<std::uint32_t>(i) : vertices_[i]];
  const auto normal = [&](std::uint32_t s) { return mesh_.normals[mesh_.corner_normal[s]]; };
  thread_local std::vector<FairEdge<double>> edges;
  edges.clear();
  for (std::uint32_t side = first; side != kNone;) {
    if (normal(side) != normal(first)) return false;
    // The arc of a rounded crease, which bends where the faces beside it do not.
    if (!mesh_.strips.empty() && frame_.has_tangents(side)) return false;
    edges.push_back(edge(side, joined_valence(side), corner(next_side(mesh_, topology_, side))));
    const std::uint32_t last = prev_side(mesh_, topology_, side);
    side = next_around(mesh_, topology_, side);
    if (side == first) break;
    if (side != kNone) continue;
    // The border side that ends here.
    FairEdge<double> e;
    std::copy_n(corner(last).reals, 6, e.end);
    e.by_arc = joined_valence(last) == 3;
    edges.push_back(e);
  }
  kernels<double>().fair_vertex(corner(first).reals, edges.data(), edges.size(), &shapes_[i]);
  return is_finite(shapes_[i]);
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

void FairSides::sides_of(std::uint32_t face, std::vector<double>& sides) const {
  const std::uint32_t first = mesh_.face_begin[face], n = mesh_.valence(face);
  sides.resize(n * kFairReals);
  const End begin = corner(first);
  End start = begin;
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t side = first + k, next = k + 1 < n ? side + 1 : first;
    const End end = next == first ? begin : corner(next);
    const std::uint32_t joined = joined_valence(side);
    const FairVertex<double>*from = nullptr, *to = nullptr;
    if (joined != 0) {
      from = shape_of(mesh_.corner_vertex[side]);
      to = shape_of(mesh_.corner_vertex[next]);
    }
    kernels<double>().fair_side(start.reals, edge(side, joined, end), from, to, joined == 4,
                                &sides[k * kFairReals]);
    start = end;
  }
}

}  // namespace gliss
