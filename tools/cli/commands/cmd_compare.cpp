// gliss compare: speed against accuracy of every level, on this mesh and this machine.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gliss/base/units.h"
#include "gliss/build/build_cache.h"
#include "gliss/compare/compare_mesh.h"
#include "gliss/generate/generate.h"
#include "gliss/results/compare_json.h"
#include "tools/cli/commands/commands.h"
#include "tools/cli/commands/compare_picture.h"
#include "tools/cli/commands/compare_report.h"
#include "tools/cli/terminal/watch.h"
#include "tools/cli/words/outputs.h"
#include "tools/cli/words/shape_text.h"
#include "tools/cli/words/surface_input.h"

namespace gliss::tools {
namespace {

struct ComparingOptions : SurfaceOptions {
  MeshComparisonOptions comparing;
  std::string path, reference, output;
  int ticks = 4000;
  std::string walk_depth = "0.5%";
  CompareBudget budget;
  int dense_limit = 500000;
  bool with_picture = false;
};

CompareCandidate parse_candidate(const std::string& name) {
  if (const auto candidate = find_candidate(name)) return *candidate;
  throw InputError("--levels: " + no_surface(name));
}

// "1%" or 0.01.
double parse_ratio(const std::string& option, const std::string& text) {
  const bool percent = text.ends_with('%');
  return parse_number<double>(option, percent ? text.substr(0, text.size() - 1) : text) /
         (percent ? 100 : 1);
}

double parse_memory(const std::string& option, const std::string& text) {
  for (const auto& [name, bytes] :
       {std::pair("KiB", 10), std::pair("MiB", 20), std::pair("GiB", 30)}) {
    if (text.ends_with(name))
      return std::ldexp(parse_number<double>(option, text.substr(0, text.size() - 3)), bytes);
  }
  return parse_number<double>(option, text);
}

void add_walk_options(Command& command, ComparingOptions& options) {
  WalkOptions& walk = options.comparing.walk;
  const auto count = [](const char* name, std::size_t least) {
    return [=](const std::string& text) {
      const auto number = parse_number<std::size_t>(name, text);
      if (number < least || number > 100000000)
        throw InputError(fmt::format("{}: '{}' is not from {} to 100000000", name, text, least));
      return number;
    };
  };
  command.option(
      {"--walks", "N",
       "random walks over the whole mesh, in which jumps and lost contacts are counted; 0: none; "
       "default 8"},
      [&walk, read = count("--walks", 0)](const std::string& text) { walk.walkers = read(text); });
  command.option({"--walk-ticks", "N", "length of a walk, in ticks; default 2500"},
                 [&walk, read = count("--walk-ticks", 1)](const std::string& text) {
                   walk.ticks = read(text);
                 });
  command.option({"--walk-depth", "DEPTH",
                  "how deep walks go: a length, or a share of the mesh's diagonal; default 0.5%"},
                 options.walk_depth);
  command.option(
      {"--walk-step", "RATIO",
       "how far a walk moves in a tick, as a share of its depth: 1%, the default, stands for a "
       "loop of 1000 Hz, 2% for 500 Hz, 10% for 100 Hz"},
      [&walk](const std::string& text) {
        walk.step = parse_ratio("--walk-step", text);
        if (!(walk.step > 0 && walk.step <= 1))
          throw InputError(fmt::format("--walk-step: '{}' is not above 0 and at most 1", text));
      });
  command.option({"--leaving", "N",
                  "hands that press in anywhere, slide, leave and rest outside, in which contacts "
                  "that are held there are counted; 0: none; default: 5 a walk"},
                 [&options, read = count("--leaving", 0)](const std::string& text) {
                   options.comparing.leaving = read(text);
                 });
  command.option({"--seed", "N", "seed of the walks and the leaving hands; default 1"},
                 [&walk](const std::string& text) {
                   walk.seed = parse_number<std::uint64_t>("--seed", text);
                 });
}

// Adds what is compared: --levels, --precisions, --solvers and --backends.
void add_compared_options(Command& command, CompareOptions& compare) {
  command.option(
      {"--levels", "LIST",
       "surfaces to compare, any of fair, paper, paper-ribbon, paper-bezier, paper-table, "
       "paper-table:N, shaded, flat; fair-ribbon and the like as well; default: the first five, "
       "shaded and flat"},
      [&compare](const std::string& text) {
        compare.candidates = parse_list("--levels", text, parse_candidate);
      });
  add_names_option(
      command, {"--precisions", "LIST", "precisions to compare: float, double; both by default"},
      compare.precisions, kPrecisionNames);
  add_names_option(
      command, {"--solvers", "LIST", "solvers to compare: newton (default), gauss-newton, paper"},
      compare.solvers, kSolverNames);
  add_names_option(
      command, {"--backends", "LIST", "backends to compare: tbb (default), serial, opencl, auto"},
      compare.backends, kBackendNames);
}

void add_budget_options(Command& command, CompareBudget& budget) {
  command.option({"--max-force-error", "RATIO",
                  "budget: the largest error of the force, as 1% of stiffness x depth"},
                 [&budget](const std::string& text) {
                   budget.force_error = parse_ratio("--max-force-error", text);
                 });
  command.option({"--max-tick", "TIME", "budget: the longest tick, as 5us"},
                 [&budget](const std::string& text) { budget.tick = parse_time(text); });
  command.option(
      {"--max-memory", "SIZE", "budget: the most memory, as 64MiB"},
      [&budget](const std::string& text) { budget.memory = parse_memory("--max-memory", text); });
}

void describe(Command& command, ComparingOptions& options) {
  CompareOptions& compare = options.comparing.measuring;
  compare.candidates = all_candidates();
  add_mesh_options(command, options, "MESH_OR_CACHE");
  add_compared_options(command, compare);
  add_step_options(command, compare.solving);
  add_settle_option(command, compare.settle);
  command.option({"--depth", "LIST", "depths of the HIPs; default: 1 % of the mesh's diagonal"},
                 [&](const std::string& text) { options.comparing.depths = parse_depths(text); });
  command.option({"--path", "FILE", "HIPs, one a tick, instead of a path of its own"},
                 options.path);
  command.option(
      {"--ticks", "N",
       "length of its own path, whose ticks are a thousandth of the diagonal apart; default 4000"},
      options.ticks, 100, 10000000);
  add_walk_options(command, options);
  add_stiffness_option(command, compare.stiffness);
  command.option(
      {"--reference", "MESH",
       "the true surface: a dense mesh in the same unit, or knot, torus, goldberg as generated"},
      options.reference);
  add_budget_options(command, options.budget);
  command.option(
      {"--dense-limit", "N",
       "how many triangles the densest mesh for flat and shaded may have; 0: none; default 500000"},
      options.dense_limit, 0, 100000000);
  command.flag("--picture", options.with_picture,
               "with --json: the surface of each construction with its curvature, and the places "
               "where walks jump, for gliss report");
  add_output_option(command, options.output, "rows as a table: .h5, .csv or .npy");
}

std::vector<Vec3> read_path(const ComparingOptions& options, const Mesh& mesh) {
  std::vector<Vec3> hips = points_in_metres(read_hips(options, options.path));
  if (options.comparing.depths.size() != 1)
    throw InputError("--path: needs the one --depth that its HIPs have");
  if (hips.empty()) throw InputError(fmt::format("--path: {} has no HIPs", options.path));
  for (Vec3& hip : hips) hip /= mesh.unit;
  return hips;
}

// The depth of walks, m.
double walk_depth_of(const ComparingOptions& options, const Mesh& mesh) {
  const std::string& text = options.walk_depth;
  const double depth =
      text.ends_with('%') ? parse_ratio("--walk-depth", text) / 0.005 * walk_depth(mesh) * mesh.unit
                          : parse_length(text);
  if (!(depth > 0)) throw InputError(fmt::format("--walk-depth: '{}' is not positive", text));
  return depth;
}

// From a point in the mesh's unit to the true surface.
TrueDistance true_distance(const ComparingOptions& options, const Mesh& mesh) {
  if (options.reference.empty()) return nullptr;
  constexpr Named<Generated (*)()> kGenerated[] = {{"knot", [] { return torus_knot(); }},
                                                   {"torus", [] { return torus(); }},
                                                   {"goldberg", [] { return goldberg(); }}};
  if (const auto generate = find_named(kGenerated, options.reference)) {
    const Generated made = (*generate)();
    const double scale = mesh.unit / made.mesh.unit;
    return [exact = made.exact, scale](const Vec3& x) {
      return std::abs(exact->nearest(x * scale).distance) / scale;
    };
  }
  SurfaceOptions surface = options;
  surface.surface = options.reference;
  surface.creases = {.none = true};
  surface.crease_radius = 0;
  Mesh reference = read_mesh(surface);
  add_vertex_normals(reference);
  const auto base = std::make_shared<PatchCache>(
      build_base(reference, build_topology(reference), Precision::kDouble));
  return [base](const Vec3& x) {
    QueryOptions flat;
    flat.method = Method::kFlat;
    return std::abs(nearest(*base, x, flat).distance);
  };
}

void write_table(const ComparingOptions& options, const PatchCache& exact,
                 const std::vector<CompareRow>& rows) {
  const std::string& path = options.output;
  const auto file = create_described_file(path, exact, options);
  write_rows(*file, path.ends_with(".csv") ? "" : "rows", rows);
  file->close();
}

// The mesh of a file, or that of a cache, which has normals.
Mesh compared_mesh(const ComparingOptions& options) {
  if (!is_cache(options)) return read_mesh(options);
  return mesh_of(options, read_cache(options), "compare the mesh itself");
}

MeshComparisonOptions comparing(const ComparingOptions& options, const ComparedMesh& compared) {
  MeshComparisonOptions made = options.comparing;
  if (!options.path.empty()) made.hips = read_path(options, compared.mesh);
  made.ticks = static_cast<std::size_t>(options.ticks);
  if (made.walk.walkers > 0) made.walk_depth = walk_depth_of(options, compared.baseline());
  made.truth = true_distance(options, compared.mesh);
  made.measuring.most_jumps = options.with_picture ? kMostRowJumps : 0;
  made.measuring.poll = stop_if_interrupted;
  made.measuring.make_engine = [&](const std::string& backend) {
    CommonOptions common = options;
    common.backend = backend;
    return make_engine(common);
  };
  return made;
}

std::vector<CompareRow> measure_rows(const ComparingOptions& options,
                                     const Comparison& comparison) {
  Watch watch(options, "compare", comparison.row_count(), "rows");
  return comparison.measure([&] { watch.add(1); });
}

std::vector<DenseRow> dense_rows(const ComparingOptions& options, const Comparison& comparison,
                                 const std::vector<CompareRow>& rows) {
  if (options.dense_limit == 0 || smoothest(rows) == nullptr) return {};
  Watch watch(options, "dense meshes", 2, "methods");
  return match_dense(comparison, rows, static_cast<std::uint64_t>(options.dense_limit),
                     [&] { watch.add(1); });
}

Json origin_json(const ComparingOptions& options, const Mesh& mesh, const PatchCache& surface) {
  return {{"program", "gliss"},
          {"version", GLISS_VERSION},
          {"command_line", command_line()},
          {"mesh", options.surface},
          {"faces", mesh.face_count()},
          {"unit", unit_name(mesh.unit)},
          {"mesh_hash", hash_name(surface.mesh_hash)}};
}

// Adds the surfaces, in `unit` (m), and where the walks of each row jump.
void add_picture(Json& json, const std::vector<CompareRow>& rows, const Comparison& comparison,
                 double unit) {
  for (std::size_t i = 0; i < rows.size() && !json["walks"].is_null(); ++i)
    json["rows"][i]["jumps"] = jumps_json(rows[i].jumps);
  json["picture"] = picture_json(comparison.pictures(kMostPicturePoints), unit);
}

void run(const ComparingOptions& options) {
  check_outputs({options.output}, {options.surface, options.path, options.reference});
  if (options.with_picture && !options.json)
    throw InputError("--picture: needs --json, which it is a part of");
  const Stopwatch clock;
  const auto engine = make_engine(options);
  const ComparedMesh compared(compared_mesh(options));
  const PatchCache surface = build(compared.mesh, options, *engine);
  MeshComparisonOptions how = comparing(options, compared);
  if (how.depths.empty()) how.depths = {compared_depth(surface)};
  tell_tight_curvature(options, surface, *std::max_element(how.depths.begin(), how.depths.end()));
  const Comparison comparison = compare_mesh(compared, surface, how, *engine);
  const std::vector<CompareRow> rows = measure_rows(options, comparison);
  const std::vector<DenseRow> dense = dense_rows(options, comparison, rows);
  const Recommendation best = recommend(rows, options.budget);
  if (!options.output.empty()) write_table(options, surface, rows);

  Json json = origin_json(options, compared.mesh, surface);
  json.update(json_of(how, comparison, rows, dense, best));
  std::string text = feel_text(rows) +
                     "* no other is better in jumps, p99 of the error, tick and memory at once\n" +
                     text_of(comparison.walks(), how.walk) +
                     text_of(leaving_of(how), how.measuring.settle) + "\n" + cost_text(rows);
  for (const DenseRow& row : dense) text += text_of(row);
  text += text_of(best, options.budget);
  if (options.with_picture) add_picture(json, rows, comparison, compared.mesh.unit);
  json["seconds"] = clock.seconds();
  report(options, text, json, options.output == "-");
}

}  // namespace

void add_compare(Command& program) {
  add_command<ComparingOptions>(
      program, "compare",
      "Measure what each level costs and gives, on this mesh and machine.\n"
      "First a table of what a hand feels: jumps of the force, per 100,000 ticks in contact of "
      "random walks (steps above 20 % of stiffness x depth), slow and ten times as fast, with "
      "settle 0 and above; lost/100k: contacts that end under more, as often; held: contacts that "
      "are felt for longer than 5 x --settle while the hand is out of the object, of how many; "
      "loops: "
      "what closed loops give the hand, in % of force x way. error: largest difference of the "
      "force from the exact surface's of its own construction, or from that of --reference, in % "
      "of stiffness x depth, along a path; p99: a hundredth of the samples are above it. Then "
      "costs and shape. far: from the exact surface. gap: angle between the normals on both sides "
      "of edges. step: change of the force from tick to tick of its own path; walk: of the slow "
      "walks; beyond/100k: steps there above twice the way of the hand. Last a recommendation: no "
      "energy, fewest jumps and held contacts, least error.\n",
      "gliss compare teeth.obj --unit mm --depth 0.5mm --max-force-error 1% --max-tick 5us",
      describe, run);
}

}  // namespace gliss::tools
