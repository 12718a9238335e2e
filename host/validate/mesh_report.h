// Gathers what readers and checks find: one Finding per code, naming its first place and counting.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gliss/base/poll.h"
#include "gliss/validate/validate.h"

namespace gliss {

class Report {
 public:
  struct Place {
    std::uint32_t face = kNone;
    std::uint32_t vertex = kNone;
    std::size_t line = 0;  // 0: the line of the face, if known
  };

  // Mesh and findings must outlive the report; findings may be null, `poll` empty. `strict`: as of
  // LoadOptions.
  Report(const Mesh& mesh, std::vector<Finding>* findings, Poll poll, bool strict = false)
      : mended(strict ? Severity::kError : Severity::kRepaired),
        mesh_(mesh),
        findings_(findings ? *findings : own_),
        first_(findings_.size()),
        poll_(std::move(poll)) {}
  Report(const Report&) = delete;
  Report& operator=(const Report&) = delete;

  template <class... Args>
  Finding& add(Severity severity, std::string_view code, const Place& place,
               fmt::format_string<Args...> format, Args&&... args) {
    for (std::size_t i = first_; i < findings_.size(); ++i) {
      Finding& known = findings_[i];
      if (known.severity == severity && known.code == code) return ++known.count, known;
    }
    return append(severity, code, place, fmt::format(format, std::forward<Args>(args)...));
  }

  // An error after which reading on makes no sense.
  template <class... Args>
  [[noreturn]] void fail(std::string_view code, const Place& place,
                         fmt::format_string<Args...> format, Args&&... args) {
    append(Severity::kError, code, place, fmt::format(format, std::forward<Args>(args)...));
    throw MeshError(findings_.back().message);
  }

  // Throws the first error, if there is one.
  void stop_on_error() const;

  // LoadOptions::poll, which may throw: for each item of long work.
  void poll() { poll_(); }

  // The severity of what is mended unless a check is strict.
  const Severity mended;

  // [vertex], its line, for those alone that a finding may have to name.
  std::map<std::uint32_t, std::size_t> vertex_line;

  // [face], its number in the file; empty while no face has been removed or cut.
  std::vector<std::uint32_t> file_face;
  std::uint32_t number_of(std::uint32_t face) const {
    return face < file_face.size() ? file_face[face] : face;
  }

 private:
  Finding& append(Severity severity, std::string_view code, const Place& place, std::string text);

  const Mesh& mesh_;
  std::vector<Finding> own_;
  std::vector<Finding>& findings_;
  std::size_t first_;  // findings before it are the caller's
  ItemPoll poll_;
};

}  // namespace gliss
