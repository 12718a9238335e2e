// gliss info: what a mesh or a cache holds.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "gliss/base/median.h"
#include "gliss/mesh/mesh_edges.h"
#include "gliss/surface/names.h"
#include "tools/cli/commands/commands.h"
#include "tools/cli/words/shape_text.h"
#include "tools/cli/words/surface_input.h"

namespace gliss::tools {
namespace {

// Tells of the faces that were built, and how they hang together.
struct Shape {
  std::uint32_t faces = 0, folded = 0, vertices = 0, edges = 0, border_sides = 0, parts = 0;
  std::map<std::uint32_t, std::uint32_t> valences;  // faces with as many sides
};

// A patch's sides that are the face's own; the others are cuts inside it.
Shape shape_of(const PatchCache& cache) {
  Shape shape;
  std::uint32_t centres = 0, cuts = 0;
  std::visit(
      [&](const auto& s) {
        const auto sides = static_cast<std::uint32_t>(s.side_patch.size());
        DisjointSets parts(cache.patch_count()), corners(sides);
        shape.parts = cache.patch_count();
        shape.vertices = sides;
        const auto next = [&](std::uint32_t side) {
          const std::uint32_t patch = s.side_patch[side];
          return side + 1 == s.side_begin[patch + 1] ? s.side_begin[patch] : side + 1;
        };
        for (std::uint32_t side = 0; side < sides; ++side) {
          const std::uint32_t twin = s.side_twin[side], patch = s.side_patch[side];
          shape.border_sides += twin == kNone;
          if (twin == kNone) continue;
          cuts += cache.patch_face[patch] == cache.patch_face[s.side_patch[twin]];
          shape.parts -= parts.unite(patch, s.side_patch[twin]);
          shape.vertices -= corners.unite(side, next(twin));
        }
        for (std::uint32_t face = 0; face < cache.mesh_face_count; ++face) {
          const std::uint32_t patch = cache.first_patch(face);
          if (patch == kNone) continue;
          ++shape.faces;
          shape.folded += cache.folded[patch] != 0;
          ++shape.valences[cache.face_valence[face]];
          const auto begin = cache.corner_of_face.begin() + s.side_begin[patch];
          const auto end = begin + s.valence(patch);
          centres += std::find(begin, end, cache.face_valence[face]) != end;
        }
        shape.edges = (sides - cuts - shape.border_sides) / 2 + shape.border_sides;
      },
      cache.surface);
  shape.vertices -= centres;
  return shape;
}

std::map<std::string, std::uint32_t> count_kinds(const PatchCache& cache) {
  std::map<std::string, std::uint32_t> kinds;
  for (const auto& [name, kind] : kPatchKindNames) kinds[name] = 0;
  for (const PatchKind kind : cache.kind) ++kinds[name_of(kPatchKindNames, kind)];
  return kinds;
}

// Counts the forms that patches are kept in: the cache's level, or another that stands in.
std::map<std::string, std::uint32_t> count_forms(const PatchCache& cache) {
  std::map<std::string, std::uint32_t> forms;
  std::visit(
      [&](const auto& surface) {
        for (const std::uint32_t form : surface.form) ++forms[form_name(form)];
      },
      cache.surface);
  return forms;
}

// Counts by name as a list of `format`, which takes a count and its name.
template <class Name>
std::string list_text(const std::map<Name, std::uint32_t>& counts, const char* format) {
  std::string text;
  for (const auto& [name, count] : counts)
    text += (text.empty() ? "" : ", ") + fmt::format(fmt::runtime(format), count, name);
  return text;
}

// What is known of a cache, lengths in the unit of --unit.
struct Figures {
  Shape shape;
  std::map<std::string, std::uint32_t> kinds, forms;
  Vec3 low, high;  // of the bounds
  double rho_min = 0, rho_median = 0;
};

std::string text_of(const PatchCache& cache, const Figures& figures, const std::string& unit) {
  const auto& [shape, kinds, forms, low, high, rho_min, rho_median] = figures;
  return fmt::format(
      "faces         {} of {}: {}\n"
      "vertices      {}, edges {}, border sides {}, parts {}\n"
      "patches       {}: plain {}, eased {}, split {}, bent {}\n"
      "folded faces  {}{}\n"
      "unit          {} (coordinates here in {})\n"
      "bounds        {:.6g} {:.6g} {:.6g} to {:.6g} {:.6g} {:.6g} {}, {:.4g} {} across\n"
      "departure     {}\n"
      "curvature     least radius of curvature {}, median of the patches {}\n"
      "level         {}, {} construction; forms: {}\n"
      "precision     {}, {:.2f} MiB\n"
      "mesh hash     {}\n",
      shape.faces, cache.mesh_face_count, list_text(shape.valences, "{} x {} sides"),
      shape.vertices, shape.edges, shape.border_sides, shape.parts, cache.patch_count(),
      kinds.at("exact"), kinds.at("eased"), kinds.at("split"), kinds.at("bent"), shape.folded,
      creases_text(cache.crease_count), unit_name(cache.unit), unit, low.x(), low.y(), low.z(),
      high.x(), high.y(), high.z(), unit, (high - low).norm(), unit, departure_text(cache),
      radius_text(rho_min, unit), radius_text(rho_median, unit), level_name(cache.level),
      construction_name(cache.level.construction), list_text(forms, "{} {}"),
      precision_name(cache.precision()), static_cast<double>(cache.bytes()) / (1 << 20),
      hash_name(cache.mesh_hash));
}

Json json_of(const PatchCache& cache, const Figures& figures, const SurfaceOptions& options) {
  const auto& [shape, kinds, forms, low, high, rho_min, rho_median] = figures;
  Json valences;
  for (const auto& [valence, count] : shape.valences) valences[std::to_string(valence)] = count;
  return {{"surface", options.surface},
          {"mesh_faces", cache.mesh_face_count},
          {"faces", shape.faces},
          {"valences", valences},
          {"vertices", shape.vertices},
          {"edges", shape.edges},
          {"border_sides", shape.border_sides},
          {"parts", shape.parts},
          {"patches", cache.patch_count()},
          {"kinds", kinds},
          {"folded_faces", shape.folded},
          {"creases", cache.crease_count},
          {"surface_unit", unit_name(cache.unit)},
          {"unit", unit_name(options.unit)},
          {"bounds", {{low.x(), low.y(), low.z()}, {high.x(), high.y(), high.z()}}},
          {"departure", departure_json(cache.departure, cache.unit)},
          {"tightest", departure_json(cache.tightest, cache.unit)},
          {"rho_min", radius_json(rho_min)},
          {"rho_median", radius_json(rho_median)},
          {"level", level_name(cache.level)},
          {"construction", construction_name(cache.level.construction)},
          {"forms", forms},
          {"precision", precision_name(cache.precision())},
          {"bytes", cache.bytes()},
          {"mesh_hash", hash_name(cache.mesh_hash)}};
}

void describe(Command& command, SurfaceOptions& options) {
  add_surface_options(command, options, "MESH_OR_CACHE");
}

void run(const SurfaceOptions& options) {
  const auto engine = make_engine(options);
  const PatchCache cache = open_surface(options, *engine);
  const UnitChange length(cache.unit, options.unit);
  const Box bounds = cache.bounds();
  const Figures figures{shape_of(cache),
                        count_kinds(cache),
                        count_forms(cache),
                        length(bounds.low),
                        length(bounds.high),
                        length(cache.smallest_rho()),
                        length(median({cache.rho_min.begin(), cache.rho_min.end()}))};
  report(options, text_of(cache, figures, unit_name(options.unit)),
         json_of(cache, figures, options));
}

}  // namespace

void add_info(Command& program) {
  add_command<SurfaceOptions>(program, "info",
                              "Say what a mesh or a cache holds.\n"
                              "rho_min (--json): least radius of curvature of its patches, by "
                              "samples, in the unit. A HIP that is deeper beneath that bend has "
                              "no single nearest point.\n",
                              "gliss info teeth.obj --unit mm", describe, run);
}

}  // namespace gliss::tools
