// gliss trace: a recorded path of HIPs, tick by tick. Its columns are a contract.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "gliss/base/median.h"
#include "gliss/query/contact_tracker.h"
#include "gliss/query/trace.h"
#include "gliss/results/trace_json.h"
#include "gliss/tables/table_columns.h"
#include "tools/cli/commands/commands.h"
#include "tools/cli/terminal/watch.h"
#include "tools/cli/words/outputs.h"
#include "tools/cli/words/shape_text.h"
#include "tools/cli/words/slips.h"
#include "tools/cli/words/surface_input.h"

namespace gliss::tools {
namespace {

constexpr std::size_t kBlockRows = 16384;

struct TracingOptions : TableOptions {
  std::string path;
  double depth = 0;  // of a path of its own, m; 0: none
  std::vector<std::string> keep;
  TraceOptions trace;
};

void describe(Command& command, TracingOptions& options) {
  add_surface_options(command, options, "MESH_OR_CACHE");
  add_input_option(command, "--path", options.path,
                   "HIPs, one a tick: columns x,y,z in the unit of --unit, or x_mm,y_mm,z_mm; "
                   "perhaps step, time (s), and vx,vy,vz (m/s), the device's velocity",
                   false);
  command.option({"--depth", "DEPTH",
                  "instead of --path: a path of its own so deep beneath the surface, 4000 ticks a "
                  "thousandth of the mesh's diagonal apart"},
                 [&](const std::string& text) {
                   const std::vector<double> depths = parse_depths(text);
                   if (depths.size() != 1) throw InputError("--depth: a path has one");
                   options.depth = depths.front();
                 });
  command.exclude("--depth", "--path");
  add_output_option(command, options.output, "table to write; CSV on standard output without it");
  add_keep_option(command, options.keep);
  command.exclude("--keep", "--depth");
  add_stiffness_option(command, options.trace.stiffness);
  add_methods_option(command, options.trace.methods);
  add_solver_options(command, options.trace);
  add_settle_option(command, options.trace.settle);
  add_friction_options(command, options.trace.friction);
  add_effect_options(command, options.trace.effects);
}

// Whole steps are written as such: 100000, where the shortest double would be 1e+05.
ColumnType step_type(const LargeArray<double>* steps) {
  const auto whole = [](double s) { return s >= 0 && s < 4294967296.0 && s == std::floor(s); };
  return steps == nullptr || std::all_of(steps->begin(), steps->end(), whole)
             ? ColumnType::kUint32
             : ColumnType::kFloat64;
}

// A tick with one method.
struct Row {
  std::size_t tick;
  double step;
  Vec3 hip;  // in the unit of --unit
  Method method;
  TraceStep felt;
};

const char* grip_name(const Contact& contact) {
  if (!contact.touching) return "free";
  return is_slipping(contact.flags) ? "slip" : "stick";
}

// Nothing where the gain lies within its error.
std::string gain_text(const LoopGain& loops) {
  if (!loops.is_certain()) return "";
  const std::string share = fmt::format("{:.3g} (± {:.1g}) % of force x way",
                                        100 * std::abs(loops.gain), 100 * loops.error);
  return loops.gain < 0 ? "; closed loops take at least " + share  // friction
                        : "; closed loops give the hand up to " + share;
}

struct Traced {
  std::vector<TraceStatistics> statistics;
  double deepest = 0, deepest_on_patches = 0;  // of all contacts, of the patches', m
  double way = 0, speed = 0;                   // of a tick, the medians, m and m/s
};

// Tells the motion that jumps depend on, in addition to the surface.
std::string motion_text(const TracingOptions& options, const Traced& traced) {
  return fmt::format(
      "jumps and lost contacts of this path: {:.3g} mm/s (half of the ticks are slower), "
      "contacts up to {:.3g} mm deep, settle {:.3g} ms\n",
      traced.speed * 1e3, traced.deepest * 1e3, options.trace.settle * 1e3);
}

void report_statistics(const TracingOptions& options, const Traced& traced) {
  std::string text =
      fmt::format("{:<8} {:>14} {:>10} {:>10} {:>14} {:>14} {:>10} {:>10} {:>8} {:>10}\n", "method",
                  "max step, N", "jumps/100k", "lost/100k", "mean step, N", "max force, N", "ticks",
                  "in contact", "entries", "settling");
  std::string slips, work;
  Json json;
  json["stiffness_N_per_m"] = options.trace.stiffness;
  json["settle_s"] = options.trace.settle;
  json["deepest_contact_m"] = traced.deepest;
  json["median_way_m"] = traced.way;
  for (const TraceStatistics& s : traced.statistics) {
    text += fmt::format(
        "{:<8} {:>14.6g} {:>10.1f} {:>10.1f} {:>14.6g} {:>14.6g} {:>10} {:>10} {:>8} {:>10}\n",
        method_name(s.method), s.largest_step, s.jumps_per_100k(), s.lost_per_100k(), s.mean_step,
        s.largest_force, s.ticks, s.touching, s.entries, s.settling);
    text += unsound_text(s.unsound, "steps");
    if (options.trace.friction.any())
      slips += fmt::format("{:<8} slips in {:.1f} % of the ticks in contact\n",
                           method_name(s.method), 100 * s.slipping_share());
    work += fmt::format("{:<8} net work {:>12.6g} J of {:.6g} J moved{}\n", method_name(s.method),
                        s.work.net, s.work.gross, gain_text(s.loop_gain));
    json["methods"].push_back(json_of(s));
    if (options.trace.friction.any()) json["methods"].back()["slipping"] = s.slipping;
  }
  report(options, text + motion_text(options, traced) + slips + work, json, options.output == "-");
}

PointTable path_of(const TracingOptions& options, const PatchCache& cache) {
  if (options.depth > 0) {
    constexpr int kTicks = 4000;
    const Mesh mesh = mesh_of(options, cache, "name a --path");
    PointTable own;
    own.unit = cache.unit;
    own.points = own_path(mesh, build_topology(mesh), cache, options.depth, kTicks);
    return own;
  }
  std::vector<std::string> further = options.keep;
  const auto add = [&](const std::string& name) {
    if (std::find(further.begin(), further.end(), name) == further.end()) further.push_back(name);
  };
  add("step");
  std::for_each(kMotionColumns.begin(), kMotionColumns.end(), add);
  return read_hips(options, options.path, further);
}

// Those of the table, whose rows keep columns of the path.
TableColumns<std::vector<Row>> columns_of(const TracingOptions& options, const PatchCache& cache,
                                          const PointTable& path) {
  using enum ColumnType;
  const std::string unit = unit_name(options.unit);
  const UnitChange length(cache.unit, options.unit);
  TableColumns<std::vector<Row>> columns;
  columns.add("step", step_type(path.table.find("step")), "", &Row::step)
      .add("method", kText, "", [](const Row& r) { return method_name(r.method); })
      .add_vector({"x", "y", "z"}, kFloat64, unit, &Row::hip)
      .add_vector({"scp_x", "scp_y", "scp_z"}, kFloat64, unit,
                  [length](const Row& r) { return length(r.felt.contact.scp); })
      .add_vector({"fx", "fy", "fz"}, kFloat64, "N", [](const Row& r) { return r.felt.force; })
      .add("face", kUint32, "", [](const Row& r) { return r.felt.contact.at.face; })
      .was("patch")
      .add("state", kText, "",
           [](const Row& r) { return r.felt.contact.touching ? "contact" : "free"; });
  if (options.trace.friction.any())
    columns.add("cone_share", kFloat64, "", [](const Row& r) { return r.felt.cone_share; })
        .add("grip", kText, "", [](const Row& r) { return grip_name(r.felt.contact); });
  for (const std::string& name : options.keep)
    columns.add(name.c_str(), kFloat64, "",
                [&kept = *path.table.find(name)](const Row& r) { return kept[r.tick]; });
  return columns;
}

void tell_untouched(const TracingOptions& options, const PatchCache& cache,
                    const PointTable& path) {
  const Box box = cache.bounds();
  const Box in_metres[] = {{box.low * cache.unit, box.high * cache.unit}};
  tell_untouched(options, options.depth > 0 ? "--depth" : options.path, points_in_metres(path),
                 in_metres, "say so by --unit, or by columns x_mm,y_mm,z_mm");
}

void check(const TracingOptions& options) {
  if (options.trace.friction.settle > 0 && !options.trace.friction.any())
    throw InputError("--friction-settle goes with --friction");
  if (options.path.empty() && !(options.depth > 0))
    throw InputError("--path is required, or --depth for a path of its own");
  check_outputs({options.output}, {options.surface, options.path});
}

double finite_median(std::vector<double> values) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  return median(std::move(values));
}

// Finds how far and how fast the hand goes, in m and m/s.
void measure_motion(std::span<const Vec3> hips, double unit,
                    std::span<const std::chrono::nanoseconds> times, Traced& traced) {
  std::vector<double> ways, speeds;
  for (std::size_t i = 1; i < hips.size(); ++i) {
    ways.push_back((hips[i] - hips[i - 1]).norm() * unit);
    const double tick = times.empty()
                            ? ContactTracker::kTick
                            : std::chrono::duration<double>(times[i] - times[i - 1]).count();
    speeds.push_back(ways.back() / tick);
  }
  traced.way = finite_median(std::move(ways));
  traced.speed = finite_median(std::move(speeds));
}

// Follows the path, and writes a row for each tick and method.
Traced follow(const TracingOptions& options, const PatchCache& cache, const PointTable& path) {
  // As the loop has it: by way of metres, so that the forces have the same bytes.
  std::vector<Vec3> hips = points_in_metres(path);
  for (Vec3& hip : hips) hip /= cache.unit;
  const auto file = create_described_file(options.output, cache, options);
  file->set_attribute({"stiffness_N_per_m", options.trace.stiffness});
  const auto columns = columns_of(options, cache, path);
  ResultTable table(*file, "", columns.columns());
  std::vector<Row> rows;
  const auto write = [&] {
    columns.fill(table, rows, rows.size());
    table.write();
    rows.clear();
  };
  const LargeArray<double>* steps = path.table.find("step");
  const UnitChange across(path.unit, options.unit);
  Traced traced;
  measure_motion(hips, cache.unit, options.trace.times, traced);
  Watch watch(options, "trace", hips.size(), "ticks");
  const auto add = [&](std::size_t tick, std::span<const TraceStep> felt) {
    for (std::size_t m = 0; m < felt.size(); ++m) {
      const Contact& contact = felt[m].contact;
      if (contact.touching) {
        const double depth = -contact.distance * cache.unit;
        traced.deepest = std::max(traced.deepest, depth);
        if (options.trace.methods[m] == Method::kGregory)
          traced.deepest_on_patches = std::max(traced.deepest_on_patches, depth);
      }
      rows.push_back({tick, steps ? (*steps)[tick] : static_cast<double>(tick),
                      across(path.points[tick]), options.trace.methods[m], felt[m]});
    }
    if (rows.size() >= kBlockRows) write();
    watch.reach(tick + 1);
  };
  TraceOptions interruptible = options.trace;
  interruptible.poll = stop_if_interrupted;
  traced.statistics = trace(cache, hips, interruptible, add);
  write();
  file->close();
  return traced;
}

void run(TracingOptions options) {
  check(options);
  const auto engine = make_engine(options);
  const PatchCache cache = open_surface(options, *engine);
  const PointTable path = path_of(options, cache);
  check_kept(options.keep, path.table, options.path);
  options.trace.times = path.times;
  options.trace.velocities = path.velocities;
  tell_soft_spring(options, options.trace.stiffness, "--stiffness");
  const Traced traced = follow(options, cache, path);
  tell_tight_curvature(options, cache, traced.deepest_on_patches, "the deepest contact");
  if (std::all_of(traced.statistics.begin(), traced.statistics.end(),
                  [](const TraceStatistics& s) { return s.touching == 0; }))
    tell_untouched(options, cache, path);
  report_statistics(options, traced);
}

}  // namespace

void add_trace(Command& program) {
  add_command<TracingOptions>(
      program, "trace", "Track a recorded path of HIPs and compare the methods' forces.",
      "gliss trace knot.obj --path path.csv --unit mm --stiffness 0.5N/mm -o forces.csv", describe,
      run);
}

}  // namespace gliss::tools
