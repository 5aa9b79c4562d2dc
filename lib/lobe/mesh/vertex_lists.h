// One short list per vertex, all in one array. To append or erase an item costs O(1). A list that outgrows
// its place moves to one that another list has left, or to the end of the array.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "lobe/types.h"

namespace lobe {

template <class Item>
class VertexLists {
 public:
  VertexLists() = default;

  // Makes empty lists with room for the given lengths, so that filling them moves nothing. There is room for
  // a quarter more, for the vertices that cuts add. Until it is touched, it takes no memory.
  explicit VertexLists(const std::vector<Index>& lengths) {
    const std::size_t vertices = lengths.size() + lengths.size() / 4;
    begin_.reserve(vertices);
    count_.reserve(vertices);
    capacity_.reserve(vertices);
    std::uint32_t total = 0;
    for (Index length : lengths) {
      begin_.push_back(total);
      total += static_cast<std::uint32_t>(length);
    }
    count_.assign(lengths.size(), 0);
    capacity_ = lengths;
    items_.reserve(total + total / 4);
    items_.resize(total);
  }

  Index vertex_count() const { return static_cast<Index>(count_.size()); }
  std::span<const Item> operator[](Index v) const {
    return {items_.data() + begin_[v], std::size_t(count_[v])};
  }
  std::span<Item> operator[](Index v) { return {items_.data() + begin_[v], std::size_t(count_[v])}; }

  // All lists as they lie in memory, with what is left of their former places, for prefetching.
  std::span<const Item> items() const { return items_; }

  void add_vertex() {
    begin_.push_back(end());
    count_.push_back(0);
    capacity_.push_back(0);
  }

  void append(Index v, const Item& item) {
    if (count_[v] == capacity_[v]) grow(v);
    items_[begin_[v] + std::size_t(count_[v]++)] = item;
  }

  // The last item takes the erased one's place.
  void erase(Index v, const Item* item) {
    std::span<Item> list = (*this)[v];
    list[std::size_t(item - list.data())] = list.back();
    --count_[v];
  }

  void erase_value(Index v, const Item& value) {
    const std::span<Item> list = (*this)[v];
    const auto found = std::find(list.begin(), list.end(), value);
    if (found != list.end()) erase(v, &*found);
  }

  // A list that does not fit takes a place of exactly its size.
  void assign(Index v, std::span<const Item> list) {
    if (const auto size = static_cast<Index>(list.size()); size > capacity_[v]) {
      leave_place(v);
      begin_[v] = place_of(size);
      capacity_[v] = size;
    }
    count_[v] = static_cast<Index>(list.size());
    std::copy(list.begin(), list.end(), (*this)[v].begin());
  }

  void clear(Index v) { count_[v] = 0; }

 private:
  std::uint32_t end() const { return static_cast<std::uint32_t>(items_.size()); }
  void grow(Index v) {
    const Index capacity = std::max<Index>(4, capacity_[v] + (capacity_[v] + 1) / 2);
    const std::uint32_t begin = place_of(capacity);
    std::copy_n(items_.begin() + std::ptrdiff_t(begin_[v]), count_[v],
                items_.begin() + std::ptrdiff_t(begin));
    leave_place(v);
    begin_[v] = begin;
    capacity_[v] = capacity;
  }

  // The smallest place that a list has left and that is large enough. What is left of it is another. If there
  // is none, a place at the end of the array.
  std::uint32_t place_of(Index capacity) {
    for (auto size = std::size_t(capacity); size < left_.size(); ++size) {
      if (left_[size].empty()) continue;
      const std::uint32_t begin = left_[size].back();
      left_[size].pop_back();
      leave_place(begin + std::uint32_t(capacity), Index(size) - capacity);
      return begin;
    }
    const std::uint32_t begin = end();
    items_.resize(begin + std::size_t(capacity));
    return begin;
  }

  void leave_place(Index v) { leave_place(begin_[v], capacity_[v]); }
  void leave_place(std::uint32_t begin, Index capacity) {
    constexpr Index least = 4, most = 256;  // others are forgotten
    if (capacity < least || capacity > most) return;
    if (left_.size() <= std::size_t(capacity)) left_.resize(std::size_t(capacity) + 1);
    left_[std::size_t(capacity)].push_back(begin);
  }

  std::vector<std::uint32_t> begin_;
  std::vector<Index> count_, capacity_;
  std::vector<Item> items_;
  std::vector<std::vector<std::uint32_t>> left_;  // places that no list uses any more, by their capacity
};

}  // namespace lobe
