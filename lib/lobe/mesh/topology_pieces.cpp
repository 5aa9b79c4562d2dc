// Topology: pieces of the body, and what an edit has cut off.
#include <algorithm>
#include <iterator>
#include <map>

#include "lobe/mesh/topology.h"

namespace lobe {

// The tetrahedra next to each connected part of the removed ones, one part after the other. `ends` has the
// end of each part. Call it before they are unlinked.
std::vector<Index> Topology::rims_of(const std::vector<Index>& removed, std::vector<Index>& ends) {
  std::vector<Index> rims, part;
  for (Index first : removed) {
    if (found_by_[first] >= 0) continue;
    part.assign(1, first);
    found_by_[first] = first;
    for (std::size_t at = 0; at < part.size(); ++at)
      for_neighbours(part[at], [&](int, Index other) {
        if (alive(other)) rims.push_back(other);
        if (alive(other) || found_by_[other] >= 0) return;
        found_by_[other] = first;
        part.push_back(other);
      });
    ends.push_back(static_cast<Index>(rims.size()));
  }
  for (Index t : removed) found_by_[t] = -1;
  return rims;
}

// The pieces of the body that have some of these tetrahedra, all but one; none if the tetrahedra are
// connected. One breadth-first search from all of them: searches that meet become one, and one that ends has
// found a piece. `left` is one of the tetrahedra that is in none of the pieces.
std::vector<std::vector<Index>> Topology::pieces_apart(std::span<const Index> tets, Index& left) {
  std::vector<Index> search_of(tets.size()), open(tets.size(), 0), queue;  // open: tetrahedra yet to be left
  const auto root = [&](Index search) {
    while (search_of[search] != search) search = search_of[search] = search_of[search_of[search]];
    return search;
  };
  Index searches = 0;
  for (Index t : tets) {
    if (found_by_[t] >= 0) continue;
    found_by_[t] = search_of[searches] = searches;
    open[searches++] = 1;
    queue.push_back(t);
  }
  constexpr std::size_t ahead = 8;  // so that what is visited next is in the cache
  std::vector<std::vector<Index>> apart;
  for (std::size_t at = 0; searches > 1; ++at) {
    if (at + 2 * ahead < queue.size()) __builtin_prefetch(&neighbours_(0, queue[at + 2 * ahead]));
    if (at + ahead < queue.size())
      for (int f = 0; f < 4; ++f)
        if (const Index other = neighbours_(f, queue[at + ahead]); other >= 0)
          __builtin_prefetch(&found_by_[other]);
    const Index this_root = root(found_by_[queue[at]]);
    Index found = 0;
    for_neighbours(queue[at], [&](int, Index other) {
      const Index by = found_by_[other];
      if (by == this_root) return;
      if (by < 0) {
        found_by_[other] = this_root;
        ++found;
        queue.push_back(other);
      } else if (const Index met = root(by); met != this_root) {
        search_of[met] = this_root;
        found += open[met];
        --searches;
      }
    });
    open[this_root] += found - 1;
    if (open[this_root] > 0 || searches == 1) continue;
    std::vector<Index>& piece = apart.emplace_back();
    std::copy_if(queue.begin(), queue.end(), std::back_inserter(piece),
                 [&](Index t) { return root(found_by_[t]) == this_root; });
    --searches;
  }
  for (const std::vector<Index>& piece : apart)
    for (Index t : piece) found_by_[t] = -1;
  for (Index t : queue) {
    if (found_by_[t] >= 0) left = t;
    found_by_[t] = -1;
  }
  return apart;
}

// Searches part by part. Where something came apart, it then searches from what is left next to each part,
// since a piece may lie between two.
void Topology::find_cut_off(const std::vector<Index>& rims, const std::vector<Index>& ends, MeshEdit& edit) {
  std::map<Index, std::vector<Index>> pieces;  // by their first tetrahedron
  std::vector<Index> lefts;
  const auto search = [&](std::span<const Index> tets) {
    Index left = -1;
    std::vector<std::vector<Index>> apart = pieces_apart(tets, left);
    if (!apart.empty()) lefts.push_back(left);
    for (std::vector<Index>& piece : apart)
      pieces.emplace(*std::min_element(piece.begin(), piece.end()), std::move(piece));
    return left;
  };
  for (std::size_t i = 0, begin = 0; i < ends.size(); begin = std::size_t(ends[i++]))
    if (begin < std::size_t(ends[i]))
      edit.next_to_removed.push_back(search({rims.data() + begin, std::size_t(ends[i]) - begin}));
  if (lefts.empty()) return;
  const Index last = lefts.size() == 1 ? lefts[0] : search(std::vector(lefts));
  edit.next_to_removed.insert(edit.next_to_removed.begin(), last);
  for (auto& [first, piece] : pieces)
    if (std::find(piece.begin(), piece.end(), last) == piece.end()) edit.cut_off.push_back(std::move(piece));
}

std::vector<std::vector<Index>> Topology::pieces() const {
  std::vector<std::vector<Index>> pieces;
  std::vector<std::uint8_t> seen(alive_.size(), 0);
  for (Index first = 0; first < tet_count(); ++first) {
    if (!alive(first) || seen[first]) continue;
    std::vector<Index>& piece = pieces.emplace_back(1, first);
    seen[first] = 1;
    for (std::size_t at = 0; at < piece.size(); ++at)
      for_neighbours(piece[at], [&](int, Index other) {
        if (seen[other]) return;
        seen[other] = 1;
        piece.push_back(other);
      });
  }
  return pieces;
}

}  // namespace lobe
