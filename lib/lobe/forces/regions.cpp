#include "lobe/forces/regions.h"

#include "lobe/condense/supports.h"
#include "lobe/numerics/supernodal_factor.h"

namespace lobe {
namespace {

// visit_regions() passes over a row that lacks a function. The lattice must have these. A pre-computed
// region, whose forces are added by name, must not.
template <class Region, class Real>
concept AddsForcesOfTets = requires(Region region, const Mat3X<Real>& u, Mat3X<Real>& f, Parallel& parallel) {
  region.add_forces(u, f, parallel);
};
template <class Region, class Real>
concept FollowsTets = requires(Region region, const Elements& elements, const RegionEdit& edit,
                               const Mat3X<Real>& u, DiagonalStiffness& K, Parallel& parallel) {
  region.follow(elements, edit);
  { region.add_diagonal_stiffness(u, K, parallel) } -> std::same_as<SmallestVolumeRatio>;
  region.visit_patches([](const auto&, auto&) {});
};
template <class Real>
constexpr bool are_visited_rightly =
    AddsForcesOfTets<LatticeRegion<Real>, Real>&& FollowsTets<LatticeRegion<Real>, Real> &&
    !AddsForcesOfTets<PrecomputedRegion<Real>, Real> && !FollowsTets<PrecomputedRegion<Real>, Real>;
static_assert(are_visited_rightly<float> && are_visited_rightly<double>);

template <class Real>
RegionList<Real> region_list(const Setup& setup, const CondensingLog::Progress& progress) {
  return {PrecomputedRegion<Real>(CondensingLog(progress), make_supernodal),
          TensorMassRegion<Real>(),
          NonlinearRegion<Real>(),
          CorotationalRegion<Real>(),
          LatticeRegion<Real>(setup.lattice_cell),
          ExpandedRegion<Real>(setup.expandable)};
}

}  // namespace

template <class Real>
Regions<Real>::Regions(const Setup& setup, const Progress& progress)
    : list_(region_list<Real>(setup, progress)), expandable_(setup.expandable) {}

template <class Real>
void Regions<Real>::refuse(RegionModel model, const std::vector<Index>& tets, const Model& body,
                           double lattice_cell) const {
  const bool is_precomputed = model == RegionModel::precomputed;
  const bool needs_lattice = model == RegionModel::reduced && !(reduced().lattice().frame.edge > 0);
  if (!is_precomputed && !needs_lattice) return;
  Elements changed = body.elements;
  for (Index t : tets) changed.region_of[std::size_t(t)] = model;
  if (is_precomputed) {
    refuse_unsupported(changed, body.held);
    PrecomputedRegion<Real>::refuse_large(changed, body.held);
  } else {
    choose_lattice(changed, lattice_cell);
  }
}

template <class Real>
void Regions<Real>::follow(const Elements& elements, const RegionEdit& edit) {
  visit_regions(
      list_, [&](auto& region) -> decltype(region.follow(elements, edit)) { region.follow(elements, edit); });
}

template <class Real>
void Regions<Real>::lay_out(const Elements& elements, const RegionEdit& everything, const Paces& paces) {
  const auto begin_anew = [&]<class Region>(Region& region) {
    region = Region();
    region.set_paces(paces);
    region.follow(elements, everything);
  };
  begin_anew(std::get<NonlinearRegion<Real>>(list_));
  begin_anew(std::get<CorotationalRegion<Real>>(list_));
  ++sums_revision_;
}

template <class Real>
void Regions<Real>::set_expanded(bool is_expanded) {
  visit_regions(list_, [&](auto& region) -> decltype(region.set_expanded(is_expanded)) {
    region.set_expanded(is_expanded);
  });
}

template <class Real>
void Regions<Real>::mark_without_patches(const Elements& elements, std::vector<std::uint8_t>& flags) const {
  if (!any_condensed()) return;
  for (Index t = 0; t < elements.topology.tet_count(); ++t)
    if (is_condensed(t))
      for (Index v : elements.topology.corners(t)) flags[std::size_t(v)] = 1;
}

template <class Real>
std::vector<Index> Regions<Real>::follow_condensed(const Model& model, const RegionEdit& edit,
                                                   Loads<Real>& loads) {
  return precomputed().follow(model.elements, model.held, edit, loads.external(), loads.dead());
}

template <class Real>
std::vector<Index> Regions<Real>::condensed_vertices(Index vertices) const {
  std::vector<Index> found = precomputed().shared();
  for (Index v = 0; v < vertices; ++v)
    if (precomputed().is_interior(v)) found.push_back(v);
  return found;
}

template <class Real>
void Regions<Real>::begin_condensing(const Elements& elements, double due, const std::vector<double>& about) {
  if (about.empty())
    precomputed().begin_condensing(elements);
  else
    precomputed().begin_relinearising(
        elements, Eigen::Map<const Mat3X<double>>(about.data(), 3, Eigen::Index(about.size() / 3)));
  condensing_due_ = due;
}

template <class Real>
void Regions<Real>::add_forces_of_tets(const Mat3X<Real>& u, Mat3X<Real>& f, Parallel& parallel) {
  visit_regions(list_, [&](auto& region) -> decltype(region.add_forces(u, f, parallel)) {
    region.add_forces(u, f, parallel);
  });
}

template <class Real>
void Regions<Real>::add_forces(const Mat3X<Real>& u, double missing_share, const ViscousStep& step,
                               Mat3X<Real>& f, Parallel& parallel) {
  set_step(step);
  precomputed().add_forces(u, Real(missing_share), f, parallel);
  add_forces_of_tets(u, f, parallel);
}

template <class Real>
void Regions<Real>::add_forces_near_rest(const Mat3X<Real>& u, Mat3X<Real>& f, Parallel& parallel) {
  set_step({});
  add_forces_of_tets(u, f, parallel);
  precomputed().add_stiffness_forces(u, f, parallel);
}

template <class Real>
void Regions<Real>::add_tet_forces_near_rest(const Mat3X<Real>& u, Mat3X<Real>& f, Parallel& parallel) {
  set_step({});
  visit_regions(list_, [&]<FreeRegion<Real> Region>(Region& region) { region.add_forces(u, f, parallel); });
  reduced().add_tet_forces(u, f, parallel);
  precomputed().add_stiffness_forces(u, f, parallel);
}

template <class Real>
void Regions<Real>::add_forces_near(const Mat3X<Real>& u, double missing_share, Mat3X<Real>& f,
                                    Parallel& parallel) {
  set_step({});
  add_forces_of_tets(u, f, parallel);
  precomputed().add_forces(u, Real(missing_share), f, parallel);
}

template <class Real>
SmallestVolumeRatio Regions<Real>::add_diagonal_stiffness(const Mat3X<Real>& u, DiagonalStiffness& K,
                                                          Parallel& parallel) {
  SmallestVolumeRatio found;
  visit_regions(list_, [&](auto& region) -> decltype(void(region.add_diagonal_stiffness(u, K, parallel))) {
    const SmallestVolumeRatio other = region.add_diagonal_stiffness(u, K, parallel);
    if (other.smallest_volume_ratio < found.smallest_volume_ratio) found = other;
  });
  precomputed().add_diagonal_stiffness(u, K);
  ++sums_revision_;
  return found;
}

template <class Real>
ElasticEnergy Regions<Real>::energy(const Elements& elements, const StateColumns<Real>& state) {
  const Mat3X<Real>& u = state.u.padded();
  set_step({state.velocity_lag, 0, false});
  ElasticEnergy e;
  visit_regions(list_, [&]<FreeRegion<Real> Region>(Region& region) {
    (is_linear(Region::model) ? e.linear : e.nonlinear) += region.energy(u);
  });
  const auto condensed = precomputed().energy(elements, u);
  e.loads = condensed.loads;
  e.linear += condensed.elastic;
  if (any_reduced()) {
    e.nonlinear += reduced().elastic_energy(u, state.nodes);
    e.loads += reduced().energy_of_loads(state.nodes);
  }
  return e;
}

template <class Real>
std::vector<Real> Regions<Real>::dashpots() const {
  std::vector<Real> strains;
  visit_viscous([&](const auto& patches) { patches.save(strains); });
  return strains;
}

template <class Real>
bool Regions<Real>::set_dashpots(const std::vector<Real>& strains) {
  std::span<const Real> left = strains;
  bool fits = true;
  visit_viscous([&](auto& patches) { fits = fits && patches.load(left); });
  return fits && left.empty();
}

template <class Real>
void Regions<Real>::recover(const Model& model, double missing_share, Interior wanted,
                            StateColumns<Real>& state) {
  const Revisions& now = model.revisions;
  const bool is_current = recovered_at_.structure == now.structure &&
                          recovered_at_.displacements == now.displacements &&
                          recovered_at_.velocities == now.velocities;
  if (is_current && recovered_ >= wanted) return;
  precomputed().recover(model.elements, Real(missing_share), state.u.padded(),
                        wanted == Interior::all ? &state.v.padded() : nullptr);
  if (reduced().any_embedded()) reduced().recover(model.elements, wanted == Interior::all, state);
  recovered_ = wanted;
  recovered_at_ = now;
}

template <class Real>
PatchCount Regions<Real>::patch_count() {
  PatchCount sum = reduced().past_patches();
  visit_patches([&](const auto&, const auto& sums) {
    sum.evaluated += sums.count().evaluated;
    sum.skipped += sums.count().skipped;
  });
  return sum;
}

template <class Real>
void Regions<Real>::forget_sums() {
  visit_patches([](const auto&, auto& sums) { sums.forget(); });
}

template class Regions<float>;
template class Regions<double>;

}  // namespace lobe
