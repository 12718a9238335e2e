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

constexpr std::string_view kName = "GLSSEAL1";
constexpr std::size_t kBlock = 1 << 20;
constexpr std::size_t kNumber = 8;                              // bytes
constexpr std::size_t kSealBytes = kName.size() + 2 * kNumber;  // name, length before it, checksum
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

// The seal of what stands before it; nothing where that cannot be read.
std::optional<SealBytes> seal_of(int descriptor, std::uint64_t bytes,
                                 const std::function<void()>& poll = nullptr) {
  XXH3_state_t hash;
  XXH3_64bits_reset(&hash);
  std::vector<char> block(kBlock);
  for (std::uint64_t at = 0; at < bytes; at += kBlock) {
    if (poll) poll();
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(kBlock, bytes - at));
    if (!read_whole(descriptor, block.data(), count, at)) return {};
    XXH3_64bits_update(&hash, block.data(), count);
  }
  SealBytes seal;
  char* to = std::copy(kName.begin(), kName.end(), seal.begin());
  for (const std::uint64_t number : {bytes, std::uint64_t{XXH3_64bits_digest(&hash)}}) {
    for (std::size_t i = 0; i < kNumber; ++i) *to++ = static_cast<char>(number >> (8 * i));
  }
  return seal;
}

}  // namespace

void append_seal(const std::string& path, const std::string& name) {
  const OpenFile file(path, O_RDWR | O_APPEND);
  file.check();
  const auto seal = seal_of(file.descriptor(), file.size());
  if (seal && write_whole(file.descriptor(), seal->data(), seal->size())) return;
  const int error = errno;
  throw std::system_error(error, std::generic_category(), fmt::format("cannot write '{}'", name));
}

Seal check_seal(const std::string& path, const std::function<void()>& poll) {
  const OpenFile file(path);
  file.check();
  if (file.size() < kSealBytes) return Seal::kNone;
  SealBytes found;
  const std::uint64_t bytes = file.size() - kSealBytes;
  if (!read_whole(file.descriptor(), found.data(), kSealBytes, bytes)) return Seal::kNone;
  if (!std::string_view(found.data(), kSealBytes).starts_with(kName)) return Seal::kNone;
  return seal_of(file.descriptor(), bytes, poll) == found ? Seal::kSound : Seal::kBroken;
}

}  // namespace gliss
