// What acts on an Organ from outside: tools, what is held, and forces.
#include <algorithm>
#include <utility>

#include "lobe/contact/softening.h"
#include "lobe/error.h"
#include "lobe/organ/kinds_of_terms.h"
#include "lobe/organ/organ.h"
#include "lobe/setup/exclusions.h"
#include "lobe/sort_unique.h"

namespace lobe {

// ---- What is held

// Vertices were grasped or released.
template <class Real>
void Organ<Real>::hold(const HeldVertices& now) {
  const Index vertices = elements().topology.vertex_count();
  const std::vector<HeldVertices::Held> items = now.as_saved();
  for (const HeldVertices::Held& item : items)
    if (!item.is_valid() || item.vertex >= vertices)
      throw InputError(
          "held vertex " + std::to_string(item.vertex),
          "does not exist, or is held at a place that is not finite or by a share not in (0, 1]");
  edit({.velocities = true, .energies = body_.regions.any_roles()}, [&] {
    RegionEdit regions;
    for (const HeldVertices::Held& item : held().as_saved()) regions.vertices.push_back(item.vertex);
    for (const HeldVertices::Held& item : items) regions.vertices.push_back(item.vertex);
    sort_unique(regions.vertices);
    body_.model.held = now;
    const bool is_listed = body_.regions.needs_history_of_holds();
    return Change{.regions = std::move(regions),
                  .entry = is_listed ? std::optional<JournalEntry>(Hold{now}) : std::nullopt};
  });
}

template <class Real>
Index Organ<Real>::grasp(const HeldVertices& held) {
  hold(held);
  return treat_loose(pieces_.loosened(body_.model));
}

// ---- Forces

template <class Real>
ForceTerm<Real>& Organ<Real>::own_term(std::string_view name) {
  auto place = body_.terms.begin();
  for (const KindOfTerm<Real>& kind : kinds_of_terms<Real>()) {
    const bool is_there = place != body_.terms.end() && (*place)->name() == kind.name;
    if (kind.name == name && !is_there) {
      edit({}, [&] {
        place = body_.terms.insert(place, kind.make(setup_));
        shown_ = {};
        return Change{.has_new_terms = true};
      });
    }
    if (kind.name == name) break;
    if (is_there) ++place;
  }
  return **place;
}

template <class Real>
AppliedForces<Real>& Organ<Real>::applied() {
  return static_cast<AppliedForces<Real>&>(own_term(AppliedForces<Real>::term_name));
}

template <class Real>
void Organ<Real>::show_tools(std::span<const ToolBody> bodies) {
  for (const KindOfTerm<Real>& kind : kinds_of_terms<Real>())
    if (kind.is_needed(setup_, bodies)) own_term(kind.name);
  bool others = false;
  for (const auto& term : body_.terms) others = term->see_tools(bodies, time()) || others;
  if (others) edit({}, [] { return Change{.has_new_terms = true}; });
}

template <class Real>
void Organ<Real>::show_body() {
  for (std::size_t i = 0; i < body_.terms.size(); ++i) {
    ForceTerm<Real>& term = *body_.terms[i];
    if (!term.needs_body()) continue;
    show_body_to(term);
    term.look_ahead(body_.here());
    if (body_.sleep.any()) body_.sleep.wake(term.wakes(body_.model), body_);
    if (!body_.regions.heeds_touch()) continue;
    if (!grant({Moment::tool_touches, {}, term.acts_on(body_.model)})) continue;
    show_body_to(term);
    term.look_ahead(body_.here());
  }
}

template <class Real>
void Organ<Real>::show_body_to(ForceTerm<Real>& term) {
  body_.recover_followers();
  BodyView body{.model = body_.model,
                .surface = display_.surface(elements(), grains()).mesh(),
                .mass = body_.inertia.mass(),
                .grains = grains(),
                .omega = limit_.omega_at_rest(body_),
                .lumped_omega = limit_.lumped_omega_at_rest(body_),
                .ratio = limit_.lumped_ratio_at_rest(body_),
                .mass_degree = body_.inertia.degree_now()};
  if (body_.inertia.is_selective()) body.softening = [this] { return softening(); };
  term.see_body(body, body_.here());
  shown_ = now_shown();
}

// Recovers what terms see, since whether somebody else has looked at it must not change bits.
template <class Real>
void Organ<Real>::refresh_terms() {
  const auto needs_body = [](const auto& term) { return term->needs_body(); };
  if (std::any_of(body_.terms.begin(), body_.terms.end(), needs_body)) body_.recover_followers();
  if (shown_ == now_shown()) return;
  for (const auto& term : body_.terms)
    if (term->needs_body()) show_body_to(*term);
}

// Of contact, at the present degree of selective masses.
template <class Real>
double Organ<Real>::softening() {
  const int degree = body_.inertia.degree_now();
  double& known = softening_[degree];
  if (known > 0) return known;
  const Setup setup = initial_setup();
  Inertia<Real> inertia(setup);
  const bool is_measured = setup.expandable || !options_of(setup).has(option_of(RegionModel::precomputed));
  known = find_softening(setup, std::move(inertia), degree, limit_.of_whole_at_rest(degree, is_measured),
                         body_.parallel);
  return known;
}

// Makes an edit of force terms. Wakes what they have woken and will wake.
template <class Real>
void Organ<Real>::edit_terms(const Before& before, const std::function<void()>& make) {
  std::vector<Index> woken = body_.woken_by_terms();
  edit(before, [&] {
    make();
    return Change{.has_terms = true, .woken = std::move(woken)};
  });
}

template <class Real>
void Organ<Real>::add(std::shared_ptr<ForceTerm<Real>> term) {
  refuse_excluded(Option::force_terms, options_of(setup_), "force term");
  const bool is_known = std::any_of(body_.terms.begin(), body_.terms.end(),
                                    [&](const auto& present) { return present->name() == term->name(); });
  if (is_known || find_kind_of_term<Real>(term->name()))
    throw InputError("force term", "there is one of the name \"" + term->name() + "\" already");
  edit_terms({.velocities = body_.any_own_steps()}, [&] {
    body_.terms.push_back(std::move(term));
    shown_ = {};
  });
}

template <class Real>
void Organ<Real>::perform(const SetForces& command) {
  AppliedForces<Real>().set(command.forces,
                            elements().topology.vertex_count());  // throws before anything changes
  edit_terms({.velocities = true},
             [&] { applied().set(command.forces, elements().topology.vertex_count()); });
}

template <class Real>
void Organ<Real>::perform(const SetSprings& command) {
  refuse_excluded(Option::force_terms, options_of(setup_), "springs");
  AppliedForces<Real>().set(command.springs,
                            elements().topology.vertex_count());  // throws before anything changes
  edit_terms({.velocities = true},
             [&] { applied().set(command.springs, elements().topology.vertex_count()); });
}

// Without a term there is no spring: an empty one says so before anything changes.
template <class Real>
void Organ<Real>::perform(const MoveSprings& command) {
  if (!term_of<AppliedForces>(body_.terms)) AppliedForces<Real>().move(command.points);
  applied().move(command.points);
}

// Reports forces on the interior of a condensed region. It follows its interface, so they have no effect.
template <class Real>
void Organ<Real>::report_lost_forces(const std::vector<Index>& vertices) {
  for (Index v : vertices)
    if (body_.regions.is_interior(v) && body_.regions.follows(v))
      return notice(
          Condition::Kind::lost_force,
          "a force on vertex " + std::to_string(v) +
              ", in the interior of a precomputed region, has no effect: expand the region, make it "
              "tensor-mass, or take hold of the vertex");
}

template <class Real>
void Organ<Real>::report_unseen_force(Index vertex) {
  notice(Condition::Kind::lost_force,
         "a force on vertex " + std::to_string(vertex) +
             ", which follows a lattice, had no effect in a frame: move the tool more slowly, or use shorter "
             "frames");
}

}  // namespace lobe
