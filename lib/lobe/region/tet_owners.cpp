#include "lobe/region/tet_owners.h"

#include <algorithm>
#include <string>

#include "lobe/error.h"
#include "lobe/region/smoothed_kernels.h"
#include "lobe/sort_unique.h"

namespace lobe {
namespace {

// How many more tetrahedra a domain may have: each has at most two vertices that are there again.
Index room(const SmoothedEdge& edge, std::span<const Index> tets) {
  const Index rows = domain_rows - static_cast<Index>(edge.vertices.size());
  return std::max<Index>(0, rows / 2 - static_cast<Index>(tets.size()));
}

}  // namespace

// Greedily: the domain that can take most comes next, of several the one of the lowest number.
void TetOwners::follow(const SmoothedEdges& edges, const std::vector<Index>& leave,
                       const std::vector<Index>& enter) {
  while (tets_of_.vertex_count() < edges.count()) tets_of_.add_vertex();
  for (Index t : leave) {
    if (t >= static_cast<Index>(owner_.size()) || owner_[t] < 0) continue;
    tets_of_.erase_value(owner_[t], t);
    owner_[t] = -1;
  }
  std::vector<Index> candidates;
  for (Index t : enter) {
    if (edges.of(t)[0] < 0) continue;
    if (t >= static_cast<Index>(owner_.size())) owner_.resize(std::size_t(t) + 1, -1);
    for (Index e : edges.of(t)) candidates.push_back(e);
  }
  sort_unique(candidates);
  const auto could_take = [&](Index e) {
    const std::span<const Index> around = edges.tets_of(e);
    const auto without_owner =
        std::count_if(around.begin(), around.end(), [&](Index t) { return owner_[t] < 0; });
    return std::size_t(std::min<std::ptrdiff_t>(without_owner, room(edges[e], of(e))));
  };
  std::vector<std::vector<Index>> by_count(1);
  const auto list = [&](Index e, std::size_t count) {
    if (by_count.size() <= count) by_count.resize(count + 1);
    by_count[count].push_back(e);
  };
  for (Index e : candidates) list(e, could_take(e));
  for (std::size_t count = by_count.size() - 1; count > 0; --count)
    for (Index e : by_count[count]) {
      const std::size_t left = could_take(e);
      if (left == count)
        give(edges, e);
      else
        list(e, left);  // among those of fewer
    }
  for (Index t : enter)
    if (edges.of(t)[0] >= 0 && owner_[t] < 0)
      throw InputError("tetrahedron " + std::to_string(t),
                       "too many tetrahedra share its edges for \"element\": \"edge-smoothed\"");
}

void TetOwners::give(const SmoothedEdges& edges, Index edge) {
  Index left = room(edges[edge], of(edge));
  for (Index t : edges.tets_of(edge)) {
    if (owner_[t] >= 0) continue;
    if (left-- == 0) return;
    owner_[t] = edge;
    tets_of_.append(edge, t);
  }
}

namespace {

// The other two corners, so that (a, b, first, second) is oriented like the tetrahedron.
std::pair<Index, Index> across(const Eigen::Vector4i& corners, Index a, Index b) {
  int of_a = 0, of_b = 0;
  for (int c = 0; c < 4; ++c) {
    if (corners[c] == a) of_a = c;
    if (corners[c] == b) of_b = c;
  }
  int others[2], n = 0;
  for (int c = 0; c < 4; ++c)
    if (c != of_a && c != of_b) others[n++] = c;
  int permutation[] = {of_a, of_b, others[0], others[1]}, inversions = 0;
  for (int i = 0; i < 4; ++i)
    for (int j = i + 1; j < 4; ++j) inversions += permutation[i] > permutation[j];
  if (inversions % 2 == 1) std::swap(others[0], others[1]);
  return {corners[others[0]], corners[others[1]]};
}

}  // namespace

// Each vertex of the ring is the first of one tetrahedron at most, and the second of one, but for copies.
void find_tet_chain(const Topology& topology, const SmoothedEdge& edge, std::span<const Index> tets,
                    TetChain& chain) {
  struct Link {
    std::uint8_t first, second;
    Index tet;
    bool is_used;
  };
  const auto number_of = [&](Index v) {
    const auto at = std::find(edge.vertices.begin(), edge.vertices.end(), v);
    return static_cast<std::uint8_t>(at - edge.vertices.begin());
  };
  std::vector<Link> links;
  for (Index t : tets) {
    const auto [first, second] = across(topology.corners(t), edge.vertices[0], edge.vertices[1]);
    links.push_back({number_of(first), number_of(second), t, false});
  }
  chain.order.assign({0, 1});
  chain.tets.clear();
  const auto walk_from = [&](Link* link) {
    if (chain.order.size() > 2) chain.tets.push_back(-1);
    chain.order.push_back(link->first);
    while (link) {
      link->is_used = true;
      chain.order.push_back(link->second);
      chain.tets.push_back(link->tet);
      const std::uint8_t end = link->second;
      link = nullptr;
      for (Link& next : links)
        if (next.first == end && !next.is_used) link = &next;
    }
  };
  const auto has_one_before = [&](const Link& link) {
    return std::any_of(links.begin(), links.end(), [&](const Link& l) { return l.second == link.first; });
  };
  for (Link& link : links)
    if (!link.is_used && !has_one_before(link)) walk_from(&link);
  for (Link& link : links)
    if (!link.is_used) walk_from(&link);  // a closed ring
  for (std::size_t v = 2; v < edge.vertices.size(); ++v) {
    const auto number = static_cast<std::uint8_t>(v);
    if (std::find(chain.order.begin(), chain.order.end(), number) == chain.order.end())
      chain.order.push_back(number);
  }
}

}  // namespace lobe
