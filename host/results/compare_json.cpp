#include "gliss/results/compare_json.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "gliss/surface/names.h"
#include "gliss/tables/table_columns.h"

namespace gliss {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi, kMicroseconds = 1e6;
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

Json json_of(const CompareWalk& walk) {
  return {{"mm_per_s_at_1kHz", walk.way * kMillimetresASecond},
          {"settle_s", walk.settle},
          {"ticks", walk.felt.touching},
          {"jumps_per_100k", walk.felt.jumps_per_100k()},
          {"jumps_spread_per_100k", walk.felt.jumps_spread_per_100k()},
          {"lost_per_100k", walk.felt.lost_per_100k()},
          {"steps_beyond_2dx_per_100k", walk.felt.steps_beyond_2dx_per_100k()},
          {"settling_share", walk.felt.settling_share()}};
}

// More than its error, in %; else what it may be at most.
Json json_of(const CompareRow& row) {
  Json json = {{"surface", row.candidate.name()},
               {"level", row.candidate.level_name()},
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
  return {{"surface", row.candidate.name()},
          {"level", row.candidate.level_name()},
          {"precision", precision_name(row.precision)},
          {"solver", name_of(kSolverNames, row.solver)},
          {"backend", row.backend}};
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
          {"target", row.target},
          {"target_level", target.candidate.level_name()},
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

}  // namespace

Json json_of(const MeshComparisonOptions& how, const Comparison& comparison,
             const std::vector<CompareRow>& rows, const std::vector<DenseRow>& dense,
             const Recommendation& best) {
  Json json = {{"depths_m", how.depths},
               {"stiffness_N_per_m", how.measuring.stiffness},
               {"walks", json_of(comparison.walks(), how.walk)},
               {"leaving", json_of(leaving_of(how))},
               {"rows", Json::array()},
               {"dense", Json::array()},
               {"recommended", nullptr},
               {"reason", best.reason}};
  for (const CompareRow& row : rows) json["rows"].push_back(json_of(row));
  for (const DenseRow& row : dense) json["dense"].push_back(json_of(row, *smoothest(rows)));
  if (best.row != nullptr) json["recommended"] = recommendation_json(*best.row);
  return json;
}

void write_rows(ResultFile& file, const std::string& name, const std::vector<CompareRow>& rows) {
  using enum ColumnType;
  TableColumns<std::vector<CompareRow>> columns;
  columns.add("surface", kText, "", [](const CompareRow& r) { return r.candidate.name(); })
      .add("level", kText, "", [](const CompareRow& r) { return r.candidate.level_name(); })
      .add("precision", kText, "", [](const CompareRow& r) { return precision_name(r.precision); })
      .add("solver", kText, "", [](const CompareRow& r) { return name_of(kSolverNames, r.solver); })
      .add("backend", kText, "", &CompareRow::backend);
  for (const NumberColumn& number : kNumbers)
    columns.add(number.name, kFloat64, number.unit, number.get);
  columns.add("pareto", kUint8, "", &CompareRow::pareto);
  ResultTable table(file, name, columns.columns());
  columns.fill(table, rows, rows.size());
  table.write();
}

}  // namespace gliss
