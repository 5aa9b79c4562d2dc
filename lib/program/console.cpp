#include "console.h"

#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <sstream>

namespace lobe::program {

void print_errors(const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) std::fprintf(stderr, "lobe: error: %s\n", line.c_str());
}

void print_warnings(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) std::fprintf(stderr, "lobe: warning: %s\n", warning.c_str());
}

ProgressBar::ProgressBar(std::string what) : what_(std::move(what)), terminal_(isatty(STDERR_FILENO) != 0) {}

ProgressBar::~ProgressBar() {
  if (shown_ >= 0) std::fputc('\n', stderr);
}

void ProgressBar::show(double fraction) {
  constexpr int width = 40;
  const int percent = static_cast<int>(100 * fraction);
  if (!terminal_ || percent == shown_) return;
  shown_ = percent;
  const int filled = width * percent / 100;
  std::fprintf(stderr, "\r%s [%s%s] %3d %%", what_.c_str(), std::string(std::size_t(filled), '#').c_str(),
               std::string(std::size_t(width - filled), ' ').c_str(), percent);
  std::fflush(stderr);
}

std::filesystem::path sibling(const std::string& program) {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::filesystem::path beside = self.parent_path() / program;
  return !error && std::filesystem::exists(beside, error) ? beside : std::filesystem::path(program);
}

void become_program(const std::vector<std::string>& arguments) {
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  std::fflush(nullptr);
  execvp(argv[0], argv.data());
}

int run_program(const std::vector<std::string>& arguments) {
  std::fflush(nullptr);  // else the child says it again
  const pid_t child = fork();
  if (child < 0) return 127;
  if (child == 0) {
    become_program(arguments);
    _exit(127);
  }
  int status = 0;
  if (waitpid(child, &status, 0) < 0) return 127;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace lobe::program
