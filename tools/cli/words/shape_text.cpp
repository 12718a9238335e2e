#include "tools/cli/words/shape_text.h"

#include <fmt/format.h>

#include <cmath>

#include "gliss/results/lengths.h"
#include "tools/cli/terminal/terminal.h"

namespace gliss::tools {

// Patches without curvature have the largest double as radius, in the unit of their mesh.
constexpr double kFlat = 1e290;

void tell_tight_curvature(const ReportOptions& options, const PatchCache& cache, double depth,
                          const std::string& meaning, const std::string& name) {
  if (options.quiet) return;
  const std::string text = tight_curvature_text(cache, depth, meaning);
  if (!text.empty()) tell(fmt::format("gliss: {}{}{}\n", name, name.empty() ? "" : ": ", text));
}

std::string departure_text(const PatchCache& cache) {
  constexpr double kRounding = 1e-9;  // of the size
  const Departure& d = cache.departure;
  const double share = d.distance / diagonal_of(cache.bounds());
  if (share < kRounding) return "patches do not leave their polygons";
  std::string room;
  if (std::isfinite(d.room)) {
    const std::string way = length_text(d.room * cache.unit);
    room = d.share() > 1
               ? fmt::format(", through the next face, {} away", way)
               : fmt::format(", {:.3g} % of the {} to the next face there", 100 * d.share(), way);
  }
  return fmt::format("patches leave their polygons by up to {} ({:.2g} % of the size{}: face {})",
                     length_text(d.distance * cache.unit), 100 * share, room, d.face);
}

Json departure_json(const Departure& d, double unit) {
  return {
      {"mm", d.distance * unit * 1e3}, {"room_mm", number(d.room * unit * 1e3)}, {"face", d.face}};
}

void tell_departure(const ReportOptions& options, const PatchCache& cache) {
  const Departure& d = cache.tightest;
  if (options.quiet || !(d.share() > kFaithful)) return;
  tell(fmt::format(
      "gliss: the surface leaves face {} by {}, and the next face is {} away: a hand feels another "
      "shape than the file's there; '--crease' keeps edges sharp, finer faces follow the shape\n",
      d.face, length_text(d.distance * cache.unit), length_text(d.room * cache.unit)));
}

std::string creases_text(std::size_t count) {
  return count == 0 ? "" : fmt::format("; {} edges are creases", count);
}

std::string rounded_text(const Mesh& mesh) {
  const std::size_t strips = mesh.strips.size(), corners = mesh.rounded_corners.size(),
                    first = mesh.face_count() - strips - corners;
  if (strips == 0) return "";
  std::string text = fmt::format("; {} creases are rounded: faces {} to {} are their strips",
                                 strips / 2, first, first + strips - 1);
  if (corners > 0)
    text += fmt::format(", {} to {} their corners", first + strips, mesh.face_count() - 1);
  return text;
}

std::string radius_text(double radius, const std::string& unit) {
  return radius < kFlat ? fmt::format("{:.4g} {}", radius, unit) : "none, as all is flat";
}

Json radius_json(double radius) { return radius < kFlat ? Json(radius) : Json(); }

}  // namespace gliss::tools
