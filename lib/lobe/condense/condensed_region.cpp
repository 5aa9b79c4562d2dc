#include "lobe/condense/condensed_region.h"

#include <algorithm>
#include <utility>

namespace lobe {

namespace {

// The springs of the factor no longer hold the interface.
std::unique_ptr<Condensation> condense(const RegionFactor& region, const Eigen::MatrixXd& loads,
                                       const Condensation::Dofs& interface, CondensingLog& log,
                                       const SparseFactorMaker& make_factor) {
  auto factor = region.factorise(make_factor, log);
  auto condensed = log.time(CondensingPhase::interface, [&] {
    auto made = std::make_unique<Condensation>(std::move(factor), loads);
    made->promote(interface);
    return made;
  });
  const auto count = Eigen::Index(interface.size());
  Eigen::MatrixXd springs = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index i = 0; i < count; ++i)
    springs(i, i) = -region.springs[std::size_t(interface[std::size_t(i)])];
  condensed->change(interface, springs, Eigen::MatrixXd::Zero(count, loads.cols()));
  return condensed;
}

}  // namespace

CondensedRegion::CondensedRegion(const RegionFactor& region, const Components& interface, const Matrix& loads,
                                 CondensingLog& log, const SparseFactorMaker& make_factor)
    : number_(region.number.data(), region.number.data() + region.number.size()),
      spring_(region.mean_stiffness) {
  Matrix of_rows = Matrix::Zero(region.size, loads.cols());
  for (std::size_t i = 0; i < number_.size(); ++i)
    if (number_[i] >= 0) of_rows.row(number_[i]) = loads.row(Eigen::Index(i));
  condensation_ = condense(region, of_rows, numbers(interface), log, make_factor);
}

Condensation::Dofs CondensedRegion::numbers(const Components& components) const {
  Condensation::Dofs dofs;
  for (Index component : components) dofs.push_back(number(component));
  return dofs;
}

CondensedRegion::Components CondensedRegion::interface() const {
  Components components(condensation_->interface().size());
  for (std::size_t i = 0; i < number_.size(); ++i)
    if (const Index at = column(static_cast<Index>(i)); at >= 0)
      components[std::size_t(at)] = static_cast<Index>(i);
  return components;
}

CondensedRegion::Matrix CondensedRegion::field(const Matrix& driven) const {
  const Matrix of_dofs = condensation_->field(driven);
  Matrix field = Matrix::Zero(Eigen::Index(number_.size()), driven.cols());
  for (std::size_t i = 0; i < number_.size(); ++i)
    if (number_[i] >= 0) field.row(Eigen::Index(i)) = of_dofs.row(number_[i]);
  return field;
}

const Eigen::VectorXd& CondensedRegion::inertia(const Eigen::VectorXd& mass, const Components& moving) {
  if (inertia_) return inertia_->of_interface;
  inertia_ = Inertia{};
  const Components components = interface();
  const auto n = Eigen::Index(components.size()), amplitudes = Eigen::Index(stiffness().cols()) - n;
  Matrix unit = Matrix::Zero(amplitudes + n, 3);
  for (Index component : moving) unit(amplitudes + column(component), component % 3) = 1;
  inertia_->follows = condensation_->field(unit);
  inertia_->of_interior = Eigen::VectorXd::Zero(inertia_->follows.rows());
  for (std::size_t i = 0; i < number_.size(); ++i)
    if (number_[i] >= 0) inertia_->of_interior[number_[i]] = mass[Eigen::Index(i)];
  const Matrix interface_forces =
      condensation_->interface_forces(inertia_->of_interior.asDiagonal() * inertia_->follows);
  inertia_->of_interface.resize(n);
  for (Eigen::Index i = 0; i < n; ++i)
    inertia_->of_interface[i] = interface_forces(i, components[std::size_t(i)] % 3);
  return inertia_->of_interface;
}

Vec3d CondensedRegion::unit_inertia_error() {
  if (!inertia_) return Vec3d::Zero();
  const auto masses = inertia_->of_interior.asDiagonal();
  if (!inertia_->unit_inertia_error) {
    const Matrix error = condensation_->fixed_interface_response(masses * inertia_->follows);
    inertia_->unit_inertia_error = (masses * error.cwiseAbs2()).colwise().sum().cwiseSqrt();
  }
  return *inertia_->unit_inertia_error;
}

void CondensedRegion::promote(const Components& components) { take({Kind::promote, components}); }
void CondensedRegion::add(const Components& components) { take({Kind::add, components}); }
void CondensedRegion::change(const Components& components, const Change& change, const Change& repeated) {
  take({Kind::change, components, change, repeated});
}
bool CondensedRegion::demote(const Components& components) { return take({Kind::demote, components}); }
void CondensedRegion::forget(const Components& components) { take({Kind::forget, components}); }

bool CondensedRegion::take(Operation operation) {
  if (operation.components.empty()) return true;
  operation.worked = apply(operation, operation.change);
  const bool worked = operation.worked;
  if (is_recorded_) operations_.push_back(std::move(operation));
  return worked;
}

bool CondensedRegion::apply(const Operation& operation, const Change& change) {
  inertia_.reset();
  const Condensation::Dofs dofs = numbers(operation.components);
  switch (operation.kind) {
    case Kind::promote:
      condensation_->promote(dofs);
      return true;
    case Kind::add: {
      const Index last = *std::max_element(operation.components.begin(), operation.components.end());
      number_.resize(std::max(number_.size(), std::size_t(last) + 1), -1);
      Index next = condensation_->add(static_cast<Index>(dofs.size()), spring_);
      for (Index component : operation.components) number_[std::size_t(component)] = next++;
      return true;
    }
    case Kind::change: {
      if (condensation_->change(dofs, change.stiffness, change.loads)) return true;
      Condensation::Dofs inside;
      for (Index dof : dofs)
        if (condensation_->column(dof) < 0) inside.push_back(dof);
      condensation_->promote(inside);
      condensation_->change(dofs, change.stiffness, change.loads);
      return false;
    }
    case Kind::demote:
      return condensation_->demote(dofs);
    case Kind::forget: {
      Condensation::Dofs outside;
      for (Index dof : dofs)
        if (condensation_->column(dof) >= 0) outside.push_back(dof);
      condensation_->forget(outside);
      for (Index component : operation.components) number_[std::size_t(component)] = -1;
      return true;
    }
  }
  return true;
}

bool CondensedRegion::repeat_on(CondensedRegion& other) const {
  return std::all_of(operations_.begin(), operations_.end(), [&](const Operation& operation) {
    return other.apply(operation, operation.repeated) == operation.worked;
  });
}

}  // namespace lobe
