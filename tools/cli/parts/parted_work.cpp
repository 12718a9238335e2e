#include "tools/cli/parts/parted_work.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <filesystem>

#include "gliss/files/atomic_file.h"
#include "tools/cli/terminal/interrupt.h"
#include "tools/cli/terminal/terminal.h"
#include "tools/cli/terminal/watch.h"
#include "tools/cli/words/outputs.h"

namespace gliss::tools {
namespace {

std::string parts_folder(const PartedOptions& options, const CommandFiles& files) {
  if (options.parts == "none") return "";
  if (!options.parts.empty()) return options.parts;
  for (const std::string& file : files.outputs) {
    if (!file.empty() && file != "-") return with_ending(file, ".parts");
  }
  return "";
}

// The folder where those that share work meet.
std::string shared_folder(const PartedOptions& options, const CommandFiles& files) {
  const std::string folder = parts_folder(options, files);
  if (folder.empty()) {
    throw InputError(
        "parts that are shared need a folder; add what the whole command writes, as -o FILE, or "
        "--parts FOLDER");
  }
  return folder;
}

void tell_found(const PartFolder& parts, const PartedOptions& options) {
  if (options.quiet) return;
  if (parts.kept() > 0)
    tell(fmt::format("gliss: goes on from {} parts in '{}'\n", parts.kept(), parts.folder()));
  if (parts.foreign() > 0)
    tell(fmt::format("gliss: {} files of other work in '{}' are left alone\n", parts.foreign(),
                     parts.folder()));
}

// Calls do_it(progress) with a bar, and says where finished parts are if it is interrupted.
// `sharers`: among which the items are dealt out, in turns.
void watched(const PartedWork& work, const PartedOptions& options, const PartFolder* parts,
             std::size_t sharers, const std::function<void(const PartProgress&)>& do_it) {
  const PartedWork::Size size = work.size();
  try {
    Watch watch(options, size.label, size.items / sharers, size.noun);
    do_it([&](std::uint64_t done, std::uint64_t) { watch.reach(done / sharers); });
  } catch (const Interrupted&) {
    if (parts == nullptr || (parts->kept() == 0 && parts->whole() == 0)) throw;
    throw Interrupted{
        fmt::format("parts are in '{}': the same command goes on from them", parts->folder())};
  }
  if (parts == nullptr) return;
  for (const std::string& path : parts->damaged())
    tell(fmt::format("gliss: '{}' was damaged, its part is computed again\n", path));
}

void do_shard(PartedWork& work, const PartedOptions& options, const std::string& folder) {
  const Shard shard = *options.shard;
  const PartFolder& parts = work.open_parts(folder, PartsAccess::kShared);
  tell_found(parts, options);
  const Stopwatch clock;
  std::uint64_t contacts = 0;
  watched(work, options, &parts, shard.count, [&](const PartProgress& reach) {
    contacts = work.do_parts(every_part(shard.number - 1, shard.count), reach);
  });
  const std::size_t whole = parts.whole(), all = work.part_count();
  const std::string rest = command_line_without("--shard");
  Json json = work.report_of_shard(contacts);
  json["seconds"] = clock.seconds();
  json["shard"] = shard_text(shard);
  json["parts_folder"] = parts.folder();
  json["parts"] = all;
  json["parts_done"] = whole;
  json["command_of_result"] = rest;
  report(options,
         fmt::format("shard {} is done: {} of {} parts are in '{}'; {}the result comes by\n{}\n",
                     shard_text(shard), whole, all, parts.folder(),
                     whole < all ? "once the others are, " : "", rest),
         json);
}

void remove(PartFolder& parts, const PartedOptions& options) {
  if (parts.remove() || options.quiet) return;
  tell(fmt::format("gliss: parts stay in '{}', where others are at work\n", parts.folder()));
}

void do_whole(PartedWork& work, const PartedOptions& options, const std::string& folder) {
  PartFolder* parts = nullptr;
  if (!folder.empty() && (!work.is_short() || std::filesystem::exists(folder))) {
    parts = &work.open_parts(folder, PartsAccess::kAlone);
    tell_found(*parts, options);
  }
  work.write_result([&](const PartWork& make) {
    watched(work, options, parts, 1, [&](const PartProgress& reach) { make(every_part(), reach); });
    return Json::object();
  });
  if (parts != nullptr) remove(*parts, options);
}

}  // namespace

void add_parts_options(Command& command, PartedOptions& options) {
  command.option({"--parts", "FOLDER",
                  "folder for finished parts, from which the same command goes on after a stop; "
                  "default OUTPUT.parts; none: no parts"},
                 options.parts);
  command.option(
      {"--shard", "I/N",
       "do only share I of N, as 3/16 (the first is 1), and write no result: run the same command "
       "without --shard once all shards are done"},
      [&options](const std::string& text) { options.shard = parse_shard(text); });
}

std::string check_files(const PartedOptions& options, const CommandFiles& files) {
  const std::string folder =
      options.shard ? shared_folder(options, files) : parts_folder(options, files);
  check_outputs(files.outputs, files.inputs);
  return folder;
}

std::string check_files(PartedOptions& options, const CommandFiles& files, const Team& team) {
  if (options.shard) throw InputError("--shard: ranks share the parts without it");
  const std::string folder = shared_folder(options, files);
  const bool leads = team.rank() == 0;
  options.quiet = options.quiet || !leads;
  if (options.threads == 0) options.threads = team.threads();
  agree(team, "the version of the program", fmt::format("gliss {}", GLISS_VERSION),
        "start the same one everywhere");
  if (leads) check_outputs(files.outputs, files.inputs);
  return folder;
}

void do_alone(PartedWork& work, const PartedOptions& options, const std::string& folder) {
  options.shard ? do_shard(work, options, folder) : do_whole(work, options, folder);
}

void do_in_team(PartedWork& work, const PartedOptions& options, const std::string& folder,
                const Team& team) {
  PartFolder& parts = work.open_parts(folder, PartsAccess::kShared);
  tell_found(parts, options);
  work.agree_on_work(team);
  TeamMember member(team, parts, work.part_count(),
                    [&](const PartSource& source, const PartProgress& reach) {
                      return work.do_parts(source, reach);
                    });
  const bool leads = team.rank() == 0, together = work.is_written_together();
  const auto done = [&](const std::function<void(const PartProgress&)>& do_it) {
    watched(work, options, &parts, 1, do_it);
    if (!leads) work.close_parts();  // rank 0 removes them
    return member.report();
  };
  const auto come = [&](const PartWork& make) {
    return done([&](const PartProgress& reach) {
      together ? member.do_share(make, reach) : member.do_all(make, reach);
    });
  };
  if (leads) {
    work.write_result(come);
    return remove(parts, options);
  }
  if (together) return work.write_share(come);
  done([&](const PartProgress& reach) { member.do_parts(reach); });
}

std::uint64_t peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

}  // namespace gliss::tools
