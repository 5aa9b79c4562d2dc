#include "lobe/solve/tangent.h"

#include <algorithm>
#include <cmath>

#include "lobe/region/energy_density.h"
#include "lobe/solve/tangent_factor.h"

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

}  // namespace

EnergyAndForces energy_and_forces(const Elements& elements, const PressureNodes& nodes,
                                  const Mat3X<double>& u) {
  EnergyAndForces result;
  result.forces.setZero(3, u.cols());
  const std::vector<double> pressures = tet_pressures(elements, nodes, u);
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
    result.energy += s.volume * energy_density(elements, t, H, elements.region_of[t], pressures[t]);
    const Mat3<double> P = stress(elements, t, H, elements.region_of[t], pressures[t]);
    const Mat34<double> f = corner_forces<double>(s.volume * P, alpha);
    for (int c = 0; c < 4; ++c) result.forces.col(elements.topology.tets()(c, t)) += f.col(c);
  });
  return result;
}

TetStiffness tet_stiffness(const Elements& elements, Index tet, const Mat34<double>& u, RegionModel model,
                           double pressure) {
  const Shape s = elements.shape_of(tet);
  if (!is_linear(model)) {
    const Mat3<double> H = displacement_gradient<double>(u, s.gradients.rightCols<3>());
    return s.volume * law_stiffness(nonlinear_law(elements, tet, pressure), H, s.gradients);
  }
  const Law<double> law = linear_law(elements, tet);
  TetStiffness K;
  for (int j = 0; j < 4; ++j)
    for (int k = 0; k < 4; ++k)
      K.block<3, 3>(3 * j, 3 * k) =
          s.volume * linear_block<double>(law, s.gradients.col(j), s.gradients.col(k));
  return K;
}

Tangent::Tangent(const Elements& elements, const Unknowns& unknowns)
    : elements_(elements), unknowns_(unknowns), nodes_(elements) {
  row_of_node_.assign(std::size_t(nodes_.count()), -1);
  for (Index n = 0; n < nodes_.count(); ++n)
    if (nodes_.volume(n) > 0) row_of_node_[n] = unknowns.count + pressures_++;
  const Index size = unknowns.count + pressures_;
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(std::size_t(elements.topology.alive_count()) * entry_count() + size);
  for_alive(elements, [&](Index t) {
    for_places(t, [&](Index row, Index column) {
      if (row >= 0) entries.emplace_back(row, column, 0.0);
    });
  });
  for (Index i = 0; i < size; ++i) entries.emplace_back(i, i, 0.0);
  matrix_.resize(size, size);
  matrix_.setFromTriplets(entries.begin(), entries.end());
  place_.reserve(std::size_t(elements.topology.alive_count()) * entry_count());
  const int* rows = matrix_.innerIndexPtr();
  for_alive(elements, [&](Index t) {
    for_places(t, [&](Index row, Index column) {
      if (row < 0) return place_.push_back(-1);
      const int *begin = rows + matrix_.outerIndexPtr()[column],
                *end = rows + matrix_.outerIndexPtr()[column + 1];
      place_.push_back(static_cast<Index>(std::lower_bound(begin, end, row) - rows));
    });
  });
}

template <class Visit>
void Tangent::for_places(Index tet, Visit&& visit) const {
  const Eigen::Vector4i corners = elements_.topology.corners(tet), nodes = nodes_.of(tet);
  const auto number = [&](int i) { return unknowns_.number(i % 3, corners[i / 3]); };
  for (int j = 0; j < 12; ++j)
    for (int i = j; i < 12; ++i) {
      const Index a = number(i), b = number(j);
      visit(a < 0 || b < 0 ? -1 : std::max(a, b), std::min(a, b));
    }
  for (int n = 0; n < 4 && nodes_.any(); ++n)
    for (int i = 0; i < 12; ++i) visit(number(i) < 0 ? -1 : row_of_node_[nodes[n]], number(i));
}

Tangent::TetEntries Tangent::entries_of(Index tet, const Mat34<double>& u, double pressure) const {
  TetEntries entries{};
  const TetStiffness K = tet_stiffness(elements_, tet, u, elements_.region_of[tet], pressure);
  auto entry = entries.begin();
  for (int j = 0; j < 12; ++j)
    for (int i = j; i < 12; ++i) *entry++ = K(i, j);
  if (nodes_.of(tet)[0] == PressureNodes::none) return entries;
  const Shape s = elements_.shape_of(tet);
  const Mat3<double> H = displacement_gradient<double>(u, s.gradients.rightCols<3>());
  const Mat34<double> g = s.volume / 4 * (s.gradients + H * s.gradients);
  for (int n = 0; n < 4; ++n) entry = std::copy(g.data(), g.data() + 12, entry);
  return entries;
}

void Tangent::update(const Mat3X<double>& u) {
  matrix_.coeffs().setZero();
  double* values = matrix_.valuePtr();
  const std::vector<double> pressures = tet_pressures(elements_, nodes_, u);
  auto place = place_.begin();
  for_alive(elements_, [&](Index t) {
    const TetEntries entries = entries_of(t, corners_of(elements_, t, u), pressures[t]);
    for (int i = 0; i < entry_count(); ++i, ++place)
      if (*place >= 0) values[*place] += entries[i];
  });
  for (Index n = 0; n < nodes_.count(); ++n)
    if (const Index row = row_of_node_[n]; row >= 0)
      values[matrix_.outerIndexPtr()[row]] = -nodes_.volume(n) / nodes_.lambda(n);
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
  const std::vector<double> pressures = tet_pressures(elements_, nodes_, u);
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
    for (Index n : nodes_.of(t))
      if (row_of_node_[n] >= 0) right[row_of_node_[n]] -= strain;
  });
  right.head(unknowns_.count) = forces - unknowns_.gather(f);
  return factor.solve(right).head(unknowns_.count);
}

}  // namespace lobe
