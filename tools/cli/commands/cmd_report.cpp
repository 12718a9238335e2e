// gliss report: results as a page to look at, in one file that needs no network.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <string_view>

#include "gliss/files/atomic_file.h"
#include "tools/cli/commands/commands.h"
#include "tools/cli/words/command.h"
#include "tools/cli/words/outputs.h"
#include "tools/report/report_page.h"
#include "tools/report/report_source.h"

namespace gliss::tools {
namespace {

struct ReportingOptions : ReportOptions {
  std::vector<std::string> results;
  std::string output;
};

void describe(Command& command, ReportingOptions& options) {
  command.list({"RESULTS", "FILE...",
                "files left by gliss trace, sweep, compare --json, run --summary, --json or "
                "--record",
                true},
               [&options](const std::string& path) {
                 check_input("RESULTS", path);
                 options.results.push_back(path);
               });
  command.option({"-o,--output", "FILE", "page to write: .html", true},
                 [&options](const std::string& path) {
                   if (!path.ends_with(".html") && !path.ends_with(".htm"))
                     throw InputError(fmt::format("--output: '{}' must end in .html", path));
                   options.output = path;
                 });
}

#ifdef GLISS_WITH_REPORT

// The bytes of all results together: pages stay below 15 MB.
constexpr std::uint64_t kResultBytes = 13'500'000;

std::vector<std::uint64_t> sizes_of(const std::vector<std::string>& paths) {
  std::vector<std::uint64_t> sizes;
  for (const std::string& path : paths) {
    std::error_code no_size;
    const auto size = std::filesystem::file_size(path, no_size);
    sizes.push_back(no_size ? 0 : size);
  }
  return sizes;
}

// The JSON as it may stand in a script element, where "</script" and "<!--" would mean something.
std::string embeddable(const Json& json) {
  std::string text;
  for (const char c : json.dump(-1, ' ', false, Json::error_handler_t::replace)) {
    if (c == '<') {
      text += "\\u003c";
    } else {
      text += c;
    }
  }
  return text;
}

struct Shown {
  std::string file, kind;
  std::string text;  // on the page
};

// Small files first: what they leave of the page is shared by the larger ones.
std::vector<Shown> read_results(const ReportingOptions& options) {
  const auto sizes = sizes_of(options.results);
  std::vector<std::size_t> order(sizes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return sizes[a] < sizes[b]; });
  Watch watch(options, "read", std::accumulate(sizes.begin(), sizes.end(), std::uint64_t{0}),
              "bytes");
  std::vector<Shown> results(sizes.size());
  std::uint64_t left = kResultBytes;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::string& path = options.results[order[i]];
    const std::uint64_t share = left / (order.size() - i);
    Json result = read_result({path, sizes[order[i]], share / 4 * 3, watch});  // base64: 4 for 3
    Shown& shown = results[order[i]];
    shown.file = std::filesystem::path(path).filename().string();
    shown.kind = result["kind"];
    result["file"] = shown.file;
    shown.text = embeddable(result);
    left -= std::min<std::uint64_t>(left, shown.text.size());
  }
  return results;
}

void run(const ReportingOptions& options) {
  check_outputs({options.output}, options.results);
  AtomicFile file(options.output);
  const auto results = read_results(options);
  constexpr std::string_view kPlace = "@@RESULTS@@";
  const std::string_view page = kReportPage;
  const auto place = page.find(kPlace);
  std::size_t bytes = 0;
  const auto write = [&](std::string_view text) {
    file.write(text);
    bytes += text.size();
  };
  write(page.substr(0, place));
  write("{\"version\":\"" GLISS_VERSION "\",\"results\":[");
  for (const Shown& shown : results) {
    if (&shown != &results.front()) write(",");
    write(shown.text);
  }
  write("]}");
  write(page.substr(place + kPlace.size()));
  file.commit();

  Json json = {{"page", options.output}, {"bytes", bytes}, {"results", Json::array()}};
  std::string text;
  for (const auto& [name, kind, embedded] : results) {
    json["results"].push_back({{"file", name}, {"kind", kind}});
    text += fmt::format("{}: {}\n", name, kind);
  }
  report(options,
         text + fmt::format("{}: {:.1f} MB, open it in a browser\n", options.output,
                            static_cast<double>(bytes) * 1e-6),
         json);
}

#else

void run(const ReportingOptions&) {
  throw Unavailable(
      "this build has no report: install npm with Node.js 18 or later, and build again with "
      "-DGLISS_REPORT=ON");
}

#endif

}  // namespace

void add_report(Command& program) {
  add_command<ReportingOptions>(program, "report",
                                "Make a page of results, to look at in a browser.",
                                "gliss report knot_forces.csv knot.h5 -o knot.html", describe, run);
}

}  // namespace gliss::tools
