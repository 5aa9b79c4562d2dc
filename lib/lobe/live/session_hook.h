// A hook takes part in every frame of a session, in the session's thread. The hand of a haptic device is one:
// it moves its tool in every frame, and needs the world itself, not only snapshots.
#pragma once

#include "lobe/live/hands.h"

namespace lobe {

template <class Real>
class SessionHook {
 public:
  virtual ~SessionHook() = default;
  // Is called after the commands of a frame were performed and before the tools move.
  virtual void before_frame(Hands<Real>& hands, World<Real>& world, double duration) = 0;
  virtual void after_frame(Hands<Real>& hands, World<Real>& world, double duration) = 0;
};

}  // namespace lobe
