// What acts on a World from outside: tools, what is held, and forces.
#include <algorithm>

#include "lobe/error.h"
#include "lobe/setup/exclusions.h"
#include "lobe/sim/world.h"
#include "lobe/sort_unique.h"

namespace lobe {

// ---- What is held

// Somebody has taken hold of vertices, or let go.
template <class Real>
void World<Real>::perform(const Hold& command) {
  RegionEdit edit;
  for (const HeldVertices::Held& item : held().all()) edit.vertices.push_back(item.vertex);
  for (const HeldVertices::Held& item : command.held.all()) edit.vertices.push_back(item.vertex);
  sort_unique(edit.vertices);
  body_.model.held = command.held;
  if (body_.regions.any_condensed()) journal_.edits.push_back(command);
  follow(std::move(edit));
}

// ---- Forces

// It is among the terms from the first time on that somebody asks for it.
template <class Real>
AppliedForces<Real>& World<Real>::applied() {
  for (const auto& term : body_.terms)
    if (auto* own = dynamic_cast<AppliedForces<Real>*>(term.get())) return *own;
  auto own = std::make_shared<AppliedForces<Real>>();
  body_.terms.push_back(own);
  return *own;
}

template <class Real>
void World<Real>::add(std::shared_ptr<ForceTerm<Real>> term) {
  refuse_excluded(Option::force_terms, options_of(setup_), "force term");
  const bool is_known = std::any_of(body_.terms.begin(), body_.terms.end(),
                                    [&](const auto& own) { return own->name() == term->name(); });
  if (is_known) throw InputError("force term", "there is one of the name \"" + term->name() + "\" already");
  body_.terms.push_back(std::move(term));
  terms_have_changed({});
}

template <class Real>
void World<Real>::perform(const SetForces& command) {
  AppliedForces<Real>().set(command.forces,
                            elements().topology.vertex_count());  // throws before anything changes
  const std::vector<Index> before = body_.touched_by_terms();
  catch_up();
  applied().set(command.forces, elements().topology.vertex_count());
  terms_have_changed(before);
}

template <class Real>
void World<Real>::perform(const SetSprings& command) {
  refuse_excluded(Option::force_terms, options_of(setup_), "springs");
  AppliedForces<Real>().set(command.springs,
                            elements().topology.vertex_count());  // throws before anything changes
  const std::vector<Index> before = body_.touched_by_terms();
  catch_up();
  applied().set(command.springs, elements().topology.vertex_count());
  terms_have_changed(before);
}

// What they act on now, and did before, wakes; the step limit has to do with their stiffness.
template <class Real>
void World<Real>::terms_have_changed(const std::vector<Index>& touched_before) {
  const std::vector<Index> now = body_.touched_by_terms();
  body_.sleep.wake(touched_before, body_);
  body_.sleep.wake(now, body_);
  limit_.forget();
  ++body_.model.revisions.structure;
  report_lost_forces(now);
}

// The interior of a condensed region follows its interface: a force on it would act on nothing.
template <class Real>
void World<Real>::report_lost_forces(const std::vector<Index>& touched) {
  if (body_.regions.is_expanded()) return;
  for (Index v : touched)
    if (body_.regions.is_interior(v))
      return notice(
          Condition::Kind::lost_force,
          "a force on vertex " + std::to_string(v) +
              ", in the interior of a precomputed region, has no effect: expand the region, make it "
              "tensor-mass, or take hold of the vertex");
}

}  // namespace lobe
