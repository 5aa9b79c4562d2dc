// A bounded queue without a lock, from one thread that puts to one that takes. Neither ever waits. A value
// that was not taken yet can be replaced by a newer one.
//
// Each place holds two values and one atomic word that says which of them counts, or that it was taken.
// Replacing writes to the other of the two and then exchanges the word, which fails if the value was taken
// meanwhile; so the two threads never touch the same value.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

namespace lobe {

template <class T>
class Ring {
 public:
  explicit Ring(std::uint32_t size) : size_(size), places_(std::make_unique<Place[]>(size)) {}  // ≥ 1
  Ring(const Ring&) = delete;
  Ring& operator=(const Ring&) = delete;

  std::uint32_t size() const { return size_; }

  // ---- The thread that puts.

  // Returns the number of the value, for replace(). Returns none if the ring is full.
  std::optional<std::uint64_t> put(T value) {
    const std::uint64_t number = put_.load(std::memory_order_relaxed);
    if (number - taken_.load(std::memory_order_acquire) == size_) return {};
    Place& place = places_[number % size_];
    place.values[0] = std::move(value);
    place.which.store(0, std::memory_order_relaxed);
    put_.store(number + 1, std::memory_order_release);
    return number;
  }

  // Returns false, and changes nothing, if the value was taken already. `number` is what put() returned for
  // one of the last size() values.
  bool replace(std::uint64_t number, T value) {
    Place& place = places_[number % size_];
    std::uint8_t which = place.which.load(std::memory_order_relaxed);
    if (which == taken) return false;
    const std::uint8_t other = 1 - which;
    place.values[other] = std::move(value);
    return place.which.compare_exchange_strong(which, other, std::memory_order_release,
                                               std::memory_order_relaxed);
  }

  // Whether `number` is that of one of the last size() values, as replace() needs it.
  bool is_recent(std::uint64_t number) const {
    return put_.load(std::memory_order_relaxed) - number <= size_;
  }

  // ---- The thread that takes.

  std::optional<T> take() {
    const std::uint64_t number = taken_.load(std::memory_order_relaxed);
    if (number == put_.load(std::memory_order_acquire)) return {};
    Place& place = places_[number % size_];
    const std::uint8_t which = place.which.exchange(taken, std::memory_order_acquire);
    std::optional<T> value(std::move(place.values[which]));
    taken_.store(number + 1, std::memory_order_release);
    return value;
  }

 private:
  static constexpr std::uint8_t taken = 2;
  struct Place {
    std::array<T, 2> values{};
    std::atomic<std::uint8_t> which{taken};  // number of the value that counts
  };

  const std::uint32_t size_;
  const std::unique_ptr<Place[]> places_;
  alignas(64) std::atomic<std::uint64_t> put_{0};    // values so far
  alignas(64) std::atomic<std::uint64_t> taken_{0};  // those taken so far
};

}  // namespace lobe
