#include "child.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>

namespace lobe::view {
namespace {

constexpr std::size_t most_said = 65536;  // [bytes]
constexpr int not_found = 127;            // as a shell says of a program that is not there

// After fork() in a program with threads: only calls that are safe in a signal handler.
[[noreturn]] void become(char* const* arguments, char* const* variables, int output) {
  ::setpgid(0, 0);
  const int null = ::open("/dev/null", O_RDONLY);
  if (null < 0 || ::dup2(null, 0) < 0 || ::dup2(output, 1) < 0 || ::dup2(output, 2) < 0) ::_exit(not_found);
  ::close_range(3, ~0u, 0);
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) ::signal(number, SIG_DFL);
  ::execvpe(arguments[0], arguments, variables);
  ::_exit(not_found);
}

// For exec: it ends with a null.
std::vector<char*> pointers_to(const std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (const std::string& text : texts) pointers.push_back(const_cast<char*>(text.c_str()));
  pointers.push_back(nullptr);
  return pointers;
}

std::vector<std::string> variables_with(const std::filesystem::path& temporary) {
  std::vector<std::string> variables;
  for (char** variable = environ; *variable; ++variable)
    if (temporary.empty() || !std::string_view(*variable).starts_with("TMPDIR="))
      variables.emplace_back(*variable);
  if (!temporary.empty()) variables.push_back("TMPDIR=" + temporary.string());
  return variables;
}

int wait_for(pid_t process) {
  int status = 0;
  while (::waitpid(process, &status, 0) < 0)
    if (errno != EINTR) return not_found;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

int Child::run(const std::vector<std::string>& arguments, const std::filesystem::path& temporary) {
  const std::vector<std::string> variables = variables_with(temporary);
  const std::vector<char*> words = pointers_to(arguments), environment = pointers_to(variables);
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return not_found;
  pid_t process = -1;
  {
    const std::lock_guard lock(mutex_);
    if (!was_stopped_) process = ::fork();
    if (process == 0) become(words.data(), environment.data(), ends[1]);
    if (process > 0) ::setpgid(process, process);  // whoever of both comes first
    if (process > 0) process_ = process;
  }
  ::close(ends[1]);
  if (process > 0) listen(ends[0]);
  ::close(ends[0]);
  if (process < 0) return not_found;
  // Its number is its own until it has been waited for; then stop() must not use it.
  siginfo_t ended{};
  while (::waitid(P_PID, id_t(process), &ended, WEXITED | WNOWAIT) < 0 && errno == EINTR) {
  }
  const std::lock_guard lock(mutex_);
  process_ = 0;
  return wait_for(process);
}

void Child::listen(int output) {
  char bytes[4096];
  for (ssize_t size; (size = ::read(output, bytes, sizeof bytes)) != 0;) {
    if (size < 0 && errno == EINTR) continue;
    if (size < 0) return;
    const std::lock_guard lock(mutex_);
    said_.append(bytes, std::size_t(size));
    if (said_.size() > most_said) said_.erase(0, said_.size() - most_said);
  }
}

std::string Child::said() const {
  const std::lock_guard lock(mutex_);
  return said_;
}

void Child::stop() {
  const std::lock_guard lock(mutex_);
  was_stopped_ = true;
  if (process_ > 0) ::kill(-process_, SIGKILL);
}

bool Child::was_stopped() const {
  const std::lock_guard lock(mutex_);
  return was_stopped_;
}

}  // namespace lobe::view
