// The one place where an Organ is changed by an edit, and how its parts follow that around what changed.
#include <algorithm>
#include <utility>

#include "lobe/assert.h"
#include "lobe/condense/supports.h"
#include "lobe/organ/organ.h"
#include "lobe/sort_unique.h"

namespace lobe {
namespace {

// What a cut means for the regions: the tetrahedra that went, have a copied vertex or another share, and all
// vertices of these, old and new.
RegionEdit region_edit_of(const MeshEdit& cut, const Topology& topology, Index vertices_before) {
  RegionEdit edit;
  edit.left = cut.removed;
  for (const VertexSplit& split : cut.splits) {
    edit.entered.insert(edit.entered.end(), split.tets.begin(), split.tets.end());
    edit.vertices.push_back(split.vertex);
    edit.copied.emplace_back(split.vertex, split.copy);
  }
  for (const TetShare& tet_share : cut.shares) edit.entered.push_back(tet_share.tet);
  for (const TetCopy& copy : cut.copies) edit.copied_tets.emplace_back(copy.tet, copy.copy);
  for (Index v = vertices_before; v < topology.vertex_count(); ++v) edit.vertices.push_back(v);
  sort_unique(edit.entered);
  edit.left.insert(edit.left.end(), edit.entered.begin(), edit.entered.end());
  std::vector<bool> is_listed(std::size_t(topology.vertex_count()), false);
  for (Index v : edit.vertices) is_listed[std::size_t(v)] = true;
  for (Index t : edit.left)
    for (Index v : topology.corners(t)) {
      if (!is_listed[std::size_t(v)]) edit.vertices.push_back(v);
      is_listed[std::size_t(v)] = true;
    }
  sort_unique(edit.vertices);
  return edit;
}

// The present shares of tetrahedra that get another one; 0 for new copies.
std::vector<double> shares_of(const Elements& elements, const MeshEdit& edit) {
  Index first_new = elements.topology.tet_count();
  for (const TetCopy& copy : edit.copies) first_new = std::min(first_new, copy.copy);
  std::vector<double> shares;
  for (const TetShare& tet_share : edit.shares)
    shares.push_back(tet_share.tet >= first_new ? 0 : elements.share_of(tet_share.tet));
  return shares;
}

}  // namespace

// make() changes rest data, and returns what it has changed.
template <class Real>
Change Organ<Real>::edit(const Before& before, const std::function<Change()>& make) {
  if (before.velocities) synchronise_velocities();
  if (before.followers) body_.recover(Regions<Real>::Interior::all);
  Change change;
  const auto change_body = [&] {
    change = make();
    if (change.entry) journal_.edits.push_back(std::move(*change.entry));
    follow(change);
  };
  if (before.energies)
    as_transition(change_body);
  else
    change_body();
  return change;
}

// Every part follows an edit, in this order.
template <class Real>
void Organ<Real>::follow(Change& change) {
  if (change.mesh) change.regions = follow_mesh(*change.mesh);
  if (change.regions) follow_regions(*change.regions);
  if (!change.frozen.empty()) follow_frozen(change.frozen);
  if (change.is_condensed_anew) follow_condensing();
  if (change.is_expanded) follow_mode(*change.is_expanded);
  if (change.roles) follow_roles(std::move(*change.roles));
  if (change.mass_degree) follow_mass_degree(*change.mass_degree);
  if (!change.weighed.empty()) update_vertices(change.weighed);
  if (change.has_terms) follow_terms(change.woken);
  if (change.has_new_terms) ++body_.model.revisions.terms;
  if (change.interior_is_sought) follow_search();
  if (change.former) body_.model.revisions = newer_than_both(*change.former, body_.model.revisions);
}

// Returns what it means for the regions: nothing if only grains have come apart.
template <class Real>
std::optional<RegionEdit> Organ<Real>::follow_mesh(const MeshEdit& edit) {
  if (edit.empty()) {
    display_.follow(elements(), blades_.grains(), edit);
    return {};
  }
  Elements& elements = body_.model.elements;
  Motion<Real>& motion = body_.motion;
  blades_.forget_prepared();
  const Index before = motion.u.count();
  const std::vector<double> shares_before = shares_of(elements, edit);
  elements.follow(edit);
  pieces_.follow(edit);
  for (const TetCopy& copy : edit.copies) groups_.add_copy(copy.tet, copy.copy);
  motion.extend(elements.topology.vertex_count());
  for (const VertexSplit& split : edit.splits) {
    lobe_assert(split.copy >= before && split.copy < motion.u.count(),
                "a copy of a vertex is not a new vertex");
    motion.u.col(split.copy) = motion.u.col(split.vertex);
    motion.v.col(split.copy) = motion.v.col(split.vertex);
    body_.model.held.split(split.vertex, split.copy);
  }
  if (!edit.shares.empty()) {
    blades_.hold_what_is_filled(edit, body_.model);
    blades_.share_loads(edit, elements, body_.loads.dead_loads());
  }
  limit_.follow(body_, edit, shares_before);
  display_.follow(elements, blades_.grains(), edit);
  display_.tell(elements.topology, edit);
  for (const auto& term : body_.terms) {
    term->follow(elements.topology, edit);
    if (grains()) term->follow_grains(elements, *grains(), edit);
  }
  return region_edit_of(edit, elements.topology, before);
}

template <class Real>
void Organ<Real>::follow_regions(RegionEdit& edit) {
  add_unsupported(edit);
  body_.regions.follow(elements(), edit);
  body_.regions.relax_entered(elements(), body_.motion.u.padded());
  update_vertices_apart(edit.vertices);
  const std::vector<Index> mechanism = body_.regions.follow_condensed(body_.model, edit, body_.loads);
  if (body_.regions.is_expanded()) {
    update_vertices(edit.vertices);
  } else if (body_.regions.precomputed().has_changed()) {
    find_carried();
    take_over(edit.vertices);
    update_inverse_masses(edit.vertices);
  }
  ++body_.model.revisions.structure;
  if (body_.regions.any_condensed()) limit_.forget();
  body_.sleep.wake(edit.vertices, body_);
  if (!body_.terms.empty()) report_lost_forces(body_.acted_on_by_terms());
  if (!mechanism.empty()) {
    RegionEdit freed = change_of_region(mechanism, RegionModel::nonlinear);
    follow_regions(freed);
  }
  embed();
}

template <class Real>
void Organ<Real>::follow_frozen(const std::vector<Index>& vertices) {
  update_inverse_masses(vertices);
  body_.regions.reduced().holds_have_changed();
  embed();
}

template <class Real>
void Organ<Real>::follow_condensing() {
  find_carried();
  ++body_.model.revisions.structure;
  limit_.forget();
}

template <class Real>
void Organ<Real>::follow_mode(bool is_expanded) {
  body_.regions.set_expanded(is_expanded);
  ++body_.model.revisions.jumps;         // of the interior
  if (body_.inertia.may_be_selective())  // also around held vertices
    for (Index t = 0; t < elements().topology.tet_count(); ++t)
      if (body_.regions.is_condensed(t)) {
        const Eigen::Vector4i corners = elements().topology.corners(t);
        body_.inertia.add_edits({corners.begin(), corners.end()});
      }
  const std::vector<Index> vertices = body_.regions.condensed_vertices(elements().topology.vertex_count());
  body_.regions.precomputed().find_carried(elements());
  update_vertices(vertices);
  body_.sleep.wake_all(time());
  if (!body_.terms.empty()) report_lost_forces(body_.acted_on_by_terms());
  limit_.restart(body_);
  ++body_.model.revisions.structure;
}

template <class Real>
void Organ<Real>::follow_roles(VertexRoles roles) {
  limit_.forget_nodes();
  const std::vector<Index> vertices = body_.regions.reduced().vertices();
  update_masses(vertices);
  body_.regions.reduced().embed(body_.model, std::move(roles), limit_.highest_at_rest(),
                                body_.inertia.masses(), body_.loads, body_.motion);
  take_over(vertices);  // last, so that momentum is that of the tetrahedra that leave the lattice
  update_inverse_masses(vertices);
  ++unreported_.transitions.count;
  body_.state_has_moved();
  ++body_.model.revisions.structure;
  ++body_.model.revisions.jumps;
}

template <class Real>
void Organ<Real>::follow_mass_degree(int degree) {
  const int before = body_.inertia.degree_now();
  body_.inertia.use(degree);
  if (degree > before) {
    body_.prepare_inertia();
    body_.inertia.slow_short_waves(body_.parallel, body_.motion);
  }
  limit_.restart_for_degree(body_);
  ++body_.model.revisions.velocities;
}

// Wakes the vertices that the terms wake now or woke before. The step limit changes with their stiffness.
template <class Real>
void Organ<Real>::follow_terms(const std::vector<Index>& woken_before) {
  body_.sleep.wake(woken_before, body_);
  body_.sleep.wake(body_.woken_by_terms(), body_);
  ++body_.model.revisions.terms;
  ++body_.model.revisions.structure;
  report_lost_forces(body_.acted_on_by_terms());
  embed();
}

template <class Real>
void Organ<Real>::follow_search() {
  ++body_.model.revisions.jumps;
  body_.recover(Regions<Real>::Interior::all);
  seen_ = body_.model.revisions;
}

// Adds parts of the pre-computed region that nothing holds in place after an edit. They will turn, so they
// become non-linear.
template <class Real>
void Organ<Real>::add_unsupported(RegionEdit& edit) {
  if (std::none_of(edit.left.begin(), edit.left.end(),
                   [&](Index t) { return body_.regions.is_condensed(t); }))
    return;
  const std::vector<Index> tets = unsupported_tets(elements(), held());
  if (tets.empty()) return;
  const RegionEdit change = change_of_region(tets, RegionModel::nonlinear);
  for (auto list : {&RegionEdit::left, &RegionEdit::entered, &RegionEdit::vertices}) {
    (edit.*list).insert((edit.*list).end(), (change.*list).begin(), (change.*list).end());
    sort_unique(edit.*list);
  }
  notice(Condition::Kind::pieces,
         std::to_string(tets.size()) + " precomputed tetrahedra are no longer held and became nonlinear");
}

// Computes masses and loads of these vertices from the tetrahedra around them, as if nothing were condensed
// and nothing followed a lattice. take_over() must follow, unless nothing of a region is condensed there.
template <class Real>
void Organ<Real>::update_masses(const std::vector<Index>& vertices) {
  body_.inertia.update(body_.model, vertices);
  body_.loads.update(elements(), vertices, [this](Index v) { return body_.inertia.weighs(v); });
}

// In the middle of an edit, which the condensed region has not followed yet.
template <class Real>
void Organ<Real>::update_vertices_apart(const std::vector<Index>& vertices) {
  const Topology& topology = elements().topology;
  body_.motion.extend(topology.vertex_count());
  body_.sleep.extend(topology.vertex_count(), time());
  limit_.extend(topology.vertex_count());
  update_masses(vertices);
  body_.regions.reduced().raise_masses(vertices, body_.inertia.masses());
  for (Index v : vertices)
    if (topology.around(v).empty()) body_.motion.v.col(v).setZero();
  update_inverse_masses(vertices);
}

template <class Real>
void Organ<Real>::update_vertices(const std::vector<Index>& vertices) {
  update_vertices_apart(vertices);
  take_over(vertices);
}

// Call it when masses of vertices have changed, or what holds them.
template <class Real>
void Organ<Real>::update_inverse_masses(const std::vector<Index>& vertices) {
  for (Index v : vertices) {
    body_.inertia.update_inverse(body_.model, v);
    limit_.update(body_, v);
  }
}

// Of these vertices, those of a condensed region get the masses and loads with which it moves.
template <class Real>
void Organ<Real>::take_over(const std::vector<Index>& vertices) {
  const std::vector<Index> taken = body_.regions.precomputed().take_over(
      elements(), vertices, body_.inertia.masses(), body_.loads.external(), body_.loads.dead());
  body_.inertia.raise_to_floor(body_.model, taken);
  update_inverse_masses(taken);
}

// The condensed region has changed, and carries other masses everywhere at its interface.
template <class Real>
void Organ<Real>::find_carried() {
  body_.regions.precomputed().find_carried(elements());
  take_over(body_.regions.shared());
}

// ---- State

// Performs a change. If it embeds vertices or makes them full, adds the change of the energies to the report.
// Masses must be those of the state when it begins.
template <class Real>
void Organ<Real>::as_transition(const std::function<void()>& change) {
  if (unreported_.in_transition) return change();
  struct InTransition {
    explicit InTransition(bool& flag) : is_set(flag) { is_set = true; }
    ~InTransition() { is_set = false; }
    bool& is_set;
  };
  Transitions& transitions = unreported_.transitions;
  const int count = transitions.count;
  const Energies before = body_.energies_without_terms();
  {
    const InTransition until_changed(unreported_.in_transition);
    change();
  }
  if (transitions.count == count) return;
  const Energies after = body_.energies_without_terms();
  transitions.kinetic += after.kinetic - before.kinetic;
  transitions.elastic += after.elastic() - before.elastic();
  transitions.loads += after.loads - before.loads;
}

template <class Real>
void Organ<Real>::synchronise_velocities() {
  if (implicit_ || body_.motion.velocity_lag == 0) return;
  refresh_terms();
  body_.synchronise_velocities();
}

}  // namespace lobe
