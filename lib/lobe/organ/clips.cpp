// Clips that tools close in an Organ.
#include "lobe/forces/clips.h"

#include "lobe/organ/organ.h"

namespace lobe {

// A frame that failed begins again: a clip that it has closed is there.
template <class Real>
void Organ<Real>::close(const ClipClosure& closure) {
  auto& clips = static_cast<Clips<Real>&>(own_term(Clips<Real>::term_name));
  if (clips.has(closure.tool, closure.number)) return;
  body_.recover_followers();
  const ClipSetup found =
      Clips<Real>::find(closure, display_.surface(elements(), grains()).mesh(), body_.here());
  if (found.pairs.empty())
    return notice(Condition::Kind::clip,
                  "clip \"" + closure.name +
                      "\" has closed on nothing: no tissue that can move lies between " + "its legs");
  edit_terms({.velocities = true, .followers = true}, [&] { clips.add(found, closure); });
}

}  // namespace lobe
