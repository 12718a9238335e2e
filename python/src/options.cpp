#include "options.h"

#include <fmt/format.h>

#include <cmath>

#include "arrays.h"
#include "gliss/base/units.h"

namespace gliss::python {
namespace {

[[noreturn]] void refuse(const py::object& value, const char* name, const char* what) {
  throw py::type_error(
      fmt::format("{}: expected {}, found {}", name, what, py::repr(value).cast<std::string>()));
}

double positive(double value, const char* name) {
  if (!(value > 0)) throw py::value_error(fmt::format("{}: {} is not above 0", name, value));
  return value;
}

// The members of a sequence that is no text. Throws TypeError.
std::vector<py::object> members(py::handle value, const char* name, const char* what) {
  if (!py::isinstance<py::sequence>(value) || py::isinstance<py::str>(value))
    throw py::type_error(fmt::format("{}: expected {}", name, what));
  std::vector<py::object> all;
  for (const py::handle member : value) all.push_back(py::reinterpret_borrow<py::object>(member));
  return all;
}

MagnetOptions magnet_of(py::handle value) {
  const auto parts = members(value, "magnet", "(force, range)");
  if (parts.size() != 2) throw py::value_error("magnet: expected (force, range)");
  return {quantity(parts[0], "magnet", parse_force, "a force in N, or text such as '0.5N'"),
          length(parts[1], "magnet")};
}

TextureOptions texture_of(py::handle value) {
  const char* what = "(relief, height, period) or (relief, height, period, (x, y, z))";
  const auto parts = members(value, "texture", what);
  if (parts.size() != 3 && parts.size() != 4)
    throw py::value_error(fmt::format("texture: expected {}", what));
  if (!py::isinstance<py::str>(parts[0]))
    throw py::type_error(fmt::format("texture: expected {}", what));
  TextureOptions texture;
  texture.relief = choice("texture", parts[0].cast<std::string>(), kReliefNames);
  texture.height = length(parts[1], "texture");
  texture.period = length(parts[2], "texture");
  if (parts.size() == 4) texture.along = point_of(parts[3], "texture");
  return texture;
}

}  // namespace

std::string text(const py::dict& options, const char* name) {
  const py::object value = options[name];
  if (!py::isinstance<py::str>(value)) refuse(value, name, "text");
  return value.cast<std::string>();
}

bool yes_or_no(const py::dict& options, const char* name) {
  const py::object value = options[name];
  if (!py::isinstance<py::bool_>(value)) refuse(value, name, "True or False");
  return value.cast<bool>();
}

std::int64_t whole_number(const py::dict& options, const char* name) {
  const py::object value = options[name];
  if (!PyIndex_Check(value.ptr())) refuse(value, name, "a whole number");
  return value.cast<std::int64_t>();
}

double quantity(py::handle value, const char* name, double (*parse)(std::string_view),
                const char* what) {
  if (parse != nullptr && py::isinstance<py::str>(value)) return parse(value.cast<std::string>());
  const double number = PyBool_Check(value.ptr()) ? -1 : PyFloat_AsDouble(value.ptr());
  if (PyBool_Check(value.ptr()) || PyErr_Occurred()) {
    PyErr_Clear();
    throw py::type_error(fmt::format("{}: expected {}", name, what));
  }
  if (!std::isfinite(number))
    throw py::value_error(fmt::format("{}: expected {}, found {}", name, what, number));
  return number;
}

double length(py::handle value, const char* name) {
  return positive(quantity(value, name, parse_length, "a length in m, or text such as '2mm'"),
                  name);
}

double stiffness(py::handle value) {
  return positive(quantity(value, "stiffness", parse_stiffness,
                           "a stiffness in N/m, or text such as '0.5N/mm'"),
                  "stiffness");
}

double settle(py::handle value, const char* name) {
  const double seconds = quantity(value, name, parse_time, "a time in s, or text such as '5ms'");
  if (!(seconds >= 0 && seconds <= kMostSettleTime))
    throw py::value_error(fmt::format("{}: {} s is not from 0 to 1 s", name, seconds));
  return seconds;
}

double tick(py::handle value) { return positive(settle(value, "dt"), "dt"); }

std::vector<double> depths(py::handle list) {
  if (py::isinstance<py::str>(list) || !py::isinstance<py::sequence>(list))
    return {length(list, "depth")};
  std::vector<double> all;
  for (const py::handle depth : list) all.push_back(length(depth, "depth"));
  if (all.empty()) throw py::value_error("depth: expected one at least");
  return all;
}

FrictionOptions friction(py::handle value, py::handle settle_time) {
  constexpr char kWhat[] = "a coefficient, or (at rest, slipping)";
  FrictionOptions options;
  const auto number = [&](py::handle part) { return quantity(part, "friction", nullptr, kWhat); };
  if (py::isinstance<py::sequence>(value) && !py::isinstance<py::str>(value)) {
    const auto parts = members(value, "friction", kWhat);
    if (parts.size() != 2) throw py::value_error(fmt::format("friction: expected {}", kWhat));
    options.at_rest = number(parts[0]);
    options.slipping = number(parts[1]);
  } else {
    options.at_rest = options.slipping = number(value);
  }
  options.settle = settle(settle_time, "friction_settle");
  if (const char* fault = fault_of(options))
    throw py::value_error(fmt::format("the surface {}", fault));
  return options;
}

EffectOptions effects(py::handle damping, py::handle viscosity, py::handle magnet,
                      py::handle texture) {
  EffectOptions options;
  options.damping =
      quantity(damping, "damping", parse_damping, "a damping in s/m, or text such as '2s/m'");
  options.viscosity = quantity(viscosity, "viscosity", parse_viscosity,
                               "a viscosity in N s/m, or text such as '3Ns/m'");
  if (!magnet.is_none()) options.magnet = magnet_of(magnet);
  if (!texture.is_none()) options.texture = texture_of(texture);
  if (const char* fault = fault_of(options))
    throw py::value_error(fmt::format("the surface {}", fault));
  return options;
}

TouchOptions touch_options(const py::dict& options) {
  TouchOptions touch;
  touch.stiffness = stiffness(options["stiffness"]);
  touch.query.method = choice("method", text(options, "method"), kMethodNames);
  touch.query.settle = settle(options["settle"], "settle");
  touch.query.friction = friction(options["friction"], options["friction_settle"]);
  touch.effects =
      effects(options["damping"], options["viscosity"], options["magnet"], options["texture"]);
  return touch;
}

}  // namespace gliss::python
