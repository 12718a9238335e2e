// Quantities as people write them ("2mm", "0.5 N/mm"), in SI as the code wants them.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace gliss {

// what() quotes the text and says what is accepted.
struct UnitError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// A finite number and a unit, with or without a space between; a number alone is SI. The result is
// the double nearest to what was written: "9mm" is 0.009.
double parse_length(std::string_view text);     // [m]; m, cm, mm, um, nm, in
double parse_stiffness(std::string_view text);  // [N/m]; N, mN or kN over a length
double parse_unit(std::string_view text);       // "mm" -> 1e-3; also a positive number of metres

}  // namespace gliss
