#include "lobe/condense/condensation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "lobe/numerics/symmetric_sweep.h"

namespace lobe {
namespace {

using Matrix = Condensation::Matrix;

// If a pivot is below this share of the stiffness of its component alone, something can move without a force.
constexpr double loose = 1e-10;

// Computes W of (3). R is zero but for the rows of the interior. None if a part could then move without a
// force.
std::optional<Matrix> change_between(const std::vector<Index>& interior, const Matrix& stiffness,
                                     const Matrix& R, DenseProducts& products) {
  Matrix left = R(interior, interior);
  if (!invert(left, 0, products)) return std::nullopt;
  left += stiffness(interior, interior);
  if (!invert(left, loose, products)) return std::nullopt;
  const Matrix of_interior = stiffness(interior, Eigen::all);
  Matrix W = stiffness;
  products.add_symmetric(-1, {of_interior, true}, {products.product({left}, {of_interior})}, W);
  return W;
}

}  // namespace

Condensation::Condensation(std::unique_ptr<SparseFactor> factor, const Matrix& loads)
    : factor_(std::move(factor)), loads_(loads), response_(loads) {
  for (Eigen::Index l = 0; l < loads.cols(); ++l)
    if (!loads.col(l).isZero(0)) response_.col(l) = factor_->solve(loads.col(l));
  slot_.assign(std::size_t(loads.rows()), -1);
  column_ = slot_;
  Phi_.resize(0, loads.cols());
  changed_loads_ = Phi_;
  S_ = -loads.transpose() * response_;
}

std::vector<Index> Condensation::slots(const Dofs& dofs) const {
  std::vector<Index> slots;
  for (Index d : dofs) slots.push_back(slot_[std::size_t(d)]);
  return slots;
}

void Condensation::touch(const Dofs& dofs) {
  Dofs fresh;
  for (Index d : dofs)
    if (slot_[std::size_t(d)] < 0) fresh.push_back(d);
  if (fresh.empty()) return;
  for (Index d : fresh) {
    slot_[std::size_t(d)] = touched();
    touched_.push_back(d);
  }
  Dofs rows;
  for (Index d : touched_)
    if (known(d)) rows.push_back(d);
  const auto now = Eigen::Index(touched_.size()), count = Eigen::Index(fresh.size());
  Matrix columns = Matrix::Zero(now, count);
  columns(slots(rows), Eigen::all) = factor_->inverse_block(rows, fresh);
  A_.conservativeResize(now, now);
  A_.rightCols(count) = columns;
  A_.bottomRows(count) = columns.transpose();
  grow_to(now);
}

// Enlarges all matrices but A by zeros.
void Condensation::grow_to(Eigen::Index touched) {
  N_.conservativeResizeLike(Matrix::Zero(touched, touched));
  Phi_.conservativeResizeLike(Matrix::Zero(touched, Phi_.cols()));
  changed_loads_.conservativeResizeLike(Matrix::Zero(touched, loads_.cols()));
}

// Adds components to the interface, with rows and columns of zeros.
void Condensation::join(const Dofs& dofs) {
  for (Index d : dofs) {
    column_[std::size_t(d)] = static_cast<Index>(interface_.size());
    interface_.push_back(d);
  }
  const Eigen::Index size = S_.rows() + Eigen::Index(dofs.size());
  S_.conservativeResizeLike(Matrix::Zero(size, size));
  Phi_.conservativeResizeLike(Matrix::Zero(Phi_.rows(), size));
}

void Condensation::leave(const Dofs& dofs) {
  for (Index d : dofs) column_[std::size_t(d)] = -1;
  const auto amplitudes = static_cast<Index>(loads_.cols());
  std::vector<Index> places(static_cast<std::size_t>(amplitudes));
  std::iota(places.begin(), places.end(), 0);
  Dofs kept;
  for (std::size_t b = 0; b < interface_.size(); ++b) {
    Index& column = column_[std::size_t(interface_[b])];
    if (column < 0) continue;
    column = static_cast<Index>(kept.size());
    kept.push_back(interface_[b]);
    places.push_back(amplitudes + static_cast<Index>(b));
  }
  S_ = Matrix(S_(places, places));
  Phi_ = Matrix(Phi_(Eigen::all, places));
  interface_ = std::move(kept);
}

// Components that are touched for the first time have no φ yet.
Condensation::Response Condensation::response_at(const Dofs& dofs) {
  const auto count = Eigen::Index(dofs.size()), amplitudes = loads_.cols();
  Response at{Matrix::Zero(count, S_.cols()), {}, Matrix::Zero(count, count)};
  for (Eigen::Index i = 0; i < count; ++i)
    if (const Index b = column(dofs[std::size_t(i)]); b >= 0) at.G(i, amplitudes + b) = 1;
  const std::vector<Index> rows = interior_rows(dofs);
  Dofs inside;
  for (Index i : rows) inside.push_back(dofs[std::size_t(i)]);
  const Index before = touched();
  touch(inside);
  const std::vector<Index> P = slots(inside);
  const Matrix A_TP = A_(Eigen::all, P);
  const auto A_known = A_TP.topRows(before);
  Matrix Z = Matrix::Zero(A_.rows(), A_TP.cols()),
         G = products_.product({A_known, true}, {Phi_.topRows(before)});
  for (std::size_t i = 0; i < P.size(); ++i) {
    Z(P[i], Eigen::Index(i)) = 1;
    if (known(inside[i])) G.row(Eigen::Index(i)).head(amplitudes) += response_.row(inside[i]);
  }
  const Matrix NA = products_.product({N_.topLeftCorner(before, before)}, {A_known});
  Z.topRows(before) -= NA;
  Matrix R = A_(P, P);
  products_.add_symmetric(-1, {A_known, true}, {NA}, R);
  at.R(rows, rows) = R;
  at.G(rows, Eigen::all) = G;
  at.Z = Matrix::Zero(A_.rows(), count);
  at.Z(Eigen::all, rows) = Z;
  return at;
}

bool Condensation::change(const Dofs& dofs, const Matrix& stiffness, const Matrix& loads) {
  const std::vector<Index> interior = interior_rows(dofs);
  const Eigen::Index amplitudes = loads_.cols();
  if (interior.empty()) {
    for (std::size_t i = 0; i < dofs.size(); ++i) {
      const Eigen::Index row = amplitudes + column(dofs[i]);
      S_.row(row).head(amplitudes) -= loads.row(Eigen::Index(i));
      S_.col(row).head(amplitudes) -= loads.row(Eigen::Index(i)).transpose();
      for (std::size_t j = 0; j < dofs.size(); ++j)
        S_(row, amplitudes + column(dofs[j])) += stiffness(Eigen::Index(i), Eigen::Index(j));
    }
    note(dofs, stiffness, loads);
    return true;
  }
  auto [G, Z, R] = response_at(dofs);
  const auto W = change_between(interior, stiffness, R, products_);
  if (!W) return false;
  note(dofs, stiffness, loads);
  S_.topRows(amplitudes).noalias() -= loads.transpose() * G;
  G.leftCols(amplitudes).noalias() += R * loads;
  S_.leftCols(amplitudes).noalias() -= G.transpose() * loads;
  Phi_.leftCols(amplitudes).noalias() += Z * loads;
  const Matrix WG = products_.product({*W}, {G}), ZW = products_.product({Z}, {*W});
  products_.add_symmetric(1, {G, true}, {WG}, S_);
  products_.add(-1, {Z}, {WG}, Phi_);
  products_.add_symmetric(1, {ZW}, {Z, true}, N_);
  return true;
}

// Adds to the ΔK and Δf of (6).
void Condensation::note(const Dofs& dofs, const Matrix& stiffness, const Matrix& loads) {
  const std::vector<Index> their_slots = slots(dofs);
  changed_loads_(their_slots, Eigen::all) += loads;
  for (std::size_t j = 0; j < their_slots.size(); ++j)
    for (std::size_t i = 0; i < their_slots.size(); ++i)
      if (const double entry = stiffness(Eigen::Index(i), Eigen::Index(j)); entry != 0)
        changed_.emplace_back(their_slots[i], their_slots[j], entry);
}

std::vector<Index> Condensation::interior_rows(const Dofs& dofs) const {
  std::vector<Index> rows;
  for (std::size_t i = 0; i < dofs.size(); ++i)
    if (column(dofs[i]) < 0) rows.push_back(static_cast<Index>(i));
  return rows;
}

void Condensation::promote(const Dofs& dofs) {
  if (dofs.empty()) return;
  auto [G, Z, C] = response_at(dofs);  // R so far
  const auto count = Eigen::Index(dofs.size()), before = S_.rows();
  invert(C, 0, products_);
  const Matrix CG = products_.product({C}, {G}), ZC = products_.product({Z}, {C});
  join(dofs);
  products_.add_symmetric(1, {G, true}, {CG}, S_.topLeftCorner(before, before));
  S_.topRightCorner(before, count) = -CG.transpose();
  S_.bottomLeftCorner(count, before) = -CG;
  S_.bottomRightCorner(count, count) = C;
  products_.add(-1, {ZC}, {G}, Phi_.leftCols(before));
  Phi_.rightCols(count) = ZC;
  products_.add_symmetric(1, {ZC}, {Z, true}, N_);
}

bool Condensation::demote(const Dofs& dofs) {
  if (dofs.empty()) return true;
  std::vector<Index> places;
  for (Index d : dofs) places.push_back(static_cast<Index>(loads_.cols()) + column(d));
  const Matrix S_D = S_(places, Eigen::all), Phi_D = Phi_(Eigen::all, places);
  Matrix C = S_(places, places);
  if (!invert(C, loose, products_)) return false;
  const Matrix CS = products_.product({C}, {S_D}), PhiC = products_.product({Phi_D}, {C});
  products_.add_symmetric(-1, {S_D, true}, {CS}, S_);
  products_.add(-1, {Phi_D}, {CS}, Phi_);
  products_.add_symmetric(-1, {PhiC}, {Phi_D, true}, N_);
  leave(dofs);
  return true;
}

void Condensation::forget(const Dofs& dofs) { leave(dofs); }

Index Condensation::add(Index count, double scale) {
  const auto first = static_cast<Index>(slot_.size()), place = touched();
  Dofs dofs(static_cast<std::size_t>(count));
  std::iota(dofs.begin(), dofs.end(), first);
  for (Index d : dofs) {
    slot_.push_back(touched());
    touched_.push_back(d);
    added_.push_back(scale);
  }
  column_.resize(slot_.size(), -1);
  const auto now = Eigen::Index(touched_.size());
  A_.conservativeResizeLike(Matrix::Zero(now, now));
  grow_to(now);
  join(dofs);
  for (Index s = place; s < touched(); ++s) changed_.emplace_back(s, s, -scale);
  A_.diagonal().tail(count).setConstant(1 / scale);
  N_.diagonal().tail(count).setConstant(scale);
  Phi_.block(place, Phi_.cols() - count, count, count).diagonal().setConstant(scale);
  return first;
}

// Computes A (f + E_T φ), and for the components that were added only φ.
Condensation::Matrix Condensation::solve(const Matrix& forces, const Matrix& phi) const {
  Matrix sum = forces, u(Eigen::Index(slot_.size()), phi.cols());
  for (Index s = 0; s < touched(); ++s) {
    const Index d = touched_[std::size_t(s)];
    if (known(d))
      sum.row(d) += phi.row(s);
    else
      u.row(d) = phi.row(s) / added_[std::size_t(d - loads_.rows())];
  }
  u.topRows(loads_.rows()).setZero();
  std::vector<Eigen::Index> loaded;
  for (Eigen::Index c = 0; c < phi.cols(); ++c)
    if (!sum.col(c).isZero(0)) loaded.push_back(c);
  if (!loaded.empty())
    u.topRows(loads_.rows())(Eigen::all, loaded) = factor_->solve_all(sum(Eigen::all, loaded));
  return u;
}

double Condensation::error() const {
  Eigen::VectorXd by_loads = Eigen::VectorXd::Zero(S_.cols()), by_interface = by_loads;
  by_loads.head(loads_.cols()).setLinSpaced(1, 2);
  by_interface.tail(S_.cols() - loads_.cols()).setLinSpaced(1, 2);
  return std::max(error_of(by_loads), error_of(by_interface));
}

double Condensation::error_of(const Eigen::VectorXd& driven) const {
  const Eigen::VectorXd a = driven.head(loads_.cols()), phi = Phi_ * driven;
  Eigen::VectorXd u = A_.selfadjointView<Eigen::Lower>() * phi, r = phi - changed_loads_ * a;
  for (Index s = 0; s < touched(); ++s)
    if (const Index d = touched_[std::size_t(s)]; known(d)) u[s] += response_.row(d).dot(a);
  for (const Eigen::Triplet<double>& entry : changed_) r[entry.row()] += entry.value() * u[entry.col()];
  r(slots(interface_)).setZero();
  const Eigen::VectorXd Ar = A_.selfadjointView<Eigen::Lower>() * r,
                        NAr = N_.selfadjointView<Eigen::Lower>() * Ar;
  const double of_error = std::abs(r.dot(Ar) - Ar.dot(NAr)), of_field = std::abs(driven.dot(S_ * driven));
  if (of_field == 0) return 0;
  const double error = std::sqrt(of_error / of_field);
  return std::isfinite(error) ? error : std::numeric_limits<double>::infinity();
}

Condensation::Matrix Condensation::field(const Matrix& driven) const {
  return solve(loads_ * driven.topRows(loads_.cols()), Phi_ * driven);
}

// The forces on dofs that K̂ does not have, T × #columns.
Condensation::Matrix Condensation::of_added(const Matrix& forces) const {
  Matrix phi = Matrix::Zero(touched(), forces.cols());
  for (Index s = 0; s < touched(); ++s)
    if (const Index d = touched_[std::size_t(s)]; !known(d)) phi.row(s) = forces.row(d);
  return phi;
}

Condensation::Matrix Condensation::interface_forces(const Matrix& forces) const {
  const Matrix free = solve(forces.topRows(loads_.rows()), of_added(forces))(touched_, Eigen::all);
  return Phi_.rightCols(Eigen::Index(interface_.size())).transpose() * free;
}

Condensation::Matrix Condensation::fixed_interface_response(const Matrix& forces) const {
  const Matrix of_first = forces.topRows(loads_.rows()), added = of_added(forces);
  return solve(of_first, added - N_ * solve(of_first, added)(touched_, Eigen::all));
}

}  // namespace lobe
