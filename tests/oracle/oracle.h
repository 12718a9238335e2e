// The oracle: the paper's equations, slow and literal, to judge every other evaluator by.
//
// Source: Wu, Leung, Wang, Wang, Zhang, "Smooth force rendering on coarse polygonal meshes";
// equation numbers are the paper's. Where the print cannot be right it is read as follows:
//   (4), (5)  the upper limit m-1 is n-1;
//   (13)      n_c is a unit vector, or the ends of T miss C' of the neighbouring sides;
//   (14)      T(0) = -C'_prev(1), T(1) = C'_next(0): T points into the patch;
//   (2)       r_v(u,0) = T_P(u), r_u(0,v) = T_Q(v).
// This file includes nothing of kernels/ and host/: an oracle that shares code shares its errors.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <random>
#include <type_traits>
#include <vector>

namespace gliss::oracle {

template <class S>
using Vec = Eigen::Matrix<S, 3, 1>;
template <class S>
using Vec2 = Eigen::Matrix<S, 2, 1>;

/// A face: its corners anticlockwise seen from outside, and a unit normal at each.
template <class S>
struct Polygon {
  std::vector<Vec<S>> positions, normals;

  int size() const { return static_cast<int>(positions.size()); }
  /// Corner and normal by cyclic index.
  const Vec<S>& position(int k) const { return positions[wrap(k)]; }
  const Vec<S>& normal(int k) const { return normals[wrap(k)]; }

 private:
  std::size_t wrap(int k) const {
    const int n = size();
    return static_cast<std::size_t>(((k % n) + n) % n);
  }
};

/// The same polygon in another precision.
template <class To, class S>
Polygon<To> cast(const Polygon<S>& polygon) {
  Polygon<To> result;
  for (const Vec<S>& p : polygon.positions) result.positions.push_back(p.template cast<To>());
  for (const Vec<S>& n : polygon.normals) result.normals.push_back(n.template cast<To>());
  return result;
}

/// The same polygon with normals of length 1 in its own precision. Normals rounded to float are off
/// by 4e-8, which (7) and (13) carry into T' at 2e-8 of the patch: normalise after a cast.
template <class S>
Polygon<S> with_unit_normals(Polygon<S> polygon) {
  for (Vec<S>& n : polygon.normals) n.normalize();
  return polygon;
}

// ---- Sides: boundary curve, its normal, the cross tangent ---------------------------------------

template <class S>
struct Side {
  Vec<S> C, dC;  ///< boundary curve (6) and its derivative by t
  Vec<S> n_c;    ///< unit normal of the surface along it (10)
  Vec<S> T, dT;  ///< cross tangent into the patch (14) and its derivative by t
};

/// A vector function of t with its derivative.
template <class S>
struct Moving {
  Vec<S> value, dot;
};

template <class S>
Moving<S> cross(const Moving<S>& a, const Moving<S>& b) {
  return {a.value.cross(b.value), a.dot.cross(b.value) + a.value.cross(b.dot)};
}

template <class S>
Moving<S> normalized(const Moving<S>& a) {
  const S length = a.value.norm();
  const Vec<S> unit = a.value / length;
  return {unit, (a.dot - unit * unit.dot(a.dot)) / length};
}

/// Edge k, from vertex k to vertex k+1, at t in [0, 1].
template <class S>
Side<S> side(const Polygon<S>& polygon, int k, std::type_identity_t<S> t) {
  const Vec<S>&v_s = polygon.position(k), &v_e = polygon.position(k + 1);
  const Vec<S>&n_s = polygon.normal(k), &n_e = polygon.normal(k + 1);
  const Vec<S>&v_before = polygon.position(k - 1), &v_after = polygon.position(k + 2);
  const Vec<S>&n_before = polygon.normal(k - 1), &n_after = polygon.normal(k + 2);
  const Vec<S> e = v_e - v_s;
  const S L = e.norm();

  const Vec<S> n_avg = (n_s + n_e) / S(2);                    // (7)
  const Vec<S> t_s = n_s.cross(e.cross(n_avg)).normalized();  // (8)
  const Vec<S> t_e = n_e.cross(e.cross(n_avg)).normalized();  // (9)

  // (6) and its first two derivatives.
  const S t2 = t * t, t3 = t2 * t;
  const Vec<S> C = (2 * t3 - 3 * t2 + 1) * v_s + (-2 * t3 + 3 * t2) * v_e +
                   L * (t3 - 2 * t2 + t) * t_s + L * (t3 - t2) * t_e;
  const Vec<S> dC = (6 * t2 - 6 * t) * v_s + (-6 * t2 + 6 * t) * v_e +
                    L * (3 * t2 - 4 * t + 1) * t_s + L * (3 * t2 - 2 * t) * t_e;
  const Vec<S> ddC =
      (12 * t - 6) * v_s + (-12 * t + 6) * v_e + L * (6 * t - 4) * t_s + L * (6 * t - 2) * t_e;

  // (10), made a unit vector.
  const Vec<S> zero = Vec<S>::Zero();
  const Moving<S> edge{e, zero};
  const Moving<S> n_lerp{(1 - t) * n_s + t * n_e, n_e - n_s};
  const Moving<S> n_c = normalized(cross(Moving<S>{dC, ddC}, cross(n_lerp, edge)));

  const Moving<S> v_int{(1 - t) * v_before + t * v_after - C, v_after - v_before - dC};  // (12)
  const Moving<S> n_int{((1 - t) * n_before + t * n_after + n_c.value) / S(2),
                        (n_after - n_before + n_c.dot) / S(2)};             // (13)
  const Moving<S> direction = normalized(cross(n_c, cross(v_int, n_int)));  // (11)

  // (14)
  const S L_prev = (v_s - v_before).norm(), L_next = (v_after - v_e).norm();
  const S length = (1 - t) * L_prev + t * L_next;
  return {C, dC, n_c.value, length * direction.value,
          (L_next - L_prev) * direction.value + length * direction.dot};
}

/// Tells how well (8), (9) and (10) are defined at the ends of edge k: 0 where it is parallel to a
/// normal or the normals are opposed, 1 at best.
template <class S>
S soundness(const Polygon<S>& polygon, int k) {
  const Vec<S>&n_s = polygon.normal(k), &n_e = polygon.normal(k + 1);
  const Vec<S> e = (polygon.position(k + 1) - polygon.position(k)).normalized();
  const Vec<S> across = e.cross(Vec<S>((n_s + n_e) / S(2)));
  return std::min({n_s.cross(across).norm(), n_e.cross(across).norm(), n_s.cross(e).norm(),
                   n_e.cross(e).norm()});
}

template <class S>
S soundness(const Polygon<S>& polygon) {
  S least = 1;
  for (int k = 0; k < polygon.size(); ++k) least = std::min(least, soundness(polygon, k));
  return least;
}

// ---- Domain: always in long double, for n^2 eps is lost between X and u, v, w ------------------

/// A function of (xi, eta) with its partial derivatives.
struct Jet {
  long double value, xi, eta;
};

inline Jet operator+(const Jet& a, const Jet& b) {
  return {a.value + b.value, a.xi + b.xi, a.eta + b.eta};
}
inline Jet operator*(const Jet& a, const Jet& b) {
  return {a.value * b.value, a.xi * b.value + a.value * b.xi, a.eta * b.value + a.value * b.eta};
}
inline Jet operator/(const Jet& a, const Jet& b) {
  const long double q = a.value / b.value;
  return {q, (a.xi - q * b.xi) / b.value, (a.eta - q * b.eta) / b.value};
}

/// Corner C_k of the domain, a regular n-gon in the unit circle.
template <class S = double>
Vec2<S> domain_corner(int n, int k) {
  const int i = ((k % n) + n) % n;
  const long double angle = 2 * i * std::numbers::pi_v<long double> / n;
  return {static_cast<S>(std::cos(angle)), static_cast<S>(std::sin(angle))};
}

/// Distance from X to the line C_k C_{k+1}, positive inside.
template <class S>
Jet signed_distance(int n, int k, S xi, S eta) {
  const int i = ((k % n) + n) % n;
  const long double pi = std::numbers::pi_v<long double>;
  const long double angle = (2 * i + 1) * pi / n;  // of the outward normal of edge k
  const long double x = std::cos(angle), y = std::sin(angle);
  const auto X = static_cast<long double>(xi), Y = static_cast<long double>(eta);
  return {std::cos(pi / n) - x * X - y * Y, -x, -y};
}

/// d_k of (3) and (5). A point on a side may lie outside by a rounding: then d_k is 0 there, but
/// its slope remains.
template <class S>
Jet side_distance(int n, int k, S xi, S eta) {
  Jet d = signed_distance(n, k, xi, eta);
  d.value = std::max(d.value, 0.0L);
  return d;
}

/// (u_k, v_k) of (3). NaN where both are undefined: for n = 3 at a vertex where w_k is 0.
struct CornerJets {
  Jet u, v;
};
template <class S>
CornerJets corner_parameter_jets(int n, int k, S xi, S eta) {
  const auto d = [&](int j) { return side_distance(n, j, xi, eta); };
  return {d(k - 1) / (d(k - 1) + d(k + 1)), d(k) / (d(k - 2) + d(k))};
}

template <class S>
struct CornerParameters {
  S u, v;
};
template <class S>
CornerParameters<S> corner_parameters(int n, int k, S xi, S eta) {
  const CornerJets c = corner_parameter_jets(n, k, xi, eta);
  return {static_cast<S>(c.u.value), static_cast<S>(c.v.value)};
}

/// A jet times 2^exponent: the products of (5) leave the range of any floating-point type.
struct Scaled {
  Jet mantissa{1, 0, 0};
  int exponent = 0;
};
inline Scaled operator*(const Scaled& a, const Scaled& b) {
  Scaled product{a.mantissa * b.mantissa, a.exponent + b.exponent};
  Jet& m = product.mantissa;
  int shift = 0;
  const long double largest = std::max({std::abs(m.value), std::abs(m.xi), std::abs(m.eta)});
  if (largest > 0) std::frexp(largest, &shift);
  m = {std::ldexp(m.value, -shift), std::ldexp(m.xi, -shift), std::ldexp(m.eta, -shift)};
  product.exponent += shift;
  return product;
}

/// All w_k of (5) with their gradients.
template <class S>
std::vector<Jet> weight_jets(int n, S xi, S eta) {
  assert(n >= 3);
  const auto count = static_cast<std::size_t>(n);
  std::vector<Scaled> factor(count), before(count + 1), after(count + 1), numerator(count);
  for (int j = 0; j < n; ++j) {
    const Jet d = side_distance(n, j, xi, eta);
    factor[static_cast<std::size_t>(j)] = Scaled{d * d, 0};
  }
  // before[j] is the product of the factors 0..j-1, after[j] that of the factors j..n-1.
  for (std::size_t j = 0; j < count; ++j) before[j + 1] = before[j] * factor[j];
  for (std::size_t j = count; j-- > 0;) after[j] = factor[j] * after[j + 1];

  // Corner k leaves out the sides k-1 and k; corner 0 leaves out the last and the first.
  for (std::size_t j = 1; j + 1 < count; ++j) numerator[0] = numerator[0] * factor[j];
  for (std::size_t k = 1; k < count; ++k) numerator[k] = before[k - 1] * after[k + 1];

  int exponent = std::numeric_limits<int>::min();
  for (const Scaled& s : numerator) {
    if (s.mantissa.value > 0) exponent = std::max(exponent, s.exponent);
  }
  std::vector<Jet> weights;
  Jet sum{0, 0, 0};
  for (const Scaled& s : numerator) {
    const int shift = s.exponent - exponent;
    weights.push_back({std::ldexp(s.mantissa.value, shift), std::ldexp(s.mantissa.xi, shift),
                       std::ldexp(s.mantissa.eta, shift)});
    sum = sum + weights.back();
  }
  for (Jet& w : weights) w = w / sum;
  return weights;
}

template <class S>
std::vector<S> weights(int n, S xi, S eta) {
  std::vector<S> result;
  for (const Jet& w : weight_jets(n, xi, eta)) result.push_back(static_cast<S>(w.value));
  return result;
}

// ---- Surface -----------------------------------------------------------------------------------

template <class S>
struct CornerSurface {
  Vec<S> r, r_u, r_v;
};

/// Gregory corner interpolator of corner k (2). `one_minus_v` is given beside v because sides
/// run from vertex k to k+1, so Q runs along side k-1 backwards.
template <class S>
CornerSurface<S> corner_interpolator(const Polygon<S>& polygon, int k, std::type_identity_t<S> u,
                                     std::type_identity_t<S> v,
                                     std::type_identity_t<S> one_minus_v) {
  // P(u) = C_k(u), T_P(u) = T_k(u); Q(v) = C_{k-1}(1-v), T_Q(v) = T_{k-1}(1-v).
  const Side<S> p0 = side(polygon, k, 0), p = side(polygon, k, u);
  const Side<S> q0 = side(polygon, k - 1, 1), q = side(polygon, k - 1, one_minus_v);
  const Vec<S> dT_P0 = p0.dT, dT_Q0 = -q0.dT;
  const Vec<S> dQ = -q.dC, dT_Q = -q.dT;

  // The twist term uv (v T_P'(0) + u T_Q'(0)) / (u + v) by the shares of u and v in u + v,
  // because it is 0/0 at the corner, where its limit is 0 and so are its slopes.
  const S r_share = u + v > 0 ? u / (u + v) : S(0), s_share = u + v > 0 ? v / (u + v) : S(0);
  const S r2 = r_share * r_share, s2 = s_share * s_share;
  const Vec<S> twist = u * v * (s_share * dT_P0 + r_share * dT_Q0);
  const Vec<S> twist_u = v * (s2 * dT_P0 + (1 - s2) * dT_Q0);
  const Vec<S> twist_v = u * ((1 - r2) * dT_P0 + r2 * dT_Q0);

  return {-p0.C - v * p0.T - u * q0.T + p.C + v * p.T + q.C + u * q.T - twist,
          -q0.T + p.dC + v * p.dT + q.T - twist_u, -p0.T + p.T + dQ + u * dT_Q - twist_v};
}

template <class S>
struct Sample {
  Vec<S> G, G_xi, G_eta;
  Vec<S> normal;  ///< unit, G_xi x G_eta
};

/// The patch (4) at (xi, eta), inside the domain or on its boundary.
template <class S>
Sample<S> evaluate(const Polygon<S>& polygon, std::type_identity_t<S> xi,
                   std::type_identity_t<S> eta) {
  const int n = polygon.size();
  const Vec<S> zero = Vec<S>::Zero();
  Sample<S> sample{zero, zero, zero, zero};
  const std::vector<Jet> w = weight_jets(n, xi, eta);
  for (int k = 0; k < n; ++k) {
    const Jet& w_k = w[static_cast<std::size_t>(k)];
    if (w_k.value == 0) continue;  // its slope is 0 too, and u, v may be 0/0 (n = 3)
    const CornerJets c = corner_parameter_jets(n, k, xi, eta);
    const CornerSurface<S> f =
        corner_interpolator(polygon, k, static_cast<S>(c.u.value), static_cast<S>(c.v.value),
                            static_cast<S>(1 - c.v.value));
    sample.G += static_cast<S>(w_k.value) * f.r;
    // d(w r) = r dw + w (r_u du + r_v dv); w du is formed first, for du may be huge where w is
    // tiny.
    sample.G_xi += static_cast<S>(w_k.xi) * f.r + static_cast<S>(w_k.value * c.u.xi) * f.r_u +
                   static_cast<S>(w_k.value * c.v.xi) * f.r_v;
    sample.G_eta += static_cast<S>(w_k.eta) * f.r + static_cast<S>(w_k.value * c.u.eta) * f.r_u +
                    static_cast<S>(w_k.value * c.v.eta) * f.r_v;
  }
  sample.normal = sample.G_xi.cross(sample.G_eta).normalized();
  return sample;
}

// ---- Nearest point of one patch, by brute force ------------------------------------------------

/// The point of the domain nearest to X.
template <class S>
Vec2<S> clamp_to_domain(int n, const Vec2<S>& X) {
  bool inside = true;
  for (int k = 0; k < n; ++k) inside = inside && signed_distance(n, k, X.x(), X.y()).value >= 0;
  if (inside) return X;
  Vec2<S> best = X;
  S best_distance = std::numeric_limits<S>::infinity();
  for (int k = 0; k < n; ++k) {
    const Vec2<S> a = domain_corner<S>(n, k), b = domain_corner<S>(n, k + 1);
    const S t = std::clamp((X - a).dot(b - a) / (b - a).squaredNorm(), S(0), S(1));
    const Vec2<S> on_side = (1 - t) * a + t * b;
    if ((X - on_side).norm() < best_distance) {
      best_distance = (X - on_side).norm();
      best = on_side;
    }
  }
  return best;
}

/// Points all over the domain: `resolution` steps along each side of each fan triangle
/// centre, C_k, C_{k+1}; corners and sides included, nothing twice.
template <class S>
std::vector<Vec2<S>> sample_domain(int n, int resolution) {
  std::vector<Vec2<S>> points{Vec2<S>::Zero()};
  for (int k = 0; k < n; ++k) {
    const Vec2<S> a = domain_corner<S>(n, k), b = domain_corner<S>(n, k + 1);
    for (int i = 1; i <= resolution; ++i) {
      for (int j = 0; j < i; ++j) points.push_back((S(i - j) * a + S(j) * b) / S(resolution));
    }
  }
  return points;
}

template <class S>
struct Nearest {
  S xi, eta;
  Vec<S> G;
  S distance;
  /// Length in the domain of one more step of projected descent: about 1e-15 at a true minimum,
  /// inside or on the boundary.
  S residual;
};

template <class S>
Nearest<S> nearest_candidate(const Polygon<S>& polygon, const Vec<S>& hip, const Vec2<S>& X) {
  const Sample<S> s = evaluate(polygon, X.x(), X.y());
  const Vec<S> offset = s.G - hip;
  const Vec2<S> gradient(offset.dot(s.G_xi), offset.dot(s.G_eta));
  const S scale = s.G_xi.squaredNorm() + s.G_eta.squaredNorm();
  const Vec2<S> next = clamp_to_domain<S>(polygon.size(), X - gradient / scale);
  return {X.x(), X.y(), s.G, offset.norm(), (next - X).norm()};
}

/// Compass search that shrinks when no neighbour is nearer. It needs no derivative and cannot
/// leave the domain, so it stands where Newton's method does not.
template <class S>
Vec2<S> pattern_search(const Polygon<S>& polygon, const Vec<S>& hip, Vec2<S> X, S step) {
  const auto distance2 = [&](const Vec2<S>& Y) {
    return (evaluate(polygon, Y.x(), Y.y()).G - hip).squaredNorm();
  };
  S best = distance2(X);
  for (int rounds = 0; step > S(1e-8) && rounds < 10000; ++rounds) {
    const Vec2<S> centre = X;
    bool moved = false;
    for (int i = -1; i <= 1; ++i) {
      for (int j = -1; j <= 1; ++j) {
        if (i == 0 && j == 0) continue;
        const Vec2<S> Y = clamp_to_domain<S>(polygon.size(), centre + step * Vec2<S>(S(i), S(j)));
        const S d = distance2(Y);
        if (d < best) {
          best = d;
          X = Y;
          moved = true;
        }
      }
    }
    if (!moved) step /= 2;
  }
  return X;
}

/// Newton's method on (G - hip).G_xi = (G - hip).G_eta = 0, its matrix by central differences.
template <class S>
Vec2<S> newton_polish(const Polygon<S>& polygon, const Vec<S>& hip, Vec2<S> X) {
  const int n = polygon.size();
  const auto gradient = [&](S xi, S eta) {
    const Sample<S> s = evaluate(polygon, xi, eta);
    return Vec2<S>((s.G - hip).dot(s.G_xi), (s.G - hip).dot(s.G_eta));
  };
  for (int i = 0; i < 20; ++i) {
    long double room = 1;
    for (int k = 0; k < n; ++k) {
      room = std::min(room, signed_distance(n, k, X.x(), X.y()).value);
    }
    const S h = static_cast<S>(std::min(1e-4L, room / 2));
    if (h < S(1e-11)) break;  // on a side: side_polish is for that
    Eigen::Matrix<S, 2, 2> H;
    H.col(0) = (gradient(X.x() + h, X.y()) - gradient(X.x() - h, X.y())) / (2 * h);
    H.col(1) = (gradient(X.x(), X.y() + h) - gradient(X.x(), X.y() - h)) / (2 * h);
    Vec2<S> next = X - H.inverse() * gradient(X.x(), X.y());
    if (!next.allFinite()) break;
    next = clamp_to_domain<S>(n, next);
    if (!(nearest_candidate<S>(polygon, hip, next).residual <
          nearest_candidate<S>(polygon, hip, X).residual)) {
      break;
    }
    X = next;
  }
  return X;
}

/// Bisection of (C - hip).C' along side k near the point of it nearest to X.
template <class S>
Vec2<S> side_polish(const Polygon<S>& polygon, const Vec<S>& hip, int k, const Vec2<S>& X) {
  const auto slope = [&](S t) {
    const Side<S> s = side(polygon, k, t);
    return (s.C - hip).dot(s.dC);
  };
  const int n = polygon.size();
  const Vec2<S> a = domain_corner<S>(n, k), b = domain_corner<S>(n, k + 1);
  const S t0 = (X - a).dot(b - a) / (b - a).squaredNorm();
  S low = std::clamp(t0 - S(1e-4), S(0), S(1)), high = std::clamp(t0 + S(1e-4), S(0), S(1));
  if (slope(low) >= 0) high = low;
  if (slope(high) <= 0) low = high;
  for (int i = 0; i < 100; ++i) {
    const S middle = (low + high) / 2;
    (slope(middle) < 0 ? low : high) = middle;
  }
  return (1 - high) * a + high * b;
}

/// The nearest point of the whole patch to `hip`: samples it, then refines the `starts` best
/// samples that are apart from each other.
template <class S>
Nearest<S> nearest(const Polygon<S>& polygon, const std::type_identity_t<Vec<S>>& hip,
                   int resolution = 24, int starts = 6) {
  const int n = polygon.size();
  struct Start {
    Vec2<S> X;
    S distance;
  };
  std::vector<Start> samples;
  S size = 0;
  for (const Vec2<S>& X : sample_domain<S>(n, resolution)) {
    const S distance = (evaluate(polygon, X.x(), X.y()).G - hip).norm();
    // A degenerate ribbon gives NaN, which cannot be sorted: such samples come last.
    samples.push_back({X, std::isnan(distance) ? std::numeric_limits<S>::infinity() : distance});
  }
  for (const Vec<S>& p : polygon.positions) size = std::max(size, (p - polygon.position(0)).norm());
  std::sort(samples.begin(), samples.end(),
            [](const Start& a, const Start& b) { return a.distance < b.distance; });

  // Equal distances cannot tell a polished point from a raw one: then the residual decides.
  const auto better = [&](const Nearest<S>& a, const Nearest<S>& b) {
    if (std::abs(a.distance - b.distance) > S(1e-12) * (size + b.distance)) {
      return a.distance < b.distance;
    }
    return a.residual < b.residual;
  };
  Nearest<S> best = nearest_candidate<S>(polygon, hip, samples.front().X);
  std::vector<Vec2<S>> used;
  for (const Start& start : samples) {
    if (static_cast<int>(used.size()) == starts) break;
    const bool apart = std::all_of(used.begin(), used.end(), [&](const Vec2<S>& X) {
      return (X - start.X).norm() > S(3) / S(resolution);
    });
    if (!apart) continue;
    used.push_back(start.X);
    const Vec2<S> X = pattern_search<S>(polygon, hip, start.X, S(1) / S(resolution));
    std::vector<Vec2<S>> candidates{X, newton_polish<S>(polygon, hip, X)};
    for (int k = 0; k < n; ++k) {
      if (side_distance(n, k, X.x(), X.y()).value < 1e-5L) {
        candidates.push_back(side_polish<S>(polygon, hip, k, X));
      }
    }
    for (const Vec2<S>& candidate : candidates) {
      const Nearest<S> c = nearest_candidate<S>(polygon, hip, candidate);
      if (better(c, best)) best = c;
    }
  }
  return best;
}

// ---- Random polygons ---------------------------------------------------------------------------

using Rng = std::mt19937_64;

/// Uniform in [low, high), the same everywhere: the standard leaves its distributions open.
inline double uniform(Rng& rng, double low, double high) {
  return low + (high - low) * std::ldexp(static_cast<double>(rng() >> 11), -53);
}

Vec<double> random_unit(Rng& rng);

/// `axis` (unit) turned by a random angle up to `max_tilt` (rad) in a random direction.
Vec<double> random_tilt(Rng& rng, const Vec<double>& axis, double max_tilt);

/// Unit normal of a polygon that need not be planar (Newell): the direction of its vector area.
template <class S>
Vec<S> face_normal(const Polygon<S>& polygon) {
  Vec<S> area = Vec<S>::Zero();
  const Vec<S>& origin = polygon.position(0);
  for (int k = 0; k < polygon.size(); ++k) {
    area += (polygon.position(k) - origin).cross(polygon.position(k + 1) - origin);
  }
  return area.normalized();
}

/// Distance by which random corners leave the regular n-gon with this edge. It falls with n, or a
/// polygon of many sides would not stay roughly convex.
inline double jitter(int n, double edge, double perturbation) {
  return perturbation * edge * std::min(1.0, 3.0 / n);
}

/// An n-gon of radius about 1, anywhere in space: a regular one whose corners are moved by up to
/// `perturbation` edges along each axis (less for many sides), its normals tilted from the face
/// normal by up to `max_tilt` (rad; ribbons never degenerate below pi/3).
template <class S = double>
Polygon<S> random_polygon(Rng& rng, int n, double max_tilt, double perturbation = 0.15) {
  const Vec<double> axis = random_unit(rng);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(uniform(rng, 0, 2 * std::numbers::pi), axis).toRotationMatrix();
  const Vec<double> centre = uniform(rng, 0, 1) * random_unit(rng);
  const double amount = jitter(n, 2 * std::sin(std::numbers::pi / n), perturbation);
  Polygon<double> polygon;
  for (int k = 0; k < n; ++k) {
    const Vec2<double> corner = domain_corner(n, k);
    Vec<double> p(corner.x(), corner.y(), 0);
    for (int i = 0; i < 3; ++i) p[i] += uniform(rng, -amount, amount);
    polygon.positions.push_back(centre + turn * p);
  }
  const Vec<double> normal = face_normal(polygon);
  for (int k = 0; k < n; ++k) polygon.normals.push_back(random_tilt(rng, normal, max_tilt));
  return cast<S>(polygon);
}

/// An n-gon on the other side of edge k of `polygon`, which is its edge 0 reversed, with the same
/// normals there; folded along that edge by up to `max_fold` (rad).
template <class S>
Polygon<S> random_neighbour(Rng& rng, const Polygon<S>& polygon, int k, int n, double max_tilt,
                            double max_fold = 0.3, double perturbation = 0.15) {
  const Polygon<double> base = cast<double>(polygon);
  const Vec<double> start = base.position(k + 1), edge = base.position(k) - start;
  const Vec<double> along = edge.normalized();
  const Vec<double> flat = face_normal(base);
  const Vec<double> up = (flat - along * along.dot(flat)).normalized();
  const Vec<double> normal = Eigen::AngleAxisd(uniform(rng, -max_fold, max_fold), along) * up;
  const Vec<double> inward = normal.cross(along);

  // The regular n-gon walked edge by edge, from corner 0 along `edge`, turning by 2 pi / n.
  const double length = edge.norm(), amount = jitter(n, length, perturbation);
  Polygon<S> result;
  Vec<double> p = start;
  for (int j = 0; j < n; ++j) {
    Vec<double> moved = p;
    for (int i = 0; i < 3; ++i) moved[i] += uniform(rng, -amount, amount);
    result.positions.push_back(moved.cast<S>());
    result.normals.push_back(random_tilt(rng, normal, max_tilt).cast<S>());
    const double angle = 2 * std::numbers::pi * j / n;
    p += length * (std::cos(angle) * along + std::sin(angle) * inward);
  }
  result.positions[0] = polygon.position(k + 1);
  result.positions[1] = polygon.position(k);
  result.normals[0] = polygon.normal(k + 1);
  result.normals[1] = polygon.normal(k);
  return result;
}

/// The same, at a point of another precision.
template <class S, class T>
Sample<S> evaluate(const Polygon<S>& polygon, const Vec2<T>& at) {
  return evaluate(polygon, static_cast<S>(at.x()), static_cast<S>(at.y()));
}

// Compiled once, in oracle.cpp.
extern template Side<double> side(const Polygon<double>&, int, std::type_identity_t<double>);
extern template Sample<double> evaluate(const Polygon<double>&, std::type_identity_t<double>,
                                        std::type_identity_t<double>);
extern template Side<long double> side(const Polygon<long double>&, int,
                                       std::type_identity_t<long double>);
extern template Sample<long double> evaluate(const Polygon<long double>&,
                                             std::type_identity_t<long double>,
                                             std::type_identity_t<long double>);
extern template Nearest<double> nearest(const Polygon<double>&,
                                        const std::type_identity_t<Vec<double>>&, int, int);
extern template Polygon<double> random_polygon(Rng&, int, double, double);
extern template Polygon<double> random_neighbour(Rng&, const Polygon<double>&, int, int, double,
                                                 double, double);

}  // namespace gliss::oracle
