#include "console.h"

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

}  // namespace lobe::program
