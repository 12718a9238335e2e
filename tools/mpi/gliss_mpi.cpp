// gliss-mpi <command>: gliss on the ranks of an MPI job.
#include "tools/cli/commands/commands.h"
#include "tools/mpi/mpi_team.h"

namespace gliss::tools {
namespace {

int run(int count, char** words) {
  const MpiTeam team;
  const End end = run_program(
      count, words,
      {"gliss-mpi",
       "Gliss on many machines, as: mpirun -n 4 gliss-mpi sweep ... Its ranks share the "
       "work, and rank 0 writes what gliss would."},
      {[&team](Command& program) { add_shared_project(program, team); },
       [&team](Command& program) { add_shared_sweep(program, team); }});
  return team.end(end);
}

}  // namespace
}  // namespace gliss::tools

int main(int count, char** words) {
  int provided = 0;
  MPI_Init_thread(&count, &words, MPI_THREAD_FUNNELED, &provided);
  const int code = gliss::tools::run(count, words);
  MPI_Finalize();
  return gliss::tools::leave(code);
}
