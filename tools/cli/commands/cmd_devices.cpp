// gliss devices: what --backend opencl can run on.
#include <fmt/format.h>

#include "tools/cli/commands/commands.h"
#include "tools/cli/words/command.h"

namespace gliss::tools {
namespace {

void run(const ReportOptions& options) {
  std::string text;
  Json json = Json::array();
  const std::vector<OpenClDevice> devices = opencl_devices();
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const OpenClDevice& d = devices[i];
    text += fmt::format(
        "{}: {}\n   {}, {}, driver {}\n   {}; {}; {} units; {:.1f} GiB, {:.1f} GiB a buffer; "
        "lanes: {} float, {} double\n",
        i, d.name, d.type, d.platform, d.driver, d.language, d.fp64 ? "fp64" : "no fp64", d.units,
        static_cast<double>(d.memory) / (1 << 30),
        static_cast<double>(d.largest_buffer) / (1 << 30), d.lanes_float, d.lanes_double);
    json.push_back({{"number", i},
                    {"name", d.name},
                    {"platform", d.platform},
                    {"driver", d.driver},
                    {"type", d.type},
                    {"opencl_c", d.language},
                    {"fp64", d.fp64},
                    {"correctly_rounded_divide_sqrt", d.exact},
                    {"shares_memory", d.shares_memory},
                    {"units", d.units},
                    {"memory_bytes", d.memory},
                    {"largest_buffer_bytes", d.largest_buffer},
                    {"lanes_float", d.lanes_float},
                    {"lanes_double", d.lanes_double}});
  }
  report(options, text, json);
}

}  // namespace

void add_devices(Command& program) {
  add_command<ReportOptions>(
      program, "devices", "List the OpenCL devices that --backend opencl can use.",
      "gliss devices --json", [](Command&, ReportOptions&) {}, run);
}

}  // namespace gliss::tools
