// Regions of an Organ: tetrahedra that change their model; pre-computed regions that are condensed from
// scratch, relinearised, and non-linear for a while (theory, section 14).
#include <algorithm>
#include <optional>

#include "lobe/error.h"
#include "lobe/organ/organ.h"
#include "lobe/setup/exclusions.h"
#include "lobe/sort_unique.h"

namespace lobe {

template <class Real>
void Organ<Real>::perform(const SetRegion& command) {
  check_tets(command.tets);
  refuse_excluded(option_of(command.model), options_of(setup_), "region");
  body_.regions.refuse(command.model, command.tets, body_.model, setup_.lattice_cell);
  std::vector<Index> tets = command.tets;
  sort_unique(tets);
  std::erase_if(tets, [&](Index t) { return !elements().topology.alive(t); });
  unravelling_.leave_alone(tets);
  if (std::all_of(tets.begin(), tets.end(),
                  [&](Index t) { return elements().region_of[t] == command.model; }))
    return;
  change_region(command.tets, command.model);
}

template <class Real>
void Organ<Real>::change_region(const std::vector<Index>& tets, RegionModel model) {
  synchronise();
  const auto change = [&] {
    RegionEdit edit = change_of_region(tets, model);
    if (edit.left.empty()) return;
    journal_.edits.push_back(SetRegion{edit.left, model});
    follow(std::move(edit));
  };
  if (body_.regions.is_transition(elements(), tets, model))
    as_transition(change);
  else
    change();
}

template <class Real>
RegionEdit Organ<Real>::change_of_region(const std::vector<Index>& tets, RegionModel model) {
  RegionEdit edit;
  Elements& elements = body_.model.elements;
  for (Index t : tets) {
    if (!elements.topology.alive(t) || elements.region_of[t] == model) continue;
    limit_.follow_region(body_, t, [&] { elements.region_of[t] = model; });
    edit.left.push_back(t);
    for (Index v : elements.topology.corners(t)) edit.vertices.push_back(v);
  }
  display_.follow_regions(elements, grains(), edit.left);
  edit.entered = edit.left;
  sort_unique(edit.vertices);
  return edit;
}

// ---- Pre-computed regions

// The entry in the journal has the displacements about which the region is linearised.
template <class Real>
void Organ<Real>::begin_condensing(BeginCondensing begin) {
  if (!body_.regions.can_begin_condensing())
    throw InputError("precomputed region", "there is none to condense, or it is being condensed already");
  if (begin.about && begin.about->size() != std::size_t(3 * elements().topology.vertex_count()))
    throw InputError("precomputed region", "cannot be linearised about displacements of another mesh");
  const Mat3X<double>& former = body_.regions.linearised_about();
  if (!begin.about && former.size() > 0)
    begin.about = std::make_shared<std::vector<double>>(former.data(), former.data() + former.size());
  body_.regions.begin_condensing(elements(), begin.due, begin.about ? *begin.about : std::vector<double>{});
  journal_.edits.push_back(std::move(begin));
}

template <class Real>
void Organ<Real>::end_condensing() {
  if (!body_.regions.is_condensing())  // the region may have been cut away meanwhile
    throw InputError("precomputed region", "condensing has not begun, so it cannot end");
  synchronise_velocities();
  const bool is_condensed = body_.regions.end_condensing(elements());
  find_carried();
  ++body_.model.revisions.structure;
  ++body_.model.revisions.condensed;
  journal_.edits.push_back(EndCondensing{});
  if (is_condensed) forget_former_condensing();
}

// A region that is condensed from scratch does not depend on how it was condensed before, nor on whether it
// was expanded in between: only its tetrahedra and what is held decide. Entries for what was held in between
// stay, because without them the interior would have other bits. If it was expanded when condensing from
// scratch last began, later edits stay in the list, since condensing it again needs another pass.
template <class Real>
void Organ<Real>::forget_former_condensing() {
  const auto is = [&]<class Kind>(std::size_t i, Kind) {
    return std::holds_alternative<Kind>(journal_.edits[i]);
  };
  std::size_t last = journal_.edits.size(), expanded_at = journal_.edits.size();
  for (std::size_t i = 0; i < journal_.edits.size(); ++i)
    if (is(i, BeginCondensing{})) last = i;
  for (std::size_t i = 0; i < last; ++i) {
    if (is(i, Expand{})) expanded_at = i;
    if (is(i, Condense{})) expanded_at = journal_.edits.size();
  }
  for (std::size_t i = 0; i < std::min(last, expanded_at); ++i)
    if (is(i, BeginCondensing{}) || is(i, EndCondensing{}) || is(i, Expand{}) || is(i, Condense{}))
      journal_.edits.supersede(i);
}

template <class Real>
void Organ<Real>::perform(const Relinearise& command) {
  if (!(command.delay > 0))
    throw InputError("region", "the delay until it is relinearised must be above 0 s");
  if (!body_.regions.can_begin_condensing()) return;
  const Mat3X<double> u = displacements().template cast<double>();
  begin_condensing(
      {time() + command.delay, std::make_shared<std::vector<double>>(u.data(), u.data() + u.size())});
}

template <class Real>
void Organ<Real>::perform(const Expand& command) {
  if (!setup_.expandable) throw InputError("region", "the setup does not say that it may be expanded");
  if (!body_.regions.may_expand()) return;
  synchronise();
  set_expanded(true);
  journal_.edits.push_back(command);
}

template <class Real>
void Organ<Real>::perform(const Condense& command) {
  if (!body_.regions.is_expanded()) return;
  if (!body_.regions.can_condense())
    throw InputError("region",
                     "it was edited while it was expanded, and must be relinearised before it is condensed");
  synchronise_velocities();
  set_expanded(false);
  journal_.edits.push_back(command);
}

template <class Real>
void Organ<Real>::set_expanded(bool is_expanded) {
  body_.regions.set_expanded(is_expanded);
  ++body_.model.revisions.jumps;         // of the interior
  if (body_.inertia.may_be_selective())  // also around held vertices
    for (Index t = 0; t < elements().topology.tet_count(); ++t)
      if (body_.regions.is_condensed(t)) {
        const Eigen::Vector4i corners = elements().topology.corners(t);
        body_.inertia.add_edits({corners.begin(), corners.end()});
      }
  const std::vector<Index> vertices = body_.regions.condensed_vertices(elements().topology.vertex_count());
  body_.regions.find_carried(elements());
  update_vertices(vertices);
  body_.sleep.wake_all(time());
  if (!body_.terms.empty()) report_lost_forces(body_.acted_on_by_terms());
  limit_.restart(body_);
  ++body_.model.revisions.structure;
}

// ---- Reduced regions

// Embeds the vertices that are to follow the nodes of the lattice now; those that are held or pressed do not.
// Before the frequency of the full body is known, no vertex is embedded. True if something has changed.
template <class Real>
bool Organ<Real>::embed(const std::vector<Index>& also_pressed) {
  Regions<Real>& regions = body_.regions;
  if (!regions.any_roles()) return false;
  FullZones::Sight sight;
  sight.damping = body_.damping;
  sight.pressed = also_pressed;
  for (const auto& term : body_.terms) {
    const std::vector<Index> vertices = term->acts_on(body_.model);
    std::vector<Index>& list = term->needs_body() ? sight.pressed : sight.loaded;
    list.insert(list.end(), vertices.begin(), vertices.end());
  }
  for (const HeldVertices::Held& item : held().all())
    if (item.holder != HeldVertices::boundary) sight.held.push_back(item.vertex);
  for (std::vector<Index>* list : {&sight.held, &sight.loaded, &sight.pressed}) sort_unique(*list);
  std::optional<VertexRoles> roles = regions.new_roles(body_.model, body_.motion, body_.inertia.mass(),
                                                       std::move(sight), limit_.highest_at_rest() > 0);
  if (!roles) return false;
  if (regions.are_up_to_date())
    as_transition([&] { embed_as(std::move(*roles)); });
  else  // energies would be those of what an edit has taken, too
    embed_as(std::move(*roles));
  return true;
}

// Sums by what a change changes energies, if it embeds vertices or makes them full. Masses must be those of
// the state when it begins.
template <class Real>
void Organ<Real>::as_transition(const std::function<void()>& change) {
  if (findings_.in_transition) return change();
  struct InTransition {
    explicit InTransition(bool& flag) : is_set(flag) { is_set = true; }
    ~InTransition() { is_set = false; }
    bool& is_set;
  };
  Transitions& transitions = findings_.transitions;
  const int count = transitions.count;
  const Energies before = body_.energies_without_terms();
  {
    const InTransition until_changed(findings_.in_transition);
    change();
  }
  if (transitions.count == count) return;
  const Energies after = body_.energies_without_terms();
  transitions.kinetic += after.kinetic - before.kinetic;
  transitions.elastic += after.elastic() - before.elastic();
  transitions.loads += after.loads - before.loads;
}

template <class Real>
void Organ<Real>::embed_as(VertexRoles roles) {
  body_.recover(Regions<Real>::Interior::all);
  limit_.forget_nodes();
  const std::vector<Index> vertices = body_.regions.reduced_vertices();
  update_masses(vertices);
  body_.regions.embed(body_.model, std::move(roles), limit_.highest_at_rest(), body_.inertia.masses(),
                      body_.loads, body_.motion);
  take_over(vertices);  // last, so that momentum is that of the tetrahedra that leave the lattice
  update_inverse_masses(vertices);
  ++findings_.transitions.count;
  body_.state_has_moved();
  ++body_.model.revisions.structure;
  ++body_.model.revisions.jumps;
}

// Reduced tetrahedra that will be cut, and those near them, become non-linear.
template <class Real>
void Organ<Real>::free_ahead(const std::vector<Index>& tets) {
  const std::vector<Index> found = body_.regions.in_the_way(elements(), tets);
  if (!found.empty()) change_region(found, RegionModel::nonlinear);
}

// Returns whether a vertex got mass.
template <class Real>
bool Organ<Real>::slow_strained() {
  const auto square = [&](Index v, double least) {
    return held().holds(v) ? 0 : limit_.limiting_square(body_, v, least);
  };
  const auto slowed = body_.regions.slow_strained(body_.inertia.mass(), square, body_.motion);
  findings_.transitions.kinetic += slowed.kinetic;
  if (!slowed.vertices.empty()) update_vertices(slowed.vertices);
  return !slowed.vertices.empty();
}

template <class Real>
void Organ<Real>::perform(const KeepFull& command) {
  body_.regions.keep_full(elements(), command.vertices, time(), command.duration);
}

// ---- Inertia

template <class Real>
void Organ<Real>::perform(const SetMassDegree& command) {
  body_.inertia.check_degree(command.degree);
  body_.inertia.ask_for(command.degree);
  if (!unravelling_.is_lumped()) use_mass_degree(command.degree);
}

template <class Real>
void Organ<Real>::use_mass_degree(int degree) {
  const int before = body_.inertia.degree_now();
  if (degree == before) return;
  synchronise_velocities();
  body_.inertia.use(degree);
  if (degree > before) {
    body_.prepare_inertia();
    body_.inertia.slow_short_waves(body_.parallel, body_.motion);
  }
  limit_.restart_for_degree(body_);
  ++body_.model.revisions.velocities;
}

}  // namespace lobe
