#include "gliss/tables/hdf5_handle.h"

#include <fmt/format.h>

#include <stdexcept>

namespace gliss::hdf5 {
namespace {

// Walking upward meets the innermost record first: the one that knows the reason.
herr_t keep_first(unsigned n, const H5E_error2_t* error, void* reason) {
  if (n == 0 && error->desc) *static_cast<std::string*>(reason) = error->desc;
  return 0;
}

}  // namespace

void fail(const std::string& action) {
  std::string reason = "no reason given by HDF5";
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_first, &reason);
  H5Eclear2(H5E_DEFAULT);
  // A failing system call is told with its buffer's address and more: keep the words of strerror.
  static constexpr std::string_view kWords = "error message = '";
  if (const auto begin = reason.find(kWords); begin != std::string::npos) {
    reason.erase(0, begin + kWords.size());
    reason.erase(std::min(reason.find('\''), reason.size()));
  }
  throw std::runtime_error(fmt::format("{}: {}", action, reason));
}

}  // namespace gliss::hdf5
