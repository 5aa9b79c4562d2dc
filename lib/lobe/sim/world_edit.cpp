// Edits of a World: everything follows a cut or a change of regions around what changed.
#include <algorithm>

#include "lobe/condense/anchors.h"
#include "lobe/error.h"
#include "lobe/region/energy_density.h"
#include "lobe/sim/world.h"

namespace lobe {
namespace {

void make_unique(std::vector<Index>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

template <class Real>
double energy_of(const Elements& elements, const std::vector<Index>& tets, const Mat3X<Real>& u) {  // [J]
  double sum = 0;
  for (Index t : tets) {
    const Shape s = elements.shape_of(t);
    const Mat34<Real> own = u(Eigen::all, elements.topology.corners(t));
    const Mat3<double> H =
        displacement_gradient<double>(own.template cast<double>(), s.gradients.rightCols<3>());
    sum += s.volume * energy_density(elements, t, H);
  }
  return sum;
}

}  // namespace

template <class Real>
Index World<Real>::remove_tets(const std::vector<Index>& tets) {
  check_tets(tets);
  if (std::none_of(tets.begin(), tets.end(), [&](Index t) { return elements_.topology.alive(t); })) return 0;
  const MeshEdit edit = cut(tets);
  if (edit.empty()) return 0;
  Index removed = static_cast<Index>(edit.removed.size());
  if (needs_all_pieces(edit))
    removed += treat_loose_pieces(elements_.topology.pieces());
  else if (!edit.cut_off.empty())
    removed += treat_loose_pieces(pieces_to_judge(edit));
  if (elements_.topology.alive_count() == 0)
    pending_.push_back({Condition::Kind::everything_cut, "no tetrahedron is left", state_.time});
  return removed;
}

template <class Real>
MeshEdit World<Real>::cut(const std::vector<Index>& tets) {
  catch_up();
  state();
  MeshEdit edit = elements_.topology.remove(tets);
  if (edit.empty()) return edit;
  follow(edit);
  history_.push_back({Edit::Kind::removal, {}, edit.removed});
  return edit;
}

template <class Real>
void World<Real>::follow(const MeshEdit& mesh_edit) {
  const Index before = state_.u.count(), after = elements_.topology.vertex_count();
  elements_.points.extend(after);
  state_.u.extend(after);
  state_.v.extend(after);
  RegionEdit edit;
  edit.left = mesh_edit.removed;
  for (const VertexSplit& split : mesh_edit.splits) {
    elements_.points.col(split.copy) = elements_.points.col(split.vertex);
    state_.u.col(split.copy) = state_.u.col(split.vertex);
    state_.v.col(split.copy) = state_.v.col(split.vertex);
    held_.split(split.vertex, split.copy);
    if (!mass_factor_.empty()) mass_factor_.push_back(mass_factor_[split.vertex]);
    edit.entered.insert(edit.entered.end(), split.tets.begin(), split.tets.end());
    edit.vertices.push_back(split.vertex);
  }
  for (Index v = before; v < after; ++v) edit.vertices.push_back(v);
  make_unique(edit.entered);
  edit.left.insert(edit.left.end(), edit.entered.begin(), edit.entered.end());
  for (Index t : edit.left)
    for (int c = 0; c < 4; ++c) edit.vertices.push_back(elements_.topology.tets()(c, t));
  make_unique(edit.vertices);
  follow_frequencies(mesh_edit);
  follow(std::move(edit));
}

// What nothing keeps in place within the precomputed region after an edit will turn: it becomes non-linear.
template <class Real>
void World<Real>::add_unanchored(RegionEdit& edit) {
  if (std::none_of(edit.left.begin(), edit.left.end(), [&](Index t) { return precomputed_.has(t); })) return;
  const std::vector<Index> tets = unanchored_tets(elements_, held_);
  if (tets.empty()) return;
  const RegionEdit change = change_of_region(tets, RegionModel::nonlinear);
  for (auto list : {&RegionEdit::left, &RegionEdit::entered, &RegionEdit::vertices}) {
    (edit.*list).insert((edit.*list).end(), (change.*list).begin(), (change.*list).end());
    make_unique(edit.*list);
  }
  pending_.push_back(
      {Condition::Kind::pieces,
       std::to_string(tets.size()) + " precomputed tetrahedra are no longer held and became nonlinear",
       state_.time});
}

template <class Real>
void World<Real>::follow(RegionEdit edit) {
  add_unanchored(edit);
  tensor_mass_.follow(elements_, edit);
  nonlinear_.follow(elements_, edit);
  if (setup_.expandable) expanded_.follow(elements_, edit, RegionModel::precomputed);
  refresh_vertices(edit.vertices);
  const std::vector<Index> mechanism =
      precomputed_.follow(elements_, held_, edit, external_.padded(), dead_loads_.padded(), is_expanded_);
  if (const std::string notice = precomputed_.take_notice(); !notice.empty())
    pending_.push_back({Condition::Kind::cache, notice, state_.time});
  if (is_expanded_)
    refresh_vertices(edit.vertices);
  else if (precomputed_.has_changed())
    move_mass(edit.vertices);
  implicit_is_stale_ = true;
  interior_ = Interior::stale;
  if (precomputed_.tet_count() > 0) known_ = Known::stale;
  kept_is_stale_ = true;
  wake(edit.vertices);
  if (!mechanism.empty()) follow(change_of_region(mechanism, RegionModel::nonlinear));
}

// Vertices that somebody has taken hold of or let go.
template <class Real>
void World<Real>::refresh_held(const HeldVertices& before) {
  RegionEdit edit;
  for (const HeldVertices::Held& item : before.all()) edit.vertices.push_back(item.vertex);
  for (const HeldVertices::Held& item : held_.all()) edit.vertices.push_back(item.vertex);
  make_unique(edit.vertices);
  if (precomputed_.tet_count() > 0) history_.push_back({Edit::Kind::held, {}, {}, held_});
  follow(std::move(edit));
}

template <class Real>
CornerStiffness World<Real>::stiffness_of(Index tet) const {
  const Mat34<Real> u = state_.u.padded()(Eigen::all, elements_.topology.corners(tet));
  return corner_stiffness(elements_, tet, u.template cast<double>());
}

// What tetrahedra add to the stiffness of their corners goes with them, or moves to the copy of a vertex. All is found
// anew with nodal pressure, beside a precomputed region, and where the tetrahedron of the smallest volume ratio goes.
template <class Real>
void World<Real>::follow_frequencies(const MeshEdit& edit) {
  const bool is_local =
      precomputed_.tet_count() == 0 && !any_nodal_pressure(elements_.materials) &&
      std::find(edit.removed.begin(), edit.removed.end(), volume_ratio_tet_) == edit.removed.end();
  known_ = known_ != Known::stale && is_local ? Known::followed : Known::stale;
  if (known_ == Known::stale) return;
  frequencies_.extend(elements_.topology.vertex_count());
  for (Index t : edit.removed) frequencies_.subtract(elements_.topology.corners(t), stiffness_of(t));
  for (const VertexSplit& split : edit.splits)
    for (Index t : split.tets) {
      const Eigen::Vector4i corners = elements_.topology.corners(t);
      const CornerStiffness K = stiffness_of(t);
      for (int c = 0; c < 4; ++c) {
        if (corners[c] != split.copy) continue;
        frequencies_.add(split.copy, K.col(c));
        frequencies_.add(split.vertex, -K.col(c));
      }
    }
}

template <class Real>
void World<Real>::refresh_vertices(const std::vector<Index>& vertices) {
  const Index n = elements_.topology.vertex_count();
  for (auto* masses : {&mass_, &inverse_mass_}) masses->resize(std::size_t(n), 0);
  for (Columns* columns : {&external_, &dead_loads_, &forces_}) columns->extend(n);
  turns_.resize(std::size_t(n));
  sleep_.extend(n, state_.time);
  ratios_.extend(n);
  if (setup_.selective_mass > 1)
    inertia_edits_.insert(inertia_edits_.end(), vertices.begin(), vertices.end());
  for (Index v : vertices) {
    mass_[v] = lumped_mass(elements_, v) * (mass_factor_.empty() ? 1.0 : mass_factor_[v]);
    refresh_inverse_mass(v);
    if (elements_.topology.around(v).empty()) state_.v.col(v).setZero();
    dead_loads_.col(v) = loads_.at(elements_, v).template cast<Real>();
    external_.col(v) = dead_loads_.col(v) + (mass_[v] * setup_.gravity).template cast<Real>();
  }
}

template <class Real>
void World<Real>::refresh_inverse_mass(Index v) {
  inverse_mass_[v] = mass_[v] > 0 && !held_.fixes(v) ? 1 / mass_[v] : 0;
  implicit_is_stale_ = moving_is_stale_ = inertia_is_stale_ = true;
  ratios_.forget(v);
  if (known_ != Known::stale) frequencies_.update(v, weight_of(v));
}

template <class Real>
double World<Real>::set_region(const std::vector<Index>& tets, RegionModel model) {
  check_tets(tets);
  if (model == RegionModel::precomputed) refuse_precomputed(tets);
  const bool is_local = precomputed_.tet_count() == 0 && model != RegionModel::precomputed &&
                        !any_nodal_pressure(elements_.materials);  // to the energies of these tetrahedra
  std::vector<Index> own = tets;
  make_unique(own);
  std::erase_if(own, [&](Index t) { return !elements_.topology.alive(t); });
  std::erase_if(unravelling_.tets, [&](Index t) { return std::binary_search(own.begin(), own.end(), t); });
  if (std::all_of(own.begin(), own.end(), [&](Index t) { return elements_.region_of[t] == model; })) return 0;
  catch_up();
  const auto energy = [&] {
    return is_local ? energy_of(elements_, own, state_.u.padded()) : energies().total();
  };
  const double before = energy();
  change_region(tets, model);
  return energy() - before;
}

template <class Real>
void World<Real>::refuse_precomputed(const std::vector<Index>& tets) {
  if (implicit_)
    throw InputError("region", "the implicit integrator has no precomputed regions; use tensor-mass");
  if (setup_.mass_scaling > 0)
    throw InputError("region", "mass scaling is not available beside precomputed regions; use tensor-mass");
  Elements changed = elements_;
  for (Index t : tets) changed.region_of[t] = RegionModel::precomputed;
  refuse_unanchored(changed, held_);
}

template <class Real>
void World<Real>::change_region(const std::vector<Index>& tets, RegionModel model) {
  catch_up();
  state();
  RegionEdit edit = change_of_region(tets, model);
  if (edit.left.empty()) return;
  history_.push_back({Edit::Kind::region, model, edit.left});
  follow(std::move(edit));
}

template <class Real>
RegionEdit World<Real>::change_of_region(const std::vector<Index>& tets, RegionModel model) {
  RegionEdit edit;
  if (precomputed_.tet_count() > 0 || any_nodal_pressure(elements_.materials)) known_ = Known::stale;
  for (Index t : tets) {
    if (!elements_.topology.alive(t) || elements_.region_of[t] == model) continue;
    const Eigen::Vector4i corners = elements_.topology.corners(t);
    if (known_ != Known::stale) frequencies_.subtract(corners, stiffness_of(t));
    elements_.region_of[t] = model;
    if (known_ != Known::stale) frequencies_.subtract(corners, -stiffness_of(t));
    edit.left.push_back(t);
    for (int c = 0; c < 4; ++c) edit.vertices.push_back(elements_.topology.tets()(c, t));
  }
  edit.entered = edit.left;
  make_unique(edit.vertices);
  if (known_ != Known::stale && !edit.left.empty()) known_ = Known::followed;
  return edit;
}

template <class Real>
void World<Real>::check_tets(const std::vector<Index>& tets) const {
  for (Index t : tets)
    if (t < 0 || t >= elements_.topology.tet_count())
      throw InputError("tetrahedron " + std::to_string(t),
                       "there are " + std::to_string(elements_.topology.tet_count()) + ", numbered from 0");
}

template <class Real>
Setup World<Real>::current_setup(CompactMesh& c) const {
  c = compact(elements_.topology, elements_.points.view(), elements_.labels);
  Setup setup = setup_;
  setup.mesh = c.mesh;
  setup.material_of.clear();
  setup.region_of.clear();
  for (Index t : c.tet_source) {
    setup.material_of.push_back(elements_.material_of[t]);
    setup.region_of.push_back(elements_.region_of[t]);
  }
  setup.prescribed.clear();
  for (const HeldVertices::Held& item : held_.all()) {
    const bool grasped = item.holder != HeldVertices::boundary;
    const Vec3d goal = grasped ? state_.u.col(item.vertex).template cast<double>() : item.goal;
    if (c.vertex_target[item.vertex] >= 0)
      setup.prescribed.push_back({c.vertex_target[item.vertex], goal, item.axes});
  }
  std::erase_if(setup.face_loads, [&](const FaceLoad& load) { return c.tet_target[load.tet] < 0; });
  for (FaceLoad& load : setup.face_loads) load.tet = c.tet_target[load.tet];
  std::erase_if(setup.vertex_loads, [&](const VertexLoad& load) { return c.vertex_target[load.vertex] < 0; });
  for (VertexLoad& load : setup.vertex_loads) load.vertex = c.vertex_target[load.vertex];
  setup.grasps.clear();
  setup.cauteries.clear();
  return setup;
}

template class World<float>;
template class World<double>;

}  // namespace lobe
