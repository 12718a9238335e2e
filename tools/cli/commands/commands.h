// The commands of the programs: each adds itself.
#pragma once

#include "tools/cli/words/command_line.h"

namespace gliss::tools {

class Team;

void add_bake(Command& program);
void add_compare(Command& program);
void add_info(Command& program);
void add_check(Command& program);
void add_eval(Command& program);
void add_project(Command& program);
void add_sweep(Command& program);
// The same by the members of a team.
void add_shared_project(Command& program, const Team& team);
void add_shared_sweep(Command& program, const Team& team);
void add_trace(Command& program);
void add_generate(Command& program);
void add_devices(Command& program);
void add_judge(Command& program);
void add_run(Command& program);
void add_serve(Command& program);
void add_report(Command& program);
void add_view(Command& program);

}  // namespace gliss::tools
