// de_DE.UTF-8, with its decimal comma, made by localedef: no need to have it installed.
#pragma once

#include <clocale>

#include "tests/support/gliss_process.h"

namespace gliss::test {

class GermanLocale {
 public:
  static constexpr const char *kName = "de_DE.UTF-8",
                              *kAbsent = "there is no localedef with the sources of de_DE";

  // True if there is such a locale: not without localedef and the sources of package locales.
  bool made() const { return made_; }
  // Makes it that of a process which asks for the user's.
  bool set_environment() const {
    return setenv("LOCPATH", folder_.path().c_str(), 1) == 0 && setenv("LC_ALL", kName, 1) == 0;
  }

 private:
  bool make() const {
    return Process(folder_ / "", "localedef",
                   {"-i", "de_DE", "-f", "UTF-8", "./" + std::string(kName)})
               .wait()
               .code == 0;
  }

  const ScratchFolder folder_;
  const bool made_ = make();
};

}  // namespace gliss::test
