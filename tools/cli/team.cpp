#include "tools/cli/team.h"

#include <fmt/format.h>

#include <random>

#include "tools/cli/command_line.h"

namespace gliss::tools {

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
  const auto seen = team.gather(parts.has_mark(mark) ? "seen" : "");
  if (team.rank() == 0) parts.remove_mark(mark);
  for (std::size_t rank = 0; rank < seen.size(); ++rank) {
    if (!seen[rank].empty()) continue;
    throw InputError(fmt::format(
        "the parts folder '{}' of {} is not that of {}; put it where all of them see it, by "
        "--parts FOLDER",
        parts.folder(), team.name_of(rank), team.name_of(0)));
  }
}

std::uint64_t sum(const Team& team, std::uint64_t value) {
  std::uint64_t total = 0;
  for (const std::string& text : team.gather(std::to_string(value)))
    total += parse_number<std::uint64_t>("sum", text);
  return total;
}

}  // namespace gliss::tools
