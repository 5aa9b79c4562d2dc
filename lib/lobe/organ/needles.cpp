// Needles in an Organ, and the threads that follow them.
#include "lobe/forces/needles.h"

#include <algorithm>

#include "lobe/error.h"
#include "lobe/organ/organ.h"

namespace lobe {

template <class Real>
void Organ<Real>::show_needles(std::span<const NeedleBody> needles, double from, double to) {
  if (needles.empty() && !term_of<Needles>(body_.terms)) return;
  auto& term = static_cast<Needles<Real>&>(own_term(Needles<Real>::term_name));
  if (term.see(needles, from, to)) edit({}, [] { return Change{.has_new_terms = true}; });
  Threads<Real>* threads = term_of<Threads>(body_.terms);
  if (!threads) return;
  for (const int tool : threads->needles()) {
    const std::optional<NeedleEnd> end = term.end_of(tool, from, to);
    if (end && term.is_there(tool, from))
      threads->follow_needle(*end);
    else
      edit_terms({.velocities = true, .followers = true}, [&] { threads->leave_needle(tool); });
  }
}

template <class Real>
std::vector<NeedleBite> Organ<Real>::take_bites() {
  Needles<Real>* needles = term_of<Needles>(body_.terms);
  return needles ? needles->take_bites() : std::vector<NeedleBite>{};
}

// A thread that cannot be sewn there stays as it was.
template <class Real>
void Organ<Real>::sew(const NeedleBite& bite, const NeedleThread& thread) {
  const Needles<Real>* needles = term_of<Needles>(body_.terms);
  const std::optional<NeedleEnd> end = needles ? needles->end_of(bite.tool, time(), time()) : std::nullopt;
  if (!end) return;
  try {
    check_bite(thread.number, bite.point);
    const Threads<Real>* threads = term_of<Threads>(body_.terms);
    const auto is_it = [&](const Thread& other) { return other.number == thread.number; };
    if (!threads || std::none_of(threads->all().begin(), threads->all().end(), is_it))
      perform(BringThread{thread.number, thread.material});
    change_term<Threads>([&](auto& each) { each.bite_by_needle(thread, bite.point, *end, body_.here()); });
  } catch (const InputError& error) {
    notice(Condition::Kind::lost_force,
           "the needle's thread " + std::to_string(thread.number) + " is not sewn: " + error.what());
  }
}

}  // namespace lobe
