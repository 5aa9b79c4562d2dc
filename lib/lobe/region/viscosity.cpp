#include "lobe/region/viscosity.h"

#include <algorithm>
#include <cmath>

#include "lobe/assert.h"
#include "lobe/fem/svk.h"

namespace lobe {

template <class Real>
std::vector<typename Viscosity<Real>::Term> Viscosity<Real>::branches_of(const Elastic& elastic) {
  const std::span<const PronyTerm> series = elastic.prony_series();
  std::vector<Term> branches;
  for (std::size_t i = 0; i < series.size(); ++i) {
    const ViscousBranch<double> branch = viscous_branch(series, i, elastic.lambda, elastic.mu, 0);
    branches.push_back({branch.lambda, branch.mu, series[i].time});
  }
  return branches;
}

template <class Real>
void Viscosity<Real>::fit(Index p, std::uint16_t material, std::size_t blocks) {
  if (std::size_t(p) >= patches_.size()) patches_.resize(std::size_t(p) + 1);
  Patch& patch = patches_[std::size_t(p)];
  if (patch.terms != terms(material)) patch.strains.clear();
  patch.terms = terms(material);
  patch.strains.resize(blocks * std::size_t(patch.terms));
}

template <class Real>
typename Viscosity<Real>::Strains Viscosity<Real>::strains(Index p, Index item) const {
  const Patch& patch = patches_[std::size_t(p)];
  Strains of_item{};
  for (int i = 0; i < patch.terms; ++i)
    for (int k = 0; k < 6; ++k)
      of_item[std::size_t(6 * i + k)] =
          patch.strains[std::size_t(item / width * patch.terms + i)].A[std::size_t(k)][item % width];
  return of_item;
}

template <class Real>
void Viscosity<Real>::set(Index p, Index item, const Strains& of_item) {
  Patch& patch = patches_[std::size_t(p)];
  for (int i = 0; i < patch.terms; ++i)
    for (int k = 0; k < 6; ++k)
      patch.strains[std::size_t(item / width * patch.terms + i)].A[std::size_t(k)][item % width] =
          of_item[std::size_t(6 * i + k)];
}

template <class Real>
void Viscosity<Real>::set(Index p, Index item, const Mat3<double>& E) {
  const std::array<double, 6> six{E(0, 0), E(1, 1), E(2, 2), E(0, 1), E(0, 2), E(1, 2)};
  Strains of_item{};
  for (std::size_t i = 0; i < of_item.size(); ++i) of_item[i] = static_cast<Real>(six[i % 6]);
  set(p, item, of_item);
}

template <class Real>
void Viscosity<Real>::save(Index p, Index item, std::vector<Real>& out) const {
  const Strains of_item = strains(p, item);
  out.insert(out.end(), of_item.begin(), of_item.begin() + 6 * patches_[std::size_t(p)].terms);
}

template <class Real>
bool Viscosity<Real>::load(Index p, Index item, std::span<const Real>& from) {
  const auto count = std::size_t(6 * patches_[std::size_t(p)].terms);
  if (count > from.size()) return false;
  Strains of_item{};
  std::copy_n(from.begin(), count, of_item.begin());
  set(p, item, of_item);
  from = from.subspan(count);
  return true;
}

template <class Real>
void Viscosity<Real>::find_factors() {
  factors_.assign(branches_.size(), {});
  for (std::size_t material = 0; material < branches_.size(); ++material)
    for (std::size_t i = 0; i < branches_[material].size(); ++i) {
      const Term& term = branches_[material][i];
      factors_[material][i] = {static_cast<Real>(term.lambda), static_cast<Real>(2 * term.mu),
                               static_cast<Real>(std::exp(-step_.before / term.time)),
                               static_cast<Real>(std::exp(-(step_.before + step_.after) / term.time))};
    }
}

template <class Real>
ViscousArrays<Real> Viscosity<Real>::arrays(Index p, std::uint16_t material) {
  Patch& patch = patches_[std::size_t(p)];
  lobe_assert(patch.terms == terms(material), "viscosity: a patch has the strains of another material");
  return {patch.strains.data(), patch.terms, step_.follows, factors_[material]};
}

template <class Real>
Mat3<double> green_strain_of(const Elements& elements, Index tet, const Mat3X<Real>& u) {
  const Mat34<double> at_corners = u(Eigen::all, elements.topology.corners(tet)).template cast<double>();
  return green_strain(
      displacement_gradient<double>(at_corners, elements.shape_of(tet).gradients.template rightCols<3>()));
}

template class Viscosity<float>;
template class Viscosity<double>;
template Mat3<double> green_strain_of(const Elements&, Index, const Mat3X<float>&);
template Mat3<double> green_strain_of(const Elements&, Index, const Mat3X<double>&);

}  // namespace lobe
