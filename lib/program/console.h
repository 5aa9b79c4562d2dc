// What the commands share: exit statuses, one line per fault, a progress bar.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lobe::program {

enum Status { done = 0, ended_early = 1, bad_input = 2 };

// "lobe: error: …" for every line of text, on standard error.
void print_errors(const std::string& text);
void print_warnings(const std::vector<std::string>& warnings);

// A bar on standard error, only if that is a terminal.
class ProgressBar {
 public:
  explicit ProgressBar(std::string what);
  ~ProgressBar();
  void show(double fraction);

 private:
  std::string what_;
  bool terminal_;
  int shown_ = -1;
};

// The program of this name in the folder of the running one, or else on the PATH.
std::filesystem::path sibling(const std::string& program);

// Replaces the arguments of main() by the same in UTF-8, as which they come everywhere but on Windows. From
// then on the console there takes what is printed as UTF-8, too.
void take_utf8_arguments(int& argc, char**& argv);

// Runs a program to its end, without a shell. Returns its exit status, 127 if it could not be started, 128 +
// n if signal n ended it.
int run_program(const std::vector<std::string>& arguments);
// Replaces this program by another one, which then gets its signals. Returns only if that cannot be run. On
// Windows this program waits for the other one and ends with its status.
void become_program(const std::vector<std::string>& arguments);

}  // namespace lobe::program
