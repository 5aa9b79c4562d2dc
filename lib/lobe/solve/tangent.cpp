#include "lobe/solve/tangent.h"

#include <algorithm>
#include <cmath>

#include "lobe/fem/law.h"
#include "lobe/fem/law_of.h"
#include "lobe/region/energy_density.h"
#include "lobe/solve/tangent_factor.h"
#include "lobe/sort_unique.h"

namespace lobe {
namespace {

Mat34<double> corners_of(const Elements& elements, Index tet, const Mat3X<double>& u) {
  Mat34<double> corners;
  for (int c = 0; c < 4; ++c) corners.col(c) = u.col(elements.topology.tets()(c, tet));
  return corners;
}

template <class Visit>  // visit(tetrahedron) for all that are alive
void for_alive(const Elements& elements, Visit&& visit) {
  for (Index t = 0; t < elements.topology.tet_count(); ++t)
    if (elements.topology.alive(t)) visit(t);
}

void add_domains(const Elements& elements, const Averages& averages, const Mat3X<double>& u,
                 EnergyAndForces& sums) {
  const SmoothedEdges& edges = averages.edges;
  const std::vector<Mat3<double>> gradients = domain_gradients(edges, u);
  const std::vector<double> pressures = domain_pressures(edges, averages.edge_pressures, gradients);
  for (Index e = 0; e < edges.count(); ++e) {
    const SmoothedEdge& edge = edges[e];
    if (!(edge.volume > 0)) continue;
    sums.energy += edge.volume * energy_density(elements, edge, gradients[e], edge.model, pressures[e]);
    const Mat3<double> P = stress(elements, edge, gradients[e], edge.model, pressures[e]);
    sums.forces(Eigen::all, edge.vertices) += vertex_forces(edge, P);
  }
}

}  // namespace

EnergyAndForces energy_and_forces(const Elements& elements, const Averages& averages,
                                  const Mat3X<double>& u) {
  EnergyAndForces result;
  result.forces.setZero(3, u.cols());
  const std::vector<double> pressures = tet_pressures(elements, averages.nodes, u);
  for_alive(elements, [&](Index t) {
    const Shape s = elements.shape_of(t);
    const Mat3<double> alpha = s.gradients.rightCols<3>();
    const Mat3<double> H = displacement_gradient(corners_of(elements, t, u), alpha);
    if (!is_linear(elements.region_of[t])) {
      const double ratio = 1 + volume_change(H);
      if (ratio < result.smallest_volume_ratio) {
        result.smallest_volume_ratio = ratio;
        result.smallest_tet = t;
      }
    }
    const RegionModel model = elements.region_of[t];
    result.energy += s.volume * unsmoothed_energy_density(elements, t, H, model, pressures[t]);
    const Mat3<double> P = unsmoothed_stress(elements, t, H, model, pressures[t]);
    const Mat34<double> f = corner_forces<double>(s.volume * P, alpha);
    for (int c = 0; c < 4; ++c) result.forces.col(elements.topology.tets()(c, t)) += f.col(c);
  });
  add_domains(elements, averages, u, result);
  return result;
}

namespace {

// V linear_block() of each pair of these gradients.
TetStiffness linear_stiffness(const Law<double>& law, const Mat34<double>& gradients, double volume) {
  TetStiffness K;
  for (int j = 0; j < 4; ++j)
    for (int k = 0; k < 4; ++k)
      K.block<3, 3>(3 * j, 3 * k) = volume * linear_block<double>(law, gradients.col(j), gradients.col(k));
  return K;
}

}  // namespace

Moduli domain_moduli(const Elements& elements, const SmoothedEdge& edge, const Mat3<double>& H,
                     RegionModel model, double pressure) {
  Mat34<double> units = Mat34<double>::Zero();
  units.leftCols<3>().setIdentity();
  return (is_linear(model) ? linear_stiffness(smoothed_linear_law(elements, edge), units, 1)
                           : law_stiffness(smoothed_law(elements, edge, pressure), H, units))
      .topLeftCorner<9, 9>();
}

Eigen::MatrixXd domain_stiffness(const Elements& elements, const SmoothedEdge& edge, const Mat3<double>& H,
                                 RegionModel model, double pressure) {
  const Moduli C = domain_moduli(elements, edge, H, model, pressure);
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(9, 3 * Eigen::Index(edge.vertices.size()));  // ∂F/∂u
  for (std::size_t j = 0; j < edge.vertices.size(); ++j)
    for (int d = 0; d < 3; ++d)
      G.block<3, 3>(3 * d, 3 * Eigen::Index(j)).diagonal().setConstant(edge.gradients[j][d]);
  return edge.volume * G.transpose() * (C * G);
}

TetStiffness tet_stiffness(const Elements& elements, Index tet, const Mat34<double>& u, RegionModel model,
                           double pressure) {
  const Shape s = elements.shape_of(tet);
  if (!is_linear(model)) {
    const Mat3<double> H = displacement_gradient<double>(u, s.gradients.rightCols<3>());
    return s.volume * law_stiffness(nonlinear_law(elements, tet, pressure), H, s.gradients);
  }
  return linear_stiffness(linear_law(elements, tet), s.gradients, s.volume);
}

TetStiffness unsmoothed_stiffness(const Elements& elements, Index tet, const Mat34<double>& u,
                                  RegionModel model, double pressure) {
  if (!elements.elastic_of(tet).is_smoothed()) return tet_stiffness(elements, tet, u, model, pressure);
  if (is_linear(model)) return TetStiffness::Zero();
  const Shape s = elements.shape_of(tet);
  const Mat3<double> H = displacement_gradient<double>(u, s.gradients.rightCols<3>());
  return s.volume * law_stiffness(unsmoothed_law(elements, tet), H, s.gradients);
}

namespace {

// Vertices that share a domain and, perhaps, no tetrahedron, each pair once.
std::vector<std::pair<Index, Index>> opposite_pairs(const SmoothedEdges& edges) {
  std::vector<std::pair<Index, Index>> pairs;
  for (Index e = 0; e < edges.count(); ++e) {
    const std::vector<Index>& vertices = edges[e].vertices;
    for (std::size_t i = 2; i < vertices.size() && edges[e].volume > 0; ++i)
      for (std::size_t j = i + 1; j < vertices.size(); ++j)
        pairs.push_back(std::minmax({vertices[i], vertices[j]}));
  }
  sort_unique(pairs);
  return pairs;
}

}  // namespace

Tangent::Tangent(const Elements& elements, const Unknowns& unknowns)
    : elements_(elements), unknowns_(unknowns), averages_(elements) {
  const PressureNodes& nodes = averages_.nodes;
  row_of_node_.assign(std::size_t(nodes.count()), -1);
  for (Index n = 0; n < nodes.count(); ++n)
    if (nodes.volume(n) > 0) row_of_node_[n] = unknowns.count + pressures_++;
  row_of_edge_node_.assign(std::size_t(averages_.edge_pressures.count()), -1);
  for (Index n = 0; n < averages_.edge_pressures.count(); ++n)
    if (averages_.edge_pressures.volume(n) > 0) row_of_edge_node_[n] = unknowns.count + pressures_++;
  const Index size = unknowns.count + pressures_;
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(std::size_t(elements.topology.alive_count()) * entry_count() + size);
  const auto add = [&](Index row, Index column) {
    if (row >= 0) entries.emplace_back(row, column, 0.0);
  };
  for_alive(elements, [&](Index t) { for_places(t, add); });
  for (const auto& [a, b] : opposite_pairs(averages_.edges)) for_places(std::array{a, b}, add);
  if (averages_.edge_pressures.any()) for_domains([&](Index e) { for_domain_places(e, add); });
  for (Index i = 0; i < size; ++i) entries.emplace_back(i, i, 0.0);
  matrix_.resize(size, size);
  matrix_.setFromTriplets(entries.begin(), entries.end());
  find_places();
}

void Tangent::find_places() {
  place_.reserve(std::size_t(elements_.topology.alive_count()) * entry_count());
  const int* rows = matrix_.innerIndexPtr();
  const auto add = [&](Index row, Index column) {
    if (row < 0) return place_.push_back(-1);
    const int *begin = rows + matrix_.outerIndexPtr()[column],
              *end = rows + matrix_.outerIndexPtr()[column + 1];
    place_.push_back(static_cast<Index>(std::lower_bound(begin, end, row) - rows));
  };
  for_alive(elements_, [&](Index t) { for_places(t, add); });
  for_domains([&](Index e) { for_domain_places(e, add); });
}

template <class Visit>
void Tangent::for_domains(Visit&& visit) const {
  for (Index e = 0; e < averages_.edges.count(); ++e)
    if (averages_.edges[e].volume > 0) visit(e);
}

template <class Visit>
void Tangent::for_domain_places(Index edge, Visit&& visit) const {
  const std::vector<Index>& vertices = averages_.edges[edge].vertices;
  for_places(vertices, visit);
  if (!averages_.edge_pressures.any()) return;
  for (Index node : averages_.edge_pressures.of(edge))
    for (std::size_t i = 0; i < 3 * vertices.size(); ++i) {
      const Index column = unknowns_.number(i % 3, vertices[i / 3]);
      visit(column < 0 ? -1 : row_of_edge_node_[node], column);
    }
}

Eigen::VectorXd Tangent::slope_of(Index edge, const Mat3<double>& H) const {
  const SmoothedEdge& domain = averages_.edges[edge];
  const Mat3<double> D = pressure_slope_less_one(H, averages_.edge_pressures.law_of(edge));
  Eigen::VectorXd slope(3 * Eigen::Index(domain.vertices.size()));
  for (std::size_t j = 0; j < domain.vertices.size(); ++j)
    slope.segment<3>(3 * Eigen::Index(j)) =
        domain.volume / 2 * (domain.gradients[j] + D * domain.gradients[j]);
  return slope;
}

template <class Visit>
void Tangent::for_places(Index tet, Visit&& visit) const {
  const Eigen::Vector4i corners = elements_.topology.corners(tet), nodes = averages_.nodes.of(tet);
  for_places(std::span<const Index>(corners.data(), 4), visit);
  const auto number = [&](int i) { return unknowns_.number(i % 3, corners[i / 3]); };
  for (int n = 0; n < 4 && averages_.nodes.any(); ++n)
    for (int i = 0; i < 12; ++i) visit(number(i) < 0 ? -1 : row_of_node_[nodes[n]], number(i));
}

template <class Visit>
void Tangent::for_places(std::span<const Index> vertices, Visit&& visit) const {
  const auto number = [&](std::size_t i) { return unknowns_.number(i % 3, vertices[i / 3]); };
  for (std::size_t j = 0; j < 3 * vertices.size(); ++j)
    for (std::size_t i = j; i < 3 * vertices.size(); ++i) {
      const Index a = number(i), b = number(j);
      visit(a < 0 || b < 0 ? -1 : std::max(a, b), std::min(a, b));
    }
}

Tangent::TetEntries Tangent::entries_of(Index tet, const Mat34<double>& u, double pressure) const {
  TetEntries entries{};
  const TetStiffness K = unsmoothed_stiffness(elements_, tet, u, elements_.region_of[tet], pressure);
  auto entry = entries.begin();
  for (int j = 0; j < 12; ++j)
    for (int i = j; i < 12; ++i) *entry++ = K(i, j);
  if (averages_.nodes.of(tet)[0] == PressureNodes::none) return entries;
  const Shape s = elements_.shape_of(tet);
  const Mat3<double> H = displacement_gradient<double>(u, s.gradients.rightCols<3>());
  const Mat3<double> D = pressure_slope_less_one(H, elements_.elastic_of(tet).law);
  const Mat34<double> g = s.volume / 4 * (s.gradients + D * s.gradients);
  for (int n = 0; n < 4; ++n) entry = std::copy(g.data(), g.data() + 12, entry);
  return entries;
}

void Tangent::update(const Mat3X<double>& u) {
  matrix_.coeffs().setZero();
  double* values = matrix_.valuePtr();
  const PressureNodes& nodes = averages_.nodes;
  const std::vector<double> pressures = tet_pressures(elements_, nodes, u);
  auto place = place_.begin();
  for_alive(elements_, [&](Index t) {
    const TetEntries entries = entries_of(t, corners_of(elements_, t, u), pressures[t]);
    for (int i = 0; i < entry_count(); ++i, ++place)
      if (*place >= 0) values[*place] += entries[i];
  });
  const std::vector<Mat3<double>> gradients = domain_gradients(averages_.edges, u);
  const EdgePressures& edge_nodes = averages_.edge_pressures;
  const std::vector<double> edge_pressures = domain_pressures(averages_.edges, edge_nodes, gradients);
  const auto add = [&](double value) {
    if (*place >= 0) values[*place] += value;
    ++place;
  };
  for_domains([&](Index e) {
    const SmoothedEdge& edge = averages_.edges[e];
    const Eigen::MatrixXd K = domain_stiffness(elements_, edge, gradients[e], edge.model, edge_pressures[e]);
    for (Eigen::Index j = 0; j < K.cols(); ++j)
      for (Eigen::Index i = j; i < K.rows(); ++i) add(K(i, j));
    if (!edge_nodes.any()) return;
    const Eigen::VectorXd slope = slope_of(e, gradients[e]);
    for (int end = 0; end < 2; ++end)
      for (double g : slope) add(g);
  });
  for (Index n = 0; n < edge_nodes.count(); ++n)
    if (const Index row = row_of_edge_node_[n]; row >= 0)
      values[matrix_.outerIndexPtr()[row]] = -edge_nodes.volume(n) / edge_nodes.lambda(n);
  for (Index n = 0; n < nodes.count(); ++n)
    if (const Index row = row_of_node_[n]; row >= 0)
      values[matrix_.outerIndexPtr()[row]] = -nodes.volume(n) / nodes.lambda(n);
}

void Tangent::add_diagonal(const Mat3X<double>& k) {
  for (Eigen::Index i = 0; i < unknowns_.number.size(); ++i)
    if (const Index row = unknowns_.number.data()[i]; row >= 0)
      matrix_.valuePtr()[matrix_.outerIndexPtr()[row]] += k.data()[i];
}

void Tangent::scale_and_add_mass(double scale, double weight, const std::vector<double>& mass) {
  matrix_.coeffs() *= scale;
  for (Eigen::Index i = 0; i < unknowns_.number.size(); ++i)
    if (const Index row = unknowns_.number.data()[i]; row >= 0)
      matrix_.valuePtr()[matrix_.outerIndexPtr()[row]] += weight * mass[std::size_t(i / 3)];
}

std::unique_ptr<SparseFactor> Tangent::make_factor(const SparseFactorMaker& wanted) const {
  return make_tangent_factor(wanted, matrix_, pressures_ > 0);
}

bool Tangent::factorise(SparseFactor& factor, bool& damped) {
  return factorise_damped(factor, matrix_, unknowns_.count, pressures_, damped);
}

Eigen::VectorXd Tangent::solve(const SparseFactor& factor, const Eigen::VectorXd& forces) const {
  Eigen::VectorXd right = Eigen::VectorXd::Zero(matrix_.rows());
  right.head(unknowns_.count) = forces;
  return factor.solve(right).head(unknowns_.count);
}

Eigen::VectorXd Tangent::solve(const SparseFactor& factor, const Eigen::VectorXd& forces,
                               const Mat3X<double>& u, const Mat3X<double>& w) const {
  Mat3X<double> f = Mat3X<double>::Zero(3, u.cols());
  Eigen::VectorXd right = Eigen::VectorXd::Zero(matrix_.rows());
  const std::vector<double> pressures = tet_pressures(elements_, averages_.nodes, u);
  for_alive(elements_, [&](Index t) {
    const Mat34<double> by = corners_of(elements_, t, w);
    if (by.isZero(0)) return;
    const TetEntries entries = entries_of(t, corners_of(elements_, t, u), pressures[t]);
    TetStiffness K;
    auto entry = entries.begin();
    for (int j = 0; j < 12; ++j)
      for (int i = j; i < 12; ++i) K(i, j) = K(j, i) = *entry++;
    const Eigen::Matrix<double, 12, 1> force = K * by.reshaped();
    for (int c = 0; c < 4; ++c) f.col(elements_.topology.tets()(c, t)) += force.segment<3>(3 * c);
    const double strain = Eigen::Map<const Eigen::Matrix<double, 12, 1>>(&*entry).dot(by.reshaped());
    for (Index n : averages_.nodes.of(t))
      if (row_of_node_[n] >= 0) right[row_of_node_[n]] -= strain;
  });
  const std::vector<Mat3<double>> gradients = domain_gradients(averages_.edges, u);
  const std::vector<double> edge_pressures =
      domain_pressures(averages_.edges, averages_.edge_pressures, gradients);
  for_domains([&](Index e) {
    const SmoothedEdge& edge = averages_.edges[e];
    const Mat3X<double> by = w(Eigen::all, edge.vertices);
    if (by.isZero(0)) return;
    const Eigen::VectorXd force =
        domain_stiffness(elements_, edge, gradients[e], edge.model, edge_pressures[e]) * by.reshaped();
    f(Eigen::all, edge.vertices) += force.reshaped(3, by.cols());
    const double strain = slope_of(e, gradients[e]).dot(by.reshaped());
    for (Index n : averages_.edge_pressures.of(e))
      if (row_of_edge_node_[n] >= 0) right[row_of_edge_node_[n]] -= strain;
  });
  right.head(unknowns_.count) = forces - unknowns_.gather(f);
  return factor.solve(right).head(unknowns_.count);
}

}  // namespace lobe
