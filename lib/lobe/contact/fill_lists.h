#pragma once

#include <cstddef>
#include <vector>

namespace lobe {

// Makes a list of values per key, in the order in which `visit(add)` gives them by add(key, value). The list
// of a key is values[first[key]] … values[first[key + 1] − 1].
template <class Visit>
void fill_lists(std::size_t keys, std::vector<int>& first, std::vector<int>& values, Visit&& visit) {
  first.assign(keys + 1, 0);
  visit([&](std::size_t key, int) { ++first[key + 1]; });
  for (std::size_t i = 0; i < keys; ++i) first[i + 1] += first[i];
  values.resize(std::size_t(first[keys]));
  std::vector<int> at(first.begin(), first.end() - 1);
  visit([&](std::size_t key, int value) { values[std::size_t(at[key]++)] = value; });
}

}  // namespace lobe
