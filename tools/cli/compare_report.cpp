#include "tools/cli/compare_report.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "gliss/surface/names.h"
#include "gliss/tables/result_table.h"

namespace gliss::tools {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi, kMicroseconds = 1e6;

constexpr double kMetreAMillisecond = 1e6;  // in mm/s

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// The numbers of a row, by the names that JSON and tables give them.
struct NumberColumn {
  const char *name, *unit;
  double (*get)(const CompareRow&);
};
template <double CompareRow::*kMember>
double get(const CompareRow& row) {
  return row.*kMember;
}
// Unknown where no hand left, or none felt anything.
template <auto HeldContacts::*kMember>
double held(const CompareRow& row) {
  return row.leaving.contacts == 0 ? kUnknown : static_cast<double>(row.leaving.*kMember);
}
constexpr NumberColumn kNumbers[] = {
    {"bytes_per_patch", "", get<&CompareRow::bytes_per_patch>},
    {"build_per_s", "", get<&CompareRow::build_per_s>},
    {"eval_per_s", "", get<&CompareRow::eval_per_s>},
    {"track_per_s", "", get<&CompareRow::track_per_s>},
    {"max_distance", "m", get<&CompareRow::max_distance>},
    {"p99_distance", "m", get<&CompareRow::p99_distance>},
    {"true_max_distance", "m", get<&CompareRow::true_max_distance>},
    {"true_p99_distance", "m", get<&CompareRow::true_p99_distance>},
    {"max_normal_gap_deg", "deg", [](const CompareRow& r) { return r.max_normal_gap * kDegrees; }},
    {"p99_normal_gap_deg", "deg", [](const CompareRow& r) { return r.p99_normal_gap * kDegrees; }},
    {"max_force_step", "N", get<&CompareRow::max_force_step>},
    {"p99_force_step", "N", get<&CompareRow::p99_force_step>},
    {"walk_max_force_step", "N", get<&CompareRow::walk_max_force_step>},
    {"walk_p99_force_step", "N", get<&CompareRow::walk_p99_force_step>},
    {"jumps_per_100k", "", get<&CompareRow::jumps_per_100k>},
    {"lost_per_100k", "", get<&CompareRow::lost_per_100k>},
    {"settling_share", "", get<&CompareRow::settling_share>},
    {"loop_gain", "", [](const CompareRow& r) { return r.loop_gain.gain; }},
    {"loop_gain_error", "", [](const CompareRow& r) { return r.loop_gain.error; }},
    {"unsound", "", [](const CompareRow& r) { return static_cast<double>(r.unsound); }},
    {"max_force_error", "", get<&CompareRow::max_force_error>},
    {"p99_force_error", "", get<&CompareRow::p99_force_error>},
    {"tick_us", "us", [](const CompareRow& r) { return r.tick * kMicroseconds; }},
    {"steps_beyond_2dx_per_100k", "", get<&CompareRow::steps_beyond_2dx_per_100k>},
    {"max_step_beyond_2dx", "N", get<&CompareRow::max_step_beyond_2dx>},
    {"held_outside", "", held<&HeldContacts::held>},
    {"held_outside_of", "", held<&HeldContacts::contacts>},
    {"held_outside_longest", "s", held<&HeldContacts::longest>},
    {"held_outside_pulled", "", held<&HeldContacts::pulled>}};

// Null: flat and shaded have none.
Json construction_of(const CompareRow& row) {
  if (row.candidate.method != Method::kGregory) return {};
  return name_of(kConstructionNames, row.candidate.level.construction);
}

std::string held_text(const HeldContacts& leaving) {
  return leaving.contacts == 0 ? "-" : fmt::format("{} of {}", leaving.held, leaving.contacts);
}

std::string rate_text(double per_second) {
  return std::isfinite(per_second) ? fmt::format("{:.3g} M", per_second * 1e-6) : "-";
}

Json json_of(const CompareWalk& walk) {
  return {{"mm_per_s_at_1kHz", walk.way * kMetreAMillisecond},
          {"settle_s", walk.settle},
          {"ticks", walk.felt.touching},
          {"jumps_per_100k", walk.felt.jumps_per_100k()},
          {"jumps_spread_per_100k", walk.felt.jumps_spread_per_100k()},
          {"lost_per_100k", walk.felt.lost_per_100k()},
          {"steps_beyond_2dx_per_100k", walk.felt.steps_beyond_2dx_per_100k()},
          {"settling_share", walk.felt.settling_share()}};
}

// More than its error, in %; else what it may be at most.
std::string gain_text(const LoopGain& loops) {
  if (std::isnan(loops.gain)) return "-";
  if (!loops.is_certain()) return fmt::format("< {:.1g}", 100 * loops.error);
  return fmt::format("{:.2g}", 100 * loops.gain);
}

std::string jumps_text(const FeltWalks& felt) {
  return fmt::format("{:.0f} ± {:.0f}", felt.jumps_per_100k(), felt.jumps_spread_per_100k());
}

}  // namespace

Json json_of(const CompareRow& row) {
  Json json = {{"level", row.candidate.name()},
               {"construction", construction_of(row)},
               {"precision", precision_name(row.precision)},
               {"solver", name_of(kSolverNames, row.solver)},
               {"backend", row.backend}};
  for (const NumberColumn& column : kNumbers) json[column.name] = number(column.get(row));
  json["unsound"] = row.unsound;
  if (row.leaving.contacts > 0) {
    json["held_outside"] = row.leaving.held;
    json["held_outside_of"] = row.leaving.contacts;
    json["held_outside_pulled"] = row.leaving.pulled;
  }
  json["bytes"] = row.bytes;
  json["pareto"] = row.pareto;
  for (const CompareWalk& walk : row.walks) json["walks"].push_back(json_of(walk));
  return json;
}

Json recommendation_json(const CompareRow& row) {
  return {{"level", row.candidate.name()},
          {"precision", precision_name(row.precision)},
          {"solver", name_of(kSolverNames, row.solver)},
          {"backend", row.backend}};
}

std::string text_of(const Recommendation& best, const CompareBudget& budget) {
  if (best.row == nullptr) return "nothing is recommended: " + best.reason + "\n";
  return fmt::format("recommended{}: {}, {}, {}: {}\n", budget.any() ? " within the budget" : "",
                     best.row->candidate.name(), precision_name(best.row->precision),
                     name_of(kSolverNames, best.row->solver), best.reason);
}

Json json_of(const DenseRow& row, const CompareRow& target) {
  return {{"method", method_name(row.method)},
          {"triangles", row.triangles},
          {"bytes", row.bytes},
          {"max_force_step", row.max_force_step},
          {"p99_force_step", row.p99_force_step},
          {"jumps_per_100k", row.jumps_per_100k},
          {"lost_per_100k", row.lost_per_100k},
          {"tick_us", row.tick * kMicroseconds},
          {"target_level", row.target},
          {"target_force_step", row.target_step},
          {"target_bytes", target.bytes},
          {"target_tick_us", target.tick * kMicroseconds},
          {"memory_ratio", row.memory_ratio},
          {"time_ratio", row.time_ratio},
          {"reached", row.reached},
          {"needed_triangles", number(row.needed_triangles)}};
}

Json json_of(const CompareWalks& walks, const WalkOptions& walk) {
  if (walks.sets.empty()) return {};
  return {{"walkers", walk.walkers}, {"walks", walks.sets.front().walks.size()},
          {"ticks", walk.ticks},     {"depth_m", walks.depth},
          {"step", walk.step},       {"seed", walk.seed}};
}

Json json_of(const LeavingOptions& leaving) {
  if (leaving.hands == 0) return {};
  return {{"hands", leaving.hands}, {"rest_ticks", leaving.rest}, {"seed", leaving.seed}};
}

std::string feel_text(const std::vector<CompareRow>& rows) {
  std::string text = fmt::format("  {:<8} {:<6} {:<12}", "level", "prec.", "solver");
  if (!rows.empty()) {
    for (const CompareWalk& walk : rows.front().walks)
      text += fmt::format(" {:>19}", fmt::format("{:.3g} mm/s, {:.3g} ms",
                                                 walk.way * kMetreAMillisecond, 1e3 * walk.settle));
  }
  text += fmt::format(" {:>8} {:>10} {:>9} {:>9} {:>9} {:>9}\n", "lost/", "held", "loops, %",
                      "p99, %", "error, %", "tick, us");
  for (const CompareRow& row : rows) {
    if (row.backend != rows.front().backend) continue;
    text += fmt::format("{} {:<8} {:<6} {:<12}", row.pareto ? '*' : ' ', row.candidate.name(),
                        precision_name(row.precision), name_of(kSolverNames, row.solver));
    for (const CompareWalk& walk : row.walks) text += fmt::format(" {:>19}", jumps_text(walk.felt));
    text += fmt::format(" {:>8.1f} {:>10} {:>9} {:>9.2g} {:>9.3g} {:>9.2f}\n", row.lost_per_100k,
                        held_text(row.leaving), gain_text(row.loop_gain), 100 * row.p99_force_error,
                        100 * row.max_force_error, row.tick * kMicroseconds);
    text += unsound_text(row.unsound, "steps");
  }
  return text;
}

std::string cost_text(const std::vector<CompareRow>& rows) {
  std::string text = fmt::format(
      "  {:<8} {:<6} {:<12} {:<6} {:>8} {:>9} {:>8} {:>8} {:>10} {:>10} {:>9} {:>9} {:>9} {:>9} "
      "{:>9} {:>9} {:>9}\n",
      "level", "prec.", "solver", "on", "B/patch", "build/s", "eval/s", "track/s", "far, mm",
      "p99, mm", "gap, deg", "p99, deg", "step, N", "p99, N", "walk, N", "p99, N", "beyond/");
  for (const CompareRow& row : rows) {
    text += fmt::format(
        "  {:<8} {:<6} {:<12} {:<6} {:>8.0f} {:>9} {:>8} {:>8} {:>10.3g} {:>10.3g} {:>9.2g} "
        "{:>9.2g} {:>9.4g} {:>9.4g} {:>9.4g} {:>9.4g} {:>9.1f}\n",
        row.candidate.name(), precision_name(row.precision), name_of(kSolverNames, row.solver),
        row.backend, row.bytes_per_patch, rate_text(row.build_per_s), rate_text(row.eval_per_s),
        rate_text(row.track_per_s), row.max_distance * 1e3, row.p99_distance * 1e3,
        row.max_normal_gap * kDegrees, row.p99_normal_gap * kDegrees, row.max_force_step,
        row.p99_force_step, row.walk_max_force_step, row.walk_p99_force_step,
        row.steps_beyond_2dx_per_100k);
  }
  return text;
}

std::string text_of(const DenseRow& row) {
  std::string text = fmt::format("{} needs ", method_name(row.method));
  if (row.reached) {
    text += fmt::format("{} triangles", row.triangles);
  } else if (std::isfinite(row.needed_triangles)) {
    text += fmt::format("more than {} triangles, by extrapolation {:.2g},", row.triangles,
                        row.needed_triangles);
  } else {
    text += fmt::format("more than {} triangles", row.triangles);
  }
  return text + fmt::format(
                    " to feel as smooth as {} ({:.4g} N; {:.4g} N, jumps {:.1f} and lost {:.1f} "
                    "per 100k with {}: {:.3g} x the memory, {:.3g} x the time)\n",
                    row.target, row.target_step, row.max_force_step, row.jumps_per_100k,
                    row.lost_per_100k, row.triangles, row.memory_ratio, row.time_ratio);
}

std::string text_of(const CompareWalks& walks, const WalkOptions& walk) {
  if (walks.sets.empty()) return "lost/: per 100,000 ticks in contact along the path\n";
  return fmt::format(
      "mm/s, ms: jumps of the force in 100,000 ticks in contact, ± one standard deviation over "
      "seeds, by the hand's speed in a loop of 1 kHz and by settle: {} random walks of {} ticks, "
      "{:.3g} mm deep; lost/, walk, N, beyond/: of the slow ones with settle as given; loops: net "
      "work, of force x way, that {} closed loops a face wide give the hand at most\n",
      walk.walkers, walk.ticks, walks.depth * 1e3, walks.loops.size());
}

std::string text_of(const LeavingOptions& leaving, double settle) {
  if (leaving.hands == 0) return "";
  return fmt::format(
      "held: contacts of {} hands that press in, slide, leave at up to 2 % of the mesh's diagonal "
      "a tick, and rest outside, that are felt there for longer than {} ticks, 5 x settle and "
      "one\n",
      leaving.hands, held_bound(settle));
}

void write_rows(ResultFile& file, const std::string& name, const std::vector<CompareRow>& rows) {
  Columns columns;
  columns.add({"level", "precision", "solver", "backend"}, ColumnType::kText);
  for (const NumberColumn& column : kNumbers)
    columns.add({column.name}, ColumnType::kFloat64, column.unit);
  ResultTable table(file, name, columns.add({"pareto"}, ColumnType::kUint8));
  const auto fill = [&](auto get_from) {
    table.fill(rows.size(), [&](std::size_t i) { return get_from(rows[i]); });
  };
  fill([](const CompareRow& r) { return r.candidate.name(); });
  fill([](const CompareRow& r) { return std::string(precision_name(r.precision)); });
  fill([](const CompareRow& r) { return std::string(name_of(kSolverNames, r.solver)); });
  fill([](const CompareRow& r) { return r.backend; });
  for (const NumberColumn& column : kNumbers) fill(column.get);
  fill([](const CompareRow& r) { return r.pareto ? 1.0 : 0.0; });
  table.write();
}

}  // namespace gliss::tools
