#include "lobe/region/smoothed_edges.h"

#include <algorithm>

#include "lobe/sort_unique.h"

namespace lobe {
SmoothedEdges::SmoothedEdges(const Elements& elements, std::optional<RegionModel> only) {
  std::vector<Index> alive;
  for (Index t = 0; t < elements.topology.tet_count(); ++t)
    if (elements.topology.alive(t)) alive.push_back(t);
  follow(elements, {}, alive, only);
}

std::vector<Index> SmoothedEdges::follow(const Elements& elements, const std::vector<Index>& leave,
                                         const std::vector<Index>& enter, std::optional<RegionModel> only,
                                         std::vector<SmoothedEdge>* before) {
  std::vector<Index> touched;
  const auto takes = [&](Index t) {
    return (!only || elements.region_of[t] == *only) && elements.elastic_of(t).is_smoothed();
  };
  if (!any() && (!any_smoothed(elements.materials) || std::none_of(enter.begin(), enter.end(), takes)))
    return touched;
  const Eigen::Index known = of_.cols(), all = elements.topology.tet_count();
  of_.conservativeResize(6, all);
  of_.rightCols(all - known).setConstant(-1);
  while (edges_at_.vertex_count() < elements.topology.vertex_count()) edges_at_.add_vertex();
  for (Index t : leave)
    for (Index& edge : of_.col(t)) {
      if (edge < 0) continue;
      tets_of_.erase_value(edge, t);
      touched.push_back(edge);
      edge = -1;
    }
  for (Index t : enter) {
    if (!takes(t)) continue;
    const Eigen::Vector4i corners = elements.topology.corners(t);
    for (int e = 0; e < 6; ++e) {
      const auto [a, b] = std::minmax(corners[edge_corners[e][0]], corners[edge_corners[e][1]]);
      const Index edge = edge_at(a, b, elements.material_of[t], elements.region_of[t]);
      tets_of_.append(edge, t);
      touched.push_back(edge);
      of_(e, t) = edge;
    }
  }
  sort_unique(touched);
  for (Index edge : touched) {
    if (before && edges_[edge].volume > 0) before->push_back(edges_[edge]);
    if (tets_of_[edge].empty()) drop(edge);
    const auto [a, b] = std::pair(edges_[edge].vertices[0], edges_[edge].vertices[1]);
    find_smoothed_edge(elements, a, b, tets_of_[edge], edges_[edge]);
  }
  return touched;
}

Index SmoothedEdges::edge_at(Index a, Index b, std::uint16_t material, RegionModel model) {
  for (Index edge : edges_at_[a]) {
    const SmoothedEdge& it = edges_[edge];
    if (it.vertices[1] == b && it.material == material && it.model == model) return edge;
  }
  if (unused_.empty()) {
    unused_.push_back(count());
    tets_of_.add_vertex();
    edges_.emplace_back();
  }
  const Index edge = unused_.back();
  unused_.pop_back();
  edges_[edge].vertices = {a, b};
  edges_[edge].material = material;
  edges_[edge].model = model;
  edges_at_.append(a, edge);
  return edge;
}

void SmoothedEdges::drop(Index edge) {
  edges_at_.erase_value(edges_[edge].vertices[0], edge);
  unused_.push_back(edge);
}

}  // namespace lobe
