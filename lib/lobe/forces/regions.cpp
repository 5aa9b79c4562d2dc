#include "lobe/forces/regions.h"

#include "lobe/condense/supports.h"
#include "lobe/numerics/supernodal_factor.h"

namespace lobe {

template <class Real>
Regions<Real>::Regions(const Setup& setup, const CondensingLog::Progress& condensing)
    : free_(free_regions<Real>(setup.evaluator)),
      expanded_(setup.evaluator),
      precomputed_(CondensingLog(condensing), make_supernodal),
      reduced_(setup.lattice_cell, setup.evaluator),
      expandable_(setup.expandable) {}

template <class Real>
void Regions<Real>::refuse(RegionModel model, const std::vector<Index>& tets, const Model& body,
                           double lattice_cell) const {
  const bool is_precomputed = model == RegionModel::precomputed;
  const bool needs_lattice = model == RegionModel::reduced && !(reduced_.lattice().frame.edge > 0);
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
  for_free([&](auto& region) { region.follow(elements, edit); });
  reduced_.follow(elements, edit);
  if (expandable_) expanded_.follow(elements, edit, RegionModel::precomputed);
}

template <class Real>
std::vector<Index> Regions<Real>::follow_condensed(const Model& model, const RegionEdit& edit,
                                                   Loads<Real>& loads) {
  return precomputed_.follow(model.elements, model.held, edit, loads.external(), loads.dead(), is_expanded_);
}

template <class Real>
std::vector<Index> Regions<Real>::condensed_vertices(Index vertices) const {
  std::vector<Index> found = precomputed_.shared();
  for (Index v = 0; v < vertices; ++v)
    if (precomputed_.is_interior(v)) found.push_back(v);
  return found;
}

template <class Real>
void Regions<Real>::begin_condensing(const Elements& elements, double due, const std::vector<double>& about) {
  if (about.empty())
    precomputed_.begin_condensing(elements);
  else
    precomputed_.begin_relinearising(
        elements, Eigen::Map<const Mat3X<double>>(about.data(), 3, Eigen::Index(about.size() / 3)));
  condensing_due_ = due;
}

template <class Real>
std::optional<VertexRoles> Regions<Real>::new_roles(const Model& model, const Motion<Real>& motion,
                                                    const std::vector<double>& mass, FullZones::Sight sight,
                                                    bool may_embed) {
  reduced_.look(model.elements, motion, mass, std::move(sight));
  VertexRoles roles = reduced_.roles(model, motion.time, may_embed);
  return reduced_.has_roles(roles) ? std::nullopt : std::optional(std::move(roles));
}

template <class Real>
VertexRoles Regions<Real>::begin_restoring(const Model& model, const State& state,
                                           std::vector<Index>& weighed) {
  reduced_.set_zones(state.zones);
  reduced_.holds_have_changed();
  weighed = reduced_.set_asked_mass(state.asked_mass);
  return reduced_.roles(model, state.is_embedded);
}

template <class Real>
void Regions<Real>::end_restoring(const Elements& elements, const State& state, Motion<Real>& motion) {
  motion.nodes.u = state.u;
  motion.nodes.v = state.v;
  reduced_.set_fading(elements, state.fading);
}

template <class Real>
void Regions<Real>::add_free_forces(const Mat3X<Real>& u, Mat3X<Real>& f, Parallel& parallel) {
  for_free([&](auto& region) { region.add_forces(u, f, parallel); });
  reduced_.add_full_forces(u, f, parallel);
  if (is_expanded_) expanded_.add_forces(u, f, parallel);
}

template <class Real>
void Regions<Real>::add_forces(const Mat3X<Real>& u, double missing_share, Mat3X<Real>& f,
                               Parallel& parallel) {
  if (!is_expanded_) precomputed_.add_forces(u, Real(missing_share), f, parallel);
  add_free_forces(u, f, parallel);
}

template <class Real>
void Regions<Real>::add_forces_near_rest(const Mat3X<Real>& u, Mat3X<Real>& f, Parallel& parallel) {
  add_free_forces(u, f, parallel);
  if (!is_expanded_) precomputed_.add_stiffness_forces(u, f, parallel);
}

template <class Real>
void Regions<Real>::add_tet_forces_near_rest(const Mat3X<Real>& u, Mat3X<Real>& f, Parallel& parallel) {
  for_free([&](auto& region) { region.add_forces(u, f, parallel); });
  reduced_.add_tet_forces(u, f, parallel);
  if (is_expanded_)
    expanded_.add_forces(u, f, parallel);
  else
    precomputed_.add_stiffness_forces(u, f, parallel);
}

template <class Real>
void Regions<Real>::add_forces_near(const Mat3X<Real>& u, double missing_share, Mat3X<Real>& f,
                                    Parallel& parallel) {
  add_free_forces(u, f, parallel);
  if (!is_expanded_) precomputed_.add_forces(u, Real(missing_share), f, parallel);
}

template <class Real>
SmallestVolumeRatio Regions<Real>::add_diagonal_stiffness(const Mat3X<Real>& u, DiagonalStiffness& K,
                                                          Parallel& parallel) {
  SmallestVolumeRatio found;
  const auto add = [&](auto& region) {
    const SmallestVolumeRatio other = region.add_diagonal_stiffness(u, K, parallel);
    if (other.smallest_volume_ratio < found.smallest_volume_ratio) found = other;
  };
  for_free(add);
  add(reduced_);
  if (is_expanded_)
    add(expanded_);
  else
    precomputed_.add_diagonal_stiffness(u, K);
  ++sums_revision_;
  return found;
}

template <class Real>
ElasticEnergy Regions<Real>::energy(const Elements& elements, const StateColumns<Real>& state) {
  const Mat3X<Real>& u = state.u.padded();
  ElasticEnergy e;
  for_free([&](auto& region) { (is_linear(region.model) ? e.linear : e.nonlinear) += region.energy(u); });
  if (is_expanded_) {
    e.nonlinear += expanded_.energy(u);
  } else {
    const auto condensed = precomputed_.energy(elements, u);
    e.condensed_loads = condensed.loads;
    e.linear += condensed.elastic;
  }
  if (any_reduced()) {
    e.nonlinear += reduced_.elastic_energy(u, state.nodes);
    e.condensed_loads += reduced_.energy_of_loads(state.nodes);
  }
  return e;
}

template <class Real>
Vec3d Regions<Real>::force_on_fixed(const Elements& elements, const Mat3X<Real>& u, Index vertex) const {
  return is_expanded_ ? Vec3d::Zero() : precomputed_.force_on_fixed(elements, u, vertex);
}

template <class Real>
void Regions<Real>::recover(const Model& model, double missing_share, Interior wanted,
                            StateColumns<Real>& state) {
  const Revisions& now = model.revisions;
  const bool is_current = recovered_at_.structure == now.structure &&
                          recovered_at_.displacements == now.displacements &&
                          recovered_at_.velocities == now.velocities;
  if (is_current && recovered_ >= wanted) return;
  if (!is_expanded_)
    precomputed_.recover(model.elements, Real(missing_share), state.u.padded(),
                         wanted == Interior::all ? &state.v.padded() : nullptr);
  if (reduced_.any_embedded()) reduced_.recover(model.elements, wanted == Interior::all, state);
  recovered_ = wanted;
  recovered_at_ = now;
}

template <class Real>
PatchCount Regions<Real>::patch_count() {
  PatchCount sum = reduced_.past_patches();
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
