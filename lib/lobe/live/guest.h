// Somebody who takes part in the frames of a session, in its thread: what leads tools faster than commands are
// sent, and wants to know more than pictures tell.
#pragma once

#include "lobe/live/hands.h"

namespace lobe {

template <class Real>
class SessionGuest {
 public:
  virtual ~SessionGuest() = default;
  // Commands have been taken; tools are led next.
  virtual void before_frame(Hands<Real>& hands, World<Real>& world, double duration) = 0;
  virtual void after_frame(Hands<Real>& hands, World<Real>& world, double duration) = 0;
};

}  // namespace lobe
