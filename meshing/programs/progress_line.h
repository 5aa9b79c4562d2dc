// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#pragma once

#include <chrono>
#include <string>

namespace lobe::meshing {

// One line on a terminal that says what a run is doing, how far it is, and since when. The process that works
// reports through a pipe; the one that waits for it draws, so that the clock goes on while a library is at
// work.
class ProgressLine {
 public:
  explicit ProgressLine(bool shown);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  // In the process that works; `done` from 0 to 1, negative if unknown.
  void report(const std::string& phase, double done);
  // In the process that waits, now and then.
  void draw();

 private:
  using Clock = std::chrono::steady_clock;

  bool shown_;
  int from_ = -1, to_ = -1;  // ends of the pipe
  Clock::time_point start_ = Clock::now(), last_report_ = {};
  std::string reported_, phase_, buffer_, drawn_;
  double done_ = -1;
};

// Erases the line before a message takes its place, if standard error is a terminal.
std::string line_eraser();

}  // namespace lobe::meshing
