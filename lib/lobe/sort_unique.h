// A list as a set: sorted, each item once.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

#include "lobe/types.h"

namespace lobe {

template <class T>
void sort_unique(std::vector<T>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

// Makes a set of numbers ≥ 0. Where they lie close together, a bit is set for each: faster than sorting.
inline void sort_unique(std::vector<Index>& list) {
  constexpr std::size_t few = 64,
                        sparse = 64;  // words of 64 bits: as many per number cost as much as sorting
  if (list.size() < few) return sort_unique<Index>(list);
  const auto [least, most] = std::minmax_element(list.begin(), list.end());
  const Index first = *least;
  const std::size_t words = std::size_t(*most - first) / 64 + 1;
  if (words * 64 > sparse * 64 * list.size()) return sort_unique<Index>(list);
  std::vector<std::uint64_t> bits(words, 0);
  for (Index i : list) bits[std::size_t(i - first) / 64] |= std::uint64_t(1) << (i - first) % 64;
  list.clear();
  for (std::size_t w = 0; w < words; ++w)
    for (std::uint64_t left = bits[w]; left != 0; left &= left - 1)
      list.push_back(first + static_cast<Index>(64 * w) + std::countr_zero(left));
}

}  // namespace lobe
