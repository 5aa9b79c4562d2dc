// Threads in an Organ.
#include "lobe/error.h"
#include "lobe/organ/organ.h"
#include "lobe/setup/exclusions.h"

namespace lobe {

template <class Real>
void Organ<Real>::perform(const BringThread& command) {
  refuse_excluded(Option::force_terms, options_of(setup_), "thread");
  change_term<Threads>([&](auto& threads) { threads.bring(command.thread, command.material); });
}

template <class Real>
void Organ<Real>::check_bite(int thread, const EmbeddedPoint& point) const {
  check_tets({point.tet});
  for (const Index v : elements().topology.corners(point.tet))
    if (body_.regions.is_interior(v) && body_.regions.follows(v))
      throw InputError("thread " + std::to_string(thread),
                       "cannot pass tetrahedron " + std::to_string(point.tet) +
                           ": it is inside of a precomputed region; expand that, or make it tensor-mass");
}

template <class Real>
void Organ<Real>::perform(const Bite& command) {
  check_bite(command.thread, command.point);
  change_term<Threads>([&](auto& threads) { threads.bite(command.thread, command.point, body_.here()); });
}

// A hand that holds the thread already is only led: what acts on the body stays the same.
template <class Real>
void Organ<Real>::perform(const Pull& command) {
  Threads<Real>* threads = term_of<Threads>(body_.terms);
  if (command.on && threads && threads->lead(command.thread, command.point))
    return body_.sleep.wake(body_.woken_by_terms(), body_);
  change_term<Threads>(
      [&](auto& threads) { threads.pull(command.thread, command.on, command.point, body_.here()); });
}

template <class Real>
void Organ<Real>::perform(const Tie& command) {
  change_term<Threads>([&](auto& threads) {
    threads.tie(command.thread, command.from, command.to, command.tighten, command.over, body_.here());
  });
}

template <class Real>
void Organ<Real>::perform(const CutThread& command) {
  change_term<Threads>([&](auto& threads) { threads.cut(command.thread, command.after); });
}

}  // namespace lobe
