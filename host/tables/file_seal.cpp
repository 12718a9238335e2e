#include "gliss/tables/file_seal.h"

#include <fmt/format.h>
#include <unistd.h>
#include <xxhash.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <optional>
#include <string_view>
#include <system_error>
#include <vector>

#include "gliss/files/open_file.h"

namespace gliss {
namespace {

// The checksum is of all bytes in their order, or of the hashes of blocks.
constexpr std::string_view kOfBytes = "GLSSEAL1", kOfBlocks = "GLSSEAL2";
constexpr std::size_t kBlock = 1 << 20;
constexpr std::size_t kNumber = 8;                                 // bytes
constexpr std::size_t kSealBytes = kOfBytes.size() + 2 * kNumber;  // name, length, checksum
using SealBytes = std::array<char, kSealBytes>;

bool read_whole(int descriptor, char* to, std::size_t bytes, std::uint64_t at) {
  while (bytes > 0) {
    const ssize_t count = pread(descriptor, to, bytes, static_cast<off_t>(at));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    to += count;
    at += static_cast<std::uint64_t>(count);
    bytes -= static_cast<std::size_t>(count);
  }
  return true;
}

bool write_whole(int descriptor, const char* from, std::size_t bytes) {
  while (bytes > 0) {
    const ssize_t count = write(descriptor, from, bytes);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    from += count;
    bytes -= static_cast<std::size_t>(count);
  }
  return true;
}

// Calls visit(number, bytes) for the blocks first, first + step ... of what stands before the seal;
// false where that cannot be read.
template <class Visit>
bool for_blocks(int descriptor, std::uint64_t bytes, std::size_t first, std::size_t step,
                const Poll& poll, const Visit& visit) {
  std::vector<char> block(kBlock);
  for (std::uint64_t number = first; number * kBlock < bytes; number += step) {
    poll();
    const std::uint64_t at = number * kBlock;
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(kBlock, bytes - at));
    if (!read_whole(descriptor, block.data(), count, at)) return false;
    visit(number, std::string_view(block.data(), count));
  }
  return true;
}

SealBytes seal_of(std::string_view name, std::uint64_t bytes, std::uint64_t checksum) {
  SealBytes seal;
  char* to = std::copy(name.begin(), name.end(), seal.begin());
  for (const std::uint64_t number : {bytes, checksum}) {
    for (std::size_t i = 0; i < kNumber; ++i) *to++ = static_cast<char>(number >> (8 * i));
  }
  return seal;
}

std::uint64_t checksum_of(const std::vector<std::uint64_t>& hashes) {
  return XXH3_64bits(hashes.data(), hashes.size() * sizeof hashes[0]);
}

std::optional<std::uint64_t> checksum_of_bytes(int descriptor, std::uint64_t bytes,
                                               const Poll& poll = {}) {
  XXH3_state_t hash;
  XXH3_64bits_reset(&hash);
  const bool read =
      for_blocks(descriptor, bytes, 0, 1, poll, [&](std::uint64_t, std::string_view block) {
        XXH3_64bits_update(&hash, block.data(), block.size());
      });
  if (!read) return {};
  return XXH3_64bits_digest(&hash);
}

[[noreturn]] void fail(const char* action, const std::string& name) {
  const int error = errno;
  throw std::system_error(error, std::generic_category(), fmt::format("{} '{}'", action, name));
}

void append(const OpenFile& file, const std::string& name, const SealBytes& seal) {
  if (!write_whole(file.descriptor(), seal.data(), seal.size())) fail("cannot write", name);
}

}  // namespace

void append_seal(const std::string& path, const std::string& name) {
  const OpenFile file(path, O_RDWR | O_APPEND);
  file.check();
  const auto checksum = checksum_of_bytes(file.descriptor(), file.size());
  if (!checksum) fail("cannot write", name);
  append(file, name, seal_of(kOfBytes, file.size(), *checksum));
}

std::vector<std::uint64_t> block_hashes(const std::string& path, std::uint64_t bytes,
                                        std::size_t first, std::size_t step, const Poll& poll) {
  const OpenFile file(path);
  file.check();
  std::vector<std::uint64_t> hashes((bytes + kBlock - 1) / kBlock);
  const bool read = for_blocks(file.descriptor(), bytes, first, step, poll,
                               [&](std::uint64_t number, std::string_view block) {
                                 hashes[number] = XXH3_64bits(block.data(), block.size());
                               });
  if (!read) fail("cannot read", path);
  return hashes;
}

void append_seal(const std::string& path, const std::string& name,
                 const std::vector<std::uint64_t>& hashes) {
  const OpenFile file(path, O_RDWR | O_APPEND);
  file.check();
  append(file, name, seal_of(kOfBlocks, file.size(), checksum_of(hashes)));
}

Seal check_seal(const std::string& path, const Poll& poll) {
  const OpenFile file(path);
  file.check();
  if (file.size() < kSealBytes) return Seal::kNone;
  SealBytes found;
  const std::uint64_t bytes = file.size() - kSealBytes;
  if (!read_whole(file.descriptor(), found.data(), kSealBytes, bytes)) return Seal::kNone;
  const auto name = std::string_view(found.data(), kOfBytes.size());
  if (name == kOfBlocks) {
    const auto checksum = checksum_of(block_hashes(path, bytes, 0, 1, poll));
    return seal_of(name, bytes, checksum) == found ? Seal::kSound : Seal::kBroken;
  }
  if (name != kOfBytes) return Seal::kNone;
  const auto checksum = checksum_of_bytes(file.descriptor(), bytes, poll);
  return checksum && seal_of(name, bytes, *checksum) == found ? Seal::kSound : Seal::kBroken;
}

}  // namespace gliss
