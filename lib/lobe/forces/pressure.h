// The force term of pressure on faces of the body (setup/pressures.h), which follows cuts.
//
// The force on a corner turns at a right angle to the motion of that corner, so the term adds no diagonal
// stiffness: ∂f_a/∂x_a = −p/6 [c − b]× is antisymmetric.
#pragma once

#include "lobe/forces/force_term.h"
#include "lobe/setup/pressures.h"

namespace lobe {

template <class Real>
class Pressure : public ForceTerm<Real> {
 public:
  using At = typename ForceTerm<Real>::At;

  explicit Pressure(const Setup& setup) : pressures_(setup.pressures), ramp_(setup.load_ramp) {}

  static constexpr const char* term_name = "pressure";
  std::string name() const override { return term_name; }
  void add_forces(const At& at, Mat3X<Real>& f) override;
  std::vector<Index> acts_on(const Model& model) const override;
  void follow(const Topology& topology, const MeshEdit& edit) override;
  void add_to_setup(const Elements&, const CompactMesh& left, Setup& setup) const override;
  std::string save() const override;
  void load(const std::string& saved, Index vertices) override;

 private:
  std::vector<FacePressure> pressures_;
  double ramp_ = 0;  // [s] over which they grow
};

extern template class Pressure<float>;
extern template class Pressure<double>;

}  // namespace lobe
