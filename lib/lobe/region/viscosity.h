// The strains of dashpots (fem/prony.h) of the tetrahedra or smoothing domains of patches: A of each term,
// beside the blocks of patches whose material has a Prony series. A tetrahedron that enters with a history
// keeps it; one without is at rest in its present strain, and its branches carry nothing.
#pragma once

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "lobe/fem/elements.h"
#include "lobe/region/viscous_kernels.h"

namespace lobe {

using TetPairs = std::vector<std::pair<Index, Index>>;

// The time [s] from that of A to that of the displacements, and from there to when A is found again by the
// next evaluation of forces, if it follows them. Otherwise forces are evaluated and A is left.
struct ViscousStep {
  double before = 0, after = 0;
  bool follows = false;

  bool operator==(const ViscousStep&) const = default;
};

template <class Real>
class Viscosity {
 public:
  static constexpr int width = ElementBlock<Real>::width;
  using Strains = std::array<Real, 6 * most_prony_terms>;  // A of the terms of one item, one after the other

  // `takes_part`: of each material, whether it is evaluated here.
  template <class TakesPart>
  void set_materials(const std::vector<Elastic>& materials, TakesPart&& takes_part) {
    branches_.clear();
    any_ = false;
    for (const Elastic& elastic : materials) {
      branches_.push_back(takes_part(elastic) ? branches_of(elastic) : std::vector<Term>());
      any_ = any_ || !branches_.back().empty();
    }
    find_factors();
  }
  bool any() const { return any_; }  // whether any material is viscous
  int terms(std::uint16_t material) const { return static_cast<int>(branches_[material].size()); }

  void set_step(const ViscousStep& step) {
    if (step == step_) return;
    step_ = step;
    find_factors();
  }

  // Gives a patch of this material so many blocks. What it had is kept if it has as many terms as before.
  void fit(Index patch, std::uint16_t material, std::size_t blocks);
  bool has(Index patch) const {
    return std::size_t(patch) < patches_.size() && patches_[std::size_t(patch)].terms > 0;
  }
  Strains strains(Index patch, Index item) const;  // for the item in this lane of the patch
  void set(Index patch, Index item, const Strains& strains);
  void set(Index patch, Index item, const Mat3<double>& E);              // at rest in this strain
  void save(Index patch, Index item, std::vector<Real>& strains) const;  // appends those of the item
  // Takes those of the item off the front. False, and nothing is taken, if there are too few.
  bool load(Index patch, Index item, std::span<const Real>& strains);

  ViscousArrays<Real> arrays(Index patch, std::uint16_t material);  // what kernels need, at the present step

  // Before steps that may be taken back, and if they are.
  void keep() { kept_ = patches_; }
  void take_back() { patches_ = kept_; }

 private:
  struct Term {
    double lambda, mu, time;
  };
  struct Patch {
    int terms = 0;
    std::vector<DashpotStrains<Real>> strains;
  };
  static std::vector<Term> branches_of(const Elastic& elastic);
  void find_factors();

  std::vector<std::vector<Term>> branches_;  // per material
  bool any_ = false;
  ViscousStep step_;
  std::vector<std::array<Branch<Real>, most_prony_terms>> factors_;  // per material, of the step
  std::vector<Patch> patches_, kept_;
};

// The strain of a tetrahedron, of displacements of vertices [m].
template <class Real>
Mat3<double> green_strain_of(const Elements& elements, Index tet, const Mat3X<Real>& u);

extern template class Viscosity<float>;
extern template class Viscosity<double>;

}  // namespace lobe
