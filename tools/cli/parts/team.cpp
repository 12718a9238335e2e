#include "tools/cli/parts/team.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <random>

#include "gliss/tables/file_seal.h"
#include "tools/cli/terminal/watch.h"
#include "tools/cli/words/command_line.h"

namespace gliss::tools {
namespace {

// The first rank for which it is not so; nothing where it is so for all.
std::optional<std::size_t> first_without(const Team& team, bool so) {
  const auto all = team.gather(so ? "so" : "");
  const auto found = std::find(all.begin(), all.end(), "");
  if (found == all.end()) return {};
  return static_cast<std::size_t>(found - all.begin());
}

}  // namespace

void agree(const Team& team, const std::string& what, const std::string& text,
           const std::string& cure) {
  const std::vector<std::string> all = team.gather(text);
  for (std::size_t rank = 0; rank < all.size(); ++rank) {
    if (all[rank] == all[0]) continue;
    throw InputError(fmt::format("{} is not the same everywhere: {} has {}, {} has {}; {}", what,
                                 team.name_of(0), all[0], team.name_of(rank), all[rank], cure));
  }
}

// Rank 0 leaves a mark, and the others look for it.
void agree_on_folder(const Team& team, const PartFolder& parts) {
  std::uint64_t mark = 0;
  if (team.rank() == 0) {
    mark = std::random_device()();
    parts.leave_mark(mark);
  }
  mark = sum(team, mark);
  const auto blind = first_without(team, parts.has_mark(mark));
  if (team.rank() == 0) parts.remove_mark(mark);
  if (!blind) return;
  throw InputError(fmt::format(
      "the parts folder '{}' of {} is not that of {}; put it where all of them see it, by "
      "--parts FOLDER",
      parts.folder(), team.name_of(*blind), team.name_of(0)));
}

std::uint64_t sum(const Team& team, std::uint64_t value) {
  std::vector<std::uint64_t> values{value};
  team.sum(values);
  return values[0];
}

std::string text_of_rank_0(const Team& team, const std::string& text) {
  const bool leads = team.rank() == 0;
  std::vector<std::uint64_t> letters(sum(team, leads ? text.size() : 0));
  if (leads) std::copy(text.begin(), text.end(), letters.begin());
  team.sum(letters);
  return {letters.begin(), letters.end()};
}

std::string shared_path(const Team& team, const std::string& temporary) {
  const std::string path =
      text_of_rank_0(team, temporary.empty() ? "" : std::filesystem::absolute(temporary).string());
  const auto blind = first_without(team, std::filesystem::exists(path));
  if (!blind) return path;
  throw InputError(
      fmt::format("{} does not see '{}', which {} has made; put the result where all see it",
                  team.name_of(*blind), path, team.name_of(0)));
}

std::vector<std::uint64_t> shared_hashes(const Team& team, const std::string& path) {
  const std::uint64_t bytes = sum(team, team.rank() == 0 ? std::filesystem::file_size(path) : 0);
  auto hashes = block_hashes(path, bytes, team.rank(), team.size(), stop_if_interrupted);
  team.sum(hashes);
  return hashes;
}

}  // namespace gliss::tools
