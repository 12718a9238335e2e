// Quantities as people write them ("2mm", "0.5 N/mm"), in SI as the code wants them.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

#include "gliss/base/export.h"
#include "gliss/base/vector.h"

namespace gliss {

// what() quotes the text and says what is accepted.
struct GLISS_EXPORT UnitError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// A finite number and a unit, with or without a space between; a number alone is SI. The result is
// the double nearest to what was written: "9mm" is 0.009.
GLISS_EXPORT double parse_length(std::string_view text);     // [m]; m, cm, mm, um, nm, in
GLISS_EXPORT double parse_stiffness(std::string_view text);  // [N/m]; N, mN or kN over a length
GLISS_EXPORT double parse_force(std::string_view text);      // [N]; N, mN, kN
GLISS_EXPORT double parse_viscosity(std::string_view text);  // [N s/m]; as "3 N s/m", "1 mN s/mm"
GLISS_EXPORT double parse_damping(std::string_view text);    // [s/m]; a time over a length
GLISS_EXPORT double parse_time(std::string_view text);       // [s]; s, ms, us, ns
GLISS_EXPORT double parse_angle(std::string_view text);      // [rad]; deg, rad
// "mm" -> 1e-3; also a positive number of metres.
GLISS_EXPORT double parse_unit(std::string_view text);

// Lengths of one unit in another: the same bits where the units are equal, one rounding where one
// is a whole multiple of the other.
class UnitChange {
 public:
  UnitChange(double from, double to)
      : times_(from > to ? from / to : 1), over_(from < to ? to / from : 1) {}
  double operator()(double length) const { return length * times_ / over_; }
  Vec3 operator()(const Vec3& v) const { return v * times_ / over_; }

 private:
  double times_, over_;
};

}  // namespace gliss
