#include "tests/extremes/extreme_hips.h"

namespace gliss::test {

SurfacePoint random_site(Rng& rng, const Extreme& e) {
  const auto face = static_cast<std::uint32_t>(rng() % e.mesh.face_count());
  return at(e.cache, face,
            oracle::random_inside<double>(rng, static_cast<int>(e.mesh.valence(face))));
}

SurfacePoint site_on_side(const Extreme& e, std::uint32_t side, double t) {
  const std::uint32_t face = e.topology.side_face[side];
  return evaluate(e.cache, on_side(face, e.mesh.valence(face), side - e.mesh.face_begin[face], t));
}

std::uint32_t random_side(Rng& rng, const Extreme& e) {
  return static_cast<std::uint32_t>(rng() % e.mesh.corner_vertex.size());
}

Vec3 along_normal(Rng& rng, const Extreme& e, const SurfacePoint& p) {
  const double reach[] = {0, 1e-12 * e.size, 0.25 * e.rho, 0.1 * e.size, e.size};
  const double most = reach[rng() % std::size(reach)];
  const double aside = rng() % 2 ? 0 : e.size * std::pow(10, uniform(rng, -15, -3));
  return p.position + uniform(rng, -0.3 * most, most) * p.normal + aside * oracle::random_unit(rng);
}

Vec3 on_the_surface(Rng& rng, const Extreme& e) { return random_site(rng, e).position; }

Vec3 over_an_edge(Rng& rng, const Extreme& e) {
  return along_normal(rng, e, site_on_side(e, random_side(rng, e), uniform(rng, 0, 1)));
}

Vec3 over_a_vertex(Rng& rng, const Extreme& e) {
  return along_normal(rng, e, site_on_side(e, random_side(rng, e), 0));
}

Vec3 past_a_border(Rng& rng, const Extreme& e) {
  std::uint32_t side = random_side(rng, e);
  while (e.topology.side_twin[side] != kNone) side = random_side(rng, e);
  const double t = uniform(rng, 0, 1);
  const SurfacePoint p = site_on_side(e, side, rng() % 4 ? t : 0),
                     before = site_on_side(e, side, 0), after = site_on_side(e, side, 1);
  const Vec3 out = (after.position - before.position).cross(p.normal).normalized();
  const double reach = e.size * std::pow(10, uniform(rng, -9, 0));
  return p.position + uniform(rng, 0, 1) * reach * out + uniform(rng, -1, 1) * reach * p.normal;
}

Vec3 over_a_pole(Rng& rng, const Extreme& e) {
  const std::size_t first_pole = e.mesh.positions.size() - 2;
  std::uint32_t side = random_side(rng, e);
  while (e.mesh.corner_vertex[side] < first_pole) side = random_side(rng, e);
  const double t = rng() % 2 ? 0 : std::pow(10, uniform(rng, -16, 0));
  return along_normal(rng, e, site_on_side(e, side, t));
}

Vec3 on_the_medial_axis(Rng& rng, const Extreme& e) {
  const SurfacePoint p = random_site(rng, e);
  const Vec3 n = rng() % 2 ? p.normal : Vec3(-p.normal);
  double radius = e.size;
  for (int i = 0; i < 8; ++i) {
    const Vec3 centre = p.position + radius * n;
    const Foot foot = i < 6 ? e.oracle.nearest_sample(centre) : e.oracle.nearest(centre);
    const Vec3 way = foot.position - p.position;
    if (foot.distance < radius && way.dot(n) > 0) radius = way.squaredNorm() / (2 * way.dot(n));
  }
  const double aside = rng() % 2 ? 0 : e.size * std::pow(10, uniform(rng, -15, -2));
  return p.position + radius * n + aside * oracle::random_unit(rng);
}

Vec3 at_a_centre_of_curvature(Rng& rng, const Extreme& e) {
  const auto face = static_cast<std::uint32_t>(rng() % e.mesh.face_count());
  const Vec2 X = 0.99 * oracle::random_inside<double>(rng, static_cast<int>(e.mesh.valence(face)));
  constexpr double h = 1e-5;
  const auto normal = [&](double dx, double dy) {
    return at(e.cache, face, {X.x() + dx, X.y() + dy}).normal;
  };
  const SurfacePoint p = at(e.cache, face, X);
  Eigen::Matrix<double, 3, 2> d, turn;
  d << p.d_xi, p.d_eta;
  turn << (normal(h, 0) - normal(-h, 0)) / (2 * h), (normal(0, h) - normal(0, -h)) / (2 * h);
  Eigen::Matrix2d second = d.transpose() * turn;
  second(0, 1) = second(1, 0) = 0.5 * (second(0, 1) + second(1, 0));
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix2d> eigen(second, d.transpose() * d);
  const double curvature = eigen.eigenvalues()[static_cast<int>(rng() % 2)];
  const double radius = 1 / std::max(std::abs(curvature), 0.1 / e.size);
  const double aside = rng() % 2 ? 0 : e.size * std::pow(10, uniform(rng, -15, -2));
  return p.position - std::copysign(radius, curvature) * p.normal +
         aside * oracle::random_unit(rng);
}

Vec3 inside_a_fold(Rng& rng, const Extreme& e) {
  const std::vector<std::uint32_t>& flagged = e.report.flagged_faces;
  const std::uint32_t face = flagged[rng() % flagged.size()];
  const SurfacePoint p =
      at(e.cache, face, oracle::random_inside<double>(rng, static_cast<int>(e.mesh.valence(face))));
  const double reach = e.size * std::pow(10, uniform(rng, -6, -1));
  return p.position + uniform(rng, -reach, reach) * p.normal + reach * oracle::random_unit(rng);
}

}  // namespace gliss::test
