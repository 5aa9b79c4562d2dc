#include "lobe/linearity/error_equation.h"

#include <algorithm>
#include <cmath>

namespace lobe {

ErrorEquation::ErrorEquation(TwoGrid grid, double damping) : grid_(std::move(grid)), damping_(damping) {
  restart();
}

void ErrorEquation::restart() {
  for (Mat3X<double>* values : {&e_, &v_, &a_, &r_}) values->setZero(3, grid_.vertex_count());
}

auto ErrorEquation::grid_maker() const
    -> std::function<TwoGrid(const Elements&, double, const HeldVertices&)> {
  return [h = h_, damping = damping_](const Elements& elements, double edge, const HeldVertices& held) {
    TwoGrid grid(elements, edge);
    if (h > 0) prepare(grid, held, damping, h);
    return grid;
  };
}

void ErrorEquation::use(TwoGrid grid, const Topology& topology) {
  grid_ = std::move(grid);
  is_prepared_ = false;
  for (Mat3X<double>* values : {&e_, &v_, &a_, &r_}) {
    const Index known = static_cast<Index>(values->cols());
    values->conservativeResize(3, grid_.vertex_count());
    for (Index v = known; v < grid_.vertex_count(); ++v) {
      const Index origin = topology.origin(v);
      values->col(v) = origin < known ? Vec3d(values->col(origin)) : Vec3d(Vec3d::Zero());
    }
  }
}

void ErrorEquation::prepare(const HeldVertices& held, double h) {
  if (is_prepared_ && std::abs(h - h_) <= 1e-3 * h && held == held_) return;
  is_prepared_ = true;
  h_ = h;
  held_ = held;
  prepare(grid_, held, damping_, h);
}

void ErrorEquation::prepare(TwoGrid& grid, const HeldVertices& held, double damping, double h) {
  const double of_mass = (1 - alpha_m) / (beta * h * h), of_damping = (1 - alpha_f) * gamma / (beta * h);
  grid.prepare(held, 1 - alpha_f, of_mass + damping * of_damping);
}

// With x the change of e,
//   (1 − α_m) M a₁ + α_m M a₀ + γ M ((1 − α_f) v₁ + α_f v₀) + K (e₀ + (1 − α_f) x)
//     = (1 − α_f) r₁ + α_f r₀,   a₁ = (x − p)/(β h²), v₁ = q + γ_N (x − p)/(β h),
// where p and q are the change of e and the velocity without a₁.
void ErrorEquation::step(const TwoGrid::Product& product, const HeldVertices& held, const Mat3X<double>& r,
                         double h) {
  prepare(held, h);
  const double to_a = 1 / (beta * h * h), to_v = gamma / (beta * h);
  Mat3X<double> f = product(e_), p(3, f.cols()), q(3, f.cols());
  for (Index v = 0; v < grid_.vertex_count(); ++v) {
    p.col(v) = h * v_.col(v) + (0.5 - beta) * h * h * a_.col(v);
    q.col(v) = v_.col(v) + (1 - gamma) * h * a_.col(v);
    const Vec3d inertia = alpha_m * a_.col(v) - (1 - alpha_m) * to_a * p.col(v) +
                          damping_ * ((1 - alpha_f) * (q.col(v) - to_v * p.col(v)) + alpha_f * v_.col(v));
    f.col(v) =
        (1 - alpha_f) * r.col(v) + alpha_f * r_.col(v) - f.col(v) - grid_.mass()[std::size_t(v)] * inertia;
  }
  const Mat3X<double> x = grid_.solve(product, f);
  for (Index v = 0; v < grid_.vertex_count(); ++v) {
    e_.col(v) += x.col(v);
    a_.col(v) = to_a * (x.col(v) - p.col(v));
    v_.col(v) = q.col(v) + to_v * (x.col(v) - p.col(v));
  }
  grid_.clear_held(a_);
  grid_.clear_held(v_);
  r_ = r;
}

void ErrorEquation::add(const Mat3X<double>& e) {
  const auto known = std::min(e_.cols(), e.cols());
  e_.leftCols(known) += e.leftCols(known);
}

Eigen::VectorXd ErrorEquation::power() const { return e_.cwiseProduct(r_).colwise().sum(); }

double ErrorEquation::norm() const {
  double sum = 0;
  for (Index v = 0; v < grid_.vertex_count(); ++v)
    sum += grid_.mass()[std::size_t(v)] * e_.col(v).squaredNorm();
  return std::sqrt(sum);
}

}  // namespace lobe
