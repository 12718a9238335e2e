#include "host/point_table.h"

#include <fmt/format.h>

#include <cmath>

#include "host/hdf5_types.h"
#include "host/units.h"

namespace gliss {
namespace {

using hdf5::Handle;

std::vector<double> read_column(const Handle& file, const std::string& name,
                                const std::string& action) {
  const Handle dataset(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose, action);
  const Handle space(H5Dget_space(dataset), H5Sclose, action);
  std::vector<double> values(
      static_cast<std::size_t>(hdf5::check(H5Sget_simple_extent_npoints(space), action)));
  hdf5::check(H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
              action);
  return values;
}

std::vector<Vec3> read_recording(const std::string& path) {
  hdf5::Quiet quiet;
  const std::string action = fmt::format("cannot read '{}' as a recording", path);
  const Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, action);
  const auto x = read_column(file, "ticks/x", action), y = read_column(file, "ticks/y", action),
             z = read_column(file, "ticks/z", action);
  if (y.size() != x.size() || z.size() != x.size())
    throw std::runtime_error(action + ": x, y and z are not equally long");
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < x.size(); ++i) {
    points.emplace_back(x[i], y[i], z[i]);
    if (!points.back().allFinite())
      throw std::runtime_error(fmt::format("{}: tick {} is not finite", action, i));
  }
  return points;
}

}  // namespace

PointTable read_points(const std::string& path, double unit,
                       const std::vector<std::string>& optional) {
  PointTable result;
  if (path.ends_with(".h5") || path.ends_with(".hdf5")) {
    result.points = read_recording(path);
    return result;
  }
  const std::vector<std::vector<std::string>> names = {{"x", "y", "z"}, {"x_mm", "y_mm", "z_mm"}};
  result.table = read_csv(path, {.alternatives = names, .optional = optional});
  const std::size_t chosen = result.table.alternative;
  result.unit = chosen == 0 ? unit : 1e-3;
  const auto &x = *result.table.find(names[chosen][0]), &y = *result.table.find(names[chosen][1]),
             &z = *result.table.find(names[chosen][2]);
  result.points.reserve(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) result.points.emplace_back(x[i], y[i], z[i]);
  return result;
}

std::vector<Vec3> points_in_metres(const PointTable& table) {
  const UnitChange to_metres(table.unit, 1);
  std::vector<Vec3> points = table.points;
  for (Vec3& point : points) point = to_metres(point);
  return points;
}

}  // namespace gliss
