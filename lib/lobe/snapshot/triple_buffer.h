// Hands whole values from one thread that writes to any number of threads that read, without a lock: a reader
// always gets the latest value that is complete, and the writer never waits.
//
// The value that a reader looks at is never written to. With one reader this is the triple buffer: one slot
// that is being read, one that is complete, one that is being written. Each further view that is held at the
// same time needs one more slot.
//
// Reading and publishing take a bounded number of atomic operations, whatever the other threads do. One word
// says which slot is the latest and how often it has been taken. So a reader finds the slot and registers
// itself in one operation.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <utility>

#include "lobe/assert.h"

namespace lobe {

template <class T>
class TripleBuffer {
  struct Slots;

 public:
  // `views`: how many views all readers together may hold while a slot is still left to write into. Slots
  // that are not needed hold an empty T.
  explicit TripleBuffer(int views = 4)
      : slots_(std::make_shared<Slots>(static_cast<std::uint32_t>(views) + 2)) {}
  TripleBuffer(const TripleBuffer&) = delete;
  TripleBuffer& operator=(const TripleBuffer&) = delete;

  // ---- The thread that writes.

  // The slot to write the next value into. It holds an older value, whose storage can be used again. All
  // calls before publish() give the same slot. Null if readers hold more views than were planned for; then
  // leave this value out. O(#slots).
  T* writable() {
    for (std::uint32_t i = 0; i < slots_->count && writing_ == none; ++i)
      if (i != published_ && slots_->slot[i].holders.load(std::memory_order_acquire) == 0) writing_ = i;
    return writing_ == none ? nullptr : &slots_->slot[writing_].value;
  }

  // Makes the value of the last writable() the latest one. Call it only after writable().
  void publish() {
    lobe_assert(writing_ != none, "publish() without writable()");
    const std::uint64_t before = slots_->latest.exchange(writing_, std::memory_order_acq_rel);
    // Views of the former value were counted in `latest` when they were taken, and in `holders` when they
    // were given back. The sum of both is the number of views that still hold it.
    if (published_ != none)
      slots_->slot[published_].holders.fetch_add(std::uint32_t(before >> 32), std::memory_order_acq_rel);
    published_ = std::exchange(writing_, none);
  }

  // ---- Any thread.

  // A view keeps its value unchanged as long as the view lives, even after the buffer is gone.
  class View {
   public:
    View() = default;
    View(View&& other) noexcept : slots_(std::move(other.slots_)), index_(other.index_) {}
    View& operator=(View&& other) noexcept {
      std::swap(slots_, other.slots_);
      std::swap(index_, other.index_);
      return *this;
    }
    ~View() {
      if (slots_) slots_->slot[index_].holders.fetch_sub(1, std::memory_order_release);
    }

    explicit operator bool() const { return slots_ != nullptr; }
    const T& operator*() const { return slots_->slot[index_].value; }
    const T* operator->() const { return &**this; }

   private:
    friend class TripleBuffer;
    View(std::shared_ptr<Slots> slots, std::uint32_t index) : slots_(std::move(slots)), index_(index) {}

    std::shared_ptr<Slots> slots_;
    std::uint32_t index_ = none;
  };

  // Returns the latest value; empty before the first.
  View latest() const {
    const std::uint64_t found = slots_->latest.fetch_add(one_taken, std::memory_order_acquire);
    const std::uint32_t index = static_cast<std::uint32_t>(found);
    return index == none ? View() : View(slots_, index);
  }

 private:
  static constexpr std::uint32_t none = 0xffffffff;
  static constexpr std::uint64_t one_taken = std::uint64_t(1) << 32;
  static_assert(std::atomic<std::uint64_t>::is_always_lock_free);

  struct alignas(64) Slot {
    // Views given back, negative, while it is the latest; afterwards views that are still held. Modulo 2^32.
    std::atomic<std::uint32_t> holders{0};
    T value;
  };
  struct Slots {
    explicit Slots(std::uint32_t slots) : count(slots), slot(std::make_unique<Slot[]>(slots)) {}
    alignas(64) std::atomic<std::uint64_t> latest{none};  // times taken × 2^32 + slot
    alignas(64) const std::uint32_t count;
    const std::unique_ptr<Slot[]> slot;
  };

  const std::shared_ptr<Slots> slots_;
  std::uint32_t published_ = none, writing_ = none;  // the writer's own
};

}  // namespace lobe
