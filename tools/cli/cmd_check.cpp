// gliss check: everything the checks of a mesh find, and the faces whose exact patch folds.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <exception>
#include <span>

#include "gliss/build/build_cache.h"
#include "gliss/files/mesh_file.h"
#include "gliss/surface/names.h"
#include "gliss/walk/fidelity.h"
#include "tools/cli/curvature.h"
#include "tools/cli/finding_json.h"
#include "tools/cli/slips.h"
#include "tools/cli/surface_input.h"
#include "tools/cli/watch.h"

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

template <class Items>
std::string listed(const char* name, const Items& items, std::size_t count) {
  if (count == 0) return "";
  return fmt::format("{}: {}{}\n", name, fmt::join(items, ","), count > kListed ? ",..." : "");
}

void describe(Command& command, SurfaceOptions& options) {
  add_surface_options(command, options, "MESH");
}

void run(const SurfaceOptions& options) {
  refuse_cache(options);
  std::vector<Finding> findings;
  CheckedSurface surface;
  Mesh mesh;
  std::vector<VertexPair> creases;
  std::exception_ptr refusal;
  try {
    mesh = load_mesh(options, findings);
    tell_odd_size(options, mesh);
    tell_seams(options, mesh, findings);
    tell_creases(options, mesh);
    if (!mesh.sharp.empty()) creases = crease_edges(mesh, build_topology(mesh));
    round_creases(options, mesh);
    surface = build_surface(options, mesh);
  } catch (const MeshError&) {
    refusal = std::current_exception();
  }

  std::string text;
  Json list = Json::array();
  for (const Finding& finding : findings) {
    if (text.empty())
      text = fmt::format("{:<9} {:<20} {:>7}  {}\n", "severity", "code", "count", "first");
    text += fmt::format("{:<9} {:<20} {:>7}  {}\n", severity_name(finding.severity), finding.code,
                        finding.count, finding.message);
    list.push_back(json_of(finding));
  }
  if (findings.empty()) text += "nothing found\n";
  const BuildReport& built = surface.report;
  const auto& flagged = built.flagged_faces;
  text += fmt::format("{}: {}\n", options.surface, state_of(findings, refusal != nullptr));
  if (!mesh.lost_faces.empty()) text += removed_text(mesh) + "\n";
  if (!refusal) {
    text += fmt::format("{} faces; folded {}, degenerate {}; eased {}, split {}, bent {}{}\n",
                        mesh.face_count(), built.folded, built.degenerate, built.eased, built.split,
                        built.bent,
                        mesh.strips.empty() ? creases_text(creases.size()) : rounded_text(mesh));
    text += surface.departure_text + "\n";
  }
  text += listed("flagged", std::span(flagged).first(std::min(flagged.size(), kListed)),
                 flagged.size());
  std::vector<std::string> edges;
  for (const VertexPair& edge : surface.rough_edges) {
    if (edges.size() < kListed) edges.push_back(fmt::format("{}-{}", edge[0], edge[1]));
  }
  text += listed("not smooth, edges of vertices", edges, surface.rough_edges.size());
  report(options, text,
         {{"mesh", options.surface},
          {"accepted", !refusal},
          {"state", state_of(findings, refusal != nullptr)},
          {"faces", mesh.face_count()},
          {"findings", list},
          {"removed_faces", mesh.lost_faces},
          {"folded", built.folded},
          {"degenerate", built.degenerate},
          {"eased", built.eased},
          {"split", built.split},
          {"bent", built.bent},
          {"flagged_faces", flagged},
          {"flagged_kinds", surface.kinds},
          {"departure", surface.departure},
          {"tightest", surface.tightest},
          {"rough_edges", surface.rough_edges},
          {"creases", creases},
          {"strips", mesh.strips},
          {"rounded_corners", mesh.rounded_corners}});
  if (refusal) std::rethrow_exception(refusal);
}

}  // namespace

void add_check(Command& program) {
  add_command<SurfaceOptions>(program, "check", "List all that is wrong or odd about a mesh.",
                              "gliss check teeth.obj --unit mm", describe, run);
}

}  // namespace gliss::tools
