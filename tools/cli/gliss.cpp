// gliss <command>
#include "tools/cli/commands/commands.h"
#include "tools/cli/program.h"

int main(int count, char** words) {
  using namespace gliss::tools;
  const End end = run_program(
      count, words, {"gliss", "Smooth haptic force on coarse polygon meshes."},
      {add_bake, add_compare, add_info, add_check, add_eval, add_project, add_sweep, add_trace,
       add_generate, add_devices, add_judge, add_run, add_serve, add_report, add_view});
  tell("gliss", end);
  return leave(end.code);
}
