// Lists which slots of an array changed with which revision. A reader with an older copy of the array, such
// as a graphics card, then copies only these.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "lobe/types.h"

namespace lobe {

class SlotLog {
 public:
  // Says that everything has changed with this revision.
  void restart(std::uint64_t revision) {
    first_ = revision + 1;
    slots_.clear();
    begins_.clear();
  }

  // Begins the next revision. If more than about `limit` slots are listed, older revisions are dropped,
  // because it is then as cheap to copy the whole array.
  void next(std::size_t limit) {
    if (slots_.size() + begins_.size() > limit) restart(last());
    begins_.push_back(slots_.size());
  }

  void record(Index slot) { slots_.push_back(slot); }

  // Returns the slots that changed after this revision. A slot may be listed several times, or lie beyond the
  // end of an array that has become shorter. None if it is no longer known: then all may have changed. O(1).
  std::optional<std::span<const Index>> since(std::uint64_t revision) const {
    if (revision > last() || revision + 1 < first_) return std::nullopt;
    const std::uint64_t at = revision + 1 - first_;
    const std::size_t begin = at < begins_.size() ? begins_[at] : slots_.size();
    return std::span(slots_).subspan(begin);
  }

 private:
  std::uint64_t last() const { return first_ + begins_.size() - 1; }

  std::uint64_t first_ = 1;  // the revision whose slots begin at begins_[0]
  std::vector<std::size_t> begins_;
  std::vector<Index> slots_;
};

}  // namespace lobe
