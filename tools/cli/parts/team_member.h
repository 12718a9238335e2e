// A member of a team at its share of the parts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "gliss/results/json.h"
#include "gliss/sweep/part_folder.h"
#include "tools/cli/parts/team.h"

namespace gliss::tools {

// Does the parts that `source` names, unless they are there, keeps all of them, and counts the
// contacts that it computed.
using PartWork =
    std::function<std::uint64_t(const PartSource& source, const PartProgress& progress)>;

class TeamMember {
 public:
  // `parts`, `count` in number, are shared; `work` keeps them there. Throws InputError, in all
  // members, where their folders differ.
  TeamMember(const Team& team, PartFolder& parts, std::size_t count, PartWork work);

  // Does parts that nobody has taken, one after the other, until there are none.
  void do_parts(const PartProgress& progress);
  // The same, and all parts as they come, in their order, by `whole`, which makes the result of
  // them. For rank 0.
  void do_all(const PartWork& whole, const PartProgress& progress);

  // The same as do_parts(), by `make`, which makes what is written of each. Returns once all
  // members are done.
  void do_share(const PartWork& make, const PartProgress& progress);

  // What all members did, once all have come here. The parts are no longer needed.
  Json report() const;

 private:
  void do_parts_until(const std::function<bool()>& enough, const PartWork& work);
  void wait_for(std::size_t part);
  PartProgress reach();

  const Team& team_;
  PartFolder& parts_;
  const std::size_t count_;
  const PartWork work_;
  PartProgress progress_;
  bool none_left_ = false;
  std::uint64_t reached_ = 0, computed_ = 0;
  double at_parts_ = 0, at_counter_ = 0, waiting_ = 0, all_ = 0;  // s
};

}  // namespace gliss::tools
