// What commands read: a mesh or a cache, and points in whatever unit they come.
#pragma once

#include <string>
#include <vector>

#include "host/csv_reader.h"
#include "tools/command.h"

namespace gliss::tools {

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

// Reads and repairs; what was repaired is said on stderr.
Mesh read_mesh(const SurfaceOptions& options);

// With progress and Ctrl-C. `faces` empty: all.
PatchCache build(const Mesh& mesh, const SurfaceOptions& options, const Engine& engine,
                 BuildOptions build_options = {}, BuildReport* report = nullptr);

// A cache as it is, a mesh built. Throws CacheError where a cache is not of the wanted precision.
PatchCache open_surface(const SurfaceOptions& options, const Engine& engine);

// Columns x,y,z in the unit of --unit, or x_mm,y_mm,z_mm in millimetres.
struct PointTable {
  CsvTable table;
  double unit = 1;           // m
  std::vector<Vec3> points;  // in `unit`
};
PointTable read_points(const std::string& path, double unit,
                       const std::vector<std::string>& optional = {});

}  // namespace gliss::tools
