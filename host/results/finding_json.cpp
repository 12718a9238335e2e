#include "gliss/results/finding_json.h"

namespace gliss {

const char* severity_name(Severity severity) {
  return severity == Severity::kError      ? "error"
         : severity == Severity::kRepaired ? "repaired"
                                           : "warning";
}

Json json_of(const Finding& finding) {
  const auto known = [](auto value, auto none) { return value == none ? Json() : Json(value); };
  return {{"code", finding.code},
          {"severity", severity_name(finding.severity)},
          {"message", finding.message},
          {"face", known(finding.face, kNone)},
          {"vertex", known(finding.vertex, kNone)},
          {"line", known(finding.line, std::size_t{0})},
          {"count", finding.count}};
}

}  // namespace gliss
