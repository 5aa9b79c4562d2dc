// A condensed region by the components of the mesh, 3 × vertex + axis: which of them it knows, and the operations of
// condensed.h on them. They may be recorded, to be repeated on another that was condensed from an earlier state.
#pragma once

#include "lobe/condense/condensed_cache.h"
#include "lobe/condense/region_factor.h"

namespace lobe {

class ReducedRegion {
 public:
  using Matrix = Condensed::Matrix;
  using Components = std::vector<Index>;

  // The region as it is, condensed to these components.
  ReducedRegion(const RegionFactor& region, const Components& interface,
                const Matrix& loads,  // 3 × #vertices, #amplitudes [N]
                CondensedCache& cache, const SparseFactorMaker& make_factor);

  bool has(Index component) const { return number(component) >= 0; }
  Index column(Index component) const {  // of the stiffness, less the amplitudes; −1 if it is interior
    return has(component) ? condensed_->column(number(component)) : -1;
  }
  bool is_interior(Index component) const { return has(component) && column(component) < 0; }
  Index touched() const { return condensed_->touched(); }
  Components interface() const;  // in the order of the columns
  const Matrix& stiffness() const { return condensed_->stiffness(); }
  Matrix field(const Matrix& driven) const;  // per component, 0 where there is none

  void promote(const Components& components);
  void add(const Components& components);
  // What would become a mechanism is promoted. Components of which nothing is left are held by springs, if `gone`.
  void change(const Components& components, const Matrix& stiffness, const Matrix& loads);
  bool demote(const Components& components);  // false if it would be a mechanism
  void forget(const Components& components);
  double spring() const { return spring_; }  // of the size of the stiffness [N/m]

  void record() { is_recorded_ = true; }
  // The same operations on another; false if they do not end the same way.
  bool repeat_on(ReducedRegion& other) const;

 private:
  enum class Kind : std::uint8_t { promote, add, change, demote, forget };
  struct Step {
    Kind kind;
    Components components;
    Matrix stiffness = {}, loads = {};
    bool worked = true;
  };
  bool take(Step step);
  bool apply(const Step& step);
  Index number(Index component) const {
    return std::size_t(component) < number_.size() ? number_[std::size_t(component)] : -1;
  }
  Condensed::Dofs numbers(const Components& components) const;

  std::vector<Index> number_;  // per component, in condensed_
  double spring_ = 1;
  std::unique_ptr<Condensed> condensed_;
  bool is_recorded_ = false;
  std::vector<Step> steps_;
};

}  // namespace lobe
