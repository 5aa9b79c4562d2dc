#include "lobe/region/smoothed_edges.h"

#include <algorithm>

#include "lobe/sort_unique.h"

namespace lobe {
SmoothedEdges::SmoothedEdges(const Elements& elements) : SmoothedEdges() {
  std::vector<Index> alive;
  for (Index t = 0; t < elements.topology.tet_count(); ++t)
    if (elements.topology.alive(t)) alive.push_back(t);
  follow(elements, {}, alive);
}

std::vector<Index> SmoothedEdges::follow(const Elements& elements, const std::vector<Index>& leave,
                                         const std::vector<Index>& enter) {
  std::vector<Index> touched;
  if (!any() && !any_smoothed(elements.materials)) return touched;
  const Eigen::Index before = of_.cols(), after = elements.topology.tet_count();
  of_.conservativeResize(6, after);
  of_.rightCols(after - before).setConstant(-1);
  while (edges_at_.vertex_count() < elements.topology.vertex_count()) edges_at_.add_vertex();
  for (Index t : leave)
    for (Index& edge : of_.col(t)) {
      if (edge < 0) continue;
      tets_of_.erase_value(edge, t);
      touched.push_back(edge);
      edge = -1;
    }
  for (Index t : enter) {
    if (elements.region_of[t] != model_ || !elements.elastic_of(t).is_smoothed()) continue;
    const Eigen::Vector4i corners = elements.topology.corners(t);
    for (int e = 0; e < 6; ++e) {
      const auto [a, b] = std::minmax(corners[edge_corners[e][0]], corners[edge_corners[e][1]]);
      const Index edge = edge_at(a, b, elements.material_of[t]);
      tets_of_.append(edge, t);
      touched.push_back(edge);
      of_(e, t) = edge;
    }
  }
  sort_unique(touched);
  for (Index edge : touched) {
    if (tets_of_[edge].empty()) drop(edge);
    const auto [a, b] = std::pair(edges_[edge].vertices[0], edges_[edge].vertices[1]);
    find_smoothed_edge(elements, a, b, tets_of_[edge], edges_[edge]);
  }
  return touched;
}

Index SmoothedEdges::edge_at(Index a, Index b, std::uint16_t material) {
  for (Index edge : edges_at_[a])
    if (edges_[edge].vertices[1] == b && edges_[edge].material == material) return edge;
  if (unused_.empty()) {
    unused_.push_back(count());
    tets_of_.add_vertex();
    edges_.emplace_back();
  }
  const Index edge = unused_.back();
  unused_.pop_back();
  edges_[edge].vertices = {a, b};
  edges_[edge].material = material;
  edges_at_.append(a, edge);
  return edge;
}

void SmoothedEdges::drop(Index edge) {
  edges_at_.erase_value(edges_[edge].vertices[0], edge);
  unused_.push_back(edge);
}

}  // namespace lobe
