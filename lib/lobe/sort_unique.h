// A list as a set: sorted, each item once.
#pragma once

#include <algorithm>
#include <vector>

namespace lobe {

template <class T>
void sort_unique(std::vector<T>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

}  // namespace lobe
