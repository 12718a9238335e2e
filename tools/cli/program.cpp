#include "tools/cli/program.h"

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
#include "tools/cli/terminal/interrupt.h"
#include "tools/cli/terminal/terminal.h"
#include "tools/cli/words/command.h"

namespace gliss::tools {
namespace {

enum ExitCode { kDone, kInternal, kBadInput, kBadCache, kNoBackend };

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
  constexpr rlim_t kLeast = 384 << 10;
  rlimit limit{};
  return getrlimit(RLIMIT_STACK, &limit) != 0 || limit.rlim_cur >= kLeast;
}

}  // namespace

End run_program(int count, char** words, const ProgramText& text,
                const std::vector<std::function<void(Command&)>>& commands) {
  catch_interrupts();
  keep_standard_descriptors();
  if (!has_stack()) return {kInternal, "the stack's limit is below 384 KiB; cure: ulimit -s 8192"};
  keep_command_line(count, words);
  Command program(text.description, text.name);
  program.set_version(text.name + " " GLISS_VERSION);
  program.set_footer(
      text.name +
      " <command> --help tells more.\n"
      "Exit codes: 0 done, 1 internal error, 2 bad input, 3 stale or foreign cache,\n"
      "4 backend, device, real-time scheduling or report not available, 130 interrupted.");
  for (const auto& add : commands) add(program);
  try {
    program.run(count, words);
    if (std::fflush(stdout) != 0) return {kInternal, "cannot write to standard output"};
    return {};
  } catch (const MeshError& error) {
    return {kBadInput, error.what()};
  } catch (const NoFileError& error) {
    return {kBadInput, error.what()};
  } catch (const CsvError& error) {
    return {kBadInput, error.what()};
  } catch (const RecordingError& error) {
    return {kBadInput, error.what()};
  } catch (const SceneError& error) {
    return {kBadInput, error.what()};
  } catch (const UnitError& error) {
    return {kBadInput, error.what()};
  } catch (const InputError& error) {
    return {kBadInput, error.what()};
  } catch (const std::invalid_argument& error) {
    return {kBadInput, error.what()};
  } catch (const CacheError& error) {
    return {kBadCache, error.what()};
  } catch (const DeviceError& error) {
    return {kNoBackend, error.what()};
  } catch (const LoopError& error) {
    return {kNoBackend, error.what()};
  } catch (const Unavailable& error) {
    return {kNoBackend, error.what()};
  } catch (const Interrupted& interrupted) {
    return {kExitInterrupted,
            "interrupted" + (interrupted.hint.empty() ? "" : "; " + interrupted.hint)};
  } catch (const std::bad_alloc&) {
    return {kInternal, "out of memory"};
  } catch (const std::exception& error) {
    return {kInternal, error.what()};
  }
}

void tell(const std::string& who, End end) {
  if (end.message.empty()) return;
  std::replace(end.message.begin(), end.message.end(), '\n', ' ');
  tell(fmt::format("{}: {}\n", who, end.message));
}

int leave(int code) {
  if (code == kExitInterrupted) {
    std::fflush(stdout);
    _exit(code);
  }
  return code;
}

}  // namespace gliss::tools
