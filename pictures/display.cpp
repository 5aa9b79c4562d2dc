#include "display.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <random>
#include <stdexcept>

namespace picture {
namespace {

constexpr int tries = 3;           // of a server that ends before it has a display
constexpr int patience = 300'000;  // for a server that says nothing [ms]
constexpr int not_installed = 127;

bool is_installed(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::string rest = path ? path : "";
  while (!rest.empty()) {
    const std::size_t end = rest.find(':');
    if (access((rest.substr(0, end) + "/" + program).c_str(), X_OK) == 0) return true;
    rest = end == std::string::npos ? "" : rest.substr(end + 1);
  }
  return false;
}

// One entry of an Xauthority file, for any display: family, address, display, name and key, each with its
// length in two bytes, the higher one first.
void write_key(const std::filesystem::path& file) {
  constexpr std::string_view name = "MIT-MAGIC-COOKIE-1";
  std::array<char, 16> key{};
  std::random_device random;
  for (char& byte : key) byte = static_cast<char>(random());
  std::ofstream out(file, std::ios::binary);
  const auto put = [&](std::string_view text) {
    out << static_cast<char>(text.size() >> 8) << static_cast<char>(text.size()) << text;
  };
  out << "\xff\xff";  // the family of any host
  for (const std::string_view text : {std::string_view(), std::string_view(), name}) put(text);
  put({key.data(), key.size()});
  if (!out.flush()) throw std::runtime_error(file.string() + ": cannot be written");
}

// The server's own folder of sockets, which it does not make unless it is root's.
void make_folder_of_sockets() {
  const char* folder = "/tmp/.X11-unix";
  if (mkdir(folder, 01777) == 0) chmod(folder, 01777);
}

[[noreturn]] void become_server(int number_to, pid_t parent, const std::filesystem::path& folder) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(1);  // which has ended already
  setpgid(0, 0);                      // Ctrl+C ends who draws first
  const std::string key = folder / "key", number = std::to_string(number_to);
  const int said = open((folder / "said").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  dup2(said, STDOUT_FILENO);
  dup2(said, STDERR_FILENO);
  execlp("Xvfb", "Xvfb", "-displayfd", number.c_str(), "-auth", key.c_str(), "-screen", "0", "1280x1024x24",
         "-nolisten", "tcp", "-noreset", nullptr);
  _exit(not_installed);
}

// The line that the server writes when it is ready: the number of its display. Empty if it ends before.
std::string read_line(int from) {
  std::string line;
  char byte = 0;
  pollfd ready{from, POLLIN, 0};
  while (poll(&ready, 1, patience) != 0) {
    const ssize_t got = read(from, &byte, 1);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return "";
    if (byte == '\n') return line;
    line += byte;
  }
  return "";
}

}  // namespace

Display::Display() {
  if (!is_installed("Xvfb")) {
    const char* display = std::getenv("DISPLAY");
    if (display && *display) return;
    throw std::runtime_error("there is no X server to draw on: install Xvfb (Debian's package xvfb)");
  }
  std::string folder = (std::filesystem::temp_directory_path() / "lobe-picture-XXXXXX").string();
  if (!mkdtemp(folder.data())) throw std::runtime_error(folder + ": cannot be made");
  folder_ = folder;
  try {
    write_key(folder_ / "key");
    make_folder_of_sockets();
    for (int i = 0; i < tries; ++i)
      if (start()) return;
    throw std::runtime_error("the X server Xvfb does not start" + said());
  } catch (...) {
    stop();
    throw;
  }
}

Display::~Display() { stop(); }

bool Display::start() {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("no pipe to Xvfb");
  const pid_t parent = getpid();
  server_ = fork();
  if (server_ == 0) {
    fcntl(ends[1], F_SETFD, 0);  // this end stays open in the server
    become_server(ends[1], parent, folder_);
  }
  close(ends[1]);
  const std::string number = server_ > 0 ? read_line(ends[0]) : "";
  close(ends[0]);
  if (number.empty()) {
    stop_server();
    return false;
  }
  setenv("DISPLAY", (":" + number).c_str(), 1);
  setenv("XAUTHORITY", (folder_ / "key").c_str(), 1);
  return true;
}

void Display::stop_server() {
  if (server_ <= 0) return;
  kill(server_, SIGTERM);
  while (waitpid(server_, nullptr, 0) < 0 && errno == EINTR) {
  }
  server_ = 0;
}

void Display::stop() {
  stop_server();
  std::error_code ignored;
  if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
}

// The last line of what the server said.
std::string Display::said() const {
  std::ifstream in(folder_ / "said");
  std::string last;
  for (std::string line; std::getline(in, line);)
    if (line.find_first_not_of(" \t") != std::string::npos) last = line;
  return last.empty() ? "" : ": " + last;
}

}  // namespace picture
