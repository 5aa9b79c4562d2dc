// What kinds of regions, and tangles, wish for at the moments of a frame.
#include <array>
#include <utility>

#include "lobe/organ/organ.h"
#include "lobe/sort_unique.h"

namespace lobe {

// Grants the wishes of a moment, in the order of the list. Returns whether anything has changed.
template <class Real>
bool Organ<Real>::grant(const Occasion& occasion) {
  struct Wish {
    Moment moment;
    bool (Organ::*grant)(const Occasion&);
  };
  static constexpr std::array list{
      Wish{Moment::frame_begins, &Organ::condense_anew}, Wish{Moment::limit_is_found, &Organ::unravel},
      Wish{Moment::tool_touches, &Organ::follow_touch},  Wish{Moment::blade_comes, &Organ::expand_ahead},
      Wish{Moment::blade_comes, &Organ::free_ahead},     Wish{Moment::tets_go, &Organ::free_ahead},
      Wish{Moment::steps_begin, &Organ::embed},          Wish{Moment::step_is_chosen, &Organ::slow_strained}};
  bool has_changed = false;
  for (const Wish& wish : list)
    if (wish.moment == occasion.moment && (this->*wish.grant)(occasion)) has_changed = true;
  return has_changed;
}

// ---- Pre-computed regions

// Takes the result of condensing when it is due, and waits for it if necessary, so that a run has the same
// bits on every machine.
template <class Real>
bool Organ<Real>::condense_anew(const Occasion&) {
  constexpr double delay = 1;  // [s]
  const bool is_due = body_.regions.is_condensing() && time() >= body_.regions.condensing_due();
  if (is_due)
    end_condensing();
  else if (body_.regions.precomputed().needs_condensing())
    begin_condensing({time() + delay});
  return is_due;
}

// To edit a condensed region costs milliseconds per tetrahedron. So an expandable one is expanded before a
// blade reaches it.
template <class Real>
bool Organ<Real>::expand_ahead(const Occasion& blade) {
  if (!body_.regions.expands_for(blade.tets)) return false;
  perform(Expand{});
  return true;
}

template <class Real>
bool Organ<Real>::follow_touch(const Occasion& tool) {
  const auto interior = std::find_if(tool.vertices.begin(), tool.vertices.end(),
                                     [&](Index v) { return body_.regions.is_interior(v); });
  switch (wish_memory_.follow(body_.regions, interior != tool.vertices.end(), time())) {
    case TouchExpansion::Answer::nothing:
      return false;
    case TouchExpansion::Answer::report:
      report_lost_forces({*interior});
      return false;
    case TouchExpansion::Answer::expand:
      perform(Expand{});
      return true;
    case TouchExpansion::Answer::condense:
      perform(Condense{});
      return true;
  }
  return false;
}

// ---- Tangles

// Unravels tetrahedra that stay crushed. The search for the step limit has found the smallest det F.
template <class Real>
bool Organ<Real>::unravel(const Occasion&) {
  if (elements().guard_below == 0) return false;
  const bool was_lumped = unravelling_.is_lumped();
  unravelling_.lump(body_, limit_.volume_ratio());
  if (unravelling_.is_lumped() != was_lumped)
    notice(Condition::Kind::lumped, was_lumped
                                        ? "nothing is crushed any more: masses are selective again"
                                        : "tetrahedra are crushed: masses are lumped until they are not");
  use_mass_degree(unravelling_.is_lumped() ? 1 : body_.inertia.degree());
  const auto was_held = [&](Index tet) { return pieces_.was_held(tet); };
  const auto remedy = unravelling_.look(body_, limit_.volume_ratio(), was_held);
  if (!remedy) return false;
  notice(Condition::Kind::unravelling, remedy->why);
  change_region(remedy->tets, remedy->model);
  return true;
}

// ---- Reduced regions

// Reduced tetrahedra that will be cut, and those near them, become non-linear.
template <class Real>
bool Organ<Real>::free_ahead(const Occasion& cut) {
  const std::vector<Index> found = body_.regions.reduced().in_the_way(elements(), cut.tets);
  if (!found.empty()) change_region(found, RegionModel::nonlinear);
  return !found.empty();
}

// Embeds the vertices that are to follow the nodes of the lattice now; those that are held or pressed do not.
// Before the frequency of the full body is known, no vertex is embedded.
template <class Real>
bool Organ<Real>::embed(const Occasion& steps) {
  Regions<Real>& regions = body_.regions;
  if (!regions.any_roles()) return false;
  FullZones::Sight sight;
  sight.damping = body_.damping;
  sight.pressed = steps.vertices;
  for (const auto& term : body_.terms) {
    const std::vector<Index> vertices = term->acts_on(body_.model);
    std::vector<Index>& list = term->needs_body() ? sight.pressed : sight.loaded;
    list.insert(list.end(), vertices.begin(), vertices.end());
  }
  for (const HeldVertices::Held& item : held().all())
    if (item.holder != HeldVertices::boundary) sight.held.push_back(item.vertex);
  for (std::vector<Index>* list : {&sight.held, &sight.loaded, &sight.pressed}) sort_unique(*list);
  LatticeRegion<Real>& region = regions.reduced();
  region.look(elements(), body_.motion, body_.inertia.mass(), std::move(sight));
  VertexRoles roles = region.roles(body_.model, time(), limit_.highest_at_rest() > 0);
  if (region.has_roles(roles)) return false;
  // While they are not up to date, energies would be those of what an edit has taken, too.
  give(std::move(roles), {.followers = true, .energies = regions.are_up_to_date()});
  return true;
}

template <class Real>
void Organ<Real>::give(VertexRoles roles, const Before& before) {
  edit(before, [&] { return Change{.roles = std::move(roles)}; });
}

// Vertices get mass where they are strained so that steps would be shorter.
template <class Real>
bool Organ<Real>::slow_strained(const Occasion&) {
  const auto square = [&](Index v, double least) {
    return held().holds(v) ? 0 : limit_.limiting_square(body_, v, least);
  };
  const auto slowed = body_.regions.reduced().slow_strained(body_.inertia.mass(), square, body_.motion);
  unreported_.transitions.kinetic += slowed.kinetic;
  if (slowed.vertices.empty()) return false;
  edit({}, [&] { return Change{.weighed = slowed.vertices}; });
  return true;
}

}  // namespace lobe
