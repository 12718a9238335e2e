// A checksum behind the end of a file whose format knows its own length, as HDF5 does: other
// readers do not look there. HDF5 itself cannot be trusted with damaged files.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gliss/base/poll.h"

namespace gliss {

// Seals all that the file holds. Throws std::system_error that names `name`.
void append_seal(const std::string& path, const std::string& name);

// Finds the hashes of blocks of 1 MiB of a file, 8 bytes for each, or those alone that come by step
// `step` from `first` on, among zeros: what many processes find so adds up to all. Throws
// std::system_error.
std::vector<std::uint64_t> block_hashes(const std::string& path, std::uint64_t bytes,
                                        std::size_t first = 0, std::size_t step = 1,
                                        const Poll& poll = {});
// Seals the file by the hashes of all its blocks.
void append_seal(const std::string& path, const std::string& name,
                 const std::vector<std::uint64_t>& hashes);

enum class Seal { kNone, kSound, kBroken };  // none: of other programs, or cut off
// Checks a seal of either kind. Throws as OpenFile does where the file cannot be read.
Seal check_seal(const std::string& path, const Poll& poll = {});

}  // namespace gliss
