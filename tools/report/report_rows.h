// Rows of a result in JSON, checked on their way into the page of gliss report.
#pragma once

#include <span>

#include "tools/report/report_source.h"

namespace gliss::tools {

enum class Expect { kText, kNumber, kTruth };

struct RowKey {
  const char* name;
  Expect type;
  bool needed = false;  // otherwise null and absent are "not measured"
};

// The keys of each row, the others left out. InputError names file, list, row and key of what
// `writer` would not have written.
Json read_rows(const Json& rows, const char* list, std::span<const RowKey> keys, const char* writer,
               const ReportSource& source);

}  // namespace gliss::tools
