// Progress of condensing a region, and the time that it took.
#pragma once

#include <array>
#include <chrono>
#include <functional>
#include <utility>

namespace lobe {

enum class CondensingPhase { ordering, factor, interface };
inline constexpr std::array<const char*, 3> condensing_phases = {"ordering", "factor", "interface"};

class CondensingLog {
 public:
  using Progress = std::function<void(double fraction)>;

  explicit CondensingLog(Progress progress = {}) : progress_(std::move(progress)) {}

  template <class Function>
  auto time(CondensingPhase phase, const Function& function) {
    const auto start = std::chrono::steady_clock::now();
    auto result = function();
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    seconds_[static_cast<std::size_t>(phase)] += taken.count();
    if (progress_) progress_(double(static_cast<int>(phase) + 1) / double(seconds_.size()));
    return result;
  }
  const std::array<double, 3>& seconds() const { return seconds_; }  // per phase

 private:
  Progress progress_;
  std::array<double, 3> seconds_{};
};

}  // namespace lobe
