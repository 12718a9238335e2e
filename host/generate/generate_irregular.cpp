// Random triangles on the surface of a generated solid.
#include <array>
#include <cmath>
#include <random>
#include <unordered_map>

#include "gliss/generate/generate.h"
#include "gliss/generate/generate_parts.h"
#include "gliss/mesh/triangulate.h"

namespace gliss {
namespace {

constexpr int kRounds = 8;            // of moving all vertices
constexpr double kLeastFacing = 0.2;  // cosine between a triangle and the surface at its corners

// Triangles on an exact surface, whose edges can be flipped.
class Irregular {
 public:
  Irregular(const Generated& from, std::uint64_t seed)
      : exact_(*from.exact), random_(seed), position_(from.mesh.positions) {
    const Mesh& mesh = from.mesh;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      const std::uint32_t* corner = &mesh.corner_vertex[mesh.face_begin[f]];
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
    }
    for (const Vec3& p : position_) normal_.push_back(exact_.nearest(p).normal);
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

  // Each by up to the mean length of its edges, if its triangles keep facing outwards.
  void move_vertices() {
    std::vector<std::vector<std::uint32_t>> around(position_.size());
    for (std::uint32_t t = 0; t < triangle_.size(); ++t) {
      for (const std::uint32_t v : triangle_[t]) around[v].push_back(t);
    }
    for (std::uint32_t v = 0; v < position_.size(); ++v) {
      double length = 0;
      for (const std::uint32_t t : around[v]) {
        for (const std::uint32_t w : triangle_[t])
          length +=
              (position_[w] - position_[v]).norm() / (2.0 * static_cast<double>(around[v].size()));
      }
      const Vec3 before = position_[v], normal = normal_[v];
      const auto moved =
          exact_.nearest(before + length * Vec3(symmetric(), symmetric(), symmetric()));
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
  std::vector<Vec3> position_, normal_;
  std::vector<Triangle> triangle_;
  std::unordered_map<std::uint64_t, std::uint32_t> owner_;  // of a directed edge
};

}  // namespace

Generated irregular(Generated from, std::uint64_t seed) {
  require(from.exact != nullptr, "irregular: a shape with an exact surface");
  Irregular made(from, seed);
  made.shuffle();
  from.mesh = made.mesh("irregular " + from.mesh.source);
  return from;
}

}  // namespace gliss
