// A histogram of times in microseconds. One thread counts, any thread reads, without a lock.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>

namespace lobe {

class Histogram {
 public:
  static constexpr int buckets = 4096;  // buckets of 1 µs; the last has all that is longer

  void add(double seconds) {
    const double micro = std::clamp(1e6 * seconds, 0.0, 1e9);
    const int bucket = std::min(static_cast<int>(micro), buckets - 1);
    count_[std::size_t(bucket)].fetch_add(1, std::memory_order_relaxed);
    if (micro > longest_.load(std::memory_order_relaxed)) longest_.store(micro, std::memory_order_relaxed);
  }
  void clear() {
    for (auto& count : count_) count.store(0, std::memory_order_relaxed);
    longest_.store(0, std::memory_order_relaxed);
  }

  std::uint32_t operator[](int bucket) const {
    return count_[std::size_t(bucket)].load(std::memory_order_relaxed);
  }
  std::uint64_t total() const {
    std::uint64_t sum = 0;
    for (const auto& count : count_) sum += count.load(std::memory_order_relaxed);
    return sum;
  }
  double longest() const { return longest_.load(std::memory_order_relaxed); }  // [µs]
  // Upper end of the bucket below which this share of all lies [µs].
  double quantile(double share) const {
    const double wanted = share * double(total());
    double sum = 0;
    for (int bucket = 0; bucket < buckets; ++bucket)
      if ((sum += (*this)[bucket]) >= wanted) return std::min(double(bucket + 1), std::max(1.0, longest()));
    return longest();
  }

 private:
  std::array<std::atomic<std::uint32_t>, buckets> count_{};
  std::atomic<double> longest_{0};
};

}  // namespace lobe
