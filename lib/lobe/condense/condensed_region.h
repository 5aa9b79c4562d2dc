// A condensed region in terms of the components of the mesh, 3 × vertex + axis: which of them it has, and the
// operations of condensation.h on them. The operations may be recorded, to be repeated on a region that was
// condensed from an earlier state.
#pragma once

#include <optional>

#include "lobe/condense/condensation.h"
#include "lobe/condense/region_factor.h"

namespace lobe {

class CondensedRegion {
 public:
  using Matrix = Condensation::Matrix;
  using Components = std::vector<Index>;

  // Condenses the region as it is now to these components.
  CondensedRegion(const RegionFactor& region, const Components& interface,
                  const Matrix& loads,  // 3 × #vertices, #amplitudes [N]
                  CondensingLog& log, const SparseFactorMaker& make_factor);

  bool has(Index component) const { return number(component) >= 0; }
  Index column(Index component) const {  // number after the amplitudes; −1 if it is interior
    return has(component) ? condensation_->column(number(component)) : -1;
  }
  bool is_interior(Index component) const { return has(component) && column(component) < 0; }
  Index touched() const { return condensation_->touched(); }
  double error() const { return condensation_->error(); }  // relative
  Components interface() const;                            // components of B, in the order of the columns
  const Matrix& stiffness() const { return condensation_->stiffness(); }
  Matrix field(const Matrix& driven) const;  // displacement of each component, 0 where it has none
  // The mass that the interior gives to each component of the interface, if the interface moves as a whole
  // along an axis. It is computed once, and again after an operation.
  const Eigen::VectorXd& inertia(
      const Eigen::VectorXd& mass,  // mass of each component, 0 outside of the interior [kg]
      const Components& moving);    // moving mass of each component of the interface [kg]
  // The displacement error of the interior because it has no inertia, per axis: √Σ m |u|² for 1 m/s² [√kg
  // s²]. It belongs to the last call of inertia(). It is 0 if there was none since the last operation.
  Vec3d unit_inertia_error();

  void promote(const Components& components);
  void add(const Components& components);
  struct Change {
    Matrix stiffness = {}, loads = {};
  };
  // Components that would become a mechanism are promoted. `repeated`: the change for a region that is
  // being condensed, which repeats it.
  void change(const Components& components, const Change& change, const Change& repeated);
  bool demote(const Components& components);  // false if the region would be a mechanism
  void forget(const Components& components);
  double spring() const { return spring_; }  // a stiffness of the size of the region's [N/m]

  void record() { is_recorded_ = true; }
  void forget_operations() {
    is_recorded_ = false;
    operations_.clear();
  }
  // Repeats the recorded operations on another region. False if one of them has another outcome there.
  bool repeat_on(CondensedRegion& other) const;

 private:
  enum class Kind : std::uint8_t { promote, add, change, demote, forget };
  struct Operation {
    Kind kind;
    Components components;
    Change change = {}, repeated = {};
    bool worked = true;
  };
  bool take(Operation operation);
  bool apply(const Operation& operation, const Change& change);
  Index number(Index component) const {
    return std::size_t(component) < number_.size() ? number_[std::size_t(component)] : -1;
  }
  Condensation::Dofs numbers(const Components& components) const;

  std::vector<Index> number_;  // number of each component in condensation_
  double spring_ = 1;
  std::unique_ptr<Condensation> condensation_;
  struct Inertia {
    Eigen::VectorXd of_interface, of_interior;  // mass per component of the interface, and per dof [kg]
    Matrix follows;                             // how the interior moves, dofs × axes
    std::optional<Vec3d> unit_inertia_error;
  };
  std::optional<Inertia> inertia_;
  bool is_recorded_ = false;
  std::vector<Operation> operations_;
};

}  // namespace lobe
