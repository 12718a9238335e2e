#include "gliss/validate/mesh_report.h"

namespace gliss {

Finding& Report::append(Severity severity, std::string_view code, const Place& place,
                        std::string text) {
  Finding finding;
  finding.code = code;
  finding.severity = severity;
  finding.vertex = place.vertex;
  finding.line = place.line;
  if (place.face != kNone) {
    if (!finding.line && place.face < mesh_.face_line.size()) {
      finding.line = mesh_.face_line[place.face];
    }
    finding.face = number_of(place.face);
  } else if (const auto known = vertex_line.find(place.vertex);
             !finding.line && known != vertex_line.end()) {
    finding.line = known->second;
  }

  finding.message = mesh_.source.empty() ? "mesh" : mesh_.source;
  if (finding.line) finding.message += fmt::format(":{}", finding.line);
  if (finding.face != kNone) {
    finding.message += fmt::format(": face {}", finding.face);
  } else if (finding.vertex != kNone) {
    finding.message += fmt::format(": vertex {}", finding.vertex);
  }
  finding.message += ": " + text;
  return findings_.emplace_back(std::move(finding));
}

void Report::stop_on_error() const {
  for (std::size_t i = first_; i < findings_.size(); ++i) {
    if (findings_[i].severity == Severity::kError) throw MeshError(findings_[i].message);
  }
}

}  // namespace gliss
