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
  edit({.velocities = true,
        .followers = true,
        .energies = body_.regions.is_transition(elements(), tets, model)},
       [&] {
         RegionEdit regions = change_of_region(tets, model);
         if (regions.left.empty()) return Change{};
         JournalEntry entry = SetRegion{regions.left, model};
         return Change{.regions = std::move(regions), .entry = std::move(entry)};
       });
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
  bool is_condensed = false;
  edit({.velocities = true}, [&] {
    is_condensed = body_.regions.precomputed().end_condensing(elements());
    return Change{.is_condensed_anew = true, .entry = EndCondensing{}};
  });
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
void Organ<Real>::take_mode(const Organ& other, const std::vector<Index>& vertices) {
  const Mat3X<double>& former = other.body_.regions.linearised_about();
  if (former.size() > 0 && body_.regions.can_begin_condensing()) {
    const Mat3X<double> about = former(Eigen::all, vertices);
    begin_condensing(
        {time(), std::make_shared<std::vector<double>>(about.data(), about.data() + about.size())});
    end_condensing();
  }
  other.body_.regions.is_expanded() ? perform(Expand{}) : perform(Condense{});
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
  edit({.velocities = true, .followers = true},
       [&] { return Change{.is_expanded = true, .entry = command}; });
}

template <class Real>
void Organ<Real>::perform(const Condense& command) {
  if (!body_.regions.is_expanded()) return;
  if (!body_.regions.can_condense())
    throw InputError("region",
                     "it was edited while it was expanded, and must be relinearised before it is condensed");
  edit({.velocities = true}, [&] { return Change{.is_expanded = false, .entry = command}; });
}

// ---- Reduced regions

template <class Real>
void Organ<Real>::perform(const KeepFull& command) {
  body_.regions.reduced().keep_full(elements(), command.vertices, time(), command.duration);
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
  if (degree == body_.inertia.degree_now()) return;
  edit({.velocities = true}, [&] { return Change{.mass_degree = degree}; });
}

}  // namespace lobe
