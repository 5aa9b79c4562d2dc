#include "lobe/region/nodal_pressure.h"

#include <algorithm>

#include "lobe/fem/pressure_term.h"
#include "lobe/sort_unique.h"

namespace lobe {

PressureNodes::PressureNodes(const Elements& elements) {
  std::vector<Index> alive;
  for (Index t = 0; t < elements.topology.tet_count(); ++t)
    if (elements.topology.alive(t)) alive.push_back(t);
  follow(elements, {}, alive);
}

void PressureNodes::follow(const Elements& elements, const std::vector<Index>& leave,
                           const std::vector<Index>& enter) {
  const Eigen::Index before = nodes_.cols(), after = elements.topology.tet_count();
  nodes_.conservativeResize(4, after);
  nodes_.rightCols(after - before).setConstant(none);
  while (nodes_at_.vertex_count() < elements.topology.vertex_count()) nodes_at_.add_vertex();
  std::vector<Index> touched;
  for (Index t : leave) {
    if (nodes_(0, t) == none) continue;
    for (Index& node : nodes_.col(t)) {
      tets_of_.erase_value(node, t);
      touched.push_back(node);
      node = none;
    }
  }
  for (Index t : enter) {
    const double lambda = elements.elastic_of(t).nodal_lambda();
    const bool is_smoothed = elements.elastic_of(t).is_smoothed();
    if (elements.region_of[t] != RegionModel::nonlinear || is_smoothed || !(lambda > 0)) continue;
    for (int c = 0; c < 4; ++c) {
      const Index node = node_at(elements.topology.tets()(c, t), elements.material_of[t], lambda);
      tets_of_.append(node, t);
      touched.push_back(node);
      nodes_(c, t) = node;
    }
  }
  sort_unique(touched);
  for (Index node : touched) update(elements, node);
}

Index PressureNodes::node_at(Index vertex, std::uint16_t material, double lambda) {
  for (Index node : nodes_at_[vertex])
    if (material_[node] == material) return node;
  if (unused_.empty()) {
    unused_.push_back(count());
    tets_of_.add_vertex();
    vertex_.push_back(-1);
    material_.push_back(0);
    for (auto* values : {&volume_, &lambda_, &scale_}) values->push_back(0);
  }
  const Index node = unused_.back();
  unused_.pop_back();
  vertex_[node] = vertex;
  material_[node] = material;
  lambda_[node] = lambda;
  nodes_at_.append(vertex, node);
  return node;
}

// Volumes are summed again from the tetrahedra that are left: nothing is subtracted, and no rounding
// accumulates.
void PressureNodes::update(const Elements& elements, Index node) {
  volume_[node] = 0;
  for (Index t : tets_of_[node]) volume_[node] += elements.volume(t) / 4;
  if (!tets_of_[node].empty()) {
    scale_[node] = lambda_[node] / (4 * volume_[node]);
    return;
  }
  nodes_at_.erase_value(vertex_[node], node);
  lambda_[node] = scale_[node] = 0;
  unused_.push_back(node);
}

void PressureNodes::add_diagonal_stiffness(const Mat3X<double>& slopes, DiagonalStiffness& K) const {
  Mat3X<double> g = Mat3X<double>::Zero(3, nodes_at_.vertex_count());  // 4 ∂(V_n θ_n)/∂u around one node
  for (Index n = 0; n < count(); ++n) {
    for (Index t : tets_of_[n])
      for (int c = 0; c < 4; ++c) g.col(vertex_[nodes_(c, t)]) += slopes.col(4 * t + c);
    for (Index t : tets_of_[n])
      for (Index node : nodes_.col(t)) {
        const Index v = vertex_[node];
        const Vec3d a = g.col(v);
        if (a.isZero(0)) continue;
        K.col(v) += scale_[n] / 4 *
                    Eigen::Matrix<double, 6, 1>(a[0] * a[0], a[0] * a[1], a[0] * a[2], a[1] * a[1],
                                                a[1] * a[2], a[2] * a[2]);
        g.col(v).setZero();
      }
  }
}

std::vector<double> tet_pressures(const Elements& elements, const PressureNodes& nodes,
                                  const Mat3X<double>& u) {
  const auto tets = std::size_t(elements.topology.tet_count());
  std::vector<double> volume_strain(tets, 0), at_node(std::size_t(nodes.count())), at_tet(tets, 0);
  const auto takes_part = [&](std::size_t t) { return nodes.of(Index(t))[0] != PressureNodes::none; };
  for (std::size_t t = 0; t < tets; ++t) {
    if (!takes_part(t)) continue;
    const Shape s = elements.shape_of(Index(t));
    const Mat34<double> corners = u(Eigen::all, elements.topology.corners(Index(t)));
    volume_strain[t] =
        s.volume * pressure_strain(displacement_gradient<double>(corners, s.gradients.rightCols<3>()),
                                   elements.elastic_of(Index(t)).law);
  }
  Parallel one_thread;
  nodes.gather(volume_strain, at_node, one_thread);
  for (std::size_t t = 0; t < tets; ++t) at_tet[t] = nodes.mean(at_node, Index(t));
  return at_tet;
}

}  // namespace lobe
