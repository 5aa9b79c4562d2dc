// Threads in an Organ.
#include <algorithm>

#include "lobe/error.h"
#include "lobe/organ/organ.h"
#include "lobe/setup/exclusions.h"

namespace lobe {

template <class Real>
Threads<Real>& Organ<Real>::threads() {
  return static_cast<Threads<Real>&>(own_term(Threads<Real>::term_name));
}

template <class Real>
template <class Make>
void Organ<Real>::change_threads(const Make& change) {
  refuse_excluded(Option::force_terms, options_of(setup_), "thread");
  Threads<Real> trial{Setup()};  // throws before anything changes
  for (const auto& term : body_.terms)
    if (term->name() == Threads<Real>::term_name) trial = static_cast<const Threads<Real>&>(*term);
  change(trial);
  edit_terms({.velocities = true, .followers = true}, [&] { change(threads()); });
}

template <class Real>
void Organ<Real>::perform(const BringThread& command) {
  change_threads([&](auto& threads) { threads.bring(command.thread, command.material); });
}

template <class Real>
void Organ<Real>::perform(const Bite& command) {
  const Index tet = command.point.tet;
  check_tets({tet});
  for (const Index v : elements().topology.corners(tet))
    if (body_.regions.is_interior(v) && body_.regions.follows(v))
      throw InputError("thread " + std::to_string(command.thread),
                       "cannot pass tetrahedron " + std::to_string(tet) +
                           ": it is inside of a precomputed region; expand that, or make it tensor-mass");
  change_threads([&](auto& threads) { threads.bite(command.thread, command.point, body_.here()); });
}

// A hand that holds the thread already is only led: what acts on the body stays the same.
template <class Real>
void Organ<Real>::perform(const Pull& command) {
  const auto leads = [&](const auto& term) {
    return term->name() == Threads<Real>::term_name &&
           static_cast<Threads<Real>&>(*term).lead(command.thread, command.point);
  };
  if (command.on && std::any_of(body_.terms.begin(), body_.terms.end(), leads))
    return body_.sleep.wake(body_.woken_by_terms(), body_);
  change_threads(
      [&](auto& threads) { threads.pull(command.thread, command.on, command.point, body_.here()); });
}

template <class Real>
void Organ<Real>::perform(const Tie& command) {
  change_threads([&](auto& threads) {
    threads.tie(command.thread, command.from, command.to, command.tighten, command.over, body_.here());
  });
}

template <class Real>
void Organ<Real>::perform(const CutThread& command) {
  change_threads([&](auto& threads) { threads.cut(command.thread, command.after); });
}

}  // namespace lobe
