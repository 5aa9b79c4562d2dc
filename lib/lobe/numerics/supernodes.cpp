#include "lobe/numerics/supernodes.h"

#include <algorithm>
#include <numeric>

#include "lobe/numerics/fill_ordering.h"
#include "lobe/sort_unique.h"

namespace lobe {
namespace {

using Lists = std::vector<std::vector<int>>;

// The neighbours of each component, itself included.
Lists neighbours_of(const Eigen::SparseMatrix<double>& A) {
  Lists neighbours(std::size_t(A.cols()));
  for (Eigen::Index j = 0; j < A.cols(); ++j)
    for (Eigen::SparseMatrix<double>::InnerIterator entry(A, j); entry; ++entry) {
      neighbours[std::size_t(j)].push_back(static_cast<int>(entry.row()));
      neighbours[std::size_t(entry.row())].push_back(static_cast<int>(j));
    }
  for (std::vector<int>& list : neighbours) sort_unique(list);
  return neighbours;
}

// Groups of consecutive components with the same neighbours, and which groups are neighbours.
struct Groups {
  std::vector<int> first = {0};  // component of each group, and the end
  Lists neighbours;              // of each group, without itself
};
Groups find_groups(const Eigen::SparseMatrix<double>& A) {
  const Lists neighbours = neighbours_of(A);
  Groups groups;
  std::vector<int> group_of(neighbours.size());
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    if (i > 0 && neighbours[i] != neighbours[i - 1]) groups.first.push_back(static_cast<int>(i));
    group_of[i] = static_cast<int>(groups.first.size()) - 1;
  }
  if (!neighbours.empty()) groups.first.push_back(static_cast<int>(neighbours.size()));
  for (std::size_t g = 0; g + 1 < groups.first.size(); ++g) {
    std::vector<int>& list = groups.neighbours.emplace_back();
    for (int i : neighbours[std::size_t(groups.first[g])])
      if (group_of[std::size_t(i)] != static_cast<int>(g)) list.push_back(group_of[std::size_t(i)]);
    sort_unique(list);
  }
  return groups;
}

std::vector<int> ordered(const Lists& neighbours) {  // the groups, so that the factor has few entries
  const auto count = static_cast<int>(neighbours.size());
  std::vector<int> order(neighbours.size());
  std::iota(order.begin(), order.end(), 0);
  if (count < 2) return order;
  std::vector<Eigen::Triplet<double>> entries;
  for (int g = 0; g < count; ++g) {
    entries.emplace_back(g, g, 1.0);
    for (int h : neighbours[std::size_t(g)]) entries.emplace_back(h, g, 1.0);
  }
  Eigen::SparseMatrix<double> pattern(count, count);
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> places;
  {
    const auto lock = lock_fill_ordering();
    FillOrdering()(pattern, places);
  }
  std::copy_n(places.indices().data(), count, order.begin());
  return order;
}

// The elimination tree (J. W. H. Liu, The role of elimination trees in sparse factorization, 1990), in the
// given order.
std::vector<int> elimination_tree(const Lists& neighbours, const std::vector<int>& order,
                                  const std::vector<int>& place) {
  std::vector<int> parent(order.size(), -1), ancestor(order.size(), -1);
  for (int j = 0; j < static_cast<int>(order.size()); ++j)
    for (int h : neighbours[std::size_t(order[std::size_t(j)])]) {
      int i = place[std::size_t(h)];
      while (i >= 0 && i < j) {
        const int next = ancestor[std::size_t(i)];
        ancestor[std::size_t(i)] = j;
        if (next < 0) parent[std::size_t(i)] = j;
        i = next;
      }
    }
  return parent;
}

// Children before their parents, each subtree in one run.
std::vector<int> postorder(const std::vector<int>& parent) {
  Lists children(parent.size());
  std::vector<int> open, order;
  for (int j = static_cast<int>(parent.size()); j-- > 0;)
    (parent[std::size_t(j)] < 0 ? open : children[std::size_t(parent[std::size_t(j)])]).push_back(j);
  while (!open.empty()) {
    const int j = open.back();
    open.pop_back();
    order.push_back(j);
    open.insert(open.end(), children[std::size_t(j)].rbegin(), children[std::size_t(j)].rend());
  }
  std::reverse(order.begin(), order.end());  // parents came first
  return order;
}

std::vector<int> inverse(const std::vector<int>& order) {
  std::vector<int> place(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) place[std::size_t(order[i])] = static_cast<int>(i);
  return place;
}

// A run of groups that is eliminated at once, and the groups below.
struct Run {
  int first = 0, end = 0;
  std::vector<int> below;
  double zeros = 0;  // that it contains because runs were merged

  double width() const { return end - first; }
  double entries() const { return width() * (width() / 2 + double(below.size())); }
};

// Merges child and parent if that is cheaper, and counts the zeros that this adds.
bool join(const Run& child, Run& parent) {
  const double zeros =
      child.zeros + parent.zeros +
      child.width() * (parent.width() + double(parent.below.size()) - double(child.below.size()));
  const double all =
      parent.entries() + child.width() * (child.width() / 2 + parent.width() + double(parent.below.size()));
  const bool is_small =
      child.width() + parent.width() <= 8;  // groups: so few are cheaper to fill with zeros than to handle
  if (zeros > (is_small ? 0.5 : 0.1) * all) return false;
  parent.first = child.first;
  parent.zeros = zeros;
  return true;
}

std::vector<Run> find_runs(const Lists& neighbours, const std::vector<int>& order) {
  const std::vector<int> place = inverse(order), parent = elimination_tree(neighbours, order, place);
  Lists below(order.size()), children(order.size());
  std::vector<Run> runs;
  for (int j = 0; j < static_cast<int>(order.size()); ++j) {
    std::vector<int>& rows = below[std::size_t(j)];
    for (int h : neighbours[std::size_t(order[std::size_t(j)])])
      if (place[std::size_t(h)] > j) rows.push_back(place[std::size_t(h)]);
    for (int child : children[std::size_t(j)]) {
      for (int i : below[std::size_t(child)])
        if (i > j) rows.push_back(i);
      below[std::size_t(child)] = {};
    }
    sort_unique(rows);
    if (parent[std::size_t(j)] >= 0) children[std::size_t(parent[std::size_t(j)])].push_back(j);
    Run run{j, j + 1, rows};
    while (!runs.empty() && !runs.back().below.empty() && runs.back().below.front() < run.end &&
           join(runs.back(), run))
      runs.pop_back();
    runs.push_back(std::move(run));
  }
  return runs;
}

}  // namespace

void Supernodes::number() {
  of.clear();
  for (int s = 0; s < count(); ++s) of.insert(of.end(), std::size_t(width(s)), s);
}

Supernodes find_supernodes(const Eigen::SparseMatrix<double>& A) {
  const Groups groups = find_groups(A);
  std::vector<int> order = ordered(groups.neighbours);
  const std::vector<int> later = postorder(elimination_tree(groups.neighbours, order, inverse(order)));
  std::vector<int> final_order;
  for (int i : later) final_order.push_back(order[std::size_t(i)]);
  Supernodes found;
  found.place.resize(std::size_t(A.cols()));
  std::vector<int> begin = {0};  // component of each group, in the order
  for (int g : final_order) {
    int next = begin.back();
    for (int i = groups.first[std::size_t(g)]; i < groups.first[std::size_t(g) + 1]; ++i)
      found.place[std::size_t(i)] = next++;
    begin.push_back(next);
  }
  for (const Run& run : find_runs(groups.neighbours, final_order)) {
    found.first.push_back(begin[std::size_t(run.end)]);
    std::vector<int>& rows = found.below.emplace_back();
    for (int g : run.below)
      for (int i = begin[std::size_t(g)]; i < begin[std::size_t(g) + 1]; ++i) rows.push_back(i);
  }
  found.number();
  return found;
}

}  // namespace lobe
