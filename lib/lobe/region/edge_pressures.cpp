#include "lobe/region/edge_pressures.h"

#include <algorithm>
#include <numeric>

#include "lobe/fem/pressure_term.h"
#include "lobe/sort_unique.h"

namespace lobe {

EdgePressures::EdgePressures(const Elements& elements, const SmoothedEdges& edges) {
  std::vector<Index> all(std::size_t(edges.count()));
  std::iota(all.begin(), all.end(), 0);
  follow(elements, edges, all);
}

void EdgePressures::follow(const Elements& elements, const SmoothedEdges& edges,
                           const std::vector<Index>& changed) {
  nodes_.resize(std::size_t(edges.count()), {none, none});
  laws_.resize(std::size_t(edges.count()), MaterialLaw::svk);
  while (nodes_at_.vertex_count() < elements.topology.vertex_count()) nodes_at_.add_vertex();
  std::vector<Index> touched;
  for (Index e : changed)
    for (Index& node : nodes_[e]) {
      if (node == none) continue;
      edges_of_.erase_value(node, e);
      touched.push_back(node);
      node = none;
    }
  for (Index e : changed) {
    const SmoothedEdge& edge = edges[e];
    const double lambda = elements.materials[edge.material].nodal_lambda();
    if (!(edge.volume > 0) || !(lambda > 0) || edge.model != RegionModel::nonlinear) continue;
    laws_[e] = elements.materials[edge.material].law;
    for (int end = 0; end < 2; ++end) {
      const Index node = node_at(edge.vertices[end], edge, lambda);
      edges_of_.append(node, e);
      touched.push_back(node);
      nodes_[e][end] = node;
    }
  }
  sort_unique(touched);
  for (Index node : touched) update(edges, node);
}

Index EdgePressures::node_at(Index vertex, const SmoothedEdge& edge, double lambda) {
  for (Index node : nodes_at_[vertex])
    if (material_[node] == edge.material) return node;
  if (unused_.empty()) {
    unused_.push_back(count());
    edges_of_.add_vertex();
    vertex_.push_back(-1);
    material_.push_back(0);
    for (auto* values : {&volume_, &lambda_, &scale_}) values->push_back(0);
  }
  const Index node = unused_.back();
  unused_.pop_back();
  vertex_[node] = vertex;
  material_[node] = edge.material;
  lambda_[node] = lambda;
  nodes_at_.append(vertex, node);
  return node;
}

// Volumes are summed again from the domains that are left: nothing is subtracted, and no rounding
// accumulates.
void EdgePressures::update(const SmoothedEdges& edges, Index node) {
  volume_[node] = 0;
  for (Index e : edges_of_[node]) volume_[node] += edges[e].volume / 2;
  if (!edges_of_[node].empty()) {
    scale_[node] = lambda_[node] / (2 * volume_[node]);
    return;
  }
  nodes_at_.erase_value(vertex_[node], node);
  lambda_[node] = scale_[node] = 0;
  unused_.push_back(node);
}

void EdgePressures::add_diagonal_stiffness(const SmoothedEdges& edges,
                                           const std::vector<Mat3<double>>& gradients,
                                           DiagonalStiffness& K) const {
  struct Slope {
    Vec3d of_strain;  // 2 ∂(½ V_e θ_e)/∂u [m²]
    Index vertex;
  };
  std::vector<Slope> slopes;
  std::vector<std::size_t> first{0};  // slope of each domain, then the end
  for (Index e = 0; e < edges.count(); ++e) {
    const SmoothedEdge& edge = edges[e];
    const Mat3<double> D = pressure_slope_less_one(gradients[e], laws_[e]);
    for (std::size_t j = 0; j < edge.vertices.size() && nodes_[e][0] != none; ++j)
      slopes.push_back({edge.volume * (edge.gradients[j] + D * edge.gradients[j]), edge.vertices[j]});
    first.push_back(slopes.size());
  }
  Mat3X<double> g = Mat3X<double>::Zero(3, nodes_at_.vertex_count());  // 2 ∂(V_n θ_n)/∂u around one node
  std::vector<char> is_around(std::size_t(nodes_at_.vertex_count()), 0);
  std::vector<Index> around;
  for (Index n = 0; n < count(); ++n) {
    for (Index e : edges_of_[n])
      for (std::size_t i = first[e]; i < first[e + 1]; ++i) {
        const Index v = slopes[i].vertex;
        g.col(v) += slopes[i].of_strain;
        if (!is_around[v]) around.push_back(v);
        is_around[v] = 1;
      }
    for (Index v : around) {
      const Vec3d a = g.col(v);
      K.col(v) += scale_[n] / 2 *
                  Eigen::Matrix<double, 6, 1>(a[0] * a[0], a[0] * a[1], a[0] * a[2], a[1] * a[1], a[1] * a[2],
                                              a[2] * a[2]);
      g.col(v).setZero();
      is_around[v] = 0;
    }
    around.clear();
  }
}

std::vector<double> domain_pressures(const SmoothedEdges& edges, const EdgePressures& pressures,
                                     const std::vector<Mat3<double>>& gradients) {
  std::vector<double> volume_strain(gradients.size(), 0), at_node(std::size_t(pressures.count())),
      at_domain(gradients.size(), 0);
  for (Index e = 0; e < edges.count(); ++e)
    volume_strain[e] = edges[e].volume * pressure_strain(gradients[e], pressures.law_of(e));
  Parallel one_thread;
  pressures.gather(volume_strain, at_node, one_thread);
  for (Index e = 0; e < edges.count(); ++e) at_domain[e] = pressures.mean(at_node, e);
  return at_domain;
}

std::vector<Mat3<double>> domain_gradients(const SmoothedEdges& edges, const Mat3X<double>& u) {
  std::vector<Mat3<double>> gradients(std::size_t(edges.count()), Mat3<double>::Zero());
  for (Index e = 0; e < edges.count(); ++e)
    if (edges[e].volume > 0) gradients[e] = displacement_gradient(edges[e], u);
  return gradients;
}

}  // namespace lobe
