// Finds the largest of many numbers of which some change now and then.
#pragma once

#include <algorithm>
#include <vector>

#include "lobe/types.h"

namespace lobe {

// A binary tree of maxima, root first: a change costs O(log n).
class Tournament {
 public:
  // Takes n numbers ≥ 0, with room for a quarter more.
  template <class Number>
  void assign(Index n, Number&& number) {
    for (leaves_ = 1; leaves_ < n + n / 4;) leaves_ *= 2;
    nodes_.assign(std::size_t(2 * leaves_), 0);
    for (Index i = 0; i < n; ++i) nodes_[leaves_ + i] = number(i);
    for (Index i = leaves_ - 1; i > 0; --i) nodes_[i] = std::max(nodes_[2 * i], nodes_[2 * i + 1]);
  }

  void set(Index i, double number) {
    if (i >= leaves_) {
      const std::vector<double> before(nodes_.begin() + leaves_, nodes_.end());
      assign(i + 1, [&](Index j) { return j < Index(before.size()) ? before[j] : 0; });
    }
    Index node = leaves_ + i;
    nodes_[node] = number;
    for (node /= 2; node > 0; node /= 2) {
      const double larger = std::max(nodes_[2 * node], nodes_[2 * node + 1]);
      if (nodes_[node] == larger) return;
      nodes_[node] = larger;
    }
  }

  double operator[](Index i) const { return nodes_[leaves_ + i]; }
  double largest() const { return nodes_[1]; }
  Index winner() const {  // the first of the largest
    Index node = 1;
    while (node < leaves_) node = 2 * node + (nodes_[2 * node] < nodes_[node]);
    return node - leaves_;
  }

 private:
  Index leaves_ = 1;  // a power of two
  std::vector<double> nodes_{0, 0};
};

}  // namespace lobe
