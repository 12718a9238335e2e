#include "tools/cli/parts/shard.h"

#include <fmt/format.h>

#include "tools/cli/words/command_line.h"

namespace gliss::tools {

Shard parse_shard(const std::string& text) {
  const auto refuse = [&](const std::string& why) {
    throw InputError(fmt::format("--shard: '{}': {}", text, why));
  };
  const std::vector<std::string> words = split(text, '/');
  Shard shard;
  try {
    if (words.size() != 2) throw InputError("");
    shard.number = parse_number<std::size_t>("", words[0]);
    shard.count = parse_number<std::size_t>("", words[1]);
  } catch (const InputError&) {
    refuse("write I/N for shard I of N, as 3/16");
  }
  if (shard.count == 0) refuse("there is no shard of none; write I/N, as 3/16");
  if (shard.number == 0 || shard.number > shard.count)
    refuse(fmt::format("shards are counted from 1, so these are 1/{0} to {0}/{0}", shard.count));
  return shard;
}

std::string shard_text(const Shard& shard) {
  return fmt::format("{}/{}", shard.number, shard.count);
}

}  // namespace gliss::tools
