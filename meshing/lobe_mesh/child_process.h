// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace lobe::meshing {

struct ChildLimits {
  double seconds = 600;  // wall clock and processor time
  double memory_bytes = 8e9;
};

struct ChildResult {
  enum class End { normal, timed_out, killed, not_started } end = End::normal;
  int status = 0;          // exit status, or the signal that killed it
  int process = 0;         // its number
  double cpu_seconds = 0;  // user time of it and its children
  double peak_bytes = 0;   // memory of the largest of them
  std::string in_words() const;
};

// Runs a program to its end. Its output is thrown away; its errors may go to a file. If it crashes, the
// result says so.
ChildResult run_child(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                      const ChildLimits& limits, const std::filesystem::path& errors = "/dev/null");

// Runs `work` in a copy of this process, which must have one thread, and waits for its end. Calls `meanwhile`
// every 20 ms. A crash ends the copy only. SIGINT, SIGTERM and SIGHUP to this process are passed on to the
// copy, unless they were ignored. They end it, and all that it has started.
ChildResult run_contained(const std::function<int()>& work, double memory_bytes,
                          const std::function<void()>& meanwhile);

// A program that belongs to this one: beside the running program, else on the PATH. Empty if not found.
std::filesystem::path find_program(const std::string& name);

// A private folder below the system's temporary one, removed with everything in it.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace lobe::meshing
