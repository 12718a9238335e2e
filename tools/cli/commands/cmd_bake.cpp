// gliss bake: a mesh to a patch cache.
#include <fmt/format.h>

#include <set>

#include "gliss/build/build_cache.h"
#include "gliss/files/cache_file.h"
#include "gliss/files/mesh_file.h"
#include "gliss/mesh/regions.h"
#include "gliss/results/lengths.h"
#include "tools/cli/commands/commands.h"
#include "tools/cli/terminal/watch.h"
#include "tools/cli/words/outputs.h"
#include "tools/cli/words/shape_text.h"
#include "tools/cli/words/slips.h"
#include "tools/cli/words/surface_input.h"

namespace gliss::tools {
namespace {

struct BakeOptions : SurfaceOptions {
  std::string output, region, faces;
  bool no_tame = false;
};

void describe(Command& command, BakeOptions& options) {
  add_surface_options(command, options, "MESH");
  command.option({"-o,--output", "FILE", "cache to write", true}, options.output);
  command.option(
      {"--region", "X0,Y0,Z0:X1,Y1,Z1", "only faces that meet the box, in the unit of --unit"},
      options.region);
  command.option({"--faces", "LIST", "only these faces, as 1,2,5-9; the first is 0"},
                 options.faces);
  command.exclude("--faces", "--region");
  command.flag("--no-tame", options.no_tame, "keep folded patches as they are");
}

Vec3 parse_corner(const std::string& text) {
  const auto numbers = split(text, ',');
  if (numbers.size() != 3) throw InputError(fmt::format("--region: '{}' is not x,y,z", text));
  Vec3 corner;
  for (std::size_t i = 0; i < 3; ++i) {
    corner[static_cast<int>(i)] =
        parse_number<double>("--region, in the unit of --unit", numbers[i]);
  }
  return corner;
}

std::vector<std::uint32_t> parse_region(const Mesh& mesh, const std::string& text) {
  const auto corners = split(text, ':');
  if (corners.size() != 2)
    throw InputError(fmt::format("--region: '{}' is not x0,y0,z0:x1,y1,z1", text));
  const Vec3 a = parse_corner(corners[0]), b = parse_corner(corners[1]);
  auto faces = faces_in_box(mesh, {a.cwiseMin(b), a.cwiseMax(b)});
  if (faces.empty()) throw InputError(fmt::format("--region: no face meets '{}'", text));
  return faces;
}

std::vector<std::uint32_t> parse_faces(const Mesh& mesh, const std::string& text) {
  std::set<std::uint32_t> faces;
  for (const std::string& item : split(text, ',')) {
    const auto ends = split(item, '-');
    const auto first = parse_number<std::uint32_t>("--faces", ends.front()),
               last = parse_number<std::uint32_t>("--faces", ends.back());
    if (ends.size() > 2 || last < first) {
      throw InputError(fmt::format("--faces: '{}' is not a range", item));
    }
    if (last >= mesh.face_count()) {
      throw InputError(fmt::format("--faces: {} is beyond the last of {}, which is {}", last,
                                   mesh.source, mesh.face_count() - 1));
    }
    for (std::uint32_t face = first; face <= last; ++face) faces.insert(face);
  }
  return {faces.begin(), faces.end()};
}

void report_bake(const BakeOptions& options, const Mesh& mesh, std::size_t faces,
                 const PatchCache& cache, const BuildReport& found, double seconds) {
  const std::string unit = unit_name(cache.unit);
  Json json = {{"output", options.output},
               {"mesh_faces", mesh.face_count()},
               {"faces", faces},
               {"patches", cache.patch_count()},
               {"level", level_name(cache.level)},
               {"construction", construction_name(cache.level.construction)},
               {"precision", precision_name(cache.precision())},
               {"unit", unit}};
  json.update(built_json(found));
  json.update({{"creases", cache.crease_count},
               {"strips", mesh.strips.size()},
               {"rounded_corners", mesh.rounded_corners.size()},
               {"flagged_faces", found.flagged_faces},
               {"departure", departure_json(cache.departure, cache.unit)},
               {"tightest", departure_json(cache.tightest, cache.unit)},
               {"rho_min", radius_json(cache.smallest_rho())},
               {"bytes", cache.bytes()},
               {"mesh_hash", hash_name(cache.mesh_hash)},
               {"seconds", seconds}});
  report(options,
         fmt::format("{}: {} of {} faces, {} patches of level {}, {} construction, in {}, unit {}\n"
                     "{}{}\n"
                     "{}\n"
                     "least radius of curvature {}, {} bytes, {:.2f} s\n",
                     options.output, faces, mesh.face_count(), cache.patch_count(),
                     level_name(cache.level), construction_name(cache.level.construction),
                     precision_name(cache.precision()), unit, built_text(found),
                     creases_text(cache.crease_count) + rounded_text(mesh), departure_text(cache),
                     radius_text(cache.smallest_rho(), unit), cache.bytes(), seconds),
         json);
}

void run(const BakeOptions& options) {
  refuse_cache(options);
  check_outputs({options.output}, {options.surface});
  if (has_mesh_ending(options.output)) {
    throw InputError(
        fmt::format("'{}' has the ending of a mesh, and bake writes a cache: name it as FILE.gliss",
                    options.output));
  }
  const Stopwatch clock;
  const auto engine = make_engine(options);
  const Mesh mesh = read_mesh(options, true);
  BuildOptions how;
  how.tame = !options.no_tame;
  if (!options.region.empty()) how.faces = parse_region(mesh, options.region);
  if (!options.faces.empty()) how.faces = parse_faces(mesh, options.faces);
  BuildReport found;
  const PatchCache cache = build(mesh, options, *engine, how, &found);
  {
    const Watch watch(options, "write " + options.output);
    save_cache(cache, options.output, stop_if_interrupted);
  }
  tell_tight_curvature(options, cache, usual_depth(cache), "0.5 % of the diagonal");
  report_bake(options, mesh, how.faces.empty() ? mesh.face_count() : how.faces.size(), cache, found,
              clock.seconds());
}

}  // namespace

void add_bake(Command& program) {
  add_command<BakeOptions>(program, "bake",
                           "Build the patches of a mesh and keep them in a cache.\n"
                           "rho_min (--json): least radius of curvature of its patches, by "
                           "samples, in the unit. A HIP that is deeper beneath that bend has no "
                           "single nearest point.\n",
                           "gliss bake teeth.obj --unit mm -o teeth.gliss", describe, run);
}

}  // namespace gliss::tools
