// Measures how far a patch is from what an oracle says of it.
#pragma once

#include "tests/support/surfaces.h"

namespace gliss::test {

// Errors of a patch relative to its size; of normals in rad, where G_xi and G_eta span a square as
// large as the patch: where they nearly coincide, no evaluator can say more.
struct Errors {
  Worst position, slope, normal;

  template <class S>
  void add(const SurfacePoint& got, const oracle::Sample<S>& want, double size) {
    position.add((got.position - want.G.template cast<double>()).norm() / size);
    slope.add((got.d_xi - want.G_xi.template cast<double>()).norm() / size);
    slope.add((got.d_eta - want.G_eta.template cast<double>()).norm() / size);
    const Vec3 d_xi = want.G_xi.template cast<double>(), d_eta = want.G_eta.template cast<double>();
    const double narrow =
        d_xi.cross(d_eta).norm() / (std::max({d_xi.norm(), d_eta.norm(), size}) * size);
    const Vec3 direction = want.normal.template cast<double>();
    normal.add(narrow * oracle::angle<double>(got.normal, direction));
    normal.add(std::abs(got.normal.norm() - 1));
  }
  void expect_below(double position_bound, double slope_bound, double normal_bound,
                    const std::string& name) const {
    EXPECT_LE(position.value, position_bound) << name;
    EXPECT_LE(slope.value, slope_bound) << name;
    EXPECT_LE(normal.value, normal_bound) << name;
    test::record(name, "position {:.2g}, slope {:.2g}, normal {:.2g}", position.value, slope.value,
                 normal.value);
  }
};

}  // namespace gliss::test
