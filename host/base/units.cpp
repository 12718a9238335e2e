#include "gliss/base/units.h"

#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>

#include "gliss/base/message.h"

namespace gliss {
namespace {

// value = number * times / over. Both are whole, so that one rounding is all there is for SI
// prefixes: 9 / 1000 is the double nearest to 0.009, 9 * 1e-3 is not.
struct Factor {
  double times = 1, over = 1;
};

struct Unit {
  std::string_view name;
  Factor factor;
};

constexpr Unit kLengths[] = {{"m", {}},
                             {"metre", {}},
                             {"meter", {}},
                             {"cm", {1, 1e2}},
                             {"centimetre", {1, 1e2}},
                             {"centimeter", {1, 1e2}},
                             {"mm", {1, 1e3}},
                             {"millimetre", {1, 1e3}},
                             {"millimeter", {1, 1e3}},
                             {"um", {1, 1e6}},
                             {"\u00B5m", {1, 1e6}},  // micro sign
                             {"\u03BCm", {1, 1e6}},  // Greek mu
                             {"nm", {1, 1e9}},
                             {"in", {254, 1e4}},
                             {"inch", {254, 1e4}}};
constexpr Unit kForces[] = {{"N", {}}, {"mN", {1, 1e3}}, {"kN", {1e3, 1}}};
constexpr Unit kTimes[] = {{"s", {}}, {"ms", {1, 1e3}}, {"us", {1, 1e6}}, {"ns", {1, 1e9}}};
constexpr Unit kAngles[] = {{"rad", {}}, {"deg", {std::numbers::pi, 180}}};
constexpr char kAcceptedLengths[] = "m, cm, mm, um, nm or in";

template <std::size_t count>
std::optional<Factor> find(const Unit (&units)[count], std::string_view name) {
  for (const Unit& unit : units) {
    if (unit.name == name) return unit.factor;
  }
  return {};
}

std::optional<Factor> find_length(std::string_view name) { return find(kLengths, name); }

std::optional<Factor> find_time(std::string_view name) { return find(kTimes, name); }

std::optional<Factor> find_angle(std::string_view name) { return find(kAngles, name); }

std::optional<Factor> find_force(std::string_view name) { return find(kForces, name); }

std::string_view trim(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  return text;
}

// "N s", "Ns"
std::optional<Factor> find_impulse(std::string_view name) {
  if (!name.ends_with('s')) return {};
  name.remove_suffix(1);
  return find_force(trim(name));
}

// What `find_top` finds over a length.
template <std::optional<Factor> (*find_top)(std::string_view)>
std::optional<Factor> find_over_length(std::string_view name) {
  const auto slash = name.find('/');
  if (slash == std::string_view::npos) return {};
  const auto top = find_top(name.substr(0, slash));
  const auto length = find_length(name.substr(slash + 1));
  if (!top || !length) return {};
  return Factor{top->times * length->over, top->over * length->times};
}

double parse(std::string_view text, std::optional<Factor> (*find_factor)(std::string_view),
             const std::string& accepted) {
  std::string_view rest = trim(text);
  if (rest.starts_with('+') && !rest.starts_with("+-")) rest.remove_prefix(1);
  double number = 0;
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), number);
  if (error != std::errc() || !std::isfinite(number)) {
    throw UnitError(
        detail::message("'", text, "' does not begin with a finite number; ", accepted));
  }
  const std::string_view unit = trim(rest.substr(static_cast<std::size_t>(end - rest.data())));
  if (unit == "%") throw UnitError(detail::message("'", text, "' is a share; ", accepted));
  const auto factor = unit.empty() ? Factor{} : find_factor(unit);
  if (!factor)
    throw UnitError(detail::message("'", text, "' has an unknown unit '", unit, "'; ", accepted));
  const double value = number * factor->times / factor->over;
  if (!std::isfinite(value))
    throw UnitError(detail::message("'", text, "' is too large; ", accepted));
  return value;
}

}  // namespace

double parse_length(std::string_view text) {
  return parse(text, find_length,
               detail::message("a length is a number in ", kAcceptedLengths,
                               ", or in metres without a unit"));
}

double parse_stiffness(std::string_view text) {
  return parse(text, find_over_length<find_force>,
               detail::message("a stiffness is a number in N, mN or kN over ", kAcceptedLengths,
                               " such as 0.5N/mm, or in N/m without a unit"));
}

double parse_force(std::string_view text) {
  return parse(text, find_force, "a force is a number in N, mN or kN, or in N without a unit");
}

double parse_viscosity(std::string_view text) {
  return parse(text, find_over_length<find_impulse>,
               "a viscosity is a number such as 3 N s/m, or in N s/m without a unit");
}

double parse_damping(std::string_view text) {
  return parse(text, find_over_length<find_time>,
               "a damping is a number such as 2 s/m, or in s/m without a unit");
}

double parse_time(std::string_view text) {
  return parse(text, find_time,
               "a time is a number in s, ms, us or ns, or in seconds without a unit");
}

double parse_angle(std::string_view text) {
  return parse(text, find_angle, "an angle is a number in deg or rad, or in rad without a unit");
}

double parse_unit(std::string_view text) {
  const std::string accepted =
      detail::message("a unit is ", kAcceptedLengths, ", or a positive number of metres");
  if (const auto factor = find_length(trim(text))) return factor->times / factor->over;
  const double metres = parse(text, find_length, accepted);
  if (!(metres > 0)) throw UnitError(detail::message("'", text, "' is not positive; ", accepted));
  return metres;
}

}  // namespace gliss
