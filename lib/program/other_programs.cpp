// Other programs, where the system is POSIX.
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>

#include "console.h"

namespace lobe::program {

void take_utf8_arguments(int&, char**&) {}

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
