// A result file on its way into the page of gliss report.
#pragma once

#include <cstdint>
#include <string>

#include "gliss/tables/hdf5_reader.h"
#include "tools/cli/terminal/watch.h"

namespace gliss::tools {

struct ReportSource {
  std::string path;
  std::uint64_t bytes = 0;       // of the file
  std::uint64_t page_bytes = 0;  // that its arrays may have, before base64
  Watch& watch;                  // counts bytes read
};

// The page's view of a file: "kind", "file" and more. Throws InputError or CsvError where the
// file is no result that the page knows.
Json read_result(const ReportSource& source);

// Says where results come from, as files say it themselves: mesh, unit, stiffness, command line.
Json provenance(const Hdf5Reader& file, const ReportSource& source);

Json read_sweep(const Hdf5Reader& file, const ReportSource& source);
Json read_objects(const Json& objects, const ReportSource& source);  // of the scene of gliss run
Json read_run_report(const Json& json, const ReportSource& source);
Json read_comparison(const Json& json, const ReportSource& source);

}  // namespace gliss::tools
