#include "gliss/device/udp_pass.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "gliss/base/message.h"
#include "gliss/thread/realtime.h"

namespace gliss::udp {
namespace {

[[noreturn]] void refuse(std::uint16_t port, const std::string& path, const std::string& why) {
  throw LoopError(
      detail::message("udp:", port, ": '", path, "', which tells who may move the device, ", why));
}

bool is_own(const struct stat& status) { return status.st_uid == geteuid(); }

// The folder for files of this user alone.
std::string own_folder(std::uint16_t port) {
  struct stat status {};
  const std::string session = detail::message("/run/user/", geteuid());
  if (stat(session.c_str(), &status) == 0 && S_ISDIR(status.st_mode) && is_own(status) &&
      access(session.c_str(), W_OK) == 0)
    return session + "/gliss-";
  const std::string folder = detail::message("/tmp/gliss-", geteuid());
  if (mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST)
    refuse(port, folder, detail::message("cannot be made (", std::strerror(errno), ")"));
  if (lstat(folder.c_str(), &status) != 0 || !S_ISDIR(status.st_mode) || !is_own(status) ||
      (status.st_mode & 077) != 0)
    refuse(port, folder, "is not a folder of this user alone; cure: remove it");
  return folder + "/";
}

std::string path_of(std::uint16_t port) { return detail::message(own_folder(port), "udp-", port); }

}  // namespace

OwnPass::OwnPass(std::uint16_t port) : path_(path_of(port)) {
  for (std::size_t got = 0; got < pass_.size();) {
    const ssize_t some = getrandom(pass_.data() + got, pass_.size() - got, 0);
    if (some > 0) got += static_cast<std::size_t>(some);
  }
  unlink(path_.c_str());  // what a killed server left: the port is ours
  descriptor_ = open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
  const bool done =
      descriptor_ >= 0 && flock(descriptor_, LOCK_EX | LOCK_NB) == 0 &&
      write(descriptor_, pass_.data(), pass_.size()) == static_cast<ssize_t>(pass_.size());
  if (done) return;
  const std::string why = std::strerror(errno);
  if (descriptor_ >= 0) unlink(path_.c_str()), close(descriptor_);
  refuse(port, path_, detail::message("cannot be written (", why, ")"));
}

OwnPass::~OwnPass() {
  unlink(path_.c_str());
  close(descriptor_);
}

std::optional<FoundPass> find_pass(std::uint16_t port) {
  const std::string path = path_of(port);
  const int descriptor = open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0 && errno == ENOENT) return std::nullopt;
  FoundPass found;
  struct stat status {};
  const bool own = descriptor >= 0 && fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode) &&
                   is_own(status) && (status.st_mode & 077) == 0;
  const bool whole = own && read(descriptor, found.pass.data(), found.pass.size()) ==
                                static_cast<ssize_t>(found.pass.size());
  found.served = descriptor >= 0 && flock(descriptor, LOCK_SH | LOCK_NB) != 0;
  if (descriptor >= 0) close(descriptor);
  // A server that has made its file and not written it yet is asked again.
  if (own && !whole && found.served) return std::nullopt;
  if (!whole) refuse(port, path, "cannot be read as this user's own; cure: remove it");
  return found;
}

}  // namespace gliss::udp
