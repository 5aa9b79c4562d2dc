// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "progress_line.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <sstream>

namespace lobe::meshing {
namespace {

constexpr int bar_width = 30;
constexpr auto shortest_pause = std::chrono::milliseconds(50);  // between reports of one phase

std::string bar(double done) {
  const int full = static_cast<int>(std::lround(bar_width * std::clamp(done, 0.0, 1.0)));
  return "[" + std::string(full, '#') + std::string(bar_width - full, '.') + "]";
}

}  // namespace

ProgressLine::ProgressLine(bool shown) : shown_(shown) {
  int ends[2];
  if (!shown || pipe2(ends, O_CLOEXEC | O_NONBLOCK) != 0) {
    shown_ = false;
    return;
  }
  from_ = ends[0];
  to_ = ends[1];
}

ProgressLine::~ProgressLine() {
  if (!shown_) return;
  std::cerr << line_eraser() << std::flush;
  close(from_);
  close(to_);
}

void ProgressLine::report(const std::string& phase, double done) {
  const auto now = Clock::now();
  if (!shown_ || (phase == reported_ && now - last_report_ < shortest_pause)) return;
  reported_ = phase;
  last_report_ = now;
  const std::string line = std::to_string(done) + " " + phase + "\n";
  [[maybe_unused]] const auto written = write(to_, line.data(), line.size());  // a full pipe loses a report
}

void ProgressLine::draw() {
  if (!shown_) return;
  char bytes[4096];
  for (ssize_t count; (count = read(from_, bytes, sizeof bytes)) > 0;) buffer_.append(bytes, count);
  for (std::size_t end; (end = buffer_.find('\n')) != buffer_.npos; buffer_.erase(0, end + 1)) {
    std::istringstream line(buffer_.substr(0, end));
    line >> done_ >> std::ws;
    std::getline(line, phase_);
  }
  const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
  if (phase_.empty() || seconds < 0.3) return;  // nobody reads what is over at once
  const std::string line =
      phase_ + " " + (done_ < 0 ? "" : bar(done_) + " ") + std::to_string(std::lround(seconds)) + " s";
  if (line != drawn_) std::cerr << line_eraser() << line << std::flush;
  drawn_ = line;
}

std::string line_eraser() { return isatty(STDERR_FILENO) != 0 ? "\r\033[K" : ""; }

}  // namespace lobe::meshing
