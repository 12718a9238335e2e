// The oracle of the fair construction: its triangles, and its patches of five sides and more, slow
// and literal, in long double.
//
// A side's curve C and normal n are polynomials in t, by their powers. A side that is *fair* is a
// triangle's, and its neighbour is a triangle with the same normals at both ends, or none. All
// others keep the curve and the normal of Wu et al. (oracle.h, eq. 6 to 10). The steps, by side:
//   1  end tangents of the length that makes plane arcs exact;
//   2  a shape operator at each vertex, least squares over its sides;
//   3  a quintic curve with the curvature of that shape operator;
//   4  a cubic normal n with which n_c = C' x (n x e) has its twist;
//   5  a cross tangent T = k C' + h m with m = n x e, k and h linear;
//   6  a Gregory triangle of degree 6 with these sides; or
//   7  a blend of one curved ribbon a side.
// Every side is made from its own start to its own end: that both faces find one curve and one
// normal is not assumed. It reads a mesh and its twins as data, and uses nothing else of Gliss.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <optional>

#include "gliss/mesh/topology.h"
#include "tests/oracle/oracle.h"

namespace gliss::oracle {

/// Counts how often a clamp of the construction acted, by side end or face of a side.
struct FairClamps {
  int curvature = 0, twist = 0;

  void operator+=(const FairClamps& other) {
    curvature += other.curvature;
    twist += other.twist;
  }
};

class Fair {
 public:
  using Real = long double;
  using V = Vec<Real>;
  /// A vector polynomial of t: coefficient i is that of t^i.
  using Poly = std::vector<V>;

  struct Side {
    Poly C, n;
    V e;  ///< unit, from start to end
    bool is_fair = false;
    bool is_clamped = false;  ///< by step 3 or 4, at either end
    bool has_shape = false;   ///< steps 3 and 4 were taken
  };
  /// A point of a patch and its derivatives by each barycentric coordinate, the others held.
  struct Point {
    V G;
    std::array<V, 3> by;
  };

  Fair(const Mesh& mesh, const Topology& topology) : mesh_(mesh), topology_(topology) {
    const auto count = static_cast<std::uint32_t>(mesh.corner_vertex.size());
    for (std::uint32_t s = 0; s < count; ++s) sides_.push_back(first_side(s));
    for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) shapes_.push_back(shape_of(v));
    const std::vector<Side> first = sides_;
    for (std::uint32_t s = 0; s < count; ++s) sides_[s] = last_side(s, first[s]);
  }

  const Side& side(std::uint32_t s) const { return sides_[s]; }
  const FairClamps& clamps() const { return clamps_; }
  /// Maps the directions of the tangent plane; none where the corners have different normals.
  const std::optional<Eigen::Matrix<Real, 3, 3>>& shape(std::uint32_t vertex) const {
    return shapes_[vertex];
  }

  /// The triangle `face` at barycentric coordinates that add up to 1.
  Point evaluate(std::uint32_t face, const std::array<Real, 3>& at) const {
    const Net net = net_of(face);
    Point point{V::Zero(), {V::Zero(), V::Zero(), V::Zero()}};
    for (int i = 0; i <= 6; ++i) {
      for (int j = 0; i + j <= 6; ++j) {
        const std::array<int, 3> index{i, j, 6 - i - j};
        Real many = 720;
        for (const int p : index) many /= factorial(p);
        const V& b = net.points[place(index)];
        point.G += many * monomial(at, index) * b;
        for (std::size_t m = 0; m < 3; ++m) {
          if (index[m] == 0) continue;
          std::array<int, 3> less = index;
          --less[m];
          point.by[m] += many * static_cast<Real>(index[m]) * monomial(at, less) * b;
        }
      }
    }
    // The points (4, 1, 1) stand in the net with the mean of both sides' demands, A and B; what is
    // left of 30 a^4 b c (b A + c B) / (b + c) vanishes at the corner with its slopes.
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t l = (k + 1) % 3, m = (k + 2) % 3;
      const Real a = at[k], b = at[l], c = at[m], sum = b + c;
      if (sum == 0) continue;
      const V d = 15 * net.apart[k];
      const Real f = b * c * (b - c) / sum, a3 = a * a * a;
      point.G += a3 * a * f * d;
      point.by[k] += 4 * a3 * f * d;
      point.by[l] += a3 * a * ((2 * b * c - c * c) / sum - f / sum) * d;
      point.by[m] += a3 * a * ((b * b - 2 * b * c) / sum - f / sum) * d;
    }
    return point;
  }

  /// A triangle, or a face of five sides and more, at a point of the domain, as oracle::evaluate
  /// gives it.
  template <class T>
  Sample<Real> evaluate(std::uint32_t face, const Vec2<T>& at) const {
    return evaluate(face, static_cast<Real>(at.x()), static_cast<Real>(at.y()));
  }
  Sample<Real> evaluate(std::uint32_t face, Real xi, Real eta) const {
    if (mesh_.valence(face) != 3) return blend(face, xi, eta);
    std::array<Real, 3> at{};
    std::array<Vec2<Real>, 3> corner;
    for (int k = 0; k < 3; ++k) {
      const auto i = static_cast<std::size_t>(k);
      corner[i] = domain_corner<Real>(3, k);
      // A point on a side may lie outside by a rounding.
      at[i] = std::max(Real(0), (1 + 2 * corner[i].dot(Vec2<Real>(xi, eta))) / 3);
    }
    const Point p = evaluate(face, at);
    Sample<Real> sample{p.G, V::Zero(), V::Zero(), V::Zero()};
    for (std::size_t i = 0; i < 3; ++i) {
      sample.G_xi += 2 * corner[i].x() / 3 * p.by[i];
      sample.G_eta += 2 * corner[i].y() / 3 * p.by[i];
    }
    sample.normal = sample.G_xi.cross(sample.G_eta).normalized();
    return sample;
  }

 private:
  /// The bounds of steps 3 and 4.
  static constexpr Real kMostBend = 2.5L, kMostTwist = 1.25L;

  /// The Bezier points of a triangle, by place(), and A - B at each corner.
  struct Net {
    std::array<V, 49> points;
    std::array<V, 3> apart;
  };

  // ---- Polynomials ----
  static V value(const Poly& p, Real t) {
    V sum = V::Zero();
    for (std::size_t i = p.size(); i-- > 0;) sum = sum * t + p[i];
    return sum;
  }
  static Poly derivative(const Poly& p) {
    Poly result;
    for (std::size_t i = 1; i < p.size(); ++i) result.push_back(static_cast<Real>(i) * p[i]);
    return result;
  }
  static Poly sum(Poly a, const Poly& b) {
    if (a.size() < b.size()) a.resize(b.size(), V::Zero());
    for (std::size_t i = 0; i < b.size(); ++i) a[i] += b[i];
    return a;
  }
  /// (at0 + (at1 - at0) t) p.
  static Poly times_linear(const Poly& p, Real at0, Real at1) {
    Poly result(p.size() + 1, V::Zero());
    for (std::size_t i = 0; i < p.size(); ++i) {
      result[i] += at0 * p[i];
      result[i + 1] += (at1 - at0) * p[i];
    }
    return result;
  }
  static Poly cross(const Poly& p, const V& with) {
    Poly result;
    for (const V& a : p) result.push_back(a.cross(with));
    return result;
  }
  /// The polynomial with these scalar coefficients times a vector.
  static Poly along(const V& v, const std::vector<Real>& coefficients) {
    Poly result;
    for (const Real c : coefficients) result.push_back(c * v);
    return result;
  }
  static Real factorial(int n) { return n < 2 ? 1 : static_cast<Real>(n) * factorial(n - 1); }
  static Real binomial(int n, int k) { return factorial(n) / (factorial(k) * factorial(n - k)); }
  static std::vector<V> bezier(const Poly& p, int degree) {
    std::vector<V> points;
    for (int i = 0; i <= degree; ++i) {
      V b = V::Zero();
      for (int j = 0; j <= i && j < static_cast<int>(p.size()); ++j)
        b += binomial(i, j) / binomial(degree, j) * p[static_cast<std::size_t>(j)];
      points.push_back(b);
    }
    return points;
  }

  // ---- The mesh ----
  std::uint32_t face_of(std::uint32_t s) const { return topology_.side_face[s]; }
  std::uint32_t twin(std::uint32_t s) const { return topology_.side_twin[s]; }
  bool of_triangle(std::uint32_t s) const { return mesh_.valence(face_of(s)) == 3; }
  std::uint32_t next(std::uint32_t s) const {
    const std::uint32_t f = face_of(s);
    return s + 1 == mesh_.face_begin[f + 1] ? mesh_.face_begin[f] : s + 1;
  }
  std::uint32_t before(std::uint32_t s) const {
    const std::uint32_t f = face_of(s);
    return s == mesh_.face_begin[f] ? mesh_.face_begin[f + 1] - 1 : s - 1;
  }
  V position(std::uint32_t corner) const {
    return mesh_.positions[mesh_.corner_vertex[corner]].cast<Real>();
  }
  V normal(std::uint32_t corner) const {
    return mesh_.normals[mesh_.corner_normal[corner]].cast<Real>().normalized();
  }
  /// A face in a plane with all its normals: its sides are straight.
  bool is_flat(std::uint32_t face) const {
    for (std::uint32_t c = mesh_.face_begin[face]; c < mesh_.face_begin[face + 1]; ++c) {
      for (std::uint32_t d = mesh_.face_begin[face]; d < mesh_.face_begin[face + 1]; ++d) {
        const V way = position(d) - position(c);
        if (std::abs(normal(c).dot(way)) > Real(1e-5L) * way.norm()) return false;
      }
    }
    return true;
  }
  bool is_fair(std::uint32_t s) const {
    const std::uint32_t t = twin(s);
    if (is_flat(face_of(s))) return false;
    if (!of_triangle(s) || t == kNone) return of_triangle(s);
    return !is_flat(face_of(t)) && of_triangle(t) && normal(s) == normal(next(t)) &&
           normal(next(s)) == normal(t);
  }

  // ---- Step 1 ----
  Side first_side(std::uint32_t s) {
    const V p0 = position(s), p1 = position(next(s)), n0 = normal(s), n1 = normal(next(s));
    const Real L = (p1 - p0).norm();
    const V e = (p1 - p0) / L, n_avg = (n0 + n1) / 2;
    const V t0 = n0.cross(e.cross(n_avg)).normalized(), t1 = n1.cross(e.cross(n_avg)).normalized();
    Side side;
    side.e = e;
    side.is_fair = is_fair(s);
    const Real length = side.is_fair ? L * 2 / (1 + std::sqrt((1 + t0.dot(t1)) / 2)) : L;
    const V d0 = length * t0, d1 = length * t1;
    side.C = {p0, d0, 3 * (p1 - p0) - 2 * d0 - d1, 2 * (p0 - p1) + d0 + d1};
    side.n = {n0, n1 - n0};
    return side;
  }

  // ---- Step 2 ----
  std::optional<Eigen::Matrix<Real, 3, 3>> shape_of(std::uint32_t v) const {
    // Rows of S = S11 x x' + S12 (x y' + y x') + S22 y y'.
    Eigen::Matrix<Real, 3, 3> A = Eigen::Matrix<Real, 3, 3>::Zero();
    V right = V::Zero(), n = V::Zero(), x, y;
    const auto add = [&](const V& d, const V& dd, const V& dn) {
      const V t = d.normalized(), b = n.cross(t);
      const Real kappa = -n.dot(dd) / d.squaredNorm(), tau = b.dot(dn) / d.norm();
      const Real tx = t.dot(x), ty = t.dot(y), bx = b.dot(x), by = b.dot(y);
      const V first(tx * tx, 2 * tx * ty, ty * ty), second(bx * tx, bx * ty + by * tx, by * ty);
      A += first * first.transpose() + second * second.transpose();
      right += first * kappa + second * tau;
    };
    for (std::uint32_t s = 0; s < sides_.size(); ++s) {
      const bool starts = mesh_.corner_vertex[s] == v;
      if (starts) {
        if (n == V::Zero()) {
          n = normal(s);
          x = n.unitOrthogonal();
          y = n.cross(x);
        }
        if (normal(s) != n) return std::nullopt;
      }
    }
    if (n == V::Zero()) return std::nullopt;
    for (std::uint32_t s = 0; s < sides_.size(); ++s) {
      const Poly d = derivative(sides_[s].C), dd = derivative(d), dn = derivative(sides_[s].n);
      if (mesh_.corner_vertex[s] == v) add(value(d, 0), value(dd, 0), value(dn, 0));
      // A border has no side that leaves its end.
      if (twin(s) == kNone && mesh_.corner_vertex[next(s)] == v)
        add(-value(d, 1), value(dd, 1), -value(dn, 1));
    }
    const V S = A.fullPivLu().solve(right);
    return S[0] * x * x.transpose() + S[1] * (x * y.transpose() + y * x.transpose()) +
           S[2] * y * y.transpose();
  }

  // ---- Steps 3 and 4 ----
  /// Of the sides that S is fit to.
  Real shortest_at(std::uint32_t v) const {
    Real least = std::numeric_limits<Real>::infinity();
    for (std::uint32_t s = 0; s < sides_.size(); ++s)
      if (mesh_.corner_vertex[s] == v || mesh_.corner_vertex[next(s)] == v)
        least = std::min(least, (position(next(s)) - position(s)).norm());
    return least;
  }
  /// Twice the length over the farther of both triangles' third vertices, at most 1.
  Real short_share(std::uint32_t s) const {
    const V from = position(s), way = position(next(s)) - from;
    Real farthest = 0;
    for (const std::uint32_t t : {s, twin(s)})
      if (t != kNone)
        farthest =
            std::max(farthest, (position(next(next(t))) - from).cross(way).norm() / way.norm());
    return std::min(Real(1), 2 * way.norm() / farthest);
  }
  Side last_side(std::uint32_t s, Side side) {
    const auto& S0 = shapes_[mesh_.corner_vertex[s]];
    const auto& S1 = shapes_[mesh_.corner_vertex[next(s)]];
    if (!side.is_fair || !S0 || !S1) return side;
    side.has_shape = true;
    const auto clamped = [&](Real wanted, Real bound, int& count) {
      const Real held = std::clamp(wanted, -bound, bound);
      if (held != wanted) {
        ++count;
        side.is_clamped = true;
      }
      return held;
    };
    const Poly C = side.C, n = side.n;
    const Poly dC = derivative(C), ddC = derivative(dC), dn = derivative(n);
    const Real lean = value(dC, 0).cross(side.e).norm() + value(dC, 1).cross(side.e).norm();
    // t^2 (1 - t)^3 / 2 and t^3 (1 - t)^2 / 2; t (1 - t)^2 and the same of 1 - t.
    const std::vector<Real> bend[2] = {{0, 0, 0.5L, -1.5L, 1.5L, -0.5L}, {0, 0, 0, 0.5L, -1, 0.5L}};
    const std::vector<Real> turn[2] = {{0, 1, -2, 1}, {0, 0, 1, -1}};
    for (std::size_t i = 0; i < 2; ++i) {
      const auto end = static_cast<Real>(i);
      const auto& S = i == 0 ? *S0 : *S1;
      const V d = value(dC, end), n_i = normal(i == 0 ? s : next(s));
      const Real share =
          std::min(Real(1), 4 * shortest_at(mesh_.corner_vertex[i == 0 ? s : next(s)]) / d.norm());
      const Real curve =
          clamped(-d.dot(S * d) - n_i.dot(value(ddC, end)),
                  std::min(kMostBend * d.norm(), std::max(share * kMostBend * d.norm(), 2 * lean)),
                  clamps_.curvature);
      side.C = sum(side.C, along(curve * n_i, bend[i]));
      const V b = n_i.cross(d.normalized()), m = n_i.cross(side.e);
      const Real twist = clamped(m.dot(S * d - value(dn, end)) / m.dot(b),
                                 std::min(kMostTwist * short_share(s),
                                          std::max(share * kMostTwist, value(dn, end).norm() / 2)),
                                 clamps_.twist);
      side.n = sum(side.n, along((i == 0 ? twist : -twist) * b, turn[i]));
    }
    return side;
  }

  // ---- Steps 5 and 6 ----
  /// The k and h with which k C' + h m is `wanted`, where all three are normal to n.
  static std::array<Real, 2> shares(const V& wanted, const V& d, const V& m, const V& n) {
    const Real area = n.dot(d.cross(m));
    return {n.dot(wanted.cross(m)) / area, n.dot(d.cross(wanted)) / area};
  }

  /// T of a side, from the sides before and after it.
  Poly cross_tangent(std::uint32_t s) const {
    const Side &side = sides_[s], &after = sides_[next(s)], &last = sides_[before(s)];
    const Poly dC = derivative(side.C), m = cross(side.n, side.e);
    const auto at0 = shares(-value(derivative(last.C), 1), value(dC, 0), value(m, 0), normal(s));
    const auto at1 =
        shares(value(derivative(after.C), 0), value(dC, 1), value(m, 1), normal(next(s)));
    return sum(times_linear(dC, at0[0], at1[0]), times_linear(m, at0[1], at1[1]));
  }

  static std::size_t place(const std::array<int, 3>& index) {
    return static_cast<std::size_t>(7 * index[0] + index[1]);
  }
  static Real monomial(const std::array<Real, 3>& at, const std::array<int, 3>& index) {
    Real product = 1;
    for (std::size_t m = 0; m < 3; ++m) {
      for (int i = 0; i < index[m]; ++i) product *= at[m];
    }
    return product;
  }

  Net net_of(std::uint32_t face) const {
    assert(mesh_.valence(face) == 3);
    Net net;
    std::array<V, 3> A, B;
    V six = V::Zero(), three = V::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t s = mesh_.face_begin[face] + static_cast<std::uint32_t>(k);
      const std::vector<V> E = bezier(sides_[s].C, 6);
      const Poly towards = sum(cross_tangent(s), times_linear(derivative(sides_[s].C), 0, 1));
      const std::vector<V> D = bezier(towards, 5);
      const auto at = [&](int start, int end, int opposite) -> V& {
        std::array<int, 3> index{};
        index[k] = start;
        index[(k + 1) % 3] = end;
        index[(k + 2) % 3] = opposite;
        return net.points[place(index)];
      };
      for (int i = 0; i <= 6; ++i) at(6 - i, i, 0) = E[static_cast<std::size_t>(i)];
      at(3, 2, 1) = E[2] + D[2] / 6;
      at(2, 3, 1) = E[3] + D[3] / 6;
      six += (at(3, 2, 1) + at(2, 3, 1)) / 6;
      A[k] = E[1] + D[1] / 6;
      B[(k + 1) % 3] = E[4] + D[4] / 6;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      std::array<int, 3> index{1, 1, 1};
      index[k] = 4;
      net.points[place(index)] = (A[k] + B[k]) / 2;
      net.apart[k] = A[k] - B[k];
      three += (A[k] + B[k]) / 6;
    }
    net.points[place({2, 2, 2})] = six + (six - three) / 2;
    return net;
  }

  // ---- Step 7 ----
  /// C, T and Q of a side, by their powers: the ribbon C(u) + H (T(u) + H Q(u)).
  struct Ribbon {
    Poly C, T, Q;
  };

  /// The mean of the corners p, each as heavy as both of its sides are long, and half of what the
  /// tangent planes of the corners say there, along the normal of the face.
  V middle_of(std::uint32_t face) const {
    const std::uint32_t begin = mesh_.face_begin[face], end = mesh_.face_begin[face + 1];
    const auto weight = [&](std::uint32_t s) {
      return (position(next(s)) - position(s)).norm() + (position(before(s)) - position(s)).norm();
    };
    V mean = V::Zero(), across = V::Zero();
    Real total = 0, height = 0;
    for (std::uint32_t s = begin; s < end; ++s) {
      mean += weight(s) * position(s);
      total += weight(s);
      across += position(s).cross(position(next(s)));
    }
    mean /= total;
    across.normalize();
    for (std::uint32_t s = begin; s < end; ++s) {
      const Real steep = std::max(normal(s).dot(across), Real(1) / 4);
      height += weight(s) / total * normal(s).dot(position(s) - mean) / steep;
    }
    return mean + height / 2 * across;
  }

  /// `way`: H at the middle of the domain.
  Ribbon ribbon_of(std::uint32_t s, Real way) const {
    const Poly C = sides_[s].C, dC = derivative(C), m = cross(sides_[s].n, sides_[s].e);
    Poly T = cross_tangent(s);
    const Real half = Real(1) / 2;
    const V x = value(C, half), d = value(dC, half), m_half = value(m, half);
    const V n = d.cross(m_half), to_middle = middle_of(face_of(s)) - x;
    const auto straight = shares(value(T, half), d, m_half, n);
    auto wanted = shares(to_middle / way, d, m_half, n);
    wanted[1] = std::max(wanted[1], straight[1] / 2);
    const auto bubble = [](const Poly& p) { return times_linear(times_linear(p, 0, 4), 1, 0); };
    T = sum(T, bubble(times_linear(dC, wanted[0] - straight[0], wanted[0] - straight[0])));
    T = sum(T, bubble(times_linear(m, wanted[1] - straight[1], wanted[1] - straight[1])));
    const V Q0 = position(before(s)) - position(s) - value(T, 0);
    const V Q1 = position(next(next(s))) - position(next(s)) - value(T, 1);
    const V Q_half = (to_middle - way * value(T, half)) / (way * way);
    return {C, T,
            sum(sum(along(Q0, {1, -3, 2}), along(Q_half, {0, 4, -4})), along(Q1, {0, -1, 2}))};
  }

  /// C(u) less C(0), or less C(1) if `from_end`, as a product with u or with `rest` = 1 - u:
  /// weights change by 1 / r at r from a corner, so that a rounding of C would count there.
  static V rise(const Poly& C, Real u, Real rest, bool from_end) {
    Poly over;  // (C - C(0)) / t, or (C - C(1)) / (t - 1)
    V sum = V::Zero();
    for (std::size_t i = C.size(); i-- > 1;) {
      sum = from_end ? V(sum + C[i]) : C[i];
      over.insert(over.begin(), sum);
    }
    return (from_end ? -rest : u) * value(over, u);
  }

  Sample<Real> blend(std::uint32_t face, Real xi, Real eta) const {
    const int n = static_cast<int>(mesh_.valence(face));
    assert(n >= 5);
    const Real pi = std::numbers::pi_v<Real>;
    const Real unit = 2 * std::sin(pi / n) * std::sin(2 * pi / n);
    std::vector<Jet> d, weight;
    for (int k = 0; k < n; ++k) d.push_back(side_distance(n, k, xi, eta));
    const auto at = [&](int k) { return d[static_cast<std::size_t>((k + n) % n)]; };
    Jet total{0, 0, 0};
    for (int k = 0; k < n; ++k) {
      Jet product{1, 0, 0};
      for (int j = 1; j < n; ++j) product = product * at(k + j) * at(k + j);
      weight.push_back(product);
      total = total + product;
    }
    if (total.value == 0) {  // a corner: both of its ribbons have its slopes
      for (int k = 0; k < n; ++k) weight[static_cast<std::size_t>(k)] = {0, 0, 0};
      const auto on = std::find_if(d.begin(), d.end(), [](const Jet& j) { return j.value == 0; });
      total = weight[static_cast<std::size_t>(on - d.begin())] = {1, 0, 0};
    }
    // Corner `near` has the least d_(near - 1) + d_near.
    int near = 0;
    const auto around = [&](int k) { return at(k - 1).value + at(k).value; };
    for (int k = 1; k < n; ++k) near = around(k) < around(near) ? k : near;
    const V from = position(mesh_.face_begin[face] + static_cast<std::uint32_t>(near));
    Sample<Real> sample{V::Zero(), V::Zero(), V::Zero(), V::Zero()};
    for (int k = 0; k < n; ++k) {
      const auto i = static_cast<std::uint32_t>(k);
      const Ribbon r = ribbon_of(mesh_.face_begin[face] + i, std::cos(pi / n) / unit);
      const Jet u = at(k - 1) / (at(k - 1) + at(k + 1)), H = at(k) / Jet{unit, 0, 0};
      const Jet w = weight[static_cast<std::size_t>(k)] / total;
      const auto slope = [&](const Poly& p) { return value(derivative(p), u.value); };
      const V T = value(r.T, u.value), Q = value(r.Q, u.value);
      const bool ends = (k + 1) % n == near;
      const Real rest = at(k + 1).value / (at(k - 1).value + at(k + 1).value);
      const V C =
          k == near || ends ? rise(r.C, u.value, rest, ends) : V(value(r.C, u.value) - from);
      const V R = C + H.value * (T + H.value * Q);
      const V R_u = slope(r.C) + H.value * (slope(r.T) + H.value * slope(r.Q));
      const V R_H = T + 2 * H.value * Q;
      sample.G += w.value * R;
      sample.G_xi += w.xi * R + w.value * (u.xi * R_u + H.xi * R_H);
      sample.G_eta += w.eta * R + w.value * (u.eta * R_u + H.eta * R_H);
    }
    sample.G += from;
    sample.normal = sample.G_xi.cross(sample.G_eta).normalized();
    return sample;
  }

  const Mesh& mesh_;
  const Topology& topology_;
  std::vector<Side> sides_;
  std::vector<std::optional<Eigen::Matrix<Real, 3, 3>>> shapes_;
  FairClamps clamps_;
};

}  // namespace gliss::oracle
