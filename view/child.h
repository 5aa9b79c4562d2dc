// A program that is started for a task and may be stopped, with those that it has started. What it says is
// kept.
#pragma once

#include <filesystem>
#include <mutex>
#include <string>
#include <vector>

namespace lobe::view {

class Child {
 public:
  Child() = default;
  ~Child() { stop(); }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  // Starts it, and waits for its end. Its status as a shell tells it: 127 where there is no such program, 128
  // and the signal that ended it. Call it once; that after stop() starts nothing. What it has in temporary
  // files is in that folder; empty: where the system has them.
  int run(const std::vector<std::string>& arguments, const std::filesystem::path& temporary = {});
  // All that it has said, on both of its outputs: at most the last 64 KiB. Any thread.
  std::string said() const;
  // Ends it, and those that it has started. Any thread.
  void stop();
  bool was_stopped() const;

 private:
  void listen(int output);

  mutable std::mutex mutex_;
  int process_ = 0;  // its number, which is also that of its group; 0: it does not run
  bool was_stopped_ = false;
  std::string said_;
};

}  // namespace lobe::view
