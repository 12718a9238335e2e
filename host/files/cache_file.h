// Patch caches as files.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>

#include "gliss/base/export.h"
#include "gliss/base/poll.h"
#include "gliss/surface/patch_cache.h"

namespace gliss {

// A cache that cannot be read; what() names the file and the section. `stale`: sound, but of
// another mesh or version.
struct GLISS_EXPORT CacheError : std::runtime_error {
  CacheError(const std::string& what, bool stale) : std::runtime_error(what), stale(stale) {}
  bool stale;
};

// Written to a temporary beside `path`, synced and renamed: a reader sees a whole cache or none.
// Throws std::system_error. Reading checks every section's checksum, size, index and number; throws
// CacheError, or another std::runtime_error where `path` is no regular file. Writing that is
// stopped leaves no file.
GLISS_EXPORT void save_cache(const PatchCache& cache, const std::string& path,
                             const Poll& poll = {});
GLISS_EXPORT PatchCache load_cache(const std::string& path, const Poll& poll = {});
// The properties that a cache has to have, each if it is given.
struct CacheWanted {
  std::optional<Precision> precision{};
  std::optional<Level> level{};  // its construction does not count
  std::optional<Construction> construction{};
};
// The same of a cache that is stale where it is not as wanted.
GLISS_EXPORT PatchCache load_cache_of(const std::string& path, const CacheWanted& wanted,
                                      const Poll& poll = {});
// True if it begins as caches do.
GLISS_EXPORT bool is_cache_file(const std::string& path);
// True if it does, or is named as a cache: load_cache says what it is instead.
GLISS_EXPORT bool is_meant_as_cache(const std::string& path);

}  // namespace gliss
