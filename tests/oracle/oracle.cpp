#include "tests/oracle/oracle.h"

namespace gliss::oracle {

Vec<double> random_unit(Rng& rng) {
  const double z = uniform(rng, -1, 1), angle = uniform(rng, 0, 2 * std::numbers::pi);
  const double r = std::sqrt(std::max(0.0, 1 - z * z));
  return {r * std::cos(angle), r * std::sin(angle), z};
}

Vec<double> random_tilt(Rng& rng, const Vec<double>& axis, double max_tilt) {
  const double tilt = uniform(rng, 0, max_tilt);
  const Vec<double> sideways = axis.unitOrthogonal();
  const Vec<double> turned =
      Eigen::AngleAxisd(uniform(rng, 0, 2 * std::numbers::pi), axis) * sideways;
  return (std::cos(tilt) * axis + std::sin(tilt) * turned).normalized();
}

template Side<double> side(const Polygon<double>&, int, std::type_identity_t<double>);
template Sample<double> evaluate(const Polygon<double>&, std::type_identity_t<double>,
                                 std::type_identity_t<double>);
template Side<long double> side(const Polygon<long double>&, int,
                                std::type_identity_t<long double>);
template Sample<long double> evaluate(const Polygon<long double>&,
                                      std::type_identity_t<long double>,
                                      std::type_identity_t<long double>);
template Nearest<double> nearest(const Polygon<double>&, const std::type_identity_t<Vec<double>>&,
                                 int, int);
template Polygon<double> random_polygon(Rng&, int, double, double);
template Polygon<double> random_neighbour(Rng&, const Polygon<double>&, int, int, double, double,
                                          double);

}  // namespace gliss::oracle
