#include "lobe/condense/reduced_region.h"

#include <algorithm>

namespace lobe {

ReducedRegion::ReducedRegion(const RegionFactor& region, const Components& interface, const Matrix& loads,
                             CondensedCache& cache, const SparseFactorMaker& make_factor)
    : number_(region.number.data(), region.number.data() + region.number.size()),
      spring_(region.mean_stiffness) {
  Matrix own = Matrix::Zero(region.size, loads.cols());
  for (std::size_t i = 0; i < number_.size(); ++i)
    if (number_[i] >= 0) own.row(number_[i]) = loads.row(Eigen::Index(i));
  condensed_ = cache.condense(region, own, numbers(interface), make_factor);
}

Condensed::Dofs ReducedRegion::numbers(const Components& components) const {
  Condensed::Dofs dofs;
  for (Index component : components) dofs.push_back(number(component));
  return dofs;
}

ReducedRegion::Components ReducedRegion::interface() const {
  Components components(condensed_->interface().size());
  for (std::size_t i = 0; i < number_.size(); ++i)
    if (const Index at = column(static_cast<Index>(i)); at >= 0)
      components[std::size_t(at)] = static_cast<Index>(i);
  return components;
}

ReducedRegion::Matrix ReducedRegion::field(const Matrix& driven) const {
  const Matrix own = condensed_->field(driven);
  Matrix field = Matrix::Zero(Eigen::Index(number_.size()), driven.cols());
  for (std::size_t i = 0; i < number_.size(); ++i)
    if (number_[i] >= 0) field.row(Eigen::Index(i)) = own.row(number_[i]);
  return field;
}

const Eigen::VectorXd& ReducedRegion::inertia(const Eigen::VectorXd& mass, const Components& moving) {
  if (inertia_) return inertia_->of_interface;
  inertia_ = Inertia{};
  const Components own = interface();
  const auto n = Eigen::Index(own.size()), amplitudes = Eigen::Index(stiffness().cols()) - n;
  Matrix unit = Matrix::Zero(amplitudes + n, 3);
  for (Index component : moving) unit(amplitudes + column(component), component % 3) = 1;
  inertia_->follows = condensed_->field(unit);
  inertia_->of_interior = Eigen::VectorXd::Zero(inertia_->follows.rows());
  for (std::size_t i = 0; i < number_.size(); ++i)
    if (number_[i] >= 0) inertia_->of_interior[number_[i]] = mass[Eigen::Index(i)];
  const Matrix borne = condensed_->borne(inertia_->of_interior.asDiagonal() * inertia_->follows);
  inertia_->of_interface.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) inertia_->of_interface[i] = borne(i, own[std::size_t(i)] % 3);
  return inertia_->of_interface;
}

Vec3d ReducedRegion::sway() {
  if (!inertia_) return Vec3d::Zero();
  const auto masses = inertia_->of_interior.asDiagonal();
  if (!inertia_->sway) {
    const Matrix behind = condensed_->held(masses * inertia_->follows);
    inertia_->sway = (masses * behind.cwiseAbs2()).colwise().sum().cwiseSqrt();
  }
  return *inertia_->sway;
}

void ReducedRegion::promote(const Components& components) { take({Kind::promote, components}); }
void ReducedRegion::add(const Components& components) { take({Kind::add, components}); }
void ReducedRegion::change(const Components& components, const Change& change, const Change& repeated) {
  take({Kind::change, components, change, repeated});
}
bool ReducedRegion::demote(const Components& components) { return take({Kind::demote, components}); }
void ReducedRegion::forget(const Components& components) { take({Kind::forget, components}); }

bool ReducedRegion::take(Step step) {
  if (step.components.empty()) return true;
  step.worked = apply(step, step.change);
  const bool worked = step.worked;
  if (is_recorded_) steps_.push_back(std::move(step));
  return worked;
}

bool ReducedRegion::apply(const Step& step, const Change& change) {
  inertia_.reset();
  const Condensed::Dofs dofs = numbers(step.components);
  switch (step.kind) {
    case Kind::promote:
      condensed_->promote(dofs);
      return true;
    case Kind::add: {
      const Index last = *std::max_element(step.components.begin(), step.components.end());
      number_.resize(std::max(number_.size(), std::size_t(last) + 1), -1);
      Index next = condensed_->add(static_cast<Index>(dofs.size()), spring_);
      for (Index component : step.components) number_[std::size_t(component)] = next++;
      return true;
    }
    case Kind::change: {
      if (condensed_->change(dofs, change.stiffness, change.loads)) return true;
      Condensed::Dofs inside;
      for (Index dof : dofs)
        if (condensed_->column(dof) < 0) inside.push_back(dof);
      condensed_->promote(inside);
      condensed_->change(dofs, change.stiffness, change.loads);
      return false;
    }
    case Kind::demote:
      return condensed_->demote(dofs);
    case Kind::forget: {
      Condensed::Dofs outside;
      for (Index dof : dofs)
        if (condensed_->column(dof) >= 0) outside.push_back(dof);
      condensed_->forget(outside);
      for (Index component : step.components) number_[std::size_t(component)] = -1;
      return true;
    }
  }
  return true;
}

bool ReducedRegion::repeat_on(ReducedRegion& other) const {
  return std::all_of(steps_.begin(), steps_.end(),
                     [&](const Step& step) { return other.apply(step, step.repeated) == step.worked; });
}

}  // namespace lobe
