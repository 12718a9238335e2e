// gliss <command>: registers the commands and turns whatever goes wrong into one line and an exit
// code.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <new>

#include "gliss/base/units.h"
#include "gliss/files/cache_file.h"
#include "gliss/files/open_file.h"
#include "gliss/scene/scene.h"
#include "gliss/tables/csv_reader.h"
#include "gliss/tables/point_table.h"
#include "gliss/thread/realtime.h"
#include "tools/cli/command.h"
#include "tools/cli/interrupt.h"
#include "tools/cli/terminal.h"

namespace gliss::tools {
namespace {

enum ExitCode { kDone, kInternal, kBadInput, kBadCache, kNoBackend };

int say(std::string message, int code) {
  std::replace(message.begin(), message.end(), '\n', ' ');
  tell(fmt::format("gliss: {}\n", message));
  return code;
}

int run(int count, char** words) {
  Command program("Smooth haptic force on coarse polygon meshes.", "gliss");
  program.set_version("gliss " GLISS_VERSION);
  program.set_footer(
      "gliss <command> --help tells more.\n"
      "Exit codes: 0 done, 1 internal error, 2 bad input, 3 stale or foreign cache,\n"
      "4 backend, device, real-time scheduling or report not available, 130 interrupted.");
  for (const auto add :
       {add_bake, add_compare, add_info, add_check, add_eval, add_project, add_sweep, add_trace,
        add_generate, add_devices, add_judge, add_run, add_serve, add_report}) {
    add(program);
  }
  try {
    program.run(count, words);
    if (std::fflush(stdout) != 0) return say("cannot write to standard output", kInternal);
    return kDone;
  } catch (const MeshError& error) {
    return say(error.what(), kBadInput);
  } catch (const NoFileError& error) {
    return say(error.what(), kBadInput);
  } catch (const CsvError& error) {
    return say(error.what(), kBadInput);
  } catch (const RecordingError& error) {
    return say(error.what(), kBadInput);
  } catch (const SceneError& error) {
    return say(error.what(), kBadInput);
  } catch (const UnitError& error) {
    return say(error.what(), kBadInput);
  } catch (const InputError& error) {
    return say(error.what(), kBadInput);
  } catch (const std::invalid_argument& error) {
    return say(error.what(), kBadInput);
  } catch (const CacheError& error) {
    return say(error.what(), kBadCache);
  } catch (const DeviceError& error) {
    return say(error.what(), kNoBackend);
  } catch (const LoopError& error) {
    return say(error.what(), kNoBackend);
  } catch (const Unavailable& error) {
    return say(error.what(), kNoBackend);
  } catch (const Interrupted& interrupted) {
    return say("interrupted" + (interrupted.hint.empty() ? "" : "; " + interrupted.hint),
               kExitInterrupted);
  } catch (const std::bad_alloc&) {
    return say("out of memory", kInternal);
  } catch (const std::exception& error) {
    return say(error.what(), kInternal);
  }
}

// A descriptor that is closed would be that of the next file, into which messages would go.
void keep_standard_descriptors() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    // What is written to a standard output that was closed is an error.
    const int mode = descriptor == STDERR_FILENO ? O_WRONLY : O_RDONLY;
    if (fcntl(descriptor, F_GETFD) < 0) (void)!open("/dev/null", mode);
  }
}

// Deep calls end without a word where the stack may not grow.
bool has_stack() {
  constexpr rlim_t kLeast = 256 << 10;
  rlimit limit{};
  return getrlimit(RLIMIT_STACK, &limit) != 0 || limit.rlim_cur >= kLeast;
}

}  // namespace
}  // namespace gliss::tools

int main(int count, char** words) {
  gliss::catch_interrupts();
  gliss::tools::keep_standard_descriptors();
  if (!gliss::tools::has_stack())
    return gliss::tools::say("the stack's limit is below 256 KiB; cure: ulimit -s 8192",
                             gliss::tools::kInternal);
  gliss::tools::keep_command_line(count, words);
  return gliss::tools::run(count, words);
}
