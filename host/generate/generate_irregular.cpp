// Random triangles on the surface of a generated solid.
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <unordered_map>
#include <vector>

#include "gliss/generate/generate.h"
#include "gliss/generate/generate_parts.h"
#include "gliss/mesh/triangulate.h"

namespace gliss {
namespace {

constexpr int kRounds = 8;            // of moving all vertices
constexpr double kLeastFacing = 0.2;  // cosine between a triangle and the surface at its corners

// True for each vertex of which corners have different normals.
std::vector<bool> sharp_vertices(const Mesh& mesh) {
  std::vector<std::uint32_t> normal(mesh.positions.size(), kNone);
  std::vector<bool> sharp(mesh.positions.size(), false);
  for (std::size_t c = 0; c < mesh.corner_vertex.size(); ++c) {
    const std::uint32_t v = mesh.corner_vertex[c];
    if (normal[v] == kNone) normal[v] = mesh.corner_normal[c];
    sharp[v] = sharp[v] || normal[v] != mesh.corner_normal[c];
  }
  return sharp;
}

// Triangles on an exact surface, whose edges can be flipped.
class Irregular {
 public:
  Irregular(const Generated& from, std::uint64_t seed)
      : exact_(*from.exact),
        random_(seed),
        from_(from.mesh),
        stays_(sharp_vertices(from.mesh)),
        position_(from.mesh.positions),
        normal_(position_.size(), Vec3::Zero()) {
    const Mesh& mesh = from.mesh;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      const std::uint32_t* corner = &mesh.corner_vertex[mesh.face_begin[f]];
      if (std::all_of(corner, corner + mesh.valence(f), [&](auto v) { return stays_[v]; })) {
        kept_.push_back(f);
        continue;
      }
      std::vector<Vec3> polygon;
      Vec3 normal = Vec3::Zero();
      for (std::uint32_t k = 0; k < mesh.valence(f); ++k) polygon.push_back(position_[corner[k]]);
      for (std::uint32_t k = 0; k < mesh.valence(f); ++k)
        normal += polygon[k].cross(polygon[(k + 1) % mesh.valence(f)]);
      std::vector<std::uint32_t> cut;
      triangulate(polygon, normal, cut);
      for (std::size_t t = 0; t < cut.size(); t += 3)
        put(static_cast<std::uint32_t>(triangle_.size()),
            {corner[cut[t]], corner[cut[t + 1]], corner[cut[t + 2]]});
      for (std::uint32_t c = mesh.face_begin[f]; c < mesh.face_begin[f + 1]; ++c) {
        Vec3& normal = normal_[mesh.corner_vertex[c]];
        const Vec3& of_corner = mesh.normals[mesh.corner_normal[c]];
        require(normal == Vec3::Zero() || normal == of_corner,
                "irregular: sharp edges round whole faces only");
        normal = of_corner;
      }
    }
    require(!triangle_.empty(), "irregular: needs vertices off its sharp edges");
    for (std::size_t v = 0; v < position_.size(); ++v) {
      if (!stays_[v]) normal_[v] = exact_.nearest(position_[v]).normal;
      has_edges_ = has_edges_ || stays_[v];
    }
  }

  void shuffle() {
    for (int round = 0; round < kRounds; ++round) {
      move_vertices();
      flip_edges();
    }
  }

  Mesh mesh(const std::string& source) const {
    Mesh mesh = make_mesh(source);
    mesh.positions = position_;
    mesh.normals = normal_;
    for (const Triangle& t : triangle_) add_face(mesh, {t[0], t[1], t[2]});
    share_normals(mesh);
    for (const std::size_t f : kept_) {
      for (std::uint32_t c = from_.face_begin[f]; c < from_.face_begin[f + 1]; ++c) {
        mesh.corner_vertex.push_back(from_.corner_vertex[c]);
        mesh.corner_normal.push_back(static_cast<std::uint32_t>(mesh.normals.size()));
        mesh.normals.push_back(from_.normals[from_.corner_normal[c]]);
      }
      add_face(mesh, {});
    }
    return mesh;
  }

 private:
  using Triangle = std::array<std::uint32_t, 3>;

  static std::uint64_t edge(std::uint32_t from, std::uint32_t to) {
    return std::uint64_t{from} << 32 | to;
  }

  void put(std::uint32_t at, const Triangle& t) {
    if (at == triangle_.size()) triangle_.emplace_back();
    triangle_[at] = t;
    for (int k = 0; k < 3; ++k) owner_[edge(t[k], t[(k + 1) % 3])] = at;
  }

  // From -1 to 1.
  double symmetric() { return 2 * (static_cast<double>(random_() >> 11) * 0x1p-53) - 1; }

  bool faces_out(const Triangle& t) const {
    const Vec3 n =
        (position_[t[1]] - position_[t[0]]).cross(position_[t[2]] - position_[t[0]]).normalized();
    return n.dot(normal_[t[0]]) > kLeastFacing && n.dot(normal_[t[1]]) > kLeastFacing &&
           n.dot(normal_[t[2]]) > kLeastFacing;
  }

  // True if the surface from one place to the other has no edge in sight, and none at the other,
  // where a point a little beneath would have another nearest one.
  bool is_smooth_between(const Vec3& normal, const ExactSurface::Point& to, double length) const {
    if (!has_edges_) return true;
    const double beneath = 1e-4 * length;
    const Vec3 back = exact_.nearest(to.position - beneath * to.normal).position;
    return normal.dot(to.normal) > kLeastFacing && (back - to.position).norm() < 1e-3 * beneath;
  }

  // Each by up to the mean length of its edges, if its triangles keep facing outwards.
  void move_vertices() {
    std::vector<std::vector<std::uint32_t>> around(position_.size());
    for (std::uint32_t t = 0; t < triangle_.size(); ++t) {
      for (const std::uint32_t v : triangle_[t]) around[v].push_back(t);
    }
    for (std::uint32_t v = 0; v < position_.size(); ++v) {
      if (stays_[v]) continue;
      double length = 0;
      for (const std::uint32_t t : around[v]) {
        for (const std::uint32_t w : triangle_[t])
          length +=
              (position_[w] - position_[v]).norm() / (2.0 * static_cast<double>(around[v].size()));
      }
      const Vec3 before = position_[v], normal = normal_[v];
      const auto moved =
          exact_.nearest(before + length * Vec3(symmetric(), symmetric(), symmetric()));
      if (!is_smooth_between(normal, moved, length)) continue;
      position_[v] = moved.position;
      normal_[v] = moved.normal;
      for (const std::uint32_t t : around[v]) {
        if (faces_out(triangle_[t])) continue;
        position_[v] = before;
        normal_[v] = normal;
        break;
      }
    }
  }

  double cotangent(std::uint32_t at, std::uint32_t a, std::uint32_t b) const {
    const Vec3 u = position_[a] - position_[at], v = position_[b] - position_[at];
    return u.dot(v) / u.cross(v).norm();
  }

  // Towards Delaunay triangles: edges whose opposite angles add up to more than pi.
  void flip_edges() {
    bool again = true;
    for (int pass = 0; again && pass < kRounds; ++pass) {
      again = false;
      for (std::uint32_t t = 0; t < triangle_.size(); ++t) {
        for (int k = 0; k < 3; ++k) again |= flip(t, k);
      }
    }
  }

  bool flip(std::uint32_t t, int k) {
    const std::uint32_t a = triangle_[t][k], b = triangle_[t][(k + 1) % 3],
                        c = triangle_[t][(k + 2) % 3];
    const auto twin = owner_.find(edge(b, a));
    if (twin == owner_.end()) return false;
    const std::uint32_t other = twin->second;
    std::uint32_t d = 0;
    for (const std::uint32_t v : triangle_[other]) d = v != a && v != b ? v : d;
    if (c == d || cotangent(c, a, b) + cotangent(d, a, b) > -1e-9) return false;
    if (owner_.contains(edge(c, d)) || owner_.contains(edge(d, c))) return false;
    const Triangle first = {c, a, d}, second = {d, b, c};
    if (!faces_out(first) || !faces_out(second)) return false;
    owner_.erase(edge(a, b));
    owner_.erase(edge(b, a));
    put(t, first);
    put(other, second);
    return true;
  }

  const ExactSurface& exact_;
  std::mt19937_64 random_;  // whose numbers the standard fixes
  const Mesh& from_;
  const std::vector<bool> stays_;        // [vertex]
  bool has_edges_ = false;               // some vertex stays
  std::vector<Vec3> position_, normal_;  // [vertex]; of its triangles, where it stays
  std::vector<std::size_t> kept_;        // faces of from_
  std::vector<Triangle> triangle_;
  std::unordered_map<std::uint64_t, std::uint32_t> owner_;  // of a directed edge
};

}  // namespace

Generated irregular(Generated from, std::uint64_t seed) {
  require(from.exact != nullptr && !from.mesh.normals.empty(),
          "irregular: a shape with an exact surface and normals");
  Irregular made(from, seed);
  made.shuffle();
  from.mesh = made.mesh("irregular " + from.mesh.source);
  return from;
}

}  // namespace gliss
