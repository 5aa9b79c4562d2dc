// How often advance() is called while a scene plays, and for how long each time.
#pragma once

#include "lobe/scene/scene.h"

namespace lobe {

struct Frames {
  int count = 1;
  double length = 0;  // [s]
};

// The whole duration in equal frames, as long as the scene asks for but for what makes them a whole number.
// To count time until it reaches the duration would not do: it is a sum of rounded frames, and may stop just
// short of it.
//
//   const lobe::Frames frames = lobe::frames_of(scene.time);
//   for (int i = 0; i < frames.count; ++i) world.advance(frames.length);
Frames frames_of(const Time& time);

}  // namespace lobe
