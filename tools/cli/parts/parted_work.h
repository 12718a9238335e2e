// Commands whose work goes by parts, which wait in a folder until all is done, and which shards and
// the members of a team share.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "gliss/results/json.h"
#include "gliss/sweep/part_folder.h"
#include "tools/cli/parts/shard.h"
#include "tools/cli/parts/team.h"
#include "tools/cli/parts/team_member.h"
#include "tools/cli/words/command.h"

namespace gliss::tools {

struct PartedOptions : SurfaceOptions {
  std::string output, parts;
  std::optional<Shard> shard;
};

void add_parts_options(Command& command, PartedOptions& options);

// What a command writes and reads. Parts wait beside the first output that is a file, unless the
// options say where.
struct CommandFiles {
  std::vector<std::string> outputs, inputs;
};

// Lets the parts of a result come, in their order, to what makes it of them; what the members of a
// team did, or an empty object without one.
using PartsOfResult = std::function<Json(const PartWork& make)>;

// The work of a command: a surface is open, and inputs are sound.
class PartedWork {
 public:
  // What progress counts.
  struct Size {
    std::string label;  // "sweep"
    std::uint64_t items = 0;
    std::string noun;  // "samples"
  };

  PartedWork() = default;
  virtual ~PartedWork() = default;
  PartedWork(const PartedWork&) = delete;
  PartedWork& operator=(const PartedWork&) = delete;

  virtual Size size() const = 0;
  virtual std::size_t part_count() const = 0;
  // True if it is over so soon that a command that is alone need not keep its parts.
  virtual bool is_short() const { return false; }
  // Opens the folder where parts are kept from now on, until it is closed.
  virtual PartFolder& open_parts(const std::string& folder, PartsAccess access) = 0;
  virtual void close_parts() = 0;
  // Throws InputError, in all members, where they do not work at the same. The parts are open.
  virtual void agree_on_work(const Team& team) = 0;
  // PartWork, into the parts that are open.
  virtual std::uint64_t do_parts(const PartSource& source, const PartProgress& progress) = 0;
  // Returns what a shard says in addition to the number of parts.
  virtual Json report_of_shard(std::uint64_t contacts) const = 0;
  // Writes what was asked for, and says so.
  virtual void write_result(const PartsOfResult& come) = 0;
  // True if the members that agreed write the result together: rank 0 by write_result(), and the
  // others by write_share(), to which the parts come that a member does.
  virtual bool is_written_together() const { return false; }
  virtual void write_share(const PartsOfResult&) {}
};

// The folder where parts wait; "": nowhere. Throws InputError where they are shared and have none,
// and for outputs as check_outputs() does.
std::string check_files(const PartedOptions& options, const CommandFiles& files);
// Does one shard, or all and the result.
void do_alone(PartedWork& work, const PartedOptions& options, const std::string& folder);

// The same of a member of a team, of which rank 0 speaks and writes the result.
std::string check_files(PartedOptions& options, const CommandFiles& files, const Team& team);
void do_in_team(PartedWork& work, const PartedOptions& options, const std::string& folder,
                const Team& team);

// Runs a command whose Work is made of its Options, which have files().
template <class Work, class Options>
void run_alone(const Options& options) {
  const std::string folder = check_files(options, options.files());
  Work work(options);
  do_alone(work, options, folder);
}
template <class Work, class Options>
void run_in_team(Options options, const Team& team) {
  const std::string folder = check_files(options, options.files(), team);
  Work work(options);
  do_in_team(work, options, folder, team);
}

std::uint64_t peak_memory();  // of this process, bytes

}  // namespace gliss::tools
