// An X server to draw on, which shows nothing. Debian's VTK draws through X only.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>

namespace picture {

// Starts Xvfb on a free display and points DISPLAY and XAUTHORITY at it. Only who has its key may connect. It
// ends with this object, at the latest with the process. Where Xvfb is not installed, the display that
// DISPLAY names is used. Throws std::runtime_error if there is none.
class Display {
 public:
  Display();
  ~Display();
  Display(const Display&) = delete;
  Display& operator=(const Display&) = delete;

 private:
  bool start();
  void stop_server();
  void stop();
  std::string said() const;

  std::filesystem::path folder_;  // of the key, and of what the server says
  pid_t server_ = 0;
};

}  // namespace picture
