// A page in the browser of whoever sits there.
#pragma once

#include <string>

namespace gliss::tools {

// Opens an address by xdg-open, and removes what it needed for that when it goes. An address with a
// secret goes by a file that nobody else can read: other users see the words of a command.
class BrowserWindow {
 public:
  // Throws Unavailable where there is no xdg-open; std::system_error where there is no room.
  explicit BrowserWindow(const std::string& url);
  ~BrowserWindow();
  BrowserWindow(const BrowserWindow&) = delete;
  BrowserWindow& operator=(const BrowserWindow&) = delete;

 private:
  std::string path_;
};

}  // namespace gliss::tools
