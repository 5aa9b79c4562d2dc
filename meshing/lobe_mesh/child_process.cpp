// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/child_process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <thread>

#include "lobe_mesh/errors.h"

namespace lobe::meshing {
namespace {

template <class Resource>
void limit(Resource resource, double value) {
  const rlimit both{static_cast<rlim_t>(value), static_cast<rlim_t>(value)};
  setrlimit(resource, &both);
}

// After fork(): only calls that are safe there.
void restrict_child([[maybe_unused]] double memory_bytes) {
#ifndef LOBE_SANITIZED  // reserves terabytes of addresses
  limit(RLIMIT_AS, memory_bytes);
#endif
  limit(RLIMIT_CORE, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // never outlives this program
}

[[noreturn]] void become(char* const* arguments, const ChildLimits& limits, const char* errors) {
  restrict_child(limits.memory_bytes);
  limit(RLIMIT_CPU, std::ceil(limits.seconds) + 1);
  const int nothing = open("/dev/null", O_RDWR), kept = open(errors, O_WRONLY | O_CREAT | O_TRUNC, 0600);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO}) dup2(nothing, stream);
  dup2(kept, STDERR_FILENO);
  execv(arguments[0], arguments);
  _exit(127);
}

ChildResult ended(pid_t child, int status, const rusage& used) {
  ChildResult result{ChildResult::End::normal, 0, child, 0, 0};
  result.cpu_seconds =
      static_cast<double>(used.ru_utime.tv_sec) + 1e-6 * static_cast<double>(used.ru_utime.tv_usec);
  result.peak_bytes = 1024.0 * static_cast<double>(used.ru_maxrss);
  if (WIFSIGNALED(status)) {
    result.end = ChildResult::End::killed;
    result.status = WTERMSIG(status);
  } else {
    result.status = WEXITSTATUS(status);
    if (result.status == 127) result.end = ChildResult::End::not_started;
  }
  return result;
}

ChildResult wait_for(pid_t child, double seconds, const std::function<void()>& meanwhile) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  int status = 0;
  rusage used{};
  for (auto pause = std::chrono::microseconds(200);;
       pause = std::min(2 * pause, std::chrono::microseconds(20000))) {
    if (wait4(child, &status, WNOHANG, &used) == child) return ended(child, status, used);
    if (Clock::now() > end) {
      kill(child, SIGKILL);
      wait4(child, &status, 0, &used);
      ChildResult result = ended(child, status, used);
      result.end = ChildResult::End::timed_out;
      return result;
    }
    meanwhile();
    std::this_thread::sleep_for(pause);
  }
}

volatile sig_atomic_t contained_child = 0;

void hand_on(int signal) {
  if (contained_child > 0) kill(contained_child, signal);
}

// While it lives, signals that would end this process end the contained one instead. Signals that are
// ignored, as under nohup, stay ignored.
class HandOn {
 public:
  HandOn() {
    for (std::size_t i = 0; i < std::size(signals); ++i) {
      struct sigaction action = {};
      action.sa_handler = hand_on;
      sigaction(signals[i], nullptr, &old_[i]);
      if (old_[i].sa_handler != SIG_IGN) sigaction(signals[i], &action, nullptr);
    }
  }
  ~HandOn() {
    for (std::size_t i = 0; i < std::size(signals); ++i) sigaction(signals[i], &old_[i], nullptr);
  }

 private:
  static constexpr int signals[] = {SIGINT, SIGTERM, SIGHUP};
  struct sigaction old_[std::size(signals)] = {};
};

}  // namespace

std::string ChildResult::in_words() const {
  if (end == End::timed_out) return "ran out of time";
  if (end == End::not_started) return "could not be started";
  if (end == End::killed)
    return status == SIGXCPU ? "ran out of time" : std::string("crashed (") + strsignal(status) + ")";
  return "ended with status " + std::to_string(status);
}

ChildResult run_child(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                      const ChildLimits& limits, const std::filesystem::path& errors) {
  std::vector<std::string> words{program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const pid_t child = fork();
  if (child < 0) return {ChildResult::End::not_started, 0, 0, 0, 0};
  if (child == 0) become(pointers.data(), limits, errors.c_str());
  return wait_for(child, limits.seconds, [] {});
}

ChildResult run_contained(const std::function<int()>& work, double memory_bytes,
                          const std::function<void()>& meanwhile) {
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child < 0) return {ChildResult::End::not_started, 0, 0, 0, 0};
  if (child == 0) {
    setpgid(0, 0);
    signal(SIGTTOU, SIG_IGN);  // may write to the terminal all the same
    restrict_child(memory_bytes);
    std::exit(work());
  }
  setpgid(child, child);  // both do, so that it is done whoever comes first
  contained_child = child;
  const HandOn signals;
  const ChildResult result = wait_for(child, 1e9, meanwhile);  // it limits its time itself
  contained_child = 0;
  if (result.end == ChildResult::End::killed) kill(-child, SIGKILL);
  return result;
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
