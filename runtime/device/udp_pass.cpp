#include "gliss/device/udp_pass.h"

#include <fcntl.h>
#include <pwd.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <vector>

#include "gliss/base/message.h"
#include "gliss/thread/realtime.h"

namespace gliss::udp {
namespace {

[[noreturn]] void refuse(std::uint16_t port, const std::string& path, const std::string& why) {
  throw LoopError(
      detail::message("udp:", port, ": '", path, "', which tells who may move the device, ", why));
}

bool is_own(const struct stat& status) { return status.st_uid == geteuid(); }

// Says what is wrong with a folder for files of this user alone, and the cure; empty: nothing is.
std::string fault_of(const std::string& folder) {
  struct stat status {};
  if (lstat(folder.c_str(), &status) != 0) return std::strerror(errno);
  if (!is_own(status))
    return detail::message("it belongs to user ", status.st_uid, "; cure: ask them to remove it");
  if (!S_ISDIR(status.st_mode) || (status.st_mode & 077) != 0)
    return "it is not a folder of this user alone; cure: remove it";
  return access(folder.c_str(), W_OK) == 0 ? "" : std::strerror(errno);
}

// Finds the home of this user in the system's list, whatever HOME says: a service may have none, or
// that of whoever started it. Empty where the list has none.
std::string find_home() {
  std::vector<char> text(4096);
  struct passwd entry {};
  struct passwd* found = nullptr;
  while (getpwuid_r(geteuid(), &entry, text.data(), text.size(), &found) == ERANGE)
    text.resize(2 * text.size());
  return found != nullptr && found->pw_dir[0] == '/' ? found->pw_dir : "";
}

// The list may lie on another machine: it is asked once.
const std::string& home_folder() {
  static const std::string home = find_home();
  return home;
}

// A folder where passes may lie, and what their paths begin with: that of the session, one in /tmp,
// and one at home where somebody else has that.
struct Place {
  std::string folder, begin;
  bool is_ours = true;  // to be made
};
std::vector<Place> places() {
  const std::string session = detail::message("/run/user/", geteuid()),
                    shared = detail::message("/tmp/gliss-", geteuid());
  std::vector<Place> all{{session, session + "/gliss-", false}, {shared, shared + "/"}};
  if (const std::string& home = home_folder(); !home.empty())
    all.push_back({home + "/.gliss", home + "/.gliss/"});
  return all;
}

std::string new_path(std::uint16_t port) {
  std::string refused, why;  // the first that we would have made
  for (const Place& place : places()) {
    if (place.is_ours) mkdir(place.folder.c_str(), 0700);
    const std::string fault = fault_of(place.folder);
    if (fault.empty()) return detail::message(place.begin, "udp-", port);
    if (place.is_ours && refused.empty()) refused = place.folder, why = fault;
  }
  refuse(port, refused, detail::message("cannot be had: ", why));
}

}  // namespace

OwnPass::OwnPass(std::uint16_t port) : port_(port) {
  for (std::size_t got = 0; got < pass_.size();) {
    const ssize_t some = getrandom(pass_.data() + got, pass_.size() - got, 0);
    if (some > 0) got += static_cast<std::size_t>(some);
  }
  put_down();
}

// Whole and locked before it has its name: a loop that looks meanwhile finds it so, or not at all.
// The file that a killed server left gives way: the port is ours.
void OwnPass::put_down() {
  path_ = new_path(port_);
  const std::string made = path_ + ".new";
  unlink(made.c_str());
  const int descriptor =
      open(made.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
  const bool done =
      descriptor >= 0 && flock(descriptor, LOCK_EX | LOCK_NB) == 0 &&
      write(descriptor, pass_.data(), pass_.size()) == static_cast<ssize_t>(pass_.size()) &&
      rename(made.c_str(), path_.c_str()) == 0;
  if (done) {
    if (descriptor_ >= 0) close(descriptor_);
    descriptor_ = descriptor;
    return;
  }
  const std::string why = std::strerror(errno);
  if (descriptor >= 0) unlink(made.c_str()), close(descriptor);
  refuse(port_, path_, detail::message("cannot be written (", why, ")"));
}

void OwnPass::keep() noexcept {
  struct stat status {};
  if (lstat(path_.c_str(), &status) == 0 || errno != ENOENT) return;
  try {
    put_down();
  } catch (const std::exception&) {  // the loop is refused, as without this
  }
}

OwnPass::~OwnPass() {
  unlink(path_.c_str());
  close(descriptor_);
}

namespace {

std::optional<FoundPass> pass_in(const std::string& path, std::uint16_t port) {
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
  if (!whole) refuse(port, path, "cannot be read as this user's own; cure: remove it");
  return found;
}

}  // namespace

std::string pass_paths(std::uint16_t port) {
  std::string all;
  for (const Place& place : places())
    all += detail::message(all.empty() ? "" : ", ", place.begin, "udp-", port);
  return all;
}

std::optional<FoundPass> find_pass(std::uint16_t port) {
  std::optional<FoundPass> left;  // by a server that is no more
  for (const Place& place : places()) {
    if (!fault_of(place.folder).empty()) continue;
    const auto found = pass_in(detail::message(place.begin, "udp-", port), port);
    if (found && found->served) return found;
    if (!left) left = found;
  }
  return left;
}

}  // namespace gliss::udp
