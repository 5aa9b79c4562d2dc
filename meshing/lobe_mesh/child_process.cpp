// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/child_process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <thread>

#include "lobe_mesh/errors.h"

namespace lobe::meshing {
namespace {

// After fork(): only calls that are safe there.
[[noreturn]] void become(char* const* arguments, const ChildLimits& limits) {
  const auto limit = [](auto resource, double value) {
    const rlimit both{static_cast<rlim_t>(value), static_cast<rlim_t>(value)};
    setrlimit(resource, &both);
  };
#ifndef __SANITIZE_ADDRESS__  // reserves terabytes of addresses
  limit(RLIMIT_AS, limits.memory_bytes);
#endif
  limit(RLIMIT_CPU, std::ceil(limits.seconds) + 1);
  limit(RLIMIT_CORE, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // never outlives this program
  const int nothing = open("/dev/null", O_RDWR);
  for (int stream = 0; stream < 3; ++stream) dup2(nothing, stream);
  execv(arguments[0], arguments);
  _exit(127);
}

ChildResult wait_for(pid_t child, double seconds) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  int status = 0;
  for (auto pause = std::chrono::microseconds(200);;
       pause = std::min(2 * pause, std::chrono::microseconds(20000))) {
    const pid_t done = waitpid(child, &status, WNOHANG);
    if (done == child) break;
    if (Clock::now() > end) {
      kill(child, SIGKILL);
      waitpid(child, &status, 0);
      return {ChildResult::End::timed_out, 0};
    }
    std::this_thread::sleep_for(pause);
  }
  if (WIFSIGNALED(status)) return {ChildResult::End::killed, WTERMSIG(status)};
  if (WEXITSTATUS(status) == 127) return {ChildResult::End::not_started, 127};
  return {ChildResult::End::normal, WEXITSTATUS(status)};
}

}  // namespace

std::string ChildResult::in_words() const {
  if (end == End::timed_out) return "ran out of time";
  if (end == End::not_started) return "could not be started";
  if (end == End::killed)
    return status == SIGXCPU ? "ran out of time" : std::string("crashed (") + strsignal(status) + ")";
  return "ended with status " + std::to_string(status);
}

ChildResult run_child(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                      const ChildLimits& limits) {
  std::vector<std::string> words{program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const pid_t child = fork();
  if (child < 0) return {ChildResult::End::not_started, 0};
  if (child == 0) become(pointers.data(), limits);
  return wait_for(child, limits.seconds);
}

std::filesystem::path find_program(const std::string& name) {
  std::error_code error;
  const auto usable = [](const std::filesystem::path& file) { return access(file.c_str(), X_OK) == 0; };
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  if (!error && usable(self.parent_path() / name)) return self.parent_path() / name;
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (!folder.empty() && usable(std::filesystem::path(folder) / name))
      return std::filesystem::path(folder) / name;
  }
  return {};
}

TemporaryFolder::TemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "lobe-mesh-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw MeshingFailure("cannot create a temporary folder " + name);
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace lobe::meshing
