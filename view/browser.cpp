#include "browser.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>

namespace lobe::view {
namespace {

// After fork() in a program with threads: only calls that are safe in a signal handler.
[[noreturn]] void become_browser(const char* address) {
  constexpr int nothing = 127;  // as a shell says of a program that is not there
  const int null = ::open("/dev/null", O_RDWR);
  for (int standard = 0; standard < 3; ++standard)
    if (null < 0 || ::dup2(null, standard) < 0) ::_exit(nothing);
  ::close_range(3, ~0u, 0);
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) ::signal(number, SIG_DFL);
  ::execlp("xdg-open", "xdg-open", address, nullptr);
  ::_exit(nothing);
}

}  // namespace

// The first child ends at once, so that the second one belongs to init and is waited for there.
void open_browser(const std::string& address) {
  if (!std::getenv("DISPLAY") && !std::getenv("WAYLAND_DISPLAY")) return;
  const pid_t child = ::fork();
  if (child == 0) {
    ::setsid();
    if (::fork() == 0) become_browser(address.c_str());
    ::_exit(0);
  }
  while (child > 0 && ::waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
  }
}

}  // namespace lobe::view
