// Needles in an Organ, and the thread that follows them.
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
}

template <class Real>
std::vector<NeedleBite> Organ<Real>::take_bites() {
  Needles<Real>* needles = term_of<Needles>(body_.terms);
  return needles ? needles->take_bites() : std::vector<NeedleBite>{};
}

// A thread that cannot be sewn there stays as it was.
template <class Real>
void Organ<Real>::sew(int thread, const ThreadMaterial& material, const EmbeddedPoint& point) {
  try {
    const Threads<Real>* threads = term_of<Threads>(body_.terms);
    const auto is_it = [&](const Thread& other) { return other.number == thread; };
    if (!threads || std::none_of(threads->all().begin(), threads->all().end(), is_it))
      perform(BringThread{thread, material});
    perform(Bite{thread, point});
  } catch (const InputError& error) {
    notice(Condition::Kind::lost_force,
           "the needle's thread " + std::to_string(thread) + " is not sewn: " + error.what());
  }
}

}  // namespace lobe
