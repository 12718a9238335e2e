#include "tools/cli/words/slips.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>

#include "gliss/files/mesh_file.h"
#include "tools/cli/terminal/interrupt.h"
#include "tools/cli/terminal/terminal.h"
#include "tools/cli/terminal/watch.h"
#include "tools/cli/words/surface_input.h"

namespace gliss::tools {
namespace {

namespace fs = std::filesystem;

constexpr double kHouse = 10, kTiny = 1e-3, kUnseen = 1e-4;  // m
constexpr double kSoft = 5;                                  // N/m

Box box_of(std::span<const Vec3> points) {
  Box box{points.front(), points.front()};
  for (const Vec3& p : points) {
    box.low = box.low.cwiseMin(p);
    box.high = box.high.cwiseMax(p);
  }
  return box;
}

// How far a point is from a box.
double distance(const Vec3& p, const Box& box) {
  return (p - p.cwiseMax(box.low).cwiseMin(box.high)).norm();
}

// A unit as it is written on the command line, or in a scene.
std::string unit_words(const SurfaceOptions& options, const std::string& unit) {
  return fmt::format(fmt::runtime(options.in_scene ? "unit = \"{}\"" : "--unit {}"), unit);
}

std::size_t count_of(const std::vector<Finding>& findings, const std::string& code) {
  const auto is_it = [&](const Finding& finding) { return finding.code == code; };
  const auto known = std::find_if(findings.begin(), findings.end(), is_it);
  return known == findings.end() ? 0 : known->count;
}

}  // namespace

void tell_odd_size(const SurfaceOptions& options, const Mesh& mesh) {
  if (options.quiet || mesh.positions.empty()) return;
  const double across = diagonal_of(box_of(mesh.positions)) * mesh.unit;
  if (across > kHouse && !options.has_unit) {
    tell(fmt::format("gliss: {} is {} across: '{}' if its coordinates are millimetres\n",
                     options.surface, length_text(across), unit_words(options, "mm")));
  } else if (across < kUnseen) {
    const double metres = across / mesh.unit;
    const bool plain = metres >= kTiny && metres <= kHouse;
    tell(fmt::format(
        "gliss: {} is {} across: {}\n", options.surface, length_text(across),
        plain ? fmt::format("'{}' if its coordinates are metres", unit_words(options, "m"))
              : fmt::format("is '{}' right?", unit_words(options, unit_name(options.unit)))));
  }
}

void tell_seams(const SurfaceOptions& options, const Mesh& mesh,
                const std::vector<Finding>& findings) {
  constexpr double kNear = 1e-4;  // of the size: no detail that a mesh is meant to have
  constexpr std::size_t kMany = 20, kPart = 3;  // border sides; of which so many vertices are few
  const std::size_t borders = count_of(findings, "open-border");
  if (options.quiet || options.weld < 0 || borders < kMany) return;
  const double near = kNear * diagonal_of(box_of(mesh.positions));
  Mesh welded = mesh;
  std::vector<Finding> found;
  try {
    const LoadOptions and_weld{
        .weld = near, .normals = NormalSource::kFile, .poll = stop_if_interrupted};
    validate(welded, and_weld, &found);
  } catch (const MeshError&) {
    return;
  }
  const std::size_t vertices = count_of(found, "welded-vertices");
  if (vertices * kPart < borders) return;
  tell(fmt::format(
      "gliss: {}: {} vertices at borders are within {} of others: '--weld {:.2g}mm' "
      "makes them one\n",
      options.surface, vertices, length_text(near * mesh.unit), near * mesh.unit * 1e3));
}

void tell_edited_mesh(const SurfaceOptions& options, const PatchCache& cache) {
  // The hash of a mesh with creases holds more than its file.
  if (options.quiet || cache.crease_count > 0) return;
  std::error_code none;
  for (const std::string_view ending : mesh_endings()) {
    const fs::path mesh = fs::path(options.surface).replace_extension(ending);
    const auto written = fs::last_write_time(mesh, none);
    if (none || written <= fs::last_write_time(options.surface, none) || none) continue;
    try {
      const LoadOptions as_baked{.unit = cache.unit, .poll = stop_if_interrupted};
      if (hash_of(gliss::load_mesh(mesh.string(), as_baked)) == cache.mesh_hash) continue;
    } catch (const MeshError&) {
    }
    tell(
        fmt::format("gliss: {} has changed since {} was baked, or is another mesh: 'gliss bake' "
                    "makes the cache anew\n",
                    mesh.string(), options.surface));
  }
}

void tell_soft_spring(const ReportOptions& options, double stiffness, const std::string& name) {
  if (options.quiet || !(stiffness < kSoft)) return;
  tell(
      fmt::format("gliss: {}: {:.4g} N/m gives {:.2g} N a millimetre, which no hand feels; a bare "
                  "number is N/m, and '0.5N/mm' is usual\n",
                  name, stiffness, stiffness * 1e-3));
}

void Nearness::add(std::span<const Vec3> hips) {
  constexpr double kUnits[] = {1, 1e-3, 1e3};
  for (const Vec3& hip : hips) {
    for (const Box& box : boxes_) {
      for (std::size_t i = 0; i < least_.size(); ++i)
        least_[i] = std::min(least_[i], distance(kUnits[i] * hip, box));
    }
  }
}

void tell_untouched(const ReportOptions& options, const std::string& path, const Nearness& nearness,
                    const std::string& columns) {
  if (options.quiet || !nearness.any()) return;
  std::string text = fmt::format("gliss: {}: no HIP touches the surface", path);
  const double apart = nearness.apart();
  if (apart > 0)
    text += fmt::format(", and none comes nearer to its box than {}", length_text(apart));
  constexpr double kFar = 10;  // sizes of a box: nearer HIPs have the right unit
  if (apart > kFar * diagonal_of(nearness.boxes().front())) {
    const char* unit = nearness.would_meet_in_millimetres() ? "millimetres"
                       : nearness.would_meet_in_metres()    ? "metres"
                                                            : nullptr;
    if (unit != nullptr) text += fmt::format("; if its numbers are {}, {}", unit, columns);
  }
  tell(text + "\n");
}

void tell_untouched(const ReportOptions& options, const std::string& path,
                    std::span<const Vec3> hips, std::span<const Box> boxes,
                    const std::string& columns) {
  if (options.quiet) return;
  Nearness nearness({boxes.begin(), boxes.end()});
  nearness.add(hips);
  tell_untouched(options, path, nearness, columns);
}

void tell_far(const ReportOptions& options, const std::string& path, const Nearness& nearness,
              const std::string& columns) {
  if (nearness.any() && nearness.apart() > diagonal_of(nearness.boxes().front()))
    tell_untouched(options, path, nearness, columns);
}

void refuse_cache(const SurfaceOptions& options) {
  if (is_cache(options))
    throw InputError(
        fmt::format("{} is a cache: name the mesh that it was baked from, or 'gliss "
                    "info' to see what it holds",
                    options.surface));
}

}  // namespace gliss::tools
