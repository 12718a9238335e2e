// A checksum behind the end of a file whose format knows its own length, as HDF5 does: other
// readers do not look there. HDF5 itself cannot be trusted with damaged files.
#pragma once

#include <functional>
#include <string>

namespace gliss {

// Seals all that the file holds. Throws std::system_error that names `name`.
void append_seal(const std::string& path, const std::string& name);

enum class Seal { kNone, kSound, kBroken };  // none: of other programs, or cut off
// Throws as OpenFile does where the file cannot be read; `poll` is asked many times a second, and
// what it throws ends the reading.
Seal check_seal(const std::string& path, const std::function<void()>& poll = nullptr);

}  // namespace gliss
