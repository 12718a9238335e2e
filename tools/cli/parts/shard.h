// Shards of a sweep: some of its parts, done by a command of their own.
#pragma once

#include <cstddef>
#include <string>

namespace gliss::tools {

struct Shard {
  std::size_t number = 1, count = 1;  // from 1 on, of how many
};

// "3/16". Throws InputError.
Shard parse_shard(const std::string& text);
std::string shard_text(const Shard& shard);

}  // namespace gliss::tools
