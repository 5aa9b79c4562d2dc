// What has been done to the mesh and the regions of a world, in order. Copies share the commands: a
// checkpoint takes a pointer per command, and does not see what comes later.
#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

#include "lobe/sim/command.h"

namespace lobe {

class History {
 public:
  std::size_t size() const { return commands_.size(); }
  bool empty() const { return commands_.empty(); }
  const Command& operator[](std::size_t i) const { return *commands_[i]; }
  const Command& front() const { return *commands_.front(); }

  void push_back(Command command) { commands_.push_back(share(std::move(command))); }
  // A later command has replaced the effect of this one. The commands that follow keep their numbers.
  void supersede(std::size_t i) {
    static const Shared superseded = share(Superseded{});
    commands_[i] = superseded;
  }

  friend bool operator==(const History& a, const History& b) {
    return std::equal(a.commands_.begin(), a.commands_.end(), b.commands_.begin(), b.commands_.end(),
                      [](const Shared& x, const Shared& y) { return x == y || *x == *y; });
  }

 private:
  using Shared = std::shared_ptr<const Command>;
  static Shared share(Command command) { return std::make_shared<const Command>(std::move(command)); }

  std::vector<Shared> commands_;

 public:
  class Iterator {
   public:
    using iterator_category = std::forward_iterator_tag;
    using value_type = Command;
    using difference_type = std::ptrdiff_t;
    using pointer = const Command*;
    using reference = const Command&;

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
  Iterator begin() const { return Iterator(commands_.begin()); }
  Iterator end() const { return Iterator(commands_.end()); }

  bool is_valid() const {
    return std::none_of(commands_.begin(), commands_.end(), [](const Shared& x) { return !x; });
  }
  static constexpr auto fields = std::tuple(&History::commands_);
};

// What a world was built from, and what has been done since.
struct Journal {
  std::uint64_t setup = 0;  // fingerprint() of all that it was built from (checkpoint.h)
  History edits;            // BeginCondensing and EndCondensing are Superseded, except the last ones
};

}  // namespace lobe
