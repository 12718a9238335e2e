// gliss check: everything the checks of a mesh find, and the faces whose exact patch folds.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <exception>
#include <span>

#include "gliss/build/build_cache.h"
#include "gliss/files/mesh_file.h"
#include "gliss/results/finding_json.h"
#include "gliss/results/lengths.h"
#include "gliss/surface/names.h"
#include "gliss/walk/fidelity.h"
#include "tools/cli/commands/commands.h"
#include "tools/cli/terminal/watch.h"
#include "tools/cli/words/shape_text.h"
#include "tools/cli/words/slips.h"
#include "tools/cli/words/surface_input.h"

namespace gliss::tools {
namespace {

constexpr std::size_t kListed = 40;  // faces or edges in the text; --json has all

const char* state_of(const std::vector<Finding>& findings, bool refused) {
  const auto any = [&](Severity severity) {
    return std::any_of(findings.begin(), findings.end(),
                       [&](const Finding& finding) { return finding.severity == severity; });
  };
  if (refused) return "refused";
  return any(Severity::kRepaired) ? "repaired" : any(Severity::kWarning) ? "warned" : "accepted";
}

struct CheckedSurface {
  BuildReport report;
  std::vector<const char*> kinds;  // of the flagged faces
  std::vector<VertexPair> rough_edges;
  std::string departure_text;
  Json departure, tightest;
};

CheckedSurface build_surface(const SurfaceOptions& options, const Mesh& mesh) {
  CheckedSurface surface;
  const PatchCache cache = build(mesh, options, *make_engine(options), {}, &surface.report);
  tell_tight_curvature(options, cache, usual_depth(cache), "0.5 % of the diagonal");
  surface.departure_text = departure_text(cache);
  surface.departure = departure_json(cache.departure, cache.unit);
  surface.tightest = departure_json(cache.tightest, cache.unit);
  for (const std::uint32_t face : surface.report.flagged_faces)
    surface.kinds.push_back(name_of(kPatchKindNames, cache.kind[cache.first_patch(face)]));
  Mesh with_normals = mesh;
  add_vertex_normals(with_normals, normal_weights(cache.level.construction));
  surface.rough_edges = rough_edges(with_normals, build_topology(with_normals), cache);
  return surface;
}

// All that was found, before the mesh was refused if it was.
struct Checked {
  std::vector<Finding> findings;
  Mesh mesh;
  std::vector<VertexPair> creases;
  CheckedSurface surface;
  std::exception_ptr refusal;  // null: accepted
};

Checked check(const SurfaceOptions& options) {
  Checked checked;
  Mesh& mesh = checked.mesh;
  try {
    mesh = load_mesh(options, checked.findings);
    tell_odd_size(options, mesh);
    tell_seams(options, mesh, checked.findings);
    tell_creases(options, mesh);
    if (!mesh.sharp.empty()) checked.creases = crease_edges(mesh, build_topology(mesh));
    round_creases(options, mesh);
    checked.surface = build_surface(options, mesh);
  } catch (const MeshError&) {
    checked.refusal = std::current_exception();
  }
  return checked;
}

// The first of some items by `text_of`, behind a name; "" where there are none.
template <class Item, class TextOf>
std::string listed(const char* name, const std::vector<Item>& items, TextOf text_of) {
  if (items.empty()) return "";
  std::vector<std::string> first;
  for (const Item& item : std::span(items).first(std::min(items.size(), kListed)))
    first.push_back(text_of(item));
  return fmt::format("{}: {}{}\n", name, fmt::join(first, ","),
                     items.size() > kListed ? ",..." : "");
}

std::string text_of(const Checked& checked, const std::string& path) {
  const auto& [findings, mesh, creases, surface, refusal] = checked;
  std::string text = findings.empty() ? "nothing found\n"
                                      : fmt::format("{:<9} {:<20} {:>7}  {}\n", "severity", "code",
                                                    "count", "first");
  for (const Finding& finding : findings)
    text += fmt::format("{:<9} {:<20} {:>7}  {}\n", severity_name(finding.severity), finding.code,
                        finding.count, finding.message);
  text += fmt::format("{}: {}\n", path, state_of(findings, refusal != nullptr));
  if (!mesh.lost_faces.empty()) text += removed_text(mesh) + "\n";
  if (!refusal)
    text += fmt::format("{} faces; {}{}\n{}\n", mesh.face_count(), built_text(surface.report),
                        mesh.strips.empty() ? creases_text(creases.size()) : rounded_text(mesh),
                        surface.departure_text);
  return text +
         listed("faces that fold or degenerate as drafted", surface.report.flagged_faces,
                [](std::uint32_t face) { return std::to_string(face); }) +
         listed("not smooth, edges of vertices", surface.rough_edges,
                [](const VertexPair& edge) { return fmt::format("{}-{}", edge[0], edge[1]); });
}

Json result_of(const Checked& checked, const std::string& path) {
  const auto& [findings, mesh, creases, surface, refusal] = checked;
  Json list = Json::array();
  for (const Finding& finding : findings) list.push_back(json_of(finding));
  Json json = {{"mesh", path},
               {"accepted", !refusal},
               {"state", state_of(findings, refusal != nullptr)},
               {"faces", mesh.face_count()},
               {"findings", list},
               {"removed_faces", mesh.lost_faces}};
  json.update(built_json(surface.report));
  json.update({{"flagged_faces", surface.report.flagged_faces},
               {"flagged_kinds", surface.kinds},
               {"departure", surface.departure},
               {"tightest", surface.tightest},
               {"rough_edges", surface.rough_edges},
               {"creases", creases},
               {"strips", mesh.strips},
               {"rounded_corners", mesh.rounded_corners}});
  return json;
}

void describe(Command& command, SurfaceOptions& options) {
  add_surface_options(command, options, "MESH");
}

void run(const SurfaceOptions& options) {
  refuse_cache(options);
  const Checked checked = check(options);
  report(options, text_of(checked, options.surface), result_of(checked, options.surface));
  if (checked.refusal) std::rethrow_exception(checked.refusal);
}

}  // namespace

void add_check(Command& program) {
  add_command<SurfaceOptions>(program, "check", "List all that is wrong or odd about a mesh.",
                              "gliss check teeth.obj --unit mm", describe, run);
}

}  // namespace gliss::tools
