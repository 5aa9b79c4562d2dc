// What has been done to the mesh and the regions of a world, in order. Copies share the entries: a checkpoint
// takes a pointer per entry, and does not see what comes later.
#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

#include "lobe/organ/edit.h"

namespace lobe {

class History {
 public:
  std::size_t size() const { return entries_.size(); }
  bool empty() const { return entries_.empty(); }
  const JournalEntry& operator[](std::size_t i) const { return *entries_[i]; }
  const JournalEntry& front() const { return *entries_.front(); }

  void push_back(JournalEntry entry) { entries_.push_back(share(std::move(entry))); }
  // Says that a later entry has replaced the effect of this one. The entries that follow keep their numbers.
  void supersede(std::size_t i) {
    static const Shared superseded = share(Superseded{});
    entries_[i] = superseded;
  }

  friend bool operator==(const History& a, const History& b) {
    return std::equal(a.entries_.begin(), a.entries_.end(), b.entries_.begin(), b.entries_.end(),
                      [](const Shared& x, const Shared& y) { return x == y || *x == *y; });
  }

 private:
  using Shared = std::shared_ptr<const JournalEntry>;
  static Shared share(JournalEntry entry) { return std::make_shared<const JournalEntry>(std::move(entry)); }

  std::vector<Shared> entries_;

 public:
  class Iterator {
   public:
    using iterator_category = std::forward_iterator_tag;
    using value_type = JournalEntry;
    using difference_type = std::ptrdiff_t;
    using pointer = const JournalEntry*;
    using reference = const JournalEntry&;

    Iterator() = default;
    explicit Iterator(std::vector<Shared>::const_iterator at) : at_(at) {}
    reference operator*() const { return **at_; }
    pointer operator->() const { return at_->get(); }
    Iterator& operator++() {
      ++at_;
      return *this;
    }
    Iterator operator++(int) { return Iterator(at_++); }
    bool operator==(const Iterator&) const = default;

   private:
    std::vector<Shared>::const_iterator at_;
  };
  Iterator begin() const { return Iterator(entries_.begin()); }
  Iterator end() const { return Iterator(entries_.end()); }

  bool is_valid() const {
    return std::none_of(entries_.begin(), entries_.end(), [](const Shared& x) { return !x; });
  }
  static constexpr auto fields = std::tuple(&History::entries_);
};

// A digest of all that decides how a world moves: mesh, materials, regions, loads, tools …
std::uint64_t fingerprint(const Setup& setup);

// What a world was built from, and what has been done since.
struct Journal {
  std::uint64_t setup = 0;  // fingerprint() of the setup that it was built from
  History edits;            // BeginCondensing and EndCondensing are Superseded, except the last ones
};

}  // namespace lobe
